//! Cameras that are late by whole frames.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

use super::cameras::CameraState;
use crate::fit::FitView;

/// By how many whole frames each camera is late: its evidence is taken from that many frames earlier, so that all see nearly
/// the same moment.
pub(super) struct WholeFrames {
    pub(super) earlier: Vec<isize>,
    /// The recording's.
    frames: RangeInclusive<usize>,
}

impl WholeFrames {
    pub(super) fn of(changes: &[CameraState], frame_rate: f64, frames: RangeInclusive<usize>) -> Self {
        let earlier = changes.iter().map(|change| (change.late_s * frame_rate).round() as isize).collect();
        Self { earlier, frames }
    }

    /// What the cameras see, without those that had not begun or have ended.
    pub(super) fn views<E>(
        &self,
        frame: usize,
        views: &mut impl FnMut(usize) -> Result<Vec<FitView>, E>,
    ) -> Result<Vec<FitView>, E> {
        let mut found = BTreeMap::new();
        for &earlier in self.earlier.iter().collect::<BTreeSet<_>>() {
            let own = frame.checked_add_signed(-earlier).filter(|own| self.frames.contains(own));
            let Some(own) = own else { continue };
            let cameras = views(own)?.into_iter().enumerate();
            found.extend(cameras.filter(|(camera, _)| self.earlier.get(*camera) == Some(&earlier)));
        }
        Ok(found.into_values().collect())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::fit::Evidence;
    use crate::fixtures;
    use crate::silhouette::{Label, Mask};
    use glam::DVec3;

    #[test]
    fn a_late_camera_is_read_from_an_earlier_frame() {
        let late = |late_s| CameraState { late_s, ..CameraState::default() };
        let clocks = WholeFrames::of(&[late(0.01), late(0.06), late(-0.06)], 30.0, 10..=20);
        let camera = Arc::new(fixtures::camera([4, 4], [4.0, 4.0, 1.5, 1.5], DVec3::X, DVec3::Z, DVec3::Z));
        let mask = Arc::new(Mask::filled(4, 4, Label::Subject).unwrap());
        // Its weight tells from which frame a view is.
        let mut views = |frame: usize| -> Result<Vec<FitView>, ()> {
            let evidence = Evidence::Mask(mask.clone());
            Ok(vec![FitView { camera: camera.clone(), evidence, weight: frame as f64 }; 3])
        };
        let mut frames = |frame: usize| -> Vec<f64> {
            clocks.views(frame, &mut views).unwrap().iter().map(|view| view.weight).collect()
        };
        assert_eq!(frames(15), [15.0, 13.0, 17.0]);
        assert_eq!(frames(10), [10.0, 12.0], "the second camera had not begun");
    }
}
