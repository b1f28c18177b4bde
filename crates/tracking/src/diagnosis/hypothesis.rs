//! What may be wrong: a kind of fault, of which camera, in which of its forms; and what repairs it, given its size.

use glam::{DMat3, DVec2, DVec3};

use super::calibration::{axis_turns, placed, renamed, turned_for, with_lens};
use super::fault::{FaultKind, Size};
use super::outlines::Clock;
use crate::camera::{Camera, Distortion, Intrinsics};
use crate::geometry::rotation::exp;

/// Factors by which lengths are taken for others: millimetres, centimetres, decimetres, feet and inches for metres.
pub(super) const UNITS: [f64; 5] = [1000.0, 100.0, 10.0, 0.3048, 0.0254];
/// Frame rates of cameras, for which one another are taken.
const RATES: [f64; 8] = [24.0, 25.0, 30.0, 50.0, 60.0, 100.0, 120.0, 240.0];
/// Pictures were scaled by less than this with another name: the focal length is wrong.
const LEAST_SCALE: f64 = 0.02;
/// Nor are they scaled by more, as a logarithm.
const MOST_SCALE: f64 = 2.2;

/// One hypothesis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hypothesis {
    pub(super) kind: FaultKind,
    /// `None`: all cameras.
    pub(super) camera: Option<usize>,
    /// Which of the kind's forms.
    pub(super) form: usize,
}

/// A number of a hypothesis that is fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Parameter {
    /// How large it usually is.
    pub(super) usual: f64,
    /// Step of differences.
    pub(super) step: f64,
}

/// Cameras and clocks with a fault repaired.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Repair {
    /// By camera; those that are not named stay.
    pub(super) cameras: Vec<(usize, Camera)>,
    pub(super) clock: Clock,
    /// The repaired camera counts from here on only, seconds.
    pub(super) after: Option<f64>,
}

const TURN: Parameter = Parameter { usual: 0.05, step: 3e-4 };
const SHIFT: Parameter = Parameter { usual: 0.1, step: 1e-3 };
const LOG_FOCAL: Parameter = Parameter { usual: 0.1, step: 1e-3 };
const LOG_SCALE: Parameter = Parameter { usual: 0.7, step: 1e-3 };
/// In picture heights.
const PRINCIPAL: Parameter = Parameter { usual: 0.05, step: 3e-4 };
const OFFSET: Parameter = Parameter { usual: 1.0, step: 5e-3 };
const DRIFT: Parameter = Parameter { usual: 0.01, step: 1e-4 };

impl Hypothesis {
    /// All for so many cameras.
    pub(super) fn all(cameras: &[Camera]) -> Vec<Self> {
        use FaultKind as K;
        let count = cameras.len();
        let mut all = Vec::new();
        let mut add = |kind, camera, forms: usize| {
            all.extend((0..forms).map(|form| Self { kind, camera, form }));
        };
        for kind in [K::InvertedExtrinsics, K::CameraAxes] {
            add(kind, None, FORMS);
        }
        for (index, camera) in cameras.iter().enumerate() {
            let own = Some(index);
            add(K::PictureTurned, own, if camera.width() == camera.height() { 3 } else { 1 });
            add(K::PictureScaled, own, SCALES.len());
            add(K::InvertedExtrinsics, own, FORMS);
            add(K::Unit, own, 2 * UNITS.len());
            add(K::WorldAxes, own, 23);
            add(K::CameraAxes, own, FORMS);
            // Each pair of cameras once.
            add(K::Swapped, own, index);
            add(K::LensOrder, own, lens_orders(camera.distortion()).len());
            for kind in [K::Focal, K::PrincipalPoint, K::Turned, K::Shifted, K::Moved, K::Offset, K::Drift] {
                add(kind, own, 1);
            }
            if count > 2 {
                add(K::Bumped, own, BUMPS.len());
            }
            add(K::FrameRate, own, rates().len());
        }
        all
    }

    /// What is fitted.
    pub(super) fn parameters(&self) -> Vec<Parameter> {
        match self.kind {
            FaultKind::PictureScaled => vec![LOG_SCALE],
            FaultKind::Focal => vec![LOG_FOCAL],
            FaultKind::PrincipalPoint => vec![PRINCIPAL; 2],
            FaultKind::Turned => vec![TURN; 3],
            FaultKind::Shifted => vec![SHIFT; 3],
            FaultKind::Moved | FaultKind::Bumped => vec![TURN, TURN, TURN, SHIFT, SHIFT, SHIFT],
            FaultKind::Offset | FaultKind::FrameRate => vec![OFFSET],
            FaultKind::Drift => vec![OFFSET, DRIFT],
            _ => Vec::new(),
        }
    }

    /// Where the fit begins.
    pub(super) fn start(&self) -> Vec<f64> {
        match self.kind {
            FaultKind::PictureScaled => vec![SCALES[self.form].ln()],
            _ => vec![0.0; self.parameters().len()],
        }
    }

