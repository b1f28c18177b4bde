//! Shadows: what each way to tell them from the subject makes of both, and of the joints.
//!
//! The clothed figure in empty rooms whose truth is known: walls and floor of one grey, plain or blotched all over; lamps
//! half a metre broad, or a twentieth of that, with hard shadows; a red shirt, or one of the walls' own grey. [`noise`] asks
//! how often noise alone passes for a subject.

pub mod noise;

use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Evidence, Fit, FitError, FitOptions, FitView, Preset};
use backlit_tracking::search::start::perturb;
use backlit_tracking::segment::{Background, SegmentOptions, ShadowOptions, ShadowTest, segment};
use backlit_tracking::silhouette::{Label, Mask, PixelClass};
use backlit_tracking::statistics::Statistics;
use glam::DVec3;
use image::RgbImage;
use serde::Serialize;

use self::noise::NoiseCase;
use super::{ExperimentError, Progress};
use crate::synthetic::{Build, Figure, Lighting, Plate, Room, Sensor, motion, silhouette, studio};

/// Linear reflectance of walls, floor and the grey shirt.
const GREY: f64 = 0.42;
/// Sides of the lamps that throw hard shadows, of the usual ones.
const NARROW: f64 = 0.05;
/// The way that is given the truth instead of a segmentation.
pub const TRUTH: &str = "true silhouettes";

/// A room, its light and who is in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Scenery {
    /// Whether walls and floor are blotched, not plain.
    pub blotched_walls: bool,
    /// Whether the lamps are narrow.
    pub hard_shadows: bool,
    /// Whether the shirt is of the walls' grey, not red.
    pub grey_shirt: bool,
}

impl Scenery {
    /// What it is called in tables.
    #[must_use]
    pub fn label(self) -> String {
        let walls = if self.blotched_walls { "blotched" } else { "plain" };
        let shadows = if self.hard_shadows { "hard" } else { "soft" };
        let shirt = if self.grey_shirt { "grey" } else { "red" };
        format!("{walls} walls, {shadows} shadows, {shirt} shirt")
    }

    fn all() -> Vec<Self> {
        let each = |bits: usize| {
            let is = |bit: usize| bits >> bit & 1 == 1;
            Self { blotched_walls: is(2), hard_shadows: is(1), grey_shirt: is(0) }
        };
        (0..8).map(each).collect()
    }
}

/// A way to segment.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Way {
    /// What it is called.
    pub name: String,
    /// Every choice.
    pub segmentation: SegmentOptions,
}

/// No test; each of the two with shadow as background and as unknown; and (6.12) with the deviations that were measured,
/// however small.
#[must_use]
pub fn ways() -> Vec<Way> {
    let shadow = |test, unknown| Some(ShadowOptions { test, unknown, ..ShadowOptions::default() });
    let way = |name: &str, shadow, noise_floor| {
        let segmentation = SegmentOptions { shadow, noise_floor, ..SegmentOptions::default() };
        Way { name: name.to_owned(), segmentation }
    };
    let usual = SegmentOptions::default().noise_floor;
    vec![
        way("no test", None, usual),
        way("brightness", shadow(ShadowTest::Brightness, false), usual),
        way("brightness, unknown", shadow(ShadowTest::Brightness, true), usual),
        way("(6.12)", shadow(ShadowTest::Gradient, false), usual),
        way("(6.12), unknown", shadow(ShadowTest::Gradient, true), usual),
        way("(6.12), floor 1", shadow(ShadowTest::Gradient, false), 1.0),
        way("(6.12), floor 1, unknown", shadow(ShadowTest::Gradient, true), 1.0),
    ]
}

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Rooms, light and shirts.
    pub sceneries: Vec<Scenery>,
    /// The ways that are compared.
    pub ways: Vec<Way>,
    /// Moments of the built-in movement, in its frames.
    pub moments: Vec<f64>,
    /// Pixels across and down of each of the four cameras.
    pub size_px: [u64; 2],
    /// Pictures of the empty room behind each background, two or more.
    pub empty_frames: usize,
    /// Rays a pixel are the square of this.
    pub samples: usize,
    /// How far every rotation starts from the truth, radians.
    pub angle_rad: f64,
    /// How far the root starts from the truth, metres.
    pub distance_m: f64,
    /// Seed of noise and starts.
    pub seed: u64,
    /// Pixels of noise in each row of the second table.
    pub noise_pixels: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            sceneries: Scenery::all(),
            ways: ways(),
            moments: vec![0.0, 24.0, 48.0],
            size_px: [studio::WIDTH, studio::HEIGHT],
            empty_frames: 50,
            samples: 2,
            angle_rad: 5f64.to_radians(),
            distance_m: 0.03,
            seed: 1,
            noise_pixels: 4_000_000,
        }
    }
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// One entry a scenery and way: all ways of the first scenery first, the true silhouettes last.
    pub cases: Vec<Case>,
    /// How often noise passes for a subject.
    pub noise: Vec<NoiseCase>,
}

