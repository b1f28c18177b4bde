//! Shadows: what each way to tell them from the subject makes of both, and of the joints.
//!
//! The clothed figure in empty rooms whose truth is known: walls and floor of one grey, plain or blotched all over; lamps
//! half a metre broad, or a twentieth of that, with hard shadows; a red shirt, or one of the walls' own grey.
//! [`noise`] asks how often noise alone passes for a subject.

use std::sync::Arc;

use anyhow::Result;
use backlit_lab::synthetic::{Build, Figure, Lighting, Plate, Room, Sensor, motion, silhouette, studio};
use backlit_tracking::body::{Kinematics, Model, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::fit::{Fit, FitError, FitOptions, Preset};
use backlit_tracking::search::start::perturb;
use backlit_tracking::segment::{Background, SegmentOptions, ShadowOptions, ShadowTest, segment};
use backlit_tracking::silhouette::{Label, Mask, PixelClass};
use clap::Args;
use glam::DVec3;
use image::RgbImage;
use serde::Serialize;

use super::measures::{ErrorStatistics, masked};
use super::noise::{self, NoiseCase};
use super::{Experiment, Run, check_least};
use crate::output::number;
use crate::table::Table;

/// Linear reflectance of walls, floor and the grey shirt.
const GREY: f64 = 0.42;
/// Sides of the lamps that throw hard shadows, of the usual ones.
const NARROW: f64 = 0.05;
/// The method that is given the truth instead of a segmentation.
const TRUTH: &str = "true silhouettes";

/// Simulated rooms with shadows: what each shadow test makes of subject, shadow and joints; what noise makes of β
#[derive(Debug, Args, Serialize)]
pub(crate) struct Shadows {
    #[arg(skip = Scenery::all())]
    sceneries: Vec<Scenery>,
    #[arg(skip = methods())]
    #[serde(rename = "ways")]
    methods: Vec<SegmentationMethod>,
    /// Moments of the built-in movement (its frames, 0 to 59) to look at
    #[arg(long, value_name = "K,…", value_delimiter = ',', default_values_t = [0.0, 24.0, 48.0])]
    moments: Vec<f64>,
    #[arg(skip = [studio::WIDTH, studio::HEIGHT])]
    size_px: [u64; 2],
    /// Pictures of the empty room behind each background.
    #[arg(skip = 50_usize)]
    empty_frames: usize,
    /// Rays a pixel are the square of this.
    #[arg(skip = 2_usize)]
    samples: usize,
    #[arg(skip = 5f64.to_radians())]
    angle_rad: f64,
    #[arg(skip = 0.03)]
    distance_m: f64,
    /// Seed of noise and starts
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Pixels of noise in each row of the second table.
    #[arg(skip = 4_000_000_usize)]
    noise_pixels: usize,
}

/// A room, its light and who is in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
struct Scenery {
    /// Whether walls and floor are blotched, not plain.
    blotched_walls: bool,
    /// Whether the lamps are narrow.
    hard_shadows: bool,
    /// Whether the shirt is of the walls' grey, not red.
    grey_shirt: bool,
}

impl Scenery {
    fn label(self) -> String {
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

#[derive(Debug, Clone, PartialEq, Serialize)]
struct SegmentationMethod {
    name: String,
    segmentation: SegmentOptions,
}

/// No test; each of the two with shadow as background and as unknown; and (6.12) with the deviations that were measured,
/// however small.
fn methods() -> Vec<SegmentationMethod> {
    let usual = SegmentOptions::default().noise_floor;
    let method = |name: &str, test: Option<ShadowTest>, unknown, noise_floor| {
        let shadow = test.map(|test| ShadowOptions { test, unknown, ..ShadowOptions::default() });
        let segmentation = SegmentOptions { shadow, noise_floor, ..SegmentOptions::default() };
        SegmentationMethod { name: name.to_owned(), segmentation }
    };
    let (brightness, gradient) = (Some(ShadowTest::Brightness), Some(ShadowTest::Gradient));
    vec![
        method("no test", None, false, usual),
        method("brightness", brightness, false, usual),
        method("brightness, unknown", brightness, true, usual),
        method("(6.12)", gradient, false, usual),
        method("(6.12), unknown", gradient, true, usual),
        method("(6.12), floor 1", gradient, false, 1.0),
        method("(6.12), floor 1, unknown", gradient, true, 1.0),
    ]
}

#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct Report {
    /// All methods of the first scenery first, the true silhouettes last.
    cases: Vec<Case>,
    noise: Vec<NoiseCase>,
}

/// How well the pixels of a class were found, as shares of 1.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
struct PixelScore {
    /// Of the pixels that were called so, those that are; `None` if none was.
    precision: Option<f64>,
    /// Of the pixels that are, those that were called so; `None` if none is.
    recall: Option<f64>,
}

/// One method in one scenery: the pixels and joints of all moments and cameras.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Case {
    scenery: Scenery,
    way: String,
    /// Pixels of the figure.
    subject: PixelScore,
    /// Pixels beside the figure that its shadow darkens by more than the deviation test of the default options allows.
    shadow: PixelScore,
    /// `None` if no moment could be fitted.
    joints: Option<ErrorStatistics>,
    /// Moments in which no camera saw a subject.
    nobody: usize,
}

impl Experiment for Shadows {
    const NAME: &'static str = "shadow";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        check_least("moments", self.moments.len(), 1)?;
        check_least("empty_frames", self.empty_frames, 2)?;
        check_least("samples", self.samples, 1)?;
        let model = Arc::new(builtin::full_body());
        let total = self.sceneries.len() * (self.methods.len() + 1);
        let mut cases = Vec::new();
        for &scenery in &self.sceneries {
            let room = LitRoom::new(&model, scenery, self, run)?;
            for method in &self.methods {
                run.progress(cases.len(), total)?;
                let one = |view: &SeenView| segment(&view.picture, &view.background, &method.segmentation);
                let masks = room.views.iter().map(one).collect::<Result<_, _>>()?;
                cases.push(room.case(&model, &method.name, masks, self, run)?);
            }
            run.progress(cases.len(), total)?;
            let truth = room.views.iter().map(|view| view.truth.clone()).collect();
            cases.push(room.case(&model, TRUTH, truth, self, run)?);
        }
        Ok(Report { cases, noise: noise::run(self.noise_pixels, self.seed) })
    }

    fn table(&self, report: &Report) -> String {
        let joints = |case: &&Case, of: fn(ErrorStatistics) -> f64| number(case.joints.map(of), 1);
        let cases = Table::of(
            &report.cases,
            &[
                ("scenery", &|case| case.scenery.label()),
                ("way", &|case| case.way.clone()),
                ("subject: precision", &|case| number(case.subject.precision, 3)),
                ("recall", &|case| number(case.subject.recall, 3)),
                ("shadow: precision", &|case| number(case.shadow.precision, 3)),
                ("recall", &|case| number(case.shadow.recall, 3)),
                ("joints, mm", &|case| joints(case, |all| all.mean_mm)),
                ("95 %", &|case| joints(case, |all| all.p95_mm)),
                ("max", &|case| joints(case, |all| all.max_mm)),
                ("nobody", &|case| case.nobody.to_string()),
            ],
        );
        format!("{cases}\n{}", noise::table(&report.noise))
    }
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

struct LitRoom {
    scenery: Scenery,
    /// All cameras of the first moment first.
    views: Vec<SeenView>,
}

impl LitRoom {
    fn new(model: &Model, scenery: Scenery, options: &Shadows, run: &Run) -> Result<Self> {
        let room = Room::empty(GREY, scenery.blotched_walls);
        let lighting = if scenery.hard_shadows { Lighting::narrowed(NARROW) } else { Lighting::default() };
        let build = Build { shirt: scenery.grey_shirt.then_some(DVec3::splat(GREY)), ..Build::default() };
        let sensor = Sensor::default();
        let exact = Sensor { read_noise: 0.0, shot_noise: 0.0, ..sensor };
        let usual = SegmentOptions::default();
        let limit = f64::from(usual.z_threshold * usual.noise_floor);
        let mut views: Vec<Vec<SeenView>> = options.moments.iter().map(|_| Vec::new()).collect();
        for (index, camera) in studio::pinholes(options.size_px)?.into_iter().enumerate() {
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
                run.check()?;
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

    /// Compares masks with the truth, and fits every moment to its cameras' masks.
    fn case(
        &self,
        model: &Arc<Model>,
        method: &str,
        masks: Vec<Mask>,
        options: &Shadows,
        run: &Run,
    ) -> Result<Case> {
        let (mut subject, mut shadow) = (PixelCount::default(), PixelCount::default());
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
            let views = views.iter().map(|(view, mask)| masked(&view.camera, mask.clone())).collect();
            let fit = Fit::new(Arc::clone(model), views, start, FitOptions::preset(Preset::Robust));
            if let Err(FitError::NoData { .. }) = fit {
                nobody += 1;
                continue;
            }
            let pose = fit?.run(&run.cancel, |_| {}).pose;
            run.check()?;
            let [found, truth] = [&pose, &truth].map(|pose| Kinematics::new(model, pose));
            let joints = found.ends().iter().zip(truth.ends());
            errors.extend(joints.map(|(found, truth)| 1000.0 * found.distance(*truth)));
        }
        let (subject, shadow) = (subject.score(), shadow.score());
        let (way, joints) = (method.to_owned(), ErrorStatistics::of(&errors));
        Ok(Case { scenery: self.scenery, way, subject, shadow, joints, nobody })
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
struct PixelCount {
    called: usize,
    are: usize,
    both: usize,
}

impl PixelCount {
    fn add(&mut self, called: bool, is: bool) {
        self.called += usize::from(called);
        self.are += usize::from(is);
        self.both += usize::from(called && is);
    }

    fn score(&self) -> PixelScore {
        let share = |of: usize| (of > 0).then(|| self.both as f64 / of as f64);
        PixelScore { precision: share(self.called), recall: share(self.are) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::arguments::defaults;

    fn options(grey_shirt: bool, blotched_walls: bool) -> Shadows {
        Shadows {
            sceneries: vec![Scenery { blotched_walls, hard_shadows: false, grey_shirt }],
            moments: vec![24.0],
            size_px: [48, 64],
            empty_frames: 6,
            noise_pixels: 1000,
            ..defaults()
        }
    }

    #[test]
    fn each_test_costs_what_it_is_blind_to() {
        let case =
            |report: &Report, way: &str| report.cases.iter().find(|case| case.way == way).cloned().unwrap();
        let run = |mut options: Shadows| options.run(&Run::hidden()).unwrap();
        let red = run(options(false, false));
        let grey = run(options(true, false));
        let recall = |report: &Report, way| case(report, way).subject.recall.unwrap();
        assert_eq!(case(&red, TRUTH).subject, PixelScore { precision: Some(1.0), recall: Some(1.0) });
        assert!(recall(&red, "no test") > 0.8, "{red:#?}");
        // Both have lost the grey shirt before the grey wall, the gradient the red one as well.
        assert!(recall(&grey, "brightness") < recall(&red, "brightness") - 0.1, "{grey:#?}");
        assert!(recall(&red, "(6.12)") < recall(&red, "no test") - 0.2, "{red:#?}");
        assert!(case(&red, "brightness").shadow.recall > case(&red, "no test").shadow.recall);
        assert_eq!(run(options(false, false)), red);
    }

    #[test]
    fn an_option_out_of_range_is_named() {
        let mut none = Shadows { empty_frames: 1, ..options(false, false) };
        let error = none.run(&Run::hidden()).unwrap_err();
        assert!(error.to_string().contains("empty_frames"), "{error}");
    }
}