    /// Cameras and clocks with the fault repaired; `span` is the time of the recording. `None` where that is no camera.
    pub(super) fn repair(
        &self,
        cameras: &[Camera],
        by: &[f64],
        span: [f64; 2],
        split: f64,
    ) -> Option<Repair> {
        let repaired = |index: usize| Some((index, self.repaired(cameras, index, by)?));
        let cameras = match self.camera {
            None => (0..cameras.len()).map(repaired).collect::<Option<Vec<_>>>()?,
            Some(camera) if self.kind == FaultKind::Swapped => {
                vec![repaired(camera)?, (self.form, renamed(&cameras[self.form], &cameras[camera])?)]
            }
            Some(camera) if self.kind.is_clock() => vec![(camera, cameras[camera].clone())],
            Some(camera) => vec![repaired(camera)?],
        };
        // A drift turns about the middle of the recording, so that it is not an offset too.
        let middle = 0.5 * (span[0] + span[1]);
        let clock = match self.kind {
            FaultKind::Offset => Clock { offset_s: by[0], rate: 1.0 },
            FaultKind::Drift => Clock { offset_s: by[0] - by[1] * middle, rate: 1.0 + by[1] },
            FaultKind::FrameRate => Clock { offset_s: by[0], rate: rates()[self.form] },
            _ => Clock::RIGHT,
        };
        Some(Repair { cameras, clock, after: (self.kind == FaultKind::Bumped).then_some(split) })
    }

    fn repaired(&self, cameras: &[Camera], index: usize, by: &[f64]) -> Option<Camera> {
        let camera = cameras.get(index)?;
        let place = *camera.camera_from_world();
        let (k, lens) = (*camera.intrinsics(), *camera.distortion());
        let (rotation, translation) = (place.rotation, place.translation);
        let vector = |from: usize| DVec3::new(by[from], by[from + 1], by[from + 2]);
        let moved = |turn: DVec3, shift: DVec3| {
            let rotation = DMat3::from_quat(exp(turn)) * rotation;
            placed(camera, rotation, -(rotation * (place.centre() + shift)))
        };
        match self.kind {
            FaultKind::PictureTurned => turned_for(camera, 2 + self.form * 3),
            FaultKind::PictureScaled => {
                let scale = by[0].exp();
                let at = |x: f64| (x + 0.5) * scale - 0.5;
                let k = Intrinsics { fx: k.fx * scale, fy: k.fy * scale, cx: at(k.cx), cy: at(k.cy) };
                with_lens(camera, k, lens)
            }
            FaultKind::InvertedExtrinsics => {
                let inverse = rotation.transpose();
                match self.form {
                    0 => placed(camera, inverse, -(inverse * translation)),
                    1 => placed(camera, inverse, translation),
                    2 => placed(camera, rotation, -(rotation * translation)),
                    _ => placed(camera, inverse, -(rotation * translation)),
                }
            }
            FaultKind::Unit => {
                let unit = UNITS[self.form / 2];
                let factor = if self.form.is_multiple_of(2) { unit } else { 1.0 / unit };
                placed(camera, rotation, translation * factor)
            }
            FaultKind::WorldAxes => placed(camera, rotation * axis_turns()[self.form], translation),
            FaultKind::CameraAxes => {
                let half = [DVec3::new(1.0, -1.0, -1.0), DVec3::new(-1.0, 1.0, -1.0)][self.form % 2];
                let flip = DMat3::from_diagonal(half);
                if self.form < 2 {
                    placed(camera, flip * rotation, flip * translation)
                } else {
                    // World from camera, as OpenGL and Blender write it.
                    let inverse = rotation.transpose();
                    placed(camera, flip * inverse, -(flip * inverse * translation))
                }
            }
            FaultKind::Swapped => renamed(camera, cameras.get(self.form)?),
            FaultKind::LensOrder => with_lens(camera, k, *lens_orders(&lens).get(self.form)?),
            FaultKind::Focal => {
                let factor = by[0].exp();
                with_lens(camera, Intrinsics { fx: k.fx * factor, fy: k.fy * factor, ..k }, lens)
            }
            FaultKind::PrincipalPoint => {
                let offset = DVec2::new(by[0], by[1]) * camera.height() as f64;
                with_lens(camera, Intrinsics { cx: k.cx + offset.x, cy: k.cy + offset.y, ..k }, lens)
            }
            FaultKind::Turned => moved(vector(0), DVec3::ZERO),
            FaultKind::Shifted => moved(DVec3::ZERO, vector(0)),
            FaultKind::Moved | FaultKind::Bumped => moved(vector(0), vector(3)),
            FaultKind::Offset | FaultKind::Drift | FaultKind::FrameRate => Some(camera.clone()),
        }
    }

