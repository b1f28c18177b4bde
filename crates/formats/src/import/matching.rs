//! Which file belongs to which camera, and the folder that goes with most cameras.

use std::path::{Path, PathBuf};

use super::pictures::Pictures;
use super::scan::{Listing, Sequence};
use crate::Result;
use crate::video::Video;

/// By what a file was given to a camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MatchedBy {
    /// Its name is the camera's.
    Name,
    /// The last number of its name is that of the camera's.
    Number,
    /// Nothing but the order: there are as many files as cameras.
    Order,
}

/// For each camera the index of the item that is its own. An item is known by several names, the best first. All are
/// matched by the first rule that matches any; each item goes to one camera.
pub(super) fn matched(cameras: &[&str], items: &[Vec<String>]) -> (Vec<Option<usize>>, MatchedBy) {
    let by = |is_same: &dyn Fn(&str, &str) -> bool| -> Vec<Option<usize>> {
        let mut taken = vec![false; items.len()];
        let mut own = |camera: &&str| {
            let names = items.iter().map(Vec::len).max().unwrap_or(0);
            let found = (0..names).find_map(|rank| {
                let is_own = |(index, item): (usize, &Vec<String>)| {
                    !taken[index] && item.get(rank).is_some_and(|name| is_same(camera, name))
                };
                items.iter().enumerate().position(is_own)
            })?;
            taken[found] = true;
            Some(found)
        };
        cameras.iter().map(&mut own).collect()
    };
    for (how, is_same) in [
        (
            MatchedBy::Name,
            &(|camera: &str, name: &str| plain(camera) == plain(name)) as &dyn Fn(&str, &str) -> bool,
        ),
        (MatchedBy::Number, &|camera, name| {
            last_number(camera).is_some() && last_number(camera) == last_number(name)
        }),
    ] {
        let found = by(is_same);
        let has_twins = how == MatchedBy::Number && !are_numbered(cameras);
        if found.iter().any(Option::is_some) && !has_twins {
            return (found, how);
        }
    }
    let in_order = (cameras.len() == items.len()).then(|| (0..items.len()).map(Some).collect());
    (in_order.unwrap_or_else(|| vec![None; cameras.len()]), MatchedBy::Order)
}

/// Letters and digits in lower case, without words that say nothing and without zeros before numbers.
fn plain(name: &str) -> String {
    let mut out = String::new();
    let mut is_number = false;
    for letter in name.to_lowercase().chars().filter(|letter| letter.is_alphanumeric()) {
        let is_digit = letter.is_ascii_digit();
        if is_digit && !is_number && letter == '0' {
            continue;
        }
        is_number = is_digit;
        out.push(letter);
    }
    ["camera", "json", "video", "int", "img", "undistorted"].iter().fold(out, |out, word| match *word {
        "camera" => out.replace("camera", "cam"),
        word => out.replace(word, ""),
    })
}

fn last_number(name: &str) -> Option<u64> {
    name.rsplit(|letter: char| !letter.is_ascii_digit()).find(|part| !part.is_empty())?.parse().ok()
}

/// Whether all names have numbers, no two the same.
fn are_numbered(names: &[&str]) -> bool {
    let numbers: Vec<Option<u64>> = names.iter().map(|name| last_number(name)).collect();
    numbers.iter().enumerate().all(|(index, number)| number.is_some() && !numbers[..index].contains(number))
}

/// Words of folders that hold footage as it was recorded, not pictures made of it.
const RECORDED: [&str; 6] = ["video", "synchronized", "images", "inputmedia", "recording", "footage"];
/// Words of pictures and folders that show the scene without the subject.
pub(super) const PLATES: [&str; 4] = ["background", "plate", "empty", "bg"];
/// Words of videos that were taken to calibrate.
const BOARDS: [&str; 5] = ["checker", "board", "calib", "intrinsic", "extrinsic"];
/// How many folders up a name is looked for.
const PARENTS: usize = 4;

/// A file or folder of footage and the names that it is known by.
pub(super) struct FootageCandidate {
    pub(super) footage: FootageFiles,
    pub(super) names: Vec<String>,
    /// The files of one recording lie together.
    group: PathBuf,
}

#[derive(Clone)]
pub(super) enum FootageFiles {
    Video(PathBuf),
    Numbered(Sequence),
}

impl FootageFiles {
    /// Opens it.
    pub(super) fn open(&self) -> Result<Pictures> {
        Ok(match self {
            Self::Video(path) => Pictures::Video(Video::open(path)?),
            Self::Numbered(sequence) => Pictures::Numbered(sequence.clone()),
        })
    }

    /// The path by whose names it is told what it is: a video's own, else that of the first picture.
    pub(super) fn path(&self) -> &Path {
        match self {
            Self::Video(path) => path,
            Self::Numbered(sequence) => &sequence.example,
        }
    }
}

