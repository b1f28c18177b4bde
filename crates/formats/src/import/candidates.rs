//! Files that may be a camera's footage, and which of them go with which cameras.

use std::path::{Path, PathBuf};

use super::matching::{MatchedBy, matched};
use super::pictures::Pictures;
use super::scan::{Listing, Sequence};
use crate::FileError;
use crate::video::Video;

/// Words of folders that hold footage as it was recorded, not pictures made of it.
const RECORDED: [&str; 6] = ["video", "synchronized", "images", "inputmedia", "recording", "footage"];
/// Words of pictures and folders that show the scene without the subject.
pub(super) const PLATES: [&str; 4] = ["background", "plate", "empty", "bg"];
/// How many folders up a name is looked for.
const PARENTS: usize = 4;

/// A file or folder of footage and the names that it is known by.
pub(super) struct Candidate {
    pub(super) footage: Footage,
    pub(super) names: Vec<String>,
    /// Footage of one recording lies together.
    group: PathBuf,
}

#[derive(Clone)]
pub(super) enum Footage {
    Video(PathBuf),
    Numbered(Sequence),
}

impl Footage {
    /// Opens it.
    ///
    /// # Errors
    /// A video that cannot be read.
    pub(super) fn open(&self) -> Result<Pictures, FileError> {
        Ok(match self {
            Self::Video(path) => Pictures::Video(Video::open(path)?),
            Self::Numbered(Sequence { folder, pattern, first, count, .. }) => {
                let (folder, pattern) = (folder.clone(), pattern.clone());
                Pictures::Numbered { folder, pattern, first: *first, count: *count }
            }
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

/// All videos and numbered pictures but plates.
pub(super) fn footage_of(listing: &Listing) -> Vec<Candidate> {
    let parents = |path: &Path| -> Vec<String> {
        let names = path.ancestors().skip(1).take(PARENTS).filter_map(Path::file_name);
        names.map(|name| name.to_string_lossy().into_owned()).collect()
    };
    let videos = listing.videos.iter().map(|path| {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let names = std::iter::once(stem).chain(parents(path)).collect();
        Candidate { footage: Footage::Video(path.clone()), names, group: group_of(path) }
    });
    let sequences = listing.sequences.iter().filter(|sequence| !is_plate(&sequence.folder)).map(|sequence| {
        let before = sequence.pattern.split('%').next().unwrap_or_default().to_owned();
        let names = parents(&sequence.example).into_iter().take(1).chain([before]);
        let names = names.chain(parents(&sequence.folder)).collect();
        Candidate { footage: Footage::Numbered(sequence.clone()), names, group: group_of(&sequence.folder) }
    });
    videos.chain(sequences).collect()
}

fn group_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_owned()
}

/// For each camera its footage: of the folder whose files go with most cameras, else of all.
pub(super) fn best_group(cameras: &[&str], footage: &[Candidate]) -> (Vec<Option<usize>>, MatchedBy) {
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
