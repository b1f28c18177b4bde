//! Work on other threads: looking at folders, and writing the take.

use std::path::PathBuf;
use std::sync::Arc;

use backlit_formats::images;
use backlit_formats::import::{self, ImportOptions, ImportStep, ImportSurvey, WriteOptions};
use backlit_jobs::{Job, Outbox, Turn};
use egui::ColorImage;

/// Height of the pictures on the card, pixels.
const PICTURE_HEIGHT: usize = 96;

/// What was found, with a picture of each camera.
#[derive(Debug, Clone)]
pub(super) struct Looked {
    pub(super) found: Arc<ImportSurvey>,
    /// By camera; `None` where the first picture cannot be read.
    pub(super) pictures: Vec<Option<Arc<ColorImage>>>,
}

/// Looks through folders.
///
/// # Errors
/// Why no take can be made, in a sentence.
pub(super) fn look(paths: &[PathBuf], options: &ImportOptions) -> Result<Looked, String> {
    let found = import::survey(paths, options).map_err(|error| error.to_string())?;
    let picture = |camera: &import::ImportCamera| {
        let picture = camera.pictures.picture(found.first).ok()?;
        let divisor = (picture.height() as usize / PICTURE_HEIGHT).max(1);
        let small = images::reduced(picture, divisor);
        let size = [small.width() as usize, small.height() as usize];
        Some(Arc::new(ColorImage::from_rgb(size, small.as_raw())))
    };
    let pictures = found.cameras.iter().map(picture).collect();
    Ok(Looked { found: Arc::new(found), pictures })
}

/// What is heard of the writing.
#[derive(Debug)]
pub(super) enum Written {
    /// What is done just now.
    Step(String),
    /// Something that was done and is to be known.
    Said(String),
    /// The take file.
    Done(PathBuf),
    /// Why there is none.
    Failed(String),
}

/// Learns backgrounds and writes the take.
#[derive(Debug)]
pub(super) struct WriteJob {
    pub(super) found: Arc<ImportSurvey>,
    pub(super) out: PathBuf,
}

impl Job<Written> for WriteJob {
    fn step(&mut self, out: &Outbox<Written>) -> Turn {
        let mut say = |step: ImportStep| match step {
            ImportStep::Learning { camera } => {
                out.send(Written::Step(format!("Learning the background of {camera}")));
            }
            ImportStep::Adjusted { median_px: [before, after] } => out.send(Written::Said(format!(
                "The cameras were adjusted: keypoints were {before:.1} px off, now {after:.1} px. The take \
                 keeps both calibrations."
            ))),
            ImportStep::Measuring | ImportStep::Learnt { .. } => {}
        };
        let written = import::write(&self.found, &self.out, WriteOptions::default(), out.cancel(), &mut say);
        out.send(match written {
            Ok(file) => Written::Done(file),
            Err(error) => Written::Failed(error.to_string()),
        });
        Turn::Done
    }
}
