//! What features let others draw: what the cameras see, a drag that goes on, names of motions, a picture alone.

use std::ops::RangeInclusive;
use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::observability::JointUncertainty;
use backlit_tracking::posing::LimitedAngle;
use backlit_tracking::segment::Segmentation;
use backlit_tracking::silhouette::Label;
use backlit_ui::drawing::{JointEllipse, JointId, Swaying, joint_ellipses};
use backlit_ui::style::format;
use glam::DVec3;
use image::RgbaImage;

/// What is drawn in a frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct ObservabilityMarks {
    /// Whether what is known is of an older pose, frame or set of cameras than the one on the screen.
    pub(crate) is_stale: bool,
    /// Whether the body is on its way.
    pub(crate) is_playing: bool,
    /// The body on its way, if it sways or is held there.
    pub(crate) swaying: Option<Swaying>,
    pub(crate) swayed_pose: Option<Pose>,
    /// What is known of the joints, if it is shown.
    pub(crate) uncertainty: Option<Uncertainty>,
    /// Ellipses are drawn this many times as large as they are.
    pub(crate) factor: u32,
    /// The angle of the selected limb whose limits are to be seen.
    pub(crate) angle: Option<LimitedAngle>,
}

/// What cameras know of joints.
#[derive(Debug, Clone)]
pub(crate) struct Uncertainty {
    pub(crate) model: Arc<Model>,
    pub(crate) joints: Vec<JointUncertainty>,
    /// Whether the cameras are others than those in use.
    pub(crate) is_of_others: bool,
    /// Whether it is what a Kalman filter believes.
    pub(crate) is_believed: bool,
}

impl Uncertainty {
    /// Ellipses of the joints in a camera's view.
    pub(crate) fn ellipses(&self, camera: &Camera) -> Vec<JointEllipse> {
        joint_ellipses(&self.model, &self.joints, camera)
    }
}

/// Frames that follow each other and have one name.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NamedStretch {
    /// In plain words, in the middle of a sentence.
    pub(crate) name: String,
    /// The number of its class, which says its colour; `None` is no known motion.
    pub(crate) class: Option<usize>,
    pub(crate) frames: RangeInclusive<usize>,
    /// Mean probability of the name, 0 to 1.
    pub(crate) confidence: f64,
}

impl NamedStretch {
    /// Name, frames, and how sure that is.
    pub(crate) fn said(&self) -> String {
        let [first, last] =
            [self.frames.start(), self.frames.end()].map(|frame| format::count(*frame as i64));
        let sure = whole_percent(self.confidence);
        let how = match self.class {
            Some(_) => format!("{sure} sure"),
            None => "like no motion that was learnt".to_owned(),
        };
        format!("{}, frames {first} to {last}, {how}", format::capitalised(&self.name))
    }
}

/// A probability in whole per cent: more digits would say more than is known.
pub(crate) fn whole_percent(share: f64) -> String {
    format!("{}{}%", format::number(100.0 * share, 0), format::THIN_SPACE)
}

/// The take's motions by name.
#[derive(Debug, Clone, Default)]
pub(crate) struct MotionMarks {
    /// In the order of their frames; none where nothing is recognised.
    pub(crate) stretches: Arc<Vec<NamedStretch>>,
    /// Whether they are of an older track than the document's.
    pub(crate) is_stale: bool,
}

impl MotionMarks {
    /// The stretch that a frame is part of.
    pub(crate) fn at(&self, frame: usize) -> Option<&NamedStretch> {
        self.stretches.iter().find(|stretch| stretch.frames.contains(&frame))
    }
}

/// What the pointer draws in the camera views.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SilhouetteTool {
    /// The region of interest, a rectangle.
    Region,
    /// Pixels of the silhouette, each with this label.
    Brush(Label),
}

impl SilhouetteTool {
    #[cfg(test)]
    pub(crate) const ALL: [Self; 4] = [
        Self::Region,
        Self::Brush(Label::Subject),
        Self::Brush(Label::Background),
        Self::Brush(Label::Unknown),
    ];
}

