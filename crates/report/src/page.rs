//! What a page shows.

use backlit_tracking::belief::LimbTrust;
use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::camera::Camera;
use backlit_words::joint::{JointId, joint_name};
use glam::{DMat3, DVec3};

/// A track, and all that is told of it. Lengths are metres, in the take's world.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// What the recording is called.
    pub title: String,
    /// Frames per second.
    pub frame_rate: f64,
    /// Which way is up, a unit vector.
    pub up: DVec3,
    /// The body's limbs.
    pub limbs: Vec<PageLimb>,
    /// The cameras; none where the take is not known.
    pub cameras: Vec<PageCamera>,
    /// The frames that have a pose, in their order.
    pub frames: Vec<Frame>,
    /// Pictures and silhouettes of some frames.
    pub pictures: Vec<Picture>,
    /// Fits whose every step is shown.
    pub fits: Vec<FitSteps>,
    /// Numbers over frames.
    pub curves: Vec<Curve>,
    /// Numbers in tables.
    pub tables: Vec<Table>,
    /// Places that somebody marked.
    pub bookmarks: Vec<Bookmark>,
    /// How the track was made: what, and its value.
    pub settings: Vec<[String; 2]>,
    /// Command lines.
    pub commands: Vec<CommandLine>,
    /// What the page lacks, and why: sentences.
    pub notes: Vec<String>,
}

/// A limb of the body.
#[derive(Debug, Clone, PartialEq)]
pub struct PageLimb {
    /// Its name.
    pub name: String,
    /// What people call the joint at its end.
    pub joint: String,
    /// The limb from whose end it grows; `None`: from the root.
    pub parent: Option<usize>,
    /// Its radius, metres.
    pub radius: f64,
}

/// An ideal pinhole: the camera of rectified pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct PageCamera {
    /// Its name.
    pub name: String,
    /// Width and height of its pictures, pixels.
    pub size: [usize; 2],
    /// Focal lengths and principal point `fx, fy, cx, cy`, pixels; pixel centres are at integers.
    pub intrinsics: [f64; 4],
    /// Its axes, as rows in the world's.
    pub rotation: DMat3,
    /// Camera from world, metres.
    pub translation: DVec3,
}

/// One frame of the track.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Its number in the take.
    pub number: usize,
    /// The root, then every limb's end, metres.
    pub joints: Vec<DVec3>,
    /// Why it counts as lost, in words.
    pub lost: Option<String>,
    /// Intersection over union of all cameras together.
    pub iou: Option<f64>,
    /// Limbs that are not believed.
    pub doubts: Vec<DoubtedLimb>,
}

/// A limb that is not believed in a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct DoubtedLimb {
    /// The limb.
    pub limb: usize,
    /// Whether it is called wrong, not just doubtful.
    pub is_wrong: bool,
    /// Because …
    pub reason: &'static str,
    /// Probability that it is more than 250 mm off.
    pub wrong: f64,
}

/// What a camera saw in a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// The camera, an index in [`Page::cameras`].
    pub camera: usize,
    /// The frame's number.
    pub frame: usize,
    /// The kind of picture, as `image/jpeg`.
    pub media_type: &'static str,
    /// Width and height of the encoded picture, pixels: it may be smaller than the camera's, which it fills.
    pub size: [u32; 2],
    /// The encoded picture; empty where there is a silhouette only.
    pub bytes: Vec<u8>,
    /// The silhouette's outline, as a path in the camera's pixels ([`outline::path`](crate::outline::path)).
    pub subject: String,
    /// The same of what is unknown.
    pub unknown: String,
}

/// A fit of a frame, step by step.
#[derive(Debug, Clone, PartialEq)]
pub struct FitSteps {
    /// The frame's number.
    pub frame: usize,
    /// From where it began.
    pub start: String,
    /// Why it ended.
    pub ending: String,
    /// The start, then every step.
    pub steps: Vec<FitStep>,
}