/// How well the pixels of a class were found, as shares of 1.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Found {
    /// Of the pixels that were called so, those that are; none if none was.
    pub precision: Option<f64>,
    /// Of the pixels that are, those that were called so; none if none is.
    pub recall: Option<f64>,
}

/// Distances of joints from the truth, millimetres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct JointErrors {
    /// Arithmetic mean.
    pub mean_mm: f64,
    /// 95 % lie below.
    pub p95_mm: f64,
    /// The largest.
    pub max_mm: f64,
}

/// One way in one scenery: the pixels and joints of all moments and cameras.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Case {
    /// The scenery.
    pub scenery: Scenery,
    /// The way's name.
    pub way: String,
    /// Pixels of the figure.
    pub subject: Found,
    /// Pixels beside the figure that its shadow darkens by more than the deviation test of the default options allows.
    pub shadow: Found,
    /// Errors of the joints of all moments; none if no moment could be fitted.
    pub joints: Option<JointErrors>,
    /// Moments in which no camera saw a subject.
    pub nobody: usize,
}

/// Segments every picture in every way, and fits what came of it.
///
/// # Errors
/// Options that make no sense, or `cancel`.
pub fn run(
    options: &Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    for (option, value, least) in [
        ("moments", options.moments.len(), 1),
        ("empty_frames", options.empty_frames, 2),
        ("samples", options.samples, 1),
    ] {
        if value < least {
            let expected = if least == 1 { "1 or more" } else { "2 or more" };
            return Err(ExperimentError::Option { option, value: value as f64, expected });
        }
    }
    let model = Arc::new(builtin::full_body());
    let total = options.sceneries.len() * (options.ways.len() + 1);
    let mut cases = Vec::new();
    for &scenery in &options.sceneries {
        let scene = Scene::new(&model, scenery, options, cancel)?;
        for way in &options.ways {
            on_progress(Progress { done: cases.len(), total });
            let masks = scene.segmented(&way.segmentation)?;
            cases.push(scene.case(&model, &way.name, masks, options, cancel)?);
        }
        on_progress(Progress { done: cases.len(), total });
        let truth = scene.views.iter().map(|view| view.truth.clone()).collect();
        cases.push(scene.case(&model, TRUTH, truth, options, cancel)?);
    }
    on_progress(Progress { done: cases.len(), total });
    Ok(Report { cases, noise: noise::run(options.noise_pixels, options.seed) })
}

/// What one camera sees at one moment, and the truth of it.
struct SeenView {
    camera: Arc<Camera>,
    background: Arc<Background>,
    picture: RgbImage,
    truth: Mask,
    /// Whether each pixel is in the figure's shadow.
    in_shadow: Vec<bool>,
}

struct Scene {
    scenery: Scenery,
    /// All cameras of the first moment first.
    views: Vec<SeenView>,
}

