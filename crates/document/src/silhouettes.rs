//! Edits of how silhouettes are made, and of what is painted over them by hand.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use backlit_formats::footage::BrushStroke;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::segment::changes::BackgroundChange;

use crate::Document;
use crate::edit::{Edit, EditError};

impl Document {
    /// Makes an edit of how silhouettes are made; any other changes nothing.
    pub(crate) fn steer_silhouettes(&mut self, edit: Edit) -> Result<(), EditError> {
        match edit {
            Edit::SetMeasurement(options) => {
                for camera in Arc::make_mut(&mut self.measurement) {
                    *camera = SegmentOptions { region: camera.region, ..(*options).clone() };
                }
            }
            Edit::SetPlates(plates) => {
                self.check_cameras(&plates)?;
                self.plates = Arc::new(plates);
            }
            Edit::FollowPerson(person) => self.person = person,
            Edit::SetChanges(changes) => self.set_changes(changes)?,
            Edit::SetMasks { frame, masks } => {
                self.check_cameras(&masks)?;
                Arc::make_mut(&mut self.masks).entry(frame).or_default().extend(masks);
            }
            Edit::Paint(strokes) => {
                for one in &strokes {
                    self.check_camera(one.camera)?;
                    one.stroke.check()?;
                }
                Arc::make_mut(&mut self.brush).extend(strokes);
            }
            Edit::EraseBrush { camera, frames } => self.erase_brush(camera, frames),
            Edit::SetRegion { camera, region } => {
                self.check_camera(camera)?;
                if region.is_some_and(|region| region.width == 0 || region.height == 0) {
                    return Err(EditError::Region);
                }
                if let Some(options) = Arc::make_mut(&mut self.measurement).get_mut(camera) {
                    options.region = region;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn set_changes(&mut self, changes: Arc<Vec<BackgroundChange>>) -> Result<(), EditError> {
        let count = self.cameras.len();
        if let Some(camera) = changes.iter().map(|change| change.camera).find(|camera| *camera >= count) {
            return Err(EditError::NoCamera { camera, count });
        }
        self.changes = changes;
        Ok(())
    }

    /// Files by camera are of cameras that there are.
    fn check_cameras(&self, files: &BTreeMap<usize, PathBuf>) -> Result<(), EditError> {
        files.keys().try_for_each(|camera| self.check_camera(*camera))
    }

    pub(crate) fn check_camera(&self, camera: usize) -> Result<(), EditError> {
        let count = self.cameras.len();
        if camera < count { Ok(()) } else { Err(EditError::NoCamera { camera, count }) }
    }

    /// Takes away what is painted in some frames of a camera. Strokes that reach beyond the frames stay in the others.
    fn erase_brush(&mut self, camera: usize, [first, last]: [usize; 2]) {
        let meets =
            |one: &BrushStroke| one.camera == camera && one.frames[0] <= last && one.frames[1] >= first;
        if !self.brush.iter().any(meets) {
            return;
        }
        let mut kept = Vec::with_capacity(self.brush.len());
        for one in self.brush.iter() {
            let [from, to] = one.frames;
            let pieces = if meets(one) {
                [(from < first).then(|| [from, first - 1]), (to > last).then(|| [last + 1, to])]
            } else {
                [Some(one.frames), None]
            };
            kept.extend(pieces.into_iter().flatten().map(|frames| BrushStroke { frames, ..one.clone() }));
        }
        self.brush = Arc::new(kept);
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;
    use backlit_tracking::silhouette::{Label, Region, Stroke};

    use super::*;
    use crate::CameraUse;

    fn document() -> Document {
        let mut document = Document::new(builtin::single_limb());
        let camera = |name: &str| CameraUse { name: name.to_owned(), used: true, weight: 1.0 };
        document.cameras = Arc::new(vec![camera("a"), camera("b")]);
        document.measurement = Arc::new(vec![SegmentOptions::default(); 2]);
        document
    }

    fn stroke(camera: usize, frames: [usize; 2]) -> BrushStroke {
        let stroke = Stroke { label: Label::Subject, radius_px: 3.0, points: vec![[1.0, 2.0]] };
        BrushStroke { camera, frames, stroke }
    }

    #[test]
    fn a_stroke_is_erased_in_the_frames_that_are_named() {
        let mut document = document();
        document.apply(Edit::Paint(vec![stroke(0, [2, 9]), stroke(1, [2, 9]), stroke(0, [5, 5])])).unwrap();
        document.apply(Edit::EraseBrush { camera: 0, frames: [5, 6] }).unwrap();
        assert_eq!(*document.brush, [stroke(0, [2, 4]), stroke(0, [7, 9]), stroke(1, [2, 9])]);
        assert!(!document.would_change(&Edit::EraseBrush { camera: 0, frames: [5, 6] }));
    }

    #[test]
    fn what_cannot_be_painted_changes_nothing() {
        let mut document = document();
        let before = document.clone();
        let mut empty = stroke(1, [0, 0]);
        empty.stroke.points.clear();
        let region = Some(Region { x: 3, y: 3, width: 0, height: 9 });
        for edit in [
            Edit::Paint(vec![stroke(0, [0, 0]), stroke(2, [0, 0])]),
            Edit::Paint(vec![empty]),
            Edit::SetRegion { camera: 0, region },
            Edit::SetRegion { camera: 2, region: None },
        ] {
            assert!(document.apply(edit).is_err());
        }
        assert_eq!(document, before);
        assert_eq!(document.apply(Edit::SetRegion { camera: 0, region }), Err(EditError::Region));
    }

    #[test]
    fn a_region_is_one_cameras_own_and_stays_when_settings_change() {
        let mut document = document();
        let region = Some(Region { x: 3, y: 4, width: 10, height: 9 });
        document.apply(Edit::SetRegion { camera: 1, region }).unwrap();
        let options = SegmentOptions { closing_px: 7, ..SegmentOptions::default() };
        document.apply(Edit::SetMeasurement(Box::new(options))).unwrap();
        let regions: Vec<_> = document.measurement.iter().map(|options| options.region).collect();
        assert_eq!((regions, document.measurement[1].closing_px), (vec![None, region], 7));
    }
}
