//! A bookmark in a project's file.

use backlit_tracking::body::{Model, ROOT};
use backlit_words::joint::JointId;
use serde::{Deserialize, Serialize};

use super::ProjectProblem;
use super::record::{camera_index, limb_index};
use crate::bookmark::Bookmark;
use crate::{CameraUse, Document};

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BookmarkRecord {
    frame: usize,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    camera: Option<String>,
    /// The limb that ends there, or root.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    joint: Option<String>,
    text: String,
}

impl BookmarkRecord {
    pub(super) fn of(document: &Document, mark: &Bookmark) -> Self {
        let joint = mark.joint.map(|joint| match joint {
            JointId::Root => ROOT.to_owned(),
            JointId::End(limb) => document.model.limbs()[limb].name.clone(),
        });
        let camera = mark.camera.and_then(|camera| document.cameras.get(camera));
        let camera = camera.map(|camera| camera.name.clone());
        Self { frame: mark.frame, camera, joint, text: mark.text.clone() }
    }

    pub(super) fn read(
        self,
        model: &Model,
        cameras: &[CameraUse],
        field: &str,
    ) -> Result<Bookmark, ProjectProblem> {
        let Self { frame, camera, joint, text } = self;
        let camera =
            camera.map(|name| camera_index(cameras, &format!("{field}.camera"), name)).transpose()?;
        let joint = joint.map(|name| match name.as_str() {
            ROOT => Ok(JointId::Root),
            name => limb_index(model, &format!("{field}.joint"), name).map(JointId::End),
        });
        if let Some(expected) = Bookmark::expected_of(&text) {
            return Err(ProjectProblem::Text { field: format!("{field}.text"), expected });
        }
        Ok(Bookmark { frame, camera, joint: joint.transpose()?, text })
    }
}
