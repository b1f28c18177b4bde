//! The tracks that are made to fail, with their truth.

use std::sync::Arc;

use anyhow::{Context, Result, ensure};
use backlit_formats::{Footage, FootageError};
use backlit_lab::synthetic::figure::{Build, Figure};
use backlit_lab::synthetic::masks::{silhouette, widened};
use backlit_lab::synthetic::occlusions::Occlusion;
use backlit_lab::synthetic::people::{BREADTH, PEOPLE, Person};
use backlit_lab::synthetic::{capsules, exercise, motion, studio, upper_body};
use backlit_runs::track::FrameReader;
use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::cues::FrameCues;
use backlit_tracking::fit::FitView;
use backlit_tracking::metrics::ReferenceJoints;
use backlit_tracking::search::start;
use backlit_tracking::track::WhenToSearch;
use glam::{DQuat, DVec3};
use rayon::prelude::*;

use crate::experiment::Run;

/// Pictures of the simulated telephones, of the cameras around a body, and of those before an upper body.
const SIZE_PX: [u64; 2] = [180, 320];
const AROUND_PX: [[u64; 2]; 2] = [[studio::WIDTH, studio::HEIGHT], [96, 128]];
const UPPER_PX: [[u64; 2]; 2] = [[192, 144], [48, 36]];
/// How much too wide simulated masks are all round, as a share of the breadth of the shoulders.
const TOO_WIDE: f64 = 0.045;
/// Frames a second of the simulated telephones.
const RATE: f64 = 30.0;
/// Builds of the simulated people, as indices of [`PEOPLE`].
const BUILDS: [usize; 3] = [3, 1, 4];
/// How starts of exercises are turned: nearly upside down, and half round. Nobody looks for another pose then.
const TURNS: [(DVec3, f64); 2] = [(DVec3::X, 2.6), (DVec3::Z, 1.8)];
/// Starts that are far off, and how far.
const FAR_STARTS: u64 = 8;
const FAR_DEGREES: f64 = 30.0;
/// Only every 12th frame of the take is seen, and so on.
const SPARSE: [usize; 4] = [12, 14, 16, 20];

/// A track to be made.
pub(super) struct Case {
    pub(super) name: String,
    pub(super) model: Arc<Model>,
    pub(super) rate: f64,
    pub(super) start: Pose,
    pub(super) search: WhenToSearch,
    /// Whether rivals are carried; without them a wrong start stays wrong.
    pub(super) has_rivals: bool,
    pub(super) frames: Vec<CaseFrame>,
    /// Of real footage.
    pub(super) is_real: bool,
    /// Nothing is learnt from it.
    pub(super) is_held_out: bool,
}

impl Case {
    /// How much a joint of it counts in what is learnt: real footage is little, and in turned starts all joints are off together.
    pub(super) fn weight(&self) -> f64 {
        match (self.is_real, self.has_rivals) {
            (true, _) => 5.0,
            (false, true) => 1.0,
            (false, false) => 0.3,
        }
    }
}

/// A frame of a track, with the joints' true places.
#[derive(Debug, Clone)]
pub(super) struct CaseFrame {
    pub(super) frame: usize,
    pub(super) views: Vec<FitView>,
    pub(super) joints: ReferenceJoints,
}

/// Reads the frames of a case.
pub(super) struct CaseReader(pub(super) Vec<CaseFrame>);

impl FrameReader for CaseReader {
    type Data = Vec<FitView>;

    fn read(&self, frame: usize) -> Result<Vec<FitView>, FootageError> {
        Ok(self.0.iter().find(|one| one.frame == frame).map_or_else(Vec::new, |one| one.views.clone()))
    }

    fn views(&self, views: &Vec<FitView>) -> Vec<FitView> {
        views.clone()
    }

    fn cues(&self, _: &Vec<FitView>) -> Result<FrameCues, FootageError> {
        Ok(FrameCues::default())
    }
}

/// The pose of a body at a time, seconds.
type Movement = Box<dyn Fn(&Model, f64) -> Pose + Send + Sync>;

/// Of a person who stands on the floor that the average adult stands on.
fn movement(person: &'static Person, pose: fn(&Model, f64) -> Pose) -> Movement {
    Box::new(move |model, seconds| person.standing(pose(model, seconds)))
}

/// What a simulated mask is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum MaskSource {
    /// The body's own capsules.
    Capsules,
    /// The same, too wide.
    Wide,
    /// A figure in loose clothes.
    Clothed,
}

impl MaskSource {
    fn name(self) -> &'static str {
        match self {
            Self::Capsules => "exact",
            Self::Wide => "wide",
            Self::Clothed => "clothed",
        }
    }
}

/// A movement of a body before cameras.
struct Simulated {
    name: String,
    model: Arc<Model>,
    cameras: Vec<Arc<Camera>>,
    pose: Movement,
    rate: f64,
    seconds: f64,
    every: usize,
    drawn: MaskSource,
    /// How the start is turned: about which axis of the world, radians.
    turned: Option<(DVec3, f64)>,
    is_held_out: bool,
}