/// Names of the folders that a file lies in, the nearest first.
pub(super) fn parents(path: &Path) -> Vec<String> {
    let names = path.ancestors().skip(1).take(PARENTS).filter_map(Path::file_name);
    names.map(|name| name.to_string_lossy().into_owned()).collect()
}

/// All videos and numbered pictures but plates.
pub(super) fn footage_of(listing: &Listing) -> Vec<FootageCandidate> {
    let has_others = !listing.videos.iter().all(|path| is_plate_video(path)) || !listing.sequences.is_empty();
    let films = listing.videos.iter().filter(|path| !has_others || !is_plate_video(path));
    let videos = films.map(|path| {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let names = std::iter::once(stem).chain(parents(path)).collect();
        FootageCandidate { footage: FootageFiles::Video(path.clone()), names, group: group_of(path) }
    });
    let sequences = listing.sequences.iter().filter(|sequence| !is_plate(&sequence.folder)).map(|sequence| {
        let before = sequence.pattern.split('%').next().unwrap_or_default().to_owned();
        let names = parents(&sequence.example).into_iter().take(1).chain([before]);
        let names = names.chain(parents(&sequence.folder)).collect();
        FootageCandidate {
            footage: FootageFiles::Numbered(sequence.clone()),
            names,
            group: group_of(&sequence.folder),
        }
    });
    let mut all: Vec<FootageCandidate> = videos.chain(sequences).collect();
    // Of two videos of one camera, the one of a board is not the one that is meant.
    all.sort_by_key(|one| BOARDS.iter().any(|word| one.names[0].to_lowercase().contains(word)));
    all
}

fn group_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_owned()
}

/// For each camera its footage: of the folder whose files go with most cameras, else of all.
pub(super) fn best_group(cameras: &[&str], footage: &[FootageCandidate]) -> (Vec<Option<usize>>, MatchedBy) {
    let mut groups: Vec<Option<&Path>> = vec![None];
    for one in footage {
        if !groups.contains(&Some(&one.group)) {
            groups.push(Some(&one.group));
        }
    }
    let tried = groups.into_iter().map(|group| {
        let members: Vec<usize> = (0..footage.len())
            .filter(|&index| group.is_none_or(|group| footage[index].group == group))
            .collect();
        let names: Vec<Vec<String>> = members.iter().map(|&index| footage[index].names.clone()).collect();
        let (own, how) = matched(cameras, &names);
        let own: Vec<Option<usize>> = own.into_iter().map(|own| own.map(|own| members[own])).collect();
        let count = own.iter().flatten().count();
        let path = group.map(|group| group.to_string_lossy().to_lowercase()).unwrap_or_default();
        let last = path.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
        let is_recorded = RECORDED.iter().any(|word| last.contains(word));
        let by = [MatchedBy::Order, MatchedBy::Number, MatchedBy::Name].iter().position(|by| *by == how);
        // Of equal ones the first: a single folder before all together, a shorter path before a longer one.
        ((count, is_recorded, by, group.is_some(), usize::MAX - path.len()), (own, how))
    });
    tried.max_by(|a, b| a.0.cmp(&b.0)).map_or((vec![None; cameras.len()], MatchedBy::Order), |(_, best)| best)
}

/// Whether a path is that of pictures of the scene without the subject.
pub(super) fn is_plate(path: &Path) -> bool {
    let words = path.iter().rev().take(2).map(|part| part.to_string_lossy().to_lowercase());
    words.into_iter().any(|word| PLATES.iter().any(|plate| word.contains(plate)))
}

/// Whether a word of a video's own name says that it shows the scene without the subject.
pub(super) fn is_plate_video(path: &Path) -> bool {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
    stem.split(|letter: char| !letter.is_alphabetic()).any(|word| PLATES.contains(&word))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn items(names: &[&str]) -> Vec<Vec<String>> {
        names.iter().map(|names| names.split('|').map(str::to_owned).collect()).collect()
    }

    #[test]
    fn names_come_before_numbers_and_numbers_before_the_order() {
        let found = matched(&["cam_01", "cam_02"], &items(&["cam2", "Camera 01"]));
        assert_eq!(found, (vec![Some(1), Some(0)], MatchedBy::Name));
        let found = matched(&["cam_01", "cam_02"], &items(&["GoPro-2", "GoPro-1", "other"]));
        assert_eq!(found, (vec![Some(1), Some(0)], MatchedBy::Number));
        let found = matched(&["left", "right"], &items(&["a", "b"]));
        assert_eq!(found, (vec![Some(0), Some(1)], MatchedBy::Order));
        assert_eq!(matched(&["left", "right"], &items(&["a"])).0, [None, None]);
        // A folder's name helps where the file's own says nothing.
        let found = matched(&["Cam0", "Cam1"], &items(&["trial|Cam1", "trial|Cam0"]));
        assert_eq!(found, (vec![Some(1), Some(0)], MatchedBy::Name));
        assert_eq!(
            matched(&["a1", "b1"], &items(&["x1", "y2", "z3"])).0,
            [None, None],
            "numbers that tell nothing"
        );
    }
}
