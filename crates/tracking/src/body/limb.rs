//! One limb of a body: a rigid, inextensible link between two joints.

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use super::SizeKind;
use crate::geometry::rotation::exp;

/// A closed range of an angle in radians.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Range(
    /// Smallest value.
    pub f64,
    /// Largest value.
    pub f64,
);

impl Range {
    /// How far `value` lies outside: negative below, positive above, zero inside.
    pub fn excess(self, value: f64) -> f64 {
        (value - self.1).max(0.0) + (value - self.0).min(0.0)
    }

    /// Both ends finite and in order.
    pub fn is_valid(self) -> bool {
        self.0.is_finite() && self.1.is_finite() && self.0 <= self.1
    }
}

/// Anatomical limits of a limb's own rotation, by swing and twist about its rest direction.
///
/// The rotation is q = exp(swing) exp(twist · direction). `flexion` is the swing about `axis` (made
/// perpendicular to the rest direction), `sideways` the swing about direction × axis. Radians.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointLimits {
    /// Axis of flexion in the parent's frame at rest.
    pub axis: DVec3,
    /// Swing about `axis`.
    pub flexion: Range,
    /// Swing about direction × axis.
    pub sideways: Range,
    /// Turn about the limb's own direction.
    pub twist: Range,
}

/// A sphere of a built sphere tree, fixed in its limb.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimbSphere {
    /// Where along the limb: 0 at its first joint, 1 at its second.
    pub at: f64,
    /// Metres.
    pub radius: f64,
    /// Offset from the axis in the limb's rest frame, metres.
    #[serde(default)]
    pub offset: DVec3,
    /// The sphere of the level above that it lies under; none where there is no level above.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parent: Option<usize>,
}

/// A coarser level of a limb's sphere tree.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SphereLevel {
    /// How much farther than the finest level's its spheres stand off the limb, on average, metres.
    pub error: f64,
    /// Its spheres; at least one.
    pub spheres: Vec<LimbSphere>,
    /// How far from each sphere's centre all that lies under it reaches, itself included, metres. Worked out with the model.
    #[serde(skip)]
    pub reaches: Vec<f64>,
}

/// A level is fine enough where its error is this small in a picture, pixels.
const DETAIL_PX: f64 = 0.25;

/// One limb of a validated [`Model`](crate::body::Model).
#[derive(Debug, Clone, PartialEq)]
pub struct Limb {
    /// Unique name, lower case by custom: "right forearm".
    pub name: String,
    /// The limb it grows from; `None` for the root. Always a smaller index.
    pub parent: Option<usize>,
    /// Index of the rotation that it follows.
    pub rotation: usize,
    /// Whether it introduced that rotation (false for a limb that is `rigid_with` another).
    pub has_own_rotation: bool,
    /// Unit rest direction from the first joint to the second.
    pub direction: DVec3,
    /// Metres.
    pub length: f64,
    /// Metres.
    pub radius: f64,
    /// Limits of its own rotation.
    pub limits: Option<JointLimits>,
    /// The finest level of its sphere tree; empty for equal spheres along the axis.
    pub spheres: Vec<LimbSphere>,
    /// The levels above it, coarsest first.
    pub coarser: Vec<SphereLevel>,
}

impl Limb {
    /// The spheres of a level of its tree, counted from the coarsest; the finest where it has no more.
    pub fn level(&self, level: usize) -> &[LimbSphere] {
        self.coarser.get(level).map_or(&self.spheres, |level| &level.spheres)
    }

    /// The coarsest level that is fine enough for a picture with this many metres a pixel at the limb.
    pub fn level_for(&self, metres_per_px: f64) -> usize {
        let is_fine = |level: &SphereLevel| level.error <= DETAIL_PX * metres_per_px;
        self.coarser.iter().position(is_fine).unwrap_or(self.coarser.len())
    }

    /// Its length or its radius, metres.
    pub fn size(&self, kind: SizeKind) -> f64 {
        match kind {
            SizeKind::Length => self.length,
            SizeKind::Radius => self.radius,
        }
    }

    /// Where a sphere's centre lies in the limb's rest frame: metres from its first joint, axes of the body at rest.
    pub fn centre(&self, sphere: &LimbSphere) -> DVec3 {
        self.direction * (sphere.at * self.length) + sphere.offset
    }

    /// Works out how far each sphere's part of the tree reaches.
    pub(super) fn measure_tree(&mut self) {
        for level in (0..self.coarser.len()).rev() {
            let mut reaches: Vec<f64> =
                self.coarser[level].spheres.iter().map(|sphere| sphere.radius).collect();
            for (index, child) in self.level(level + 1).iter().enumerate() {
                let Some(parent) = child.parent else { continue };
                let own = self.coarser.get(level + 1).map_or(child.radius, |below| below.reaches[index]);
                let apart = self.centre(child).distance(self.centre(&self.coarser[level].spheres[parent]));
                reaches[parent] = reaches[parent].max(apart + own);
            }
            self.coarser[level].reaches = reaches;
        }
    }

    /// Unit axes of flexion and of sideways swing, perpendicular to the limb and to each other.
    ///
    /// Without limits, any such pair: the same one for the same direction.
    pub fn swing_axes(&self) -> (DVec3, DVec3) {
        let wanted =
            self.limits.map_or_else(|| self.direction.any_orthonormal_vector(), |limits| limits.axis);
        let flexion = wanted
            .reject_from_normalized(self.direction)
            .normalize_or(self.direction.any_orthonormal_vector());
        (flexion, self.direction.cross(flexion))
    }

    /// The rotation with these angles (radians), the inverse of [`angles`](Self::angles).
    pub fn rotation_from_angles(&self, angles: JointAngles) -> DQuat {
        let (flexion, sideways) = self.swing_axes();
        exp(flexion * angles.flexion + sideways * angles.sideways) * exp(self.direction * angles.twist)
    }

    /// Flexion, sideways swing and twist (radians) of a unit rotation of this limb.
    pub fn angles(&self, rotation: DQuat) -> JointAngles {
        let parts = crate::geometry::rotation::swing_twist(rotation, self.direction);
        let (flexion, sideways) = self.swing_axes();
        JointAngles {
            flexion: parts.swing.dot(flexion),
            sideways: parts.swing.dot(sideways),
            twist: parts.twist,
        }
    }
}

/// A limb's own rotation as three angles in radians, as people name them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointAngles {
    /// Swing about the flexion axis.
    pub flexion: f64,
    /// Swing about direction × flexion axis.
    pub sideways: f64,
    /// Turn about the limb itself.
    pub twist: f64,
}