impl Simulated {
    fn case(self, run: &Run) -> Result<Case> {
        let model = self.model;
        let frame = |frame: usize| {
            run.check()?;
            let truth = (self.pose)(&model, frame as f64 / self.rate);
            let figure = match self.drawn {
                MaskSource::Clothed => Figure::new(&model, &truth, Build::default()),
                MaskSource::Capsules | MaskSource::Wide => None,
            };
            let view = |camera: &Arc<Camera>| {
                let px_per_m = camera.intrinsics().mean_focal_px() / camera.depth(truth.root);
                let mask = match &figure {
                    Some(figure) => silhouette(figure, camera)?,
                    None => capsules::hard_mask(&model, &truth, camera)?,
                };
                let mask = match self.drawn {
                    MaskSource::Wide => widened(mask, TOO_WIDE * BREADTH * px_per_m)?,
                    MaskSource::Capsules | MaskSource::Clothed => mask,
                };
                Ok(FitView::of_mask(camera.clone(), mask))
            };
            let views = self.cameras.iter().map(view).collect::<Result<_>>()?;
            let ends = Kinematics::new(&model, &truth).ends().to_vec();
            let joints = ends.into_iter().enumerate().map(|(limb, at)| (Some(limb), at)).collect();
            Ok(CaseFrame { frame, views, joints })
        };
        let count = (self.seconds * self.rate) as usize;
        let frames = (0..count).step_by(self.every).map(frame).collect::<Result<_>>()?;
        let mut start = start::perturb(&model, &(self.pose)(&model, 0.0), 3_f64.to_radians(), 0.02, 1);
        let mut name = format!("{}, {} a second", self.name, self.rate / self.every as f64);
        if self.drawn != MaskSource::Wide {
            name += &format!(", {}", self.drawn.name());
        }
        if let Some((axis, angle)) = self.turned {
            let root = model.rotation_parents().iter().position(Option::is_none).unwrap_or_default();
            start.rotations[root] = DQuat::from_axis_angle(axis, angle) * start.rotations[root];
            let axis = if axis == DVec3::Z { "z" } else { "x" };
            name += &format!(", start turned {:.0}° about {axis}", angle.to_degrees());
        }
        Ok(Case {
            name,
            model,
            rate: self.rate,
            start,
            search: if self.turned.is_some() { WhenToSearch::Never } else { WhenToSearch::WhenPoor },
            has_rivals: self.turned.is_none(),
            frames,
            is_real: false,
            is_held_out: self.is_held_out,
        })
    }
}

/// The movements that hide limbs before two telephones, and exercises before two and three cameras, both of wide capsules and
/// clothed; and what is clear: bodies amid cameras in pictures of several sizes.
pub(super) fn simulated(seconds: f64, run: &Run) -> Result<Vec<Case>> {
    let mut all = Vec::new();
    for (build, person) in BUILDS.map(|index| &PEOPLE[index]).into_iter().enumerate() {
        let model = Arc::new(person.of(&builtin::full_body())?);
        let ways = [(0, MaskSource::Wide, 1), (1, MaskSource::Wide, 4), (0, MaskSource::Clothed, 4)];
        for (third, drawn, every) in ways {
            let held_out = |other: usize| (build + third + other) % 2 == 1;
            for (at, which) in Occlusion::ALL.into_iter().enumerate() {
                all.push(Simulated {
                    name: format!("{}, {}", which.name(), person.name),
                    model: model.clone(),
                    cameras: which.cameras(SIZE_PX)?,
                    pose: Box::new(move |model, seconds| person.standing(which.pose(model, seconds))),
                    rate: RATE,
                    seconds,
                    every,
                    drawn,
                    turned: None,
                    is_held_out: held_out(at),
                });
            }
            for count in 2..=exercise::MOST_CAMERAS {
                let is_turned = every > 1 && drawn == MaskSource::Wide && build < 2;
                let turns = TURNS.into_iter().map(Some).filter(|_| is_turned);
                for (turn, turned) in std::iter::once(None).chain(turns).enumerate() {
                    all.push(Simulated {
                        name: format!("exercises, {count} cameras, {}", person.name),
                        model: model.clone(),
                        cameras: exercise::cameras(count, SIZE_PX)?,
                        pose: movement(person, exercise::pose),
                        rate: exercise::FRAME_RATE,
                        seconds: (2.0 * seconds).min(exercise::SECONDS),
                        every,
                        drawn,
                        turned,
                        is_held_out: held_out(count + turn),
                    });
                }
            }
        }
        all.extend(clear(build, person, &model, seconds)?);
    }
    all.extend(upper_bodies(seconds)?);
    all.into_par_iter().map(|one| one.case(run)).collect()
}

