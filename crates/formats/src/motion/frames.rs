//! The frames to write, checked, in the file's axes and unit.

use std::collections::BTreeMap;

use backlit_tracking::belief::LimbTrust;
use backlit_tracking::body::{Kinematics, Model, Pose};
use glam::{DMat3, DQuat, DVec3};

use super::{Axes, EulerOrder, FormatEntry, MAX_FRAMES, Motion, MotionOptions, Names, RestPose, Unit};
use crate::FileProblem;

/// What a writer needs.
#[derive(Debug)]
pub(super) struct MotionFrames<'a> {
    pub(super) name: &'a str,
    pub(super) model: &'a Model,
    pub(super) frame_rate: f64,
    /// Numbers and poses of the frames in their order; at least one. Quaternions are of unit length.
    pub(super) frames: Vec<(usize, Pose)>,
    pub(super) file_from_world: DQuat,
    /// Stands the rest pose upright.
    pub(super) file_from_body: DQuat,
    pub(super) axes: Axes,
    pub(super) unit: Unit,
    pub(super) names: Names,
    pub(super) euler: EulerOrder,
    trust: &'a BTreeMap<usize, Vec<LimbTrust>>,
}

/// What is told of a joint: the probability that it is wrong, and how far it is off at most in 95 of 100 such frames, metres. Not a
/// number where nobody judged it.
#[derive(Debug, Clone, Copy)]
pub(super) struct JointTrust {
    pub(super) wrong: f64,
    pub(super) error_95_m: f64,
}

fn field(field: &str, found: impl ToString, expected: &str) -> FileProblem {
    FileProblem::field(field, found.to_string(), expected)
}

/// The error of a file whose lengths have 32 bits.
pub(super) fn too_large(bytes: usize) -> FileProblem {
    field("frames", format!("so many that they fill {bytes} bytes"), "less than 4 GiB")
}

impl<'a> MotionFrames<'a> {
    /// Checks everything that a writer trusts.
    pub(super) fn new(
        format: &FormatEntry,
        motion: &'a Motion,
        options: &MotionOptions,
    ) -> Result<Self, FileProblem> {
        let rate = motion.frame_rate;
        if !(1e-6..=1e6).contains(&rate) {
            return Err(field("frame_rate", rate, "frames per second, above 0"));
        }
        let up = options.up.try_normalize().filter(|up| up.is_finite());
        let up = up.ok_or_else(|| field("up", options.up, "three finite numbers, not all zero"))?;
        let wanted = |frame: usize| options.range.as_ref().is_none_or(|range| range.contains(&frame));
        let mut frames = Vec::new();
        for (&frame, pose) in motion.poses.iter().filter(|(frame, _)| wanted(**frame)) {
            pose.check(&motion.model).map_err(|error| FileProblem::Option {
                field: format!("frames[{frame}]"),
                message: error.to_string(),
            })?;
            frames.push((frame, pose.normalized()));
        }
        if frames.is_empty() {
            let found = match &options.range {
                Some(range) => format!("empty between {} and {}", range.start(), range.end()),
                None => "empty".to_owned(),
            };
            return Err(field("frames", found, "at least one frame with a pose"));
        }
        let (axes, unit) = (options.axes.unwrap_or(format.axes), options.unit.unwrap_or(format.unit));
        Ok(Self {
            name: &motion.name,
            model: &motion.model,
            frame_rate: rate,
            frames,
            file_from_world: axes.file_from_world(up),
            file_from_body: file_from_body(format.rest, axes, &motion.model),
            axes,
            unit,
            names: options.names.unwrap_or(format.names),
            euler: options.euler,
            trust: &motion.trust,
        })
    }

    /// A point of the world in the file.
    pub(super) fn point(&self, in_world: DVec3) -> DVec3 {
        self.unit.per_metre() * (self.file_from_world * in_world)
    }

    /// A vector of the rest pose in the file.
    pub(super) fn rest(&self, in_body: DVec3) -> DVec3 {
        self.unit.per_metre() * (self.file_from_body * in_body)
    }