impl Scene {
    fn new(
        model: &Model,
        scenery: Scenery,
        options: &Options,
        cancel: &CancelToken,
    ) -> Result<Self, ExperimentError> {
        let room = Room::empty(GREY, scenery.blotched_walls);
        let lighting = if scenery.hard_shadows { Lighting::narrowed(NARROW) } else { Lighting::default() };
        let build = Build { shirt: scenery.grey_shirt.then_some(DVec3::splat(GREY)), ..Build::default() };
        let sensor = Sensor::default();
        let exact = Sensor { read_noise: 0.0, shot_noise: 0.0, ..sensor };
        let usual = SegmentOptions::default();
        let limit = f64::from(usual.z_threshold * usual.noise_floor);
        let [width, height] = options.size_px;
        let mut views: Vec<Vec<SeenView>> = options.moments.iter().map(|_| Vec::new()).collect();
        for (index, camera) in studio::cameras().cameras().iter().enumerate() {
            let camera = Arc::new(camera.without_distortion().resized(width, height)?);
            let seed = |picture: usize| {
                options.seed.wrapping_mul(1_000_003).wrapping_add((index * 10_000 + picture) as u64)
            };
            let plate = Plate::lit(&room, lighting, &camera, options.samples);
            let empty = plate.empty();
            let frames: Vec<RgbImage> =
                (0..options.empty_frames).map(|frame| sensor.expose(&empty, 1.0, seed(frame))).collect();
            let background = Arc::new(Background::from_frames(&frames)?);
            let before = exact.expose(&empty, 1.0, 0);
            for (at, (&moment, views)) in options.moments.iter().zip(&mut views).enumerate() {
                if cancel.is_cancelled() {
                    return Err(ExperimentError::Cancelled);
                }
                let figure = Figure::new(model, &motion::pose(model, moment), build)
                    .expect("the built-in body has the figure's limbs");
                let light = plate.with_figure(&figure, options.samples);
                let truth = silhouette(&figure, &camera)?;
                let after = exact.expose(&light, 1.0, 0);
                let in_shadow = shadow_of(&before, &after, &truth, limit);
                let picture = sensor.expose(&light, 1.0, seed(5000 + at));
                let (camera, background) = (Arc::clone(&camera), Arc::clone(&background));
                views.push(SeenView { camera, background, picture, truth, in_shadow });
            }
        }
        Ok(Self { scenery, views: views.into_iter().flatten().collect() })
    }

    fn segmented(&self, options: &SegmentOptions) -> Result<Vec<Mask>, ExperimentError> {
        let one = |view: &SeenView| Ok(segment(&view.picture, &view.background, options)?);
        self.views.iter().map(one).collect()
    }

    /// Compares masks with the truth, and fits every moment to its cameras' masks.
    fn case(
        &self,
        model: &Arc<Model>,
        way: &str,
        masks: Vec<Mask>,
        options: &Options,
        cancel: &CancelToken,
    ) -> Result<Case, ExperimentError> {
        let (mut subject, mut shadow) = (Count::default(), Count::default());
        for (view, mask) in self.views.iter().zip(&masks) {
            for (index, label) in view.truth.labels().iter().enumerate() {
                let class = mask.class(index % mask.width(), index / mask.width());
                subject.add(class == Some(PixelClass::Subject), *label == Label::Subject);
                shadow.add(class == Some(PixelClass::Shadow), view.in_shadow[index]);
            }
        }
        let (mut errors, mut nobody) = (Vec::new(), 0);
        let cameras = self.views.len() / options.moments.len();
        let seen: Vec<_> = self.views.iter().zip(masks).collect();
        for (at, (&moment, views)) in options.moments.iter().zip(seen.chunks(cameras)).enumerate() {
            let truth = motion::pose(model, moment);
            let seed = options.seed.wrapping_add(at as u64);
            let start = perturb(model, &truth, options.angle_rad, options.distance_m, seed);
            let view = |(view, mask): &(&SeenView, Mask)| FitView {
                camera: Arc::clone(&view.camera),
                evidence: Evidence::Mask(Arc::new(mask.clone())),
                weight: 1.0,
            };
            let views = views.iter().map(view).collect();
            let fit = Fit::new(Arc::clone(model), views, start, FitOptions::preset(Preset::Robust));
            if let Err(FitError::NoData { .. }) = fit {
                nobody += 1;
                continue;
            }
            let pose = fit?.run(cancel, |_| {}).pose;
            if cancel.is_cancelled() {
                return Err(ExperimentError::Cancelled);
            }
            let [found, truth] = [&pose, &truth].map(|pose| Kinematics::new(model, pose));
            let joints = found.ends().iter().zip(truth.ends());
            errors.extend(joints.map(|(found, truth)| 1000.0 * found.distance(*truth)));
        }
        let (subject, shadow) = (subject.found(), shadow.found());
        let joints = Statistics::of(&errors).map(|all| JointErrors {
            mean_mm: all.mean,
            p95_mm: all.p95,
            max_mm: all.max,
        });
        Ok(Case { scenery: self.scenery, way: way.to_owned(), subject, shadow, joints, nobody })
    }
}

