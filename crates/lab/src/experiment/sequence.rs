//! A sequence as section 5.2 of the report has one: silhouettes in small pictures, and a pose to begin with.
//!
//! It is simulated, or a take's: then each camera's silhouette is measured in the take's own pictures, and a window of
//! them is reduced to the size asked for. The window is the largest of that shape, about the person; portrait pictures
//! are reduced to portrait ones. A small pixel is what most of its area is.

use std::sync::Arc;

use backlit_formats::Footage;
use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::camera::{Camera, Distortion, Intrinsics};
use backlit_tracking::fit::{Evidence, FitView};
use backlit_tracking::metrics::{JointErrors, ReferenceJoints};
use backlit_tracking::silhouette::{Label, Mask};
use glam::DVec2;

use super::ExperimentError;
use crate::synthetic::{capsules, upper_body};

/// A body in front of cameras, frame after frame.
#[derive(Debug, Clone)]
pub struct Sequence {
    /// What it is, for titles.
    pub name: String,
    /// The body.
    pub model: Arc<Model>,
    /// Frames a second.
    pub frame_rate: f64,
    /// A pose near the first frame's, without noise.
    pub start: Pose,
    /// The frames.
    pub moments: Vec<Moment>,
}

/// One frame.
#[derive(Debug, Clone)]
pub struct Moment {
    /// A hard mask of every camera.
    pub views: Vec<FitView>,
    /// Where joints are known to be, world, metres; none where nothing is known.
    pub joints: ReferenceJoints,
    /// The true pose of a simulation.
    pub truth: Option<Pose>,
}

impl Moment {
    /// Mean distance of a pose's joints from those that are known, millimetres; `None` where none are.
    #[must_use]
    pub fn joint_error_mm(&self, model: &Model, pose: &Pose) -> Option<f64> {
        let mut errors = JointErrors::default();
        errors.add(model, pose, &self.joints);
        errors.overall().map(|errors| errors.mean)
    }
}

impl Sequence {
    /// The upper body through its movement, by hard masks of its own capsules.
    ///
    /// # Errors
    /// Numbers that make no cameras, or no frame.
    pub fn simulated(size_px: [u64; 2], cameras: usize, frames: usize) -> Result<Self, ExperimentError> {
        some_frames(frames)?;
        let model = Arc::new(builtin::upper_body());
        let cameras = upper_body::cameras(cameras, size_px)?;
        let moment = |frame| {
            let truth = upper_body::motion(&model, frame);
            let see = |camera: &Arc<Camera>| -> Result<FitView, ExperimentError> {
                Ok(FitView::of_mask(camera.clone(), capsules::hard_mask(&model, &truth, camera)?))
            };
            let views = cameras.iter().map(see).collect::<Result<Vec<_>, _>>()?;
            let kinematics = Kinematics::new(&model, &truth);
            let joints = kinematics.ends().iter().enumerate().map(|(limb, &end)| (Some(limb), end)).collect();
            Ok(Moment { views, joints, truth: Some(truth) })
        };
        let moments = (0..frames).map(moment).collect::<Result<Vec<_>, ExperimentError>>()?;
        Ok(Self {
            name: "simulated upper body".to_owned(),
            start: upper_body::motion(&model, 0),
            frame_rate: upper_body::FRAME_RATE,
            model,
            moments,
        })
    }