    /// Joint positions of one pose after the other.
    pub(super) fn joints(&self) -> Joints<'_> {
        Joints { scene: self, kinematics: Kinematics::new(self.model, &self.frames[0].1) }
    }

    /// Whether anything is told of how far joints may be believed.
    pub(super) fn is_judged(&self) -> bool {
        self.frames.iter().any(|(frame, _)| self.trust.contains_key(frame))
    }

    /// How far the joints of a frame are believed, in their order. The root is judged as the first limb, which begins there.
    pub(super) fn joint_trust(&self, frame: usize) -> Vec<JointTrust> {
        let limbs = self.trust.get(&frame).map_or(&[][..], |limbs| limbs);
        let one = |limb: Option<&LimbTrust>| JointTrust {
            wrong: limb.map_or(f64::NAN, |limb| limb.wrong),
            error_95_m: limb.map_or(f64::NAN, |limb| limb.error_95_m),
        };
        let of_limbs = (0..self.model.limbs().len()).map(|limb| one(limbs.get(limb)));
        std::iter::once(one(limbs.first())).chain(of_limbs).collect()
    }

    /// Number of the first and the last frame.
    pub(super) fn first_and_last(&self) -> (usize, usize) {
        let number = |frame: Option<&(usize, Pose)>| frame.map_or(0, |(number, _)| *number);
        (number(self.frames.first()), number(self.frames.last()))
    }

    /// Every frame from the first to the last; `None` in gaps.
    pub(super) fn without_gaps(&self) -> Result<Vec<(usize, Option<&Pose>)>, FileProblem> {
        let (first, last) = self.first_and_last();
        if last - first >= MAX_FRAMES {
            let found = format!("frames {first} to {last}");
            return Err(field("frames", found, &format!("at most {MAX_FRAMES} from the first to the last")));
        }
        let mut all: Vec<_> = (first..=last).map(|number| (number, None)).collect();
        for (number, pose) in &self.frames {
            all[number - first].1 = Some(pose);
        }
        Ok(all)
    }

    /// The same with gaps bridged: the root goes straight, rotations the short way.
    pub(super) fn bridged(&self) -> Result<Vec<Pose>, FileProblem> {
        self.without_gaps()?;
        let mut poses = vec![self.frames[0].1.clone()];
        for pair in self.frames.windows(2) {
            let [(from, before), (to, after)] = pair else { continue };
            for frame in from + 1..*to {
                let part = (frame - from) as f64 / (to - from) as f64;
                let turns = before.rotations.iter().zip(&after.rotations);
                poses.push(Pose {
                    root: before.root.lerp(after.root, part),
                    rotations: turns.map(|(before, after)| before.slerp(*after, part)).collect(),
                });
            }
            poses.push(after.clone());
        }
        Ok(poses)
    }

    /// The axes that point to the right and up on a screen; `None` where up is not known.
    pub(super) fn screen(&self) -> Option<[&'static str; 2]> {
        match self.axes {
            Axes::YUp => Some(["+X", "+Y"]),
            Axes::ZUp => Some(["+X", "+Z"]),
            Axes::World => None,
        }
    }

    /// Seconds of a frame.
    pub(super) fn seconds(&self, frame: usize) -> f64 {
        frame as f64 / self.frame_rate
    }
}

/// Joint positions in the file's axes and unit.
#[derive(Debug)]
pub(super) struct Joints<'a> {
    scene: &'a MotionFrames<'a>,
    kinematics: Kinematics,
}

impl Joints<'_> {
    /// The root, then each limb's second joint.
    pub(super) fn of(&mut self, pose: &Pose) -> impl Iterator<Item = DVec3> {
        self.kinematics.update(self.scene.model, pose);
        let points = std::iter::once(pose.root).chain(self.kinematics.ends().iter().copied());
        points.map(|point| self.scene.point(point))
    }
}

/// Stands the rest pose upright where the file says which way is up. Up in the body is the axis nearest to its first
/// limb, and its right is along x. Animation then looks along z, `OpenSim` along x.
fn file_from_body(rest: RestPose, axes: Axes, model: &Model) -> DQuat {
    let direction = model.limbs()[0].direction;
    let z_up = direction.z > direction.x.abs().max(direction.y.abs());
    let y_up = direction.y > direction.x.abs().max(direction.z.abs());
    if rest == RestPose::AsInBody || axes == Axes::World || !(z_up || y_up) {
        return DQuat::IDENTITY;
    }
    let up = if z_up { DVec3::Z } else { DVec3::Y };
    let on_the_right = model.limbs().iter().filter(|limb| limb.name.starts_with("right "));
    let sideways: f64 = on_the_right.map(|limb| limb.direction.x).sum();
    let right = if sideways < 0.0 { -DVec3::X } else { DVec3::X };
    let body = DMat3::from_cols(right, up.cross(right), up); // right, forward, up
    let file = match (axes, rest) {
        (Axes::ZUp | Axes::World, _) => DMat3::IDENTITY,
        (Axes::YUp, RestPose::AlongX) => DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y),
        (Axes::YUp, _) => DMat3::from_cols(-DVec3::X, DVec3::Z, DVec3::Y),
    };
    DQuat::from_mat3(&(file * body.transpose())).normalize()
}
