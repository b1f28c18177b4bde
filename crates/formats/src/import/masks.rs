//! Silhouettes that were made elsewhere, found by the names of files and folders and by what the pictures look like.

use std::path::{Path, PathBuf};

use super::matching::{FootageCandidate, MatchedBy, best_group};
use super::pictures::Pictures;
use super::{ImportCamera, ImportError, plates};
use crate::images::MAX_PICTURE_BYTES;
use crate::masks::{self, MaskSequence, MaskValues, Numbers};
use crate::{DiskFiles, Result, TakeFiles};

/// Words of names that masks have.
const WORDS: &str =
    "mask masks seg segs segmentation segmentations silhouette silhouettes alpha alphas matte mattes keyed";

/// One camera's masks.
#[derive(Debug, Clone)]
pub struct ImportMasks {
    /// Where they are; a mask a frame of the footage.
    pub pictures: Pictures,
    /// What their numbers mean; `None` where the take has to say it by hand, for the reason in the camera's notes.
    pub values: Option<MaskValues>,
    /// There is no footage beside them.
    pub are_alone: bool,
}

/// The words of a name: runs of letters.
fn words(name: &str) -> impl Iterator<Item = String> {
    name.split(|letter: char| !letter.is_alphabetic()).filter(|word| !word.is_empty()).map(str::to_lowercase)
}

fn is_mask_word(word: &str) -> bool {
    WORDS.split(' ').any(|known| known == word)
}

/// Whether names below the folders that the user named say that it is masks. Of such a folder itself only the word "masks"
/// counts: people call projects anything.
fn is_called_mask(path: &Path, roots: &[PathBuf]) -> bool {
    let root = roots.iter().find(|root| path.starts_with(root));
    let below =
        root.and_then(|root| path.strip_prefix(root).ok()).filter(|rest| rest.iter().next().is_some());
    let below = below.unwrap_or(Path::new(path.file_name().unwrap_or_default()));
    let says = below.iter().any(|part| words(&part.to_string_lossy()).any(|word| is_mask_word(&word)));
    let own = root.and_then(|root| root.file_name()).map(|name| name.to_string_lossy().to_lowercase());
    says || matches!(own.as_deref(), Some("mask" | "masks"))
}

/// Parts masks from footage. Masks are then known by their names without the words that say what they are.
pub(super) fn parted(
    all: Vec<FootageCandidate>,
    roots: &[PathBuf],
) -> (Vec<FootageCandidate>, Vec<FootageCandidate>) {
    let is_mask = |one: &FootageCandidate| {
        // A name may deceive ("seg" is also a segment), so the first picture has to look like a mask.
        is_called_mask(one.footage.path(), roots)
            && one
                .footage
                .open()
                .and_then(|pictures| numbers(&pictures, 0))
                .is_ok_and(|mask| mask.is_likely())
    };
    let (mut masks, footage): (Vec<FootageCandidate>, Vec<FootageCandidate>) =
        all.into_iter().partition(is_mask);
    for mask in &mut masks {
        let names: Vec<String> = mask.names.iter().map(|name| without_words(name)).collect();
        if names.iter().any(|name| !name.is_empty()) {
            mask.names = names.into_iter().filter(|name| !name.is_empty()).collect();
        }
    }
    (masks, footage)
}

fn without_words(name: &str) -> String {
    let parts = name.split_inclusive(|letter: char| !letter.is_alphabetic());
    parts.filter(|part| !words(part).any(|word| is_mask_word(&word))).collect()
}

/// For each camera its masks, by names or numbers.
pub(super) fn of_cameras<'a>(
    cameras: &[&str],
    masks: &'a [FootageCandidate],
) -> Vec<Option<&'a FootageCandidate>> {
    let (own, how) = best_group(cameras, masks);
    own.into_iter().map(|own| own.filter(|_| how != MatchedBy::Order).map(|own| &masks[own])).collect()
}

/// Gives a camera its masks if they go with its footage; if not, a note says why.
pub(super) fn add(camera: &mut ImportCamera, masks: Option<&FootageCandidate>, are_alone: bool) {
    let Some(candidate) = masks else { return };
    let place = candidate.footage.path().display().to_string();
    match found(camera, candidate, are_alone) {
        Err(reason) => camera.notes.push(format!("masks at {place} are not used: {reason}")),
        Ok((values, pictures)) => {
            camera.notes.extend(values.as_ref().err().map(|reason| format!("masks: {reason}")));
            camera.masks = Some(ImportMasks { pictures, values: values.ok(), are_alone });
        }
    }
}

type Values = Result<MaskValues, String>;

fn found(
    camera: &ImportCamera,
    candidate: &FootageCandidate,
    are_alone: bool,
) -> Result<(Values, Pictures), String> {
    let pictures = candidate.footage.open().map_err(|error| error.to_string())?;
    let (found, expected) = (pictures.count(), camera.pictures.count());
    if found != expected && !are_alone {
        return Err(format!("there are {found}, and {expected} frames of footage"));
    }
    let [width, height] = numbers(&pictures, 0).map_err(|error| error.to_string())?.size;
    let (expected_width, expected_height) = (camera.camera.width(), camera.camera.height());
    if [width, height] != [expected_width, expected_height] {
        return Err(format!(
            "they have {width}×{height} pixels, and the footage {expected_width}×{expected_height}"
        ));
    }
    let source = MaskSequence {
        count: found,
        path: &|index| pictures.path_of(index),
        read: &|index| numbers(&pictures, index),
    };
    let values = masks::values_of(None, &source).map_err(|(_, error)| error.to_string());
    Ok((values, pictures))
}

/// The numbers of one of some pictures.
fn numbers(pictures: &Pictures, index: usize) -> Result<Numbers> {
    match pictures {
        Pictures::Video(video) => Ok(Numbers::of_picture(&*video.frame(index)?)),
        Pictures::Numbered { .. } => {
            let path = pictures.path_of(index);
            Numbers::decode(&path, &DiskFiles.read(&path, MAX_PICTURE_BYTES)?)
        }
    }
}

impl ImportMasks {
    /// The person's height in pixels, the middle of some frames; `None` where nobody is seen or the masks are not understood.
    pub(super) fn person_px(&self, frames: &[usize]) -> Result<Option<f64>, ImportError> {
        let Some(values) = &self.values else { return Ok(None) };
        let mut heights = Vec::new();
        for &frame in frames {
            let shares = masks::shares(&numbers(&self.pictures, frame)?, values);
            heights.extend(masks::mask_of(&shares).as_ref().and_then(plates::height_px));
        }
        heights.sort_by(f64::total_cmp);
        Ok(heights.get(heights.len() / 2).copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_masks() {
        let roots = [PathBuf::from("/data/alpha"), PathBuf::from("/data/masks")];
        let is_mask = |path: &str| is_called_mask(Path::new(path), &roots);
        for path in [
            "/data/alpha/masks/cam1/0001.png",
            "/data/alpha/cam1/Mask/0001.png",
            "/data/alpha/cam1_mask.mp4",
            "/data/alpha/0001_seg.png",
            "/data/alpha/cam1-alpha-0001.png",
            "/data/alpha/SILHOUETTES/a.avi",
            "/data/masks/cam1/0001.png",
        ] {
            assert!(is_mask(path), "{path}");
        }
        for path in
            ["/data/alpha/cam1.mp4", "/data/alpha/masked_ball/cam1.mp4", "/data/alpha/segment2/cam1/01.png"]
        {
            assert!(!is_mask(path), "{path}");
        }
    }
}