    /// The first frames of a take, reduced to pictures of this size, or of the same stood on end.
    ///
    /// # Errors
    /// A picture that cannot be had, or no frame.
    pub fn of_take(
        footage: &Footage,
        cameras: &[usize],
        frames: usize,
        start: Pose,
        size_px: [u64; 2],
    ) -> Result<Self, ExperimentError> {
        some_frames(frames)?;
        let take = footage.take();
        let whole: Vec<Vec<FitView>> =
            (0..frames).map(|frame| footage.fit_views(cameras, frame)).collect::<Result<_, _>>()?;
        let windows: Vec<Window> = (0..cameras.len())
            .map(|camera| Window::about_the_person(whole.iter().map(|views| &views[camera]), size_px))
            .collect();
        let reduced = |(frame, views): (usize, &Vec<FitView>)| {
            let views = views.iter().zip(&windows).map(|(view, window)| window.reduced(view));
            let joints = take.reference().map(|reference| reference.joints(frame)).unwrap_or_default();
            Ok(Moment { views: views.collect::<Result<_, ExperimentError>>()?, joints, truth: None })
        };
        let moments = whole.iter().enumerate().map(reduced).collect::<Result<Vec<_>, ExperimentError>>()?;
        let (name, frame_rate, model) = (take.name().to_owned(), take.frame_rate(), take.model().clone());
        Ok(Self { name, model, frame_rate, start, moments })
    }
}

fn some_frames(frames: usize) -> Result<(), ExperimentError> {
    if frames == 0 {
        return Err(ExperimentError::Option { option: "frames", value: 0.0, expected: "1 or more" });
    }
    Ok(())
}

/// A part of one camera's pictures, and the size that it is reduced to.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Window {
    /// Its first corner, pixels from the picture's own; edges, not centres.
    corner: DVec2,
    /// Pixels that one small pixel is wide and high.
    scale: f64,
    size_px: [u64; 2],
}

impl Window {
    /// The largest window that all pictures have, as near to the middle of the person as it can be.
    fn about_the_person<'a>(views: impl Iterator<Item = &'a FitView>, size_px: [u64; 2]) -> Self {
        let (mut whole, mut low, mut high) = (DVec2::ONE, DVec2::INFINITY, DVec2::NEG_INFINITY);
        for view in views {
            whole = DVec2::new(view.camera.width() as f64, view.camera.height() as f64);
            if let Evidence::Mask(mask) = &view.evidence
                && let Some(found) = mask.bounds()
            {
                low = low.min(DVec2::new(found.x_min as f64, found.y_min as f64));
                high = high.max(DVec2::new(found.x_max as f64 + 1.0, found.y_max as f64 + 1.0));
            }
        }
        let is_on_end = (whole.y > whole.x) != (size_px[1] > size_px[0]);
        let size_px = if is_on_end { [size_px[1], size_px[0]] } else { size_px };
        let size = DVec2::new(size_px[0] as f64, size_px[1] as f64);
        let scale = (whole / size).min_element();
        let middle = if low.is_finite() { 0.5 * (low + high) } else { 0.5 * whole };
        let corner =
            (middle - 0.5 * scale * size).clamp(DVec2::ZERO, (whole - scale * size).max(DVec2::ZERO));
        Self { corner, scale, size_px }
    }

    fn reduced(&self, view: &FitView) -> Result<FitView, ExperimentError> {
        let pinhole = view.camera.intrinsics();
        // Between centres at integers lie edges at halves.
        let centre = (DVec2::new(pinhole.cx, pinhole.cy) + 0.5 - self.corner) / self.scale - 0.5;
        let intrinsics = Intrinsics {
            fx: pinhole.fx / self.scale,
            fy: pinhole.fy / self.scale,
            cx: centre.x,
            cy: centre.y,
        };
        let place = *view.camera.camera_from_world();
        let camera = Camera::new(view.camera.name(), self.size_px, intrinsics, Distortion::None, place)?;
        let Evidence::Mask(mask) = &view.evidence else {
            return Ok(FitView { camera: Arc::new(camera), ..view.clone() });
        };
        let [columns, rows] = [(0, mask.width()), (1, mask.height())].map(|(axis, pixels)| {
            let covered =
                |small: u64| self.covered(self.corner.to_array()[axis] + self.scale * small as f64, pixels);
            (0..self.size_px[axis]).map(covered).collect::<Vec<_>>()
        });
        let label = |(row, column): (&Covered, &Covered)| {
            let mut areas = [0.0; 3];
            for &(y, high) in row {
                for &(x, wide) in column {
                    let index = LABELS.iter().position(|&label| mask.get(x, y) == Some(label));
                    areas[index.unwrap_or(2)] += high * wide;
                }
            }
            let most = (0..3).max_by(|&a, &b| f64::total_cmp(&areas[a], &areas[b]));
            LABELS[most.unwrap_or(2)]
        };
        let labels = rows.iter().flat_map(|row| columns.iter().map(move |column| (row, column))).map(label);
        let small = Mask::new(columns.len(), rows.len(), labels.collect())?;
        Ok(FitView { weight: view.weight, ..FitView::of_mask(camera, small) })
    }

    /// The pixels under a small one that begins here, each with how much of it.
    fn covered(&self, from: f64, pixels: usize) -> Covered {
        let past = from + self.scale;
        let first = from.max(0.0) as usize;
        (first..pixels)
            .take_while(|&pixel| (pixel as f64) < past)
            .map(|pixel| (pixel, (past.min(pixel as f64 + 1.0) - from.max(pixel as f64)).max(0.0)))
            .collect()
    }
}