/// Pixels beside the figure that are further off the empty room than `limit` in some channel, without any noise. The
/// figure's own rim is not shadow: a pixel that touches a subject pixel is mixed of both.
fn shadow_of(before: &RgbImage, after: &RgbImage, truth: &Mask, limit: f64) -> Vec<bool> {
    let touches_subject = |x: usize, y: usize| {
        let mut near = (0..9).map(|at| ((x + at % 3).wrapping_sub(1), (y + at / 3).wrapping_sub(1)));
        near.any(|(x, y)| truth.get(x, y) == Some(Label::Subject))
    };
    let pixels = before.pixels().zip(after.pixels()).enumerate();
    pixels
        .map(|(index, (before, after))| {
            let off = |c: usize| f64::from(before.0[c].abs_diff(after.0[c])) > limit;
            (0..3).any(off) && !touches_subject(index % truth.width(), index / truth.width())
        })
        .collect()
}

/// Pixels that were called so, that are so, and both.
#[derive(Debug, Default)]
struct Count {
    called: usize,
    are: usize,
    both: usize,
}

impl Count {
    fn add(&mut self, called: bool, is: bool) {
        self.called += usize::from(called);
        self.are += usize::from(is);
        self.both += usize::from(called && is);
    }

    fn found(&self) -> Found {
        let share = |of: usize| (of > 0).then(|| self.both as f64 / of as f64);
        Found { precision: share(self.called), recall: share(self.are) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(grey_shirt: bool, blotched_walls: bool) -> Options {
        Options {
            sceneries: vec![Scenery { blotched_walls, hard_shadows: false, grey_shirt }],
            moments: vec![24.0],
            size_px: [48, 64],
            empty_frames: 6,
            noise_pixels: 1000,
            ..Options::default()
        }
    }

    #[test]
    fn each_test_costs_what_it_is_blind_to() {
        let case =
            |report: &Report, way: &str| report.cases.iter().find(|case| case.way == way).cloned().unwrap();
        let run = |options: &Options| run(options, &CancelToken::new(), |_| {}).unwrap();
        let red = run(&options(false, false));
        let grey = run(&options(true, false));
        let recall = |report: &Report, way| case(report, way).subject.recall.unwrap();
        assert_eq!(case(&red, TRUTH).subject, Found { precision: Some(1.0), recall: Some(1.0) });
        assert!(recall(&red, "no test") > 0.8, "{red:#?}");
        // Both have lost the grey shirt before the grey wall, the gradient the red one as well.
        assert!(recall(&grey, "brightness") < recall(&red, "brightness") - 0.1, "{grey:#?}");
        assert!(recall(&red, "(6.12)") < recall(&red, "no test") - 0.2, "{red:#?}");
        assert!(case(&red, "brightness").shadow.recall > case(&red, "no test").shadow.recall);
        assert_eq!(run(&options(false, false)), red);
    }

    #[test]
    fn options_that_make_no_sense_are_named() {
        let none = Options { empty_frames: 1, ..options(false, false) };
        let error = run(&none, &CancelToken::new(), |_| {}).unwrap_err();
        assert!(error.to_string().contains("empty_frames"), "{error}");
    }
}