/// What steers silhouettes, as camera views show it.
#[derive(Debug, Clone, Default)]
pub(crate) struct SilhouetteMarks {
    /// What the pointer draws, if it draws; and the brush's radius in pixels.
    pub(crate) tool: Option<(SilhouetteTool, f32)>,
    /// How the silhouette of a camera's frame came about.
    pub(crate) steps: Option<Arc<SilhouetteSteps>>,
    /// The worst of the take that are listed.
    pub(crate) worst: Vec<WorstSilhouette>,
}

/// A silhouette that is among the worst.
#[derive(Debug, Clone)]
pub(crate) struct WorstSilhouette {
    pub(crate) camera: usize,
    pub(crate) frame: usize,
    /// What speaks against it.
    pub(crate) reason: String,
}

impl SilhouetteMarks {
    /// How the silhouette of this camera's frame came about, if it is known.
    pub(crate) fn steps_of(&self, camera: usize, frame: usize) -> Option<&Segmentation> {
        let steps = self.steps.as_deref().filter(|steps| (steps.camera, steps.frame) == (camera, frame))?;
        steps.steps.as_ref().ok()
    }
}

/// How the silhouette of a camera's frame came about, or why nobody knows.
#[derive(Debug)]
pub(crate) struct SilhouetteSteps {
    pub(crate) camera: usize,
    pub(crate) frame: usize,
    pub(crate) steps: Result<Segmentation, String>,
}

/// A drag that goes on in a camera's view, as others see it.
#[derive(Debug, Clone, Default)]
pub(crate) struct DragMarks {
    /// The camera in whose view something is dragged.
    pub(crate) camera: Option<usize>,
    /// The joint that is dragged: its sight ray is in the other views.
    pub(crate) joint: Option<JointId>,
    /// The limb that is twisted: no outline shows how far.
    pub(crate) twisted: Option<usize>,
    /// The pose in which the drag, or the last nudges, began: limits that are met since then are shown.
    pub(crate) from: Option<Arc<Pose>>,
    /// Where a joint was put last.
    pub(crate) placement: Option<Placement>,
}

/// Where a joint was put by drags in cameras' views. In other views it stays on the ray of the latest, until anything else
/// moves it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Placement {
    pub(crate) frame: usize,
    pub(crate) joint: JointId,
    /// In the world.
    pub(crate) at: DVec3,
    /// The cameras in whose views it was put there, the latest last.
    pub(crate) cameras: Vec<usize>,
}

impl Placement {
    /// Whether the joint of a frame is still there.
    pub(crate) fn holds(&self, frame: usize, joint: JointId, at: DVec3) -> bool {
        (frame, joint) == (self.frame, self.joint) && at.distance(self.at) < 1e-4
    }

    /// The cameras but one, the latest first.
    pub(crate) fn cameras_but(&self, camera: usize) -> impl Iterator<Item = usize> {
        self.cameras.iter().rev().copied().filter(move |&other| other != camera)
    }
}

impl DragMarks {
    pub(crate) fn is_dragging(&self) -> bool {
        self.camera.is_some()
    }

    /// The joint that is dragged, and in which camera's view.
    pub(crate) fn dragged_joint(&self) -> Option<(usize, JointId)> {
        self.camera.zip(self.joint)
    }
}

/// What an exported picture of a camera has besides the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PictureAlone {
    pub(crate) camera: usize,
    /// Joints, limbs and rays.
    pub(crate) marks: bool,
    /// The strip that explains the colours, under the picture.
    pub(crate) legend: bool,
}

/// A picture that lies on the floor of the scene, world metres.
#[derive(Debug)]
pub(crate) struct FloorPicture {
    /// Where its upper left corner is.
    pub(crate) corner: DVec3,
    /// From there to its upper right corner.
    pub(crate) across: DVec3,
    /// From there to its lower left corner.
    pub(crate) down: DVec3,
    pub(crate) image: RgbaImage,
    /// A tenth of what its lightest colour is, millimetres.
    pub(crate) limit_mm: f64,
}

/// A joint of a reference that the poses are compared with.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ReferenceMark {
    /// The reference's number, which says its colour.
    pub(crate) reference: usize,
    /// The joint's name.
    pub(crate) joint: String,
    /// Where the body has it, in the world.
    pub(crate) ours: DVec3,
    /// Where the reference has it, in the same world.
    pub(crate) place: DVec3,
}
