//! Outlines of silhouettes in pixels of the pictures as they were taken, so that any camera can be asked where it would see them.

use glam::{DVec2, DVec3};

use crate::camera::Camera;
use crate::synchronise::Recording;
use crate::synchronise::outline::{Corner, Sighting};

/// One camera's outlines over time.
#[derive(Debug, Clone)]
pub(super) struct Outlines {
    frames: Vec<Outline>,
}

#[derive(Debug, Clone)]
struct Outline {
    seconds: f64,
    area: f64,
    /// Pixels, and whether the subject may go on there.
    corners: Vec<(DVec2, bool)>,
    /// Pixels of joints that keypoints show.
    keypoints: Vec<Option<DVec2>>,
}

/// When a camera's clock says what, beside what it is believed to say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Clock {
    pub(super) offset_s: f64,
    /// Seconds of the others in one of its seconds.
    pub(super) rate: f64,
}

impl Clock {
    pub(super) const RIGHT: Self = Self { offset_s: 0.0, rate: 1.0 };

    /// The time of all, of a time by this clock.
    pub(super) fn common(self, own: f64) -> f64 {
        self.rate * own + self.offset_s
    }

    /// The time by this clock, of a time of all.
    pub(super) fn own(self, common: f64) -> f64 {
        (common - self.offset_s) / self.rate
    }

    /// Both changes, this one first.
    pub(super) fn then(self, other: Self) -> Self {
        Self { offset_s: other.common(self.offset_s), rate: self.rate * other.rate }
    }
}

impl Outlines {
    /// `lens` is the camera of the pictures as they were taken; the recording's may be without the lens.
    pub(super) fn of(recording: &Recording, lens: &Camera) -> Self {
        let centre = recording.camera.centre();
        let outline = |sighting: &Sighting| Outline {
            seconds: sighting.seconds,
            area: sighting.area,
            corners: sighting
                .hull
                .iter()
                .filter_map(|corner| Some((lens.project(centre + corner.ray)?, corner.is_open)))
                .collect(),
            keypoints: sighting.keypoints.iter().map(|ray| lens.project(centre + (*ray)?)).collect(),
        };
        Self { frames: recording.sightings.iter().map(outline).collect() }
    }

    /// Every `every`th frame.
    pub(super) fn thinned(&self, every: usize) -> Self {
        Self { frames: self.frames.iter().step_by(every.max(1)).cloned().collect() }
    }

    pub(super) fn frame_count(&self) -> usize {
        self.frames.len()
    }

    /// Angle between the farthest two corners as a camera sees them, by frame, and the ray of their middle; `None` where nothing is
    /// seen, or not all of it.
    pub(super) fn extents(&self, camera: &Camera) -> impl Iterator<Item = Option<(f64, DVec3)>> {
        self.frames.iter().map(|outline| {
            if outline.corners.iter().any(|corner| corner.1) {
                return None;
            }
            let rays: Vec<DVec3> =
                outline.corners.iter().filter_map(|corner| camera.ray_in_world(corner.0)).collect();
            let middle = rays.iter().copied().sum::<DVec3>().try_normalize()?;
            let widest = rays.iter().flat_map(|a| rays.iter().map(|b| a.dot(*b))).fold(1.0, f64::min);
            Some((widest.clamp(-1.0, 1.0).acos(), middle))
        })
    }

    /// What this camera would have recorded.
    pub(super) fn seen_by(&self, camera: &Camera) -> Recording {
        let sighting = |outline: &Outline| {
            let corner = |&(pixel, is_open): &(DVec2, bool)| {
                let ray: DVec3 = camera.ray_in_world(pixel)?;
                Some(Corner { ray, is_open })
            };
            Sighting {
                seconds: outline.seconds,
                hull: outline.corners.iter().filter_map(corner).collect(),
                area: outline.area,
                keypoints: outline.keypoints.iter().map(|pixel| camera.ray_in_world((*pixel)?)).collect(),
                cells: None,
            }
        };
        let sightings = self.frames.iter().map(sighting).collect();
        Recording { camera: camera.clone(), sightings, pictures: None, wrong_size: None }
    }
}

/// Recordings as others would have them, for faults of known size.
impl Recording {
    /// What would have been recorded if the camera of the pictures were believed to be `lens`, not `own`.
    #[must_use]
    pub fn with_calibration(&self, own: &Camera, lens: &Camera) -> Self {
        let mut other = Outlines::of(self, own).seen_by(lens);
        for (other, own) in other.sightings.iter_mut().zip(&self.sightings) {
            other.cells.clone_from(&own.cells);
        }
        let pictures = || Box::new([self.camera.clone(), own.clone()]);
        other.pictures = Some(self.pictures.clone().unwrap_or_else(pictures));
        other
    }

    /// The same with outlines alone: for rays that were turned as if another camera had filmed them.
    #[must_use]
    pub fn outlines_only(&self) -> Self {
        let sighting = |sighting: &Sighting| Sighting { cells: None, ..sighting.clone() };
        Self { sightings: self.sightings.iter().map(sighting).collect(), ..self.clone() }
    }

    /// The same by another clock, given its time for each of this one's.
    #[must_use]
    pub fn with_clock(&self, other: impl Fn(f64) -> f64) -> Self {
        let sighting =
            |sighting: &Sighting| Sighting { seconds: other(sighting.seconds), ..sighting.clone() };
        Self { sightings: self.sightings.iter().map(sighting).collect(), ..self.clone() }
    }

    /// This one up to a time, and another one of as many frames from then on.
    #[must_use]
    pub fn continued_by(&self, other: &Self, from_s: f64) -> Self {
        let both = self.sightings.iter().zip(&other.sightings);
        let sighting = |(own, other): (&Sighting, &Sighting)| {
            if own.seconds >= from_s { other.clone() } else { own.clone() }
        };
        Self { sightings: both.map(sighting).collect(), ..self.clone() }
    }
}
