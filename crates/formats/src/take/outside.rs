//! Files that a take names outside its own folder: a take from elsewhere should not read them unseen.

use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};

use toml::Spanned;

use super::FramePattern;
use super::reader::Reader;
use super::spec::{CalibrationSpec, ReferenceSpec, TakeSpec, ViewSpec};
use crate::files::plain;
use crate::{FileError, model_file};

/// What a take reads outside its own folder. Of numbered pictures the first one stands for all.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outside {
    /// The first such path, in the order of the take file.
    pub first: PathBuf,
    /// How many such paths the take file names, the first one included.
    pub count: usize,
}

impl Display for Outside {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "the take reads outside its own folder: {}", self.first.display())?;
        match self.count - 1 {
            0 => Ok(()),
            1 => write!(f, ", and 1 more path that it names"),
            more => write!(f, ", and {more} more paths that it names"),
        }
    }
}

/// A path as the take file has it: below which folder, what is written there, in which field, and the number of the first file
/// where it is a pattern.
struct Named<'a> {
    below: &'a Path,
    value: &'a Spanned<String>,
    field: &'static str,
    first: u64,
}

impl Reader<'_> {
    /// What the take file names outside its folder.
    ///
    /// # Errors
    /// A variable in a path that is not set.
    pub(super) fn outside(&self, spec: &TakeSpec) -> Result<Option<Outside>, FileError> {
        let own = self.real(&self.folder);
        let mut found: Vec<PathBuf> = Vec::new();
        for Named { below, value, field, first } in self.named(spec) {
            let text = self.expand(value, field)?;
            if field == "model" && model_file::is_built_in(&text) {
                continue;
            }
            let path = below.join(&text);
            let path = match FramePattern::new(&text) {
                Ok(pattern) if !self.files.exists(&path) => pattern.path(below, first),
                _ => path,
            };
            if !self.real(&path).starts_with(&own) {
                found.push(path);
            }
        }
        let first = found.first().cloned();
        found.sort_unstable();
        found.dedup();
        Ok(first.map(|first| Outside { first, count: found.len() }))
    }

    /// Every path of the take file. Whoever adds a field to the file is asked by the compiler whether it is one.
    fn named<'s>(&'s self, spec: &'s TakeSpec) -> Vec<Named<'s>> {
        let TakeSpec {
            _format: _,
            name: _,
            frame_rate: _,
            units: _,
            // What lies in it is named; the folder itself is not read.
            footage: _,
            model,
            start,
            sizes: _,
            reduction: _,
            cameras: CalibrationSpec { calibration, size: _ },
            views,
            reference,
            measurement: _,
        } = spec;
        let own = |value, field| Named { below: &self.folder, value, field, first: 0 };
        let lying = |value, field, first| Named { below: &self.footage, value, field, first };
        let mut all = vec![own(model, "model")];
        all.extend(start.as_ref().map(|start| own(start, "start")));
        all.push(lying(calibration, "cameras.calibration", 0));
        for view in views {
            let ViewSpec {
                name: _,
                frames,
                masks,
                masks_first,
                mask_values: _,
                first,
                count: _,
                last: _,
                offset: _,
                offset_seconds: _,
                background,
                background_first,
                background_count: _,
                keypoints,
                keypoints_first,
                measurement: _,
            } = view;
            let first_mask = masks_first.as_ref().map_or(*first, |number| *number.get_ref());
            let first_keypoints = keypoints_first.unwrap_or(*first);
            all.extend(frames.as_ref().map(|value| lying(value, "camera.frames", *first)));
            all.extend(masks.as_ref().map(|value| lying(value, "camera.masks", first_mask)));
            all.extend(background.as_ref().map(|value| lying(value, "camera.background", *background_first)));
            all.extend(keypoints.as_ref().map(|value| lying(value, "camera.keypoints", first_keypoints)));
        }
        if let Some(ReferenceSpec { keypoints, first_frame: _, axes: _, markers: _ }) = reference {
            all.push(lying(keypoints, "reference.keypoints", 0));
        }
        all
    }

    /// Where a path leads: behind links of the disk as far as they are there, and without `..`.
    fn real(&self, path: &Path) -> PathBuf {
        let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let there = whole.ancestors().find_map(|part| Some((part, self.files.behind_links(part)?)));
        let real = there.and_then(|(part, real)| Some(real.join(whole.strip_prefix(part).ok()?)));
        plain(&real.unwrap_or(whole))
    }
}
