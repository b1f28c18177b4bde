//! What the tracker says of a pose, as a project's file has it.

use std::collections::BTreeMap;

use backlit_formats::export::trust_record::TrustRecord;
use backlit_formats::json_text::unique_keys;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cues::{Cue, LimbHold};
use backlit_tracking::track::Mode;
use glam::DMat3;
use serde::{Deserialize, Serialize};

use super::ProjectProblem;
use super::record::{PoseRecord, check_numbers, limb_index};
use crate::frame_trust::FrameTrust;

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FrameTrustRecord {
    /// Only where it is not the estimate's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pose: Option<PoseRecord>,
    #[serde(default, skip_serializing_if = "TrustRecord::is_empty")]
    trust: TrustRecord,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", deserialize_with = "unique_keys")]
    held: BTreeMap<String, HoldRecord>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    rivals: Vec<RivalRecord>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct HoldRecord {
    cameras: usize,
    by_silhouettes: bool,
    cues: Vec<Cue>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RivalRecord {
    weight: f64,
    pose: PoseRecord,
    /// By limb: xx, yy, zz, yz, xz, xy of its end, square metres.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", deserialize_with = "unique_keys")]
    covariances: BTreeMap<String, [f64; 6]>,
}

impl RivalRecord {
    fn of(model: &Model, rival: &Mode) -> Self {
        let symmetric = |m: &DMat3| [m.x_axis.x, m.y_axis.y, m.z_axis.z, m.y_axis.z, m.x_axis.z, m.x_axis.y];
        let named = model.limbs().iter().zip(&rival.covariances);
        let covariances = named.map(|(limb, covariance)| (limb.name.clone(), symmetric(covariance)));
        let pose = PoseRecord::of(model, &rival.pose);
        Self { weight: rival.weight, pose, covariances: covariances.collect() }
    }

    fn read(self, model: &Model, field: &str) -> Result<Mode, ProjectProblem> {
        check_numbers(field, &[("weight", Some(self.weight), 1.0)])?;
        let pose = self.pose.pose(model, &format!("{field}.pose"))?;
        let is_told = !self.covariances.is_empty();
        let mut covariances = vec![DMat3::ZERO; if is_told { model.limbs().len() } else { 0 }];
        for (name, [xx, yy, zz, yz, xz, xy]) in self.covariances {
            let field = format!("{field}.covariances");
            let limb = limb_index(model, &field, &name)?;
            let own = [
                ("xx", Some(xx), f64::INFINITY),
                ("yy", Some(yy), f64::INFINITY),
                ("zz", Some(zz), f64::INFINITY),
            ];
            check_numbers(&format!("{field}.{name}"), &own)?;
            covariances[limb] = DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
        }
        Ok(Mode { pose, weight: self.weight, covariances })
    }
}

impl FrameTrustRecord {
    /// What was told in a frame whose estimate has this pose.
    pub(super) fn of(model: &Model, trust: &FrameTrust, found: Option<&Pose>) -> Self {
        let pose = |pose: &Pose| PoseRecord::of(model, pose);
        let hold = |hold: &LimbHold| {
            let LimbHold { limb, cameras, by_silhouettes, ref cues } = *hold;
            (model.limbs()[limb].name.clone(), HoldRecord { cameras, by_silhouettes, cues: cues.clone() })
        };
        Self {
            pose: (found != Some(&trust.pose)).then(|| pose(&trust.pose)),
            trust: TrustRecord::of(model, &trust.limbs),
            held: trust.holds.iter().map(hold).collect(),
            rivals: trust.rivals.iter().map(|rival| RivalRecord::of(model, rival)).collect(),
        }
    }

    pub(super) fn read(
        self,
        model: &Model,
        field: &str,
        found: Option<&Pose>,
    ) -> Result<FrameTrust, ProjectProblem> {
        let pose = match (&self.pose, found) {
            (Some(record), _) => record.pose(model, &format!("{field}.pose"))?,
            (None, Some(found)) => found.clone(),
            (None, None) => return Err(ProjectProblem::NoPose { field: format!("{field}.pose") }),
        };
        let trust = self.trust.read(model, &format!("{field}.trust")).map_err(ProjectProblem::Trust)?;
        let mut holds = Vec::with_capacity(self.held.len());
        for (name, HoldRecord { cameras, by_silhouettes, cues }) in self.held {
            let limb = limb_index(model, &format!("{field}.held"), &name)?;
            holds.push(LimbHold { limb, cameras, by_silhouettes, cues });
        }
        holds.sort_by_key(|hold| model.limbs()[hold.limb].rotation);
        let mut rivals = Vec::with_capacity(self.rivals.len());
        for (index, rival) in self.rivals.into_iter().enumerate() {
            rivals.push(rival.read(model, &format!("{field}.rivals[{index}]"))?);
        }
        Ok(FrameTrust::new(model, pose, trust, holds, rivals))
    }
}
