//! What is painted over silhouettes by hand.

use std::sync::Arc;

use backlit_formats::footage::BrushStroke;

use crate::Document;

impl Document {
    /// Takes away what is painted in some frames of a camera. Strokes that reach beyond the frames stay in the others.
    pub(crate) fn erase_brush(&mut self, camera: usize, [first, last]: [usize; 2]) {
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
    use backlit_tracking::segment::SegmentOptions;
    use backlit_tracking::silhouette::{Label, Region, Stroke};

    use super::*;
    use crate::edit::{Edit, EditError};
    use crate::{CameraUse, Document};

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
