//! The real footage in the report's small pictures: two cameras, 144 × 192 pixels, 50 frames. It does not come with the
//! program; `BACKLIT_DATA` names the folder that has it. Body, cameras and settings are those of the tests' take.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context;
use backlit_formats::{DiskFiles, FileError, Footage, Take, TakeFiles};
use backlit_lab::experiment::sequence::Sequence;
use backlit_tracking::fit::{Evidence, FitView};
use backlit_tracking::search::start;

use super::take::{CameraFilm, assemble, picture_of};

/// Frames and size of the pictures, as in Figs. 5.4 and 5.5.
const FRAMES: usize = 50;
const SIZE_PX: [u64; 2] = [144, 192];
/// The cameras that are used, as in `docs/report.md`.
const CAMERAS: [&str; 2] = ["cam03", "cam04"];

/// What of the take comes with the program.
const FILES: [(&str, &str); 2] = [
    ("take.toml", include_str!("../../../../tests/takes/balancing/take.toml")),
    ("body.toml", include_str!("../../../../tests/takes/balancing/body.toml")),
];

pub(super) fn is_there() -> bool {
    std::env::var_os("BACKLIT_DATA").is_some_and(|data| PathBuf::from(data).join("balancing").is_dir())
}

/// Its take. Errors: the footage is not there or cannot be read.
pub(super) fn take(name: &str) -> anyhow::Result<Take> {
    let footage = Footage::new(Take::from_files(Arc::new(WithOwn), Path::new(FILES[0].0))?);
    let take = footage.take();
    let cameras: Vec<usize> =
        CAMERAS.iter().map(|camera| take.rig().index(camera)).collect::<Result<_, _>>()?;
    let joints = |frame| take.reference().map(|reference| reference.joints(frame)).unwrap_or_default();
    let start = start::from_joints(take.model(), &joints(0)).context("the footage has no keypoints")?;
    let sequence = Sequence::of_take(&footage, &cameras, FRAMES, start, SIZE_PX)?;
    let film = |index: usize| {
        let views = sequence.moments.iter().map(|moment| &moment.views[index]);
        let picture = |view: &FitView| match &view.evidence {
            Evidence::Mask(mask) => picture_of(mask),
            Evidence::Measurement(data) => data.to_gray(),
        };
        let camera = &sequence.moments[0].views[index].camera;
        CameraFilm::of(camera, views.map(picture).collect())
    };
    let films = (0..cameras.len()).map(film).collect();
    let mut table = "frame,joint,x,y,z\n".to_owned();
    for (frame, moment) in sequence.moments.iter().enumerate() {
        for (limb, at) in &moment.joints {
            let joint = limb.map_or("root", |limb| &sequence.model.limbs()[limb].name);
            writeln!(table, "{frame},{joint},{},{},{}", at.x, at.y, at.z)?;
        }
    }
    assemble(name, sequence.frame_rate, &sequence.model, &sequence.start, films, Some(table))
}

/// The disk, but for what comes with the program.
#[derive(Debug)]
struct WithOwn;

fn own(path: &Path) -> Option<&'static str> {
    FILES.iter().find(|(name, _)| path == Path::new(name)).map(|(_, text)| *text)
}

impl TakeFiles for WithOwn {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
        own(path).map_or_else(|| DiskFiles.read(path, limit), |text| Ok(text.as_bytes().to_vec()))
    }

    fn exists(&self, path: &Path) -> bool {
        own(path).is_some() || DiskFiles.exists(path)
    }
}