/// A step of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FitStep {
    /// Joints as in [`Frame::joints`]; of a rejected step where the fit stayed.
    pub joints: Vec<DVec3>,
    /// Cost after it by its stage's measure, squared grey levels.
    pub cost: f64,
    /// Cost of what was tried, likewise.
    pub trial_cost: f64,
    /// Its stage, from 0.
    pub stage: usize,
    /// Whether it was kept.
    pub is_accepted: bool,
}

/// Numbers over frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its name in the plot.
    pub label: String,
    /// Its unit; empty for ratios.
    pub unit: String,
    /// The plot that it stands in: curves of one group share it.
    pub group: String,
    /// The camera whose number it is, an index in [`Page::cameras`].
    pub camera: Option<usize>,
    /// By frame number, in order; `None` where it is not known.
    pub values: Vec<(usize, Option<f64>)>,
}

/// A table.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Its title.
    pub title: String,
    /// What must be known to read it; may be empty.
    pub note: String,
    /// Whether it opens on demand only.
    pub is_folded: bool,
    /// Its columns; the first names the row.
    pub columns: Vec<String>,
    /// Its rows, each as long as there are columns.
    pub rows: Vec<Vec<Cell>>,
}

/// A field of a table.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cell {
    /// What it says.
    pub text: String,
    /// The frame to which it leads.
    pub frame: Option<usize>,
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self { text: text.into(), frame: None }
    }
}

/// A place that somebody marked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bookmark {
    /// The frame's number.
    pub frame: usize,
    /// The camera, an index in [`Page::cameras`].
    pub camera: Option<usize>,
    /// The joint, an index as in [`Frame::joints`].
    pub joint: Option<usize>,
    /// A line of text.
    pub text: String,
}

/// A command line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CommandLine {
    /// What it does.
    pub title: String,
    /// The line itself.
    pub line: String,
}

impl PageLimb {
    /// The limbs of a body.
    pub fn all(model: &Model) -> Vec<Self> {
        let limb = |(index, limb): (usize, &backlit_tracking::body::Limb)| Self {
            name: limb.name.clone(),
            joint: joint_name(model, JointId::End(index)),
            parent: limb.parent,
            radius: limb.radius,
        };
        model.limbs().iter().enumerate().map(limb).collect()
    }
}

impl PageCamera {
    /// A camera without its distortion.
    pub fn of(camera: &Camera) -> Self {
        let (intrinsics, place) = (camera.intrinsics(), camera.camera_from_world());
        Self {
            name: camera.name().to_owned(),
            size: [camera.width(), camera.height()],
            intrinsics: [intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy],
            rotation: place.rotation,
            translation: place.translation,
        }
    }
}

impl Frame {
    /// A pose without anything told of it.
    pub fn of_pose(model: &Model, number: usize, pose: &Pose) -> Self {
        Self { number, joints: joints_of(model, pose), lost: None, iou: None, doubts: Vec::new() }
    }
}

impl DoubtedLimb {
    /// Of a limb that is judged; `None` where nothing speaks against it.
    pub fn of(trust: &LimbTrust) -> Option<Self> {
        use backlit_tracking::belief::Verdict;
        let &LimbTrust { limb, verdict, reason, wrong, .. } = trust;
        Some(Self { limb, is_wrong: verdict == Verdict::Wrong, reason: reason?.text(), wrong })
    }
}

/// The root, then every limb's end.
pub(crate) fn joints_of(model: &Model, pose: &Pose) -> Vec<DVec3> {
    let kinematics = Kinematics::new(model, pose);
    std::iter::once(pose.root).chain(kinematics.ends().iter().copied()).collect()
}

impl FitStep {
    /// Where a pose puts the joints, in a step of a fit.
    pub fn new(model: &Model, pose: &Pose, costs: [f64; 2], stage: usize, is_accepted: bool) -> Self {
        let [cost, trial_cost] = costs;
        Self { joints: joints_of(model, pose), cost, trial_cost, stage, is_accepted }
    }
}