/// Pixels along one axis, each with how much of it counts.
type Covered = Vec<(usize, f64)>;

const LABELS: [Label; 3] = [Label::Subject, Label::Background, Label::Unknown];

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// A picture reduced to half its size shows every point at half its place, and the silhouette goes with it.
    #[test]
    fn reduced_pictures_are_seen_by_reduced_cameras() {
        let whole = Sequence::simulated([192, 144], 2, 2).unwrap();
        let half = Sequence::simulated([96, 72], 2, 2).unwrap();
        for (whole, half) in whole.moments.iter().zip(&half.moments) {
            for (whole, half) in whole.views.iter().zip(&half.views) {
                let window = Window::about_the_person([whole].into_iter(), [96, 72]);
                let small = window.reduced(whole).unwrap();
                let point = DVec3::new(0.2, 0.5, -0.1);
                let [a, b] = [&small, half].map(|view| view.camera.project(point).unwrap());
                assert!(a.distance(b) < 1e-9, "{a} {b}");
                let (Evidence::Mask(a), Evidence::Mask(b)) = (&small.evidence, &half.evidence) else {
                    panic!("masks")
                };
                let differ = a.labels().iter().zip(b.labels()).filter(|(a, b)| a != b).count();
                assert!(differ * 20 < b.count(Label::Subject), "{differ} pixels differ");
            }
        }
    }

    /// The window of a portrait picture stands on end and has the person in it.
    #[test]
    fn a_window_is_about_the_person() {
        let camera = &upper_body::cameras(1, [272, 480]).unwrap()[0];
        let mut mask = Mask::filled(272, 480, Label::Background).unwrap();
        for y in 300..470 {
            mask.labels_mut()[y * 272 + 100..y * 272 + 140].fill(Label::Subject);
        }
        let view = FitView::of_mask(camera.clone(), mask);
        let window = Window::about_the_person([&view].into_iter(), [192, 144]);
        assert_eq!(window.size_px, [144, 192]);
        assert!((window.scale - 272.0 / 144.0).abs() < 1e-12 && window.corner.x == 0.0, "{window:?}");
        let bottom = window.corner.y + window.scale * 192.0;
        assert!((bottom - 480.0).abs() < 1e-9, "{window:?}");
        let small = window.reduced(&view).unwrap();
        let Evidence::Mask(mask) = &small.evidence else { panic!("a mask") };
        let share = mask.count(Label::Subject) as f64 * window.scale.powi(2) / (170.0 * 40.0);
        assert!((share - 1.0).abs() < 0.03, "{share}");
    }

    #[test]
    fn simulated_joints_are_those_of_the_truth() {
        let sequence = Sequence::simulated([48, 36], 2, 3).unwrap();
        for moment in &sequence.moments {
            assert_eq!(moment.joint_error_mm(&sequence.model, moment.truth.as_ref().unwrap()), Some(0.0));
        }
        let none = Moment { joints: Vec::new(), ..sequence.moments[0].clone() };
        assert_eq!(none.joint_error_mm(&sequence.model, &sequence.start), None);
        assert!(Sequence::simulated([48, 36], 2, 0).is_err());
    }
}
