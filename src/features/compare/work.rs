//! References are read, and the poses are compared with them, while the window goes on.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_document::{Document, Estimate};
use backlit_formats::Take;
use backlit_formats::motion::Motion;
use backlit_formats::recording::RecordingOptions;
use backlit_runs::comparison::{AS_IT_IS, ComparedReference, compare_motion, read_reference};
use backlit_tracking::body::{Kinematics, Model, Pose, joint_names};
use backlit_tracking::metrics::comparison::{ComparisonOptions, TrackComparison};
use glam::DVec3;

use crate::context::marks::ReferenceMark;

/// A reference, and its file; `None` for the take's own.
#[derive(Debug)]
pub(super) struct NamedReference {
    pub(super) reference: ComparedReference,
    pub(super) path: Option<PathBuf>,
}

impl NamedReference {
    pub(super) fn of_take(take: &Take) -> Option<Self> {
        Some(Self { reference: ComparedReference::of_take(take)?, path: None })
    }
}

/// Reads a file; an error is a sentence.
pub(super) fn read(path: &Path) -> Result<Arc<NamedReference>, String> {
    let reference =
        read_reference(path, &RecordingOptions::default()).map_err(|error| format!("{error:#}"))?;
    Ok(Arc::new(NamedReference { reference, path: Some(path.to_owned()) }))
}

/// Whether two lists are of the same references.
pub(super) fn are_same(a: &[Arc<NamedReference>], b: &[Arc<NamedReference>]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| Arc::ptr_eq(a, b))
}

/// All that a comparison depends on.
#[derive(Debug, Clone)]
pub(super) struct ComparisonInputs {
    body: Arc<Model>,
    estimates: Arc<BTreeMap<usize, Arc<Estimate>>>,
    keys: Arc<BTreeMap<usize, Pose>>,
    references: Vec<Arc<NamedReference>>,
    motion: Arc<Motion>,
}

impl PartialEq for ComparisonInputs {
    fn eq(&self, other: &Self) -> bool {
        self.is_of((&other.body, &other.estimates, &other.keys), &other.references)
    }
}

/// What a document's poses are made of.
pub(super) type PoseParts<'a> =
    (&'a Arc<Model>, &'a Arc<BTreeMap<usize, Arc<Estimate>>>, &'a Arc<BTreeMap<usize, Pose>>);

impl ComparisonInputs {
    /// Whether they are of these parts of a document and these references. Parts are shared: one that has not changed is the same, and
    /// no pose is looked at.
    pub(super) fn is_of(
        &self,
        (body, estimates, keys): PoseParts<'_>,
        references: &[Arc<NamedReference>],
    ) -> bool {
        Arc::ptr_eq(&self.body, body)
            && Arc::ptr_eq(&self.estimates, estimates)
            && Arc::ptr_eq(&self.keys, keys)
            && are_same(&self.references, references)
    }

    pub(super) fn of(document: &Document, take: &Take, references: &[Arc<NamedReference>]) -> Self {
        Self {
            body: document.model.clone(),
            estimates: document.estimates.clone(),
            keys: document.keys.clone(),
            references: references.to_vec(),
            motion: Arc::new(document.motion(take.name(), take.frame_rate())),
        }
    }

    /// The poses that are compared.
    pub(super) fn motion(&self) -> &Arc<Motion> {
        &self.motion
    }

    pub(super) fn compare(&self) -> Vec<Arc<TrackComparison>> {
        let one = |named: &Arc<NamedReference>| {
            let options = if named.path.is_none() { AS_IT_IS } else { ComparisonOptions::default() };
            Arc::new(compare_motion(&self.motion, &named.reference, &options))
        };
        self.references.iter().map(one).collect()
    }
}

/// The joints of a reference beside those of a pose.
pub(super) fn marks(
    reference: usize,
    model: &Model,
    pose: &Pose,
    joints: &[String],
    places: &[Option<DVec3>],
) -> Vec<ReferenceMark> {
    let (names, kinematics) = (joint_names(model), Kinematics::new(model, pose));
    let mark = |(joint, place): (&String, &Option<DVec3>)| {
        let limb = names.iter().position(|name| name == joint)?;
        Some(ReferenceMark {
            reference,
            joint: joint.clone(),
            ours: kinematics.ends()[limb],
            place: (*place)?,
        })
    };
    joints.iter().zip(places).filter_map(mark).collect()
}
