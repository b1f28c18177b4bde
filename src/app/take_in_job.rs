//! Reading what was dropped on the window.

use std::path::PathBuf;
use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_formats::pose_file::Quaternions;
use backlit_formats::{model_file, pose_file};
use backlit_take::dropped::Dropped;
use backlit_take::footage::Footage;
use backlit_take::replacement::{masks_of, read_calibration};
use backlit_tracking::body::Model;

/// Files that were dropped, and what they are for.
#[derive(Debug)]
pub(crate) struct TakeInJob {
    /// What they are.
    pub(crate) dropped: Dropped,
    /// The take that is open.
    pub(crate) footage: Arc<Footage>,
    /// The document's body.
    pub(crate) model: Arc<Model>,
    /// The frame on the screen.
    pub(crate) frame: usize,
}

impl TakeInJob {
    /// The change of the document, and what is said of it.
    pub(crate) fn read(&self) -> anyhow::Result<(Edit, String)> {
        let name = |path: &PathBuf| {
            path.file_name()
                .map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
        };
        let cameras = self.footage.take_cameras();
        let frame = self.frame;
        Ok(match &self.dropped {
            Dropped::Calibration(path) => {
                let calibration = read_calibration(path, self.footage.full_cameras())?;
                let said = format!("The {} cameras now come from {}.", calibration.rig.count(), name(path));
                (Edit::SetCalibration(Some(Arc::new(calibration))), said)
            }
            Dropped::Masks(paths) => {
                let masks = masks_of(paths, cameras)?;
                let numbers: Vec<String> = masks.keys().map(|camera| (camera + 1).to_string()).collect();
                let plural = if numbers.len() == 1 { "" } else { "s" };
                let said = format!(
                    "Replaced the silhouettes of frame {frame} in camera{plural} {}.",
                    numbers.join(", ")
                );
                (Edit::SetMasks { frame, masks }, said)
            }
            Dropped::Pose(path) => {
                let pose = pose_file::read(path, &self.model, Quaternions::Normalised)?;
                let said = format!("Frame {frame} now has the pose of {}.", name(path));
                (Edit::SetPose { frame, pose, what: "Drop pose".to_owned() }, said)
            }
            Dropped::Body(path) => {
                let model = model_file::read(path)?;
                let said = format!("The body now has the sizes of {}.", name(path));
                (Edit::SetBody(Arc::new(model)), said)
            }
            Dropped::New(_) | Dropped::Open(_) | Dropped::Unknown(..) => {
                anyhow::bail!("{}: it has nothing that can be used here", self.dropped.explanation(frame).1)
            }
        })
    }
}