    /// How large the fault is that is repaired by these numbers: the error of the calibration, the opposite of its repair.
    pub(super) fn sizes(&self, camera: &Camera, by: &[f64], deviations: &[f64]) -> Vec<Size> {
        let size = |what, value: f64, deviation: Option<f64>, unit| Size { what, value, deviation, unit };
        let vector = |from: usize| DVec3::new(by[from], by[from + 1], by[from + 2]);
        let of_vector = |from: usize| {
            let sum: f64 = (from..from + 3).map(|at| (deviations[at] * by[at]).powi(2)).sum();
            let length = vector(from).length();
            if length > 0.0 { sum.sqrt() / length } else { deviations[from] }
        };
        let turn = || size("turn", vector(0).length().to_degrees(), Some(of_vector(0).to_degrees()), "°");
        let shift = |from| size("shift", 100.0 * vector(from).length(), Some(100.0 * of_vector(from)), "cm");
        let percent = |what| {
            let wrong = (-by[0]).exp();
            size(what, 100.0 * (wrong - 1.0), Some(100.0 * wrong * deviations[0]), "%")
        };
        match self.kind {
            FaultKind::PictureTurned => vec![size("turn", [180.0, 90.0, 270.0][self.form % 3], None, "°")],
            FaultKind::PictureScaled => {
                vec![size("scale", by[0].exp(), Some(by[0].exp() * deviations[0]), "×")]
            }
            FaultKind::Unit => {
                let unit = UNITS[self.form / 2];
                vec![size("unit", if self.form.is_multiple_of(2) { 1.0 / unit } else { unit }, None, "×")]
            }
            FaultKind::Focal => vec![percent("focal length")],
            FaultKind::PrincipalPoint => {
                let height = camera.height() as f64;
                let of = |what, at: usize| size(what, -by[at] * height, Some(deviations[at] * height), "px");
                vec![of("across", 0), of("down", 1)]
            }
            FaultKind::Turned => vec![turn()],
            FaultKind::Shifted => vec![shift(0)],
            FaultKind::Moved | FaultKind::Bumped => vec![turn(), shift(3)],
            FaultKind::Offset => vec![size("offset", -by[0], Some(deviations[0]), "s")],
            FaultKind::Drift => vec![
                size("drift", -1000.0 * by[1], Some(1000.0 * deviations[1]), "ms a second"),
                size("offset", -by[0], Some(deviations[0]), "s"),
            ],
            FaultKind::FrameRate => {
                vec![
                    size("rate", 1.0 / rates()[self.form], None, "×"),
                    size("offset", -by[0], Some(deviations[0]), "s"),
                ]
            }
            _ => Vec::new(),
        }
    }

    /// What it has to explain before it is believed, nats: ½ k ln n for its k sizes, and how unusual its size and its kind are.
    pub(super) fn cost(&self, by: &[f64], ln_samples: f64) -> f64 {
        let parameters = self.parameters();
        let unusual =
            by.iter().zip(&parameters).map(|(by, parameter)| (by / parameter.usual).powi(2).min(9.0));
        // The moment of a move is a size too.
        let sizes = parameters.len() + usize::from(self.kind == FaultKind::Bumped);
        0.5 * sizes as f64 * ln_samples + 0.5 * unusual.sum::<f64>() + self.kind.rarity()
    }

    /// Whether fitted numbers are a fault of this kind at all: not too small to matter, and not so large that all that is seen comes
    /// together in a point.
    pub(super) fn is_credible(&self, by: &[f64]) -> bool {
        match self.kind {
            FaultKind::PictureScaled => (LEAST_SCALE..MOST_SCALE).contains(&by[0].abs()),
            FaultKind::Focal => by[0].abs() < MOST_SCALE,
            _ => true,
        }
    }
}

/// Forms of [`FaultKind::InvertedExtrinsics`] and of [`FaultKind::CameraAxes`].
const FORMS: usize = 4;
/// Where fits of scaled pictures begin.
const SCALES: [f64; 5] = [0.25, 0.5, 0.75, 1.5, 2.0];
/// Where a camera may have been moved, shares of the recording.
pub(super) const BUMPS: [f64; 3] = [0.25, 0.5, 0.75];

/// Factors of a camera's times if it films at another rate than is believed.
fn rates() -> Vec<f64> {
    let mut all: Vec<f64> = Vec::new();
    for believed in RATES {
        for filmed in RATES {
            let rate: f64 = believed / filmed;
            let is_new = all.iter().all(|other| (other / rate - 1.0).abs() > 1e-6);
            if is_new && (rate - 1.0).abs() > 1e-6 && (0.24..=4.2).contains(&rate) {
                all.push(rate);
            }
        }
    }
    all
}

/// The same coefficients in other orders, and none at all: the pictures were freed of the lens already.
fn lens_orders(lens: &Distortion) -> Vec<Distortion> {
    match *lens {
        Distortion::OpenCv { k1, k2, p1, p2, k3 } => [
            [k1, k2, p2, k3, p1],
            [k1, k2, k3, p1, p2],
            [k1, k2, p2, p1, k3],
            [k2, k1, p1, p2, k3],
            [p1, p2, k1, k2, k3],
        ]
        .into_iter()
        .filter(|other| *other != [k1, k2, p1, p2, k3])
        .map(|[k1, k2, p1, p2, k3]| Distortion::OpenCv { k1, k2, p1, p2, k3 })
        .chain([Distortion::None])
        .collect(),
        Distortion::None => Vec::new(),
        _ => vec![Distortion::None],
    }
}