/// A person amid four cameras and before three, in pictures of two sizes.
fn clear(build: usize, person: &'static Person, model: &Arc<Model>, seconds: f64) -> Result<Vec<Simulated>> {
    let mut all = Vec::new();
    for (at, drawn) in [MaskSource::Capsules, MaskSource::Wide, MaskSource::Clothed].into_iter().enumerate() {
        for (third, size_px) in AROUND_PX.into_iter().enumerate() {
            let is_held_out = (build + at + third) % 2 == 1;
            let [width, height] = size_px;
            all.push(Simulated {
                name: format!("four cameras around, {width} × {height}, {}", person.name),
                model: model.clone(),
                cameras: studio::pinholes(size_px)?,
                pose: movement(person, |model, seconds| motion::pose(model, seconds * motion::FRAME_RATE)),
                rate: motion::FRAME_RATE,
                seconds: seconds.min(motion::FRAMES as f64 / motion::FRAME_RATE),
                every: 1,
                drawn,
                turned: None,
                is_held_out,
            });
            all.push(Simulated {
                name: format!("exercises, 3 cameras, {height} × {width}, {}", person.name),
                model: model.clone(),
                cameras: exercise::cameras(exercise::MOST_CAMERAS, [height, width])?,
                pose: movement(person, exercise::pose),
                rate: exercise::FRAME_RATE,
                seconds: (2.0 * seconds).min(exercise::SECONDS),
                every: 4,
                drawn,
                turned: None,
                is_held_out: !is_held_out,
            });
        }
    }
    Ok(all)
}

/// The upper body before two to four cameras, in pictures of two sizes.
fn upper_bodies(seconds: f64) -> Result<Vec<Simulated>> {
    let mut all = Vec::new();
    let upper = Arc::new(builtin::upper_body());
    for (at, count) in [2, 3, upper_body::MOST_CAMERAS].into_iter().enumerate() {
        for (third, size_px) in UPPER_PX.into_iter().enumerate() {
            let [width, height] = size_px;
            all.push(Simulated {
                name: format!("upper body, {count} cameras, {width} × {height}"),
                model: upper.clone(),
                cameras: upper_body::cameras(count, size_px)?,
                pose: Box::new(|model, seconds| {
                    upper_body::motion(model, (seconds * upper_body::FRAME_RATE).round() as usize)
                }),
                rate: upper_body::FRAME_RATE,
                seconds: seconds.min(2.0),
                every: 1,
                drawn: if count == 3 { MaskSource::Wide } else { MaskSource::Capsules },
                turned: None,
                is_held_out: (at + third) % 2 == 1,
            });
        }
    }
    Ok(all)
}

/// A take as it is, from far starts without a search, by each camera and each two alone, and by few of its frames.
pub(super) fn of_take(footage: &Footage) -> Result<Vec<Case>> {
    let take = footage.take();
    let (model, count) = (take.model().clone(), take.frame_count());
    let reference =
        take.reference().context("--take: the take has no reference keypoints to compare with")?;
    let cameras: Vec<usize> = (0..take.rig().cameras().len()).collect();
    let frames: Vec<CaseFrame> = (0..count)
        .map(|frame| {
            let views = footage.fit_views(&cameras, frame)?;
            Ok(CaseFrame { frame, views, joints: reference.joints(frame) })
        })
        .collect::<Result<_>>()?;
    ensure!(!frames.is_empty(), "--take: the take has no frames");
    let known =
        start::from_joints(&model, &frames[0].joints).context("--take: the first frame has no keypoints")?;
    let mut cases: Vec<Case> = Vec::new();
    let mut add = |name: String, every: usize, cameras: &[usize], start: &Pose, search| {
        let frame = |one: &CaseFrame| CaseFrame {
            views: cameras.iter().map(|&camera| one.views[camera].clone()).collect(),
            ..one.clone()
        };
        cases.push(Case {
            name,
            model: model.clone(),
            rate: take.frame_rate(),
            start: start.clone(),
            search,
            has_rivals: true,
            frames: frames.iter().step_by(every).map(frame).collect(),
            is_real: true,
            is_held_out: cases.len().is_multiple_of(2),
        });
    };
    let poor = WhenToSearch::WhenPoor;
    add("as it is".to_owned(), 1, &cameras, &known, poor);
    for seed in 1..=FAR_STARTS {
        let start = start::perturb(&model, &known, FAR_DEGREES.to_radians(), 0.0, seed);
        let name = format!("start {FAR_DEGREES}° off, seed {seed}");
        add(name, 1, &cameras, &start, WhenToSearch::Never);
    }
    let camera_name = |camera: usize| take.rig().cameras()[camera].name();
    for &camera in &cameras {
        add(format!("{} alone", camera_name(camera)), 1, &[camera], &known, poor);
    }
    for (at, &first) in cameras.iter().enumerate() {
        for &second in &cameras[at + 1..] {
            let name = format!("{} and {} alone", camera_name(first), camera_name(second));
            add(name, 1, &[first, second], &known, poor);
        }
    }
    for &without in cameras.iter().filter(|_| cameras.len() > 2) {
        let others: Vec<usize> = cameras.iter().copied().filter(|&camera| camera != without).collect();
        add(format!("without {}", camera_name(without)), 1, &others, &known, poor);
    }
    for every in SPARSE.into_iter().filter(|every| *every < count) {
        add(format!("every {every}th frame"), every, &cameras, &known, poor);
    }
    Ok(cases)
}
