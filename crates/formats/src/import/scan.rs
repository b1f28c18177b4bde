//! What lies in folders: videos, numbered pictures, calibrations, keypoints, tables of markers.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::take::{FramePattern, PatternError, split_number};
use crate::{FileError, FileProblem, Result, keypoints};

/// How deep folders are searched.
const MAX_DEPTH: usize = 7;
/// Most files that are looked at.
const MAX_FILES: usize = 300_000;
/// A folder with more text files than this holds data, not a calibration.
const MOST_TEXTS: usize = 60;
const VIDEOS: [&str; 9] = ["mp4", "mov", "avi", "mkv", "webm", "m4v", "mts", "wmv", "flv"];
const PICTURES: [&str; 7] = ["png", "jpg", "jpeg", "tif", "tiff", "webp", "bmp"];
const CALIBRATIONS: [&str; 9] = ["toml", "json", "yml", "yaml", "xml", "xcp", "txt", "pickle", "pkl"];

/// Numbered pictures of one folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sequence {
    pub(super) folder: PathBuf,
    /// The file's name with `%03d` in the place of its number.
    pub(super) pattern: String,
    pub(super) first: u64,
    /// How many there are without a gap.
    pub(super) count: usize,
    /// How many lie behind the first gap.
    pub(super) behind: usize,
    /// The first picture.
    pub(super) example: PathBuf,
}

impl Sequence {
    /// The picture with this place among them.
    pub(super) fn path(&self, index: usize) -> Result<PathBuf, PatternError> {
        let number = self.first.saturating_add(index as u64);
        Ok(FramePattern::new(&self.pattern)?.path(&self.folder, number))
    }

    /// Says that pictures lie behind a gap, which are not used.
    pub(super) fn gap(&self) -> Option<String> {
        let missing = self.first.saturating_add(self.count as u64);
        (self.behind > 0).then(|| {
            format!(
                "picture {missing} is missing, so that the frames end there; {} later ones are not used",
                self.behind
            )
        })
    }
}

/// A picture: its number, that number's digits, and its path.
type Numbered = (u64, usize, PathBuf);

/// The files of interest, in the order of their paths.
#[derive(Debug, Default)]
pub(super) struct Listing {
    pub(super) videos: Vec<PathBuf>,
    pub(super) sequences: Vec<Sequence>,
    /// Single pictures: plates.
    pub(super) pictures: Vec<PathBuf>,
    /// Files that may be a calibration.
    pub(super) calibrations: Vec<PathBuf>,
    /// Folders of keypoints, a file a frame.
    pub(super) keypoints: Vec<PathBuf>,
    /// Tables of markers.
    pub(super) tables: Vec<PathBuf>,
    files: usize,
}

/// Looks through folders and at single files. Hidden folders and links to folders are left out.
pub(super) fn scan(paths: &[PathBuf]) -> Result<Listing> {
    let mut found = Listing::default();
    let mut single = Vec::new();
    for path in paths {
        match std::fs::metadata(path) {
            Ok(about) if about.is_dir() => found.folder(path, 0)?,
            Ok(_) => single.push(path.clone()),
            Err(_) => return Err(FileError::new(path, FileProblem::Missing)),
        }
    }
    found.files_of_one_folder(&single);
    Ok(found)
}

fn has_ending(path: &Path, endings: &[&str]) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str());
    ending.is_some_and(|ending| endings.iter().any(|known| ending.eq_ignore_ascii_case(known)))
}

impl Listing {
    fn folder(&mut self, folder: &Path, depth: usize) -> Result<()> {
        let failed = |error| FileError::new(folder, FileProblem::Read { error });
        let (mut files, mut folders) = (Vec::new(), Vec::new());
        for entry in std::fs::read_dir(folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            let (path, kind) = (entry.path(), entry.file_type().map_err(failed)?);
            let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
            if is_hidden {
                continue;
            }
            if kind.is_dir() {
                folders.push(path);
            } else if path.is_file() {
                files.push(path);
            }
            self.files += 1;
            if self.files > MAX_FILES {
                let message = format!("there are more than {MAX_FILES} files; name a smaller folder");
                let problem = FileProblem::Option { field: "folder".to_owned(), message };
                return Err(FileError::new(folder, problem));
            }
        }
        files.sort();
        folders.sort();
        self.files_of_one_folder(&files);
        if depth < MAX_DEPTH {
            folders.iter().try_for_each(|folder| self.folder(folder, depth + 1))?;
        }
        Ok(())
    }

    fn files_of_one_folder(&mut self, files: &[PathBuf]) {
        let with = |endings: &'static [&'static str]| {
            files.iter().filter(move |path| has_ending(path, endings)).cloned()
        };
        self.videos.extend(with(&VIDEOS));
        self.tables.extend(with(&["trc"]));
        self.numbered(with(&PICTURES));
        let texts: Vec<PathBuf> = with(&CALIBRATIONS).collect();
        let json = texts.iter().find(|path| has_ending(path, &["json"]));
        let is_keypoints = json.is_some_and(|path| keypoints::read(path).is_ok());
        if is_keypoints {
            self.keypoints.extend(json.and_then(|path| path.parent()).map(Path::to_owned));
        } else if texts.len() <= MOST_TEXTS {
            self.calibrations.extend(texts);
        }
    }

    /// Sorts the pictures of a folder into those that are numbered and single ones.
    fn numbered(&mut self, pictures: impl Iterator<Item = PathBuf>) {
        let mut groups: BTreeMap<(PathBuf, String, String), Vec<Numbered>> = BTreeMap::new();
        for path in pictures {
            let folder = path.parent().unwrap_or(Path::new("")).to_owned();
            match path.file_name().and_then(|name| name.to_str()).and_then(split_number) {
                Some((before, digits, after)) => {
                    let Ok(number) = digits.parse() else { continue };
                    let group = groups.entry((folder, before.to_owned(), after.to_owned())).or_default();
                    group.push((number, digits.len(), path.clone()));
                }
                None => self.pictures.push(path),
            }
        }
        for ((folder, before, after), mut group) in groups {
            group.sort();
            let first = group[0].0;
            let count =
                group.iter().zip(first..).take_while(|(picture, number)| picture.0 == *number).count();
            if count < 2 {
                self.pictures.extend(group.into_iter().map(|(_, _, path)| path));
                continue;
            }
            let digits = group[0].1;
            let is_filled = group.iter().all(|picture| picture.1 == digits);
            let number = if is_filled && digits > 1 { format!("%0{digits}d") } else { "%d".to_owned() };
            let pattern = format!("{}{number}{}", escaped(&before), escaped(&after));
            let behind = group.len() - count;
            let example = group.swap_remove(0).2;
            self.sequences.push(Sequence { folder, pattern, first, count, behind, example });
        }
    }
}

/// A text of a path in which no number is meant.
pub(super) fn escaped(text: &str) -> String {
    text.replace('%', "%%")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_apart() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, content: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, content).unwrap();
        };
        for name in
            ["videos/cam1.MP4", "videos/cam2.mov", ".cache/old.mp4", "notes.md", "3d/a.trc", "plate.png"]
        {
            write(name, "");
        }
        for number in 7..12 {
            write(&format!("cam3/é100%_{number:04}.jpg"), "");
            write(&format!("cam4/{number}.png"), "");
            write(&format!("pose/cam1_json/cam1_{number}.json"), r#"{"people": []}"#);
        }
        write("cam3/é100%_0020.jpg", "");
        write("calibration/Calib.toml", "");
        let found = scan(&[folder.path().to_owned()]).unwrap();
        let short = |paths: &[PathBuf]| -> Vec<String> {
            let short = paths.iter().map(|path| path.strip_prefix(folder.path()).unwrap());
            short.map(|path| path.to_str().unwrap().to_owned()).collect()
        };
        assert_eq!(short(&found.videos), ["videos/cam1.MP4", "videos/cam2.mov"]);
        assert_eq!(short(&found.tables), ["3d/a.trc"]);
        assert_eq!(short(&found.pictures), ["plate.png"]);
        assert_eq!(short(&found.keypoints), ["pose/cam1_json"]);
        assert_eq!(short(&found.calibrations), ["calibration/Calib.toml"]);
        let [three, four] = &found.sequences[..] else { panic!("{:?}", found.sequences) };
        assert_eq!((three.pattern.as_str(), three.first, three.count), ("é100%%_%04d.jpg", 7, 5));
        assert_eq!((three.behind, four.behind), (1, 0), "number 20 lies behind a gap");
        assert_eq!((four.pattern.as_str(), four.first, four.count), ("%d.png", 7, 5));
        assert!(scan(&[folder.path().join("none")]).unwrap_err().is_missing());
    }

    #[test]
    fn the_last_number_counts() {
        assert_eq!(split_number("cam1_frame-012b.jpg"), Some(("cam1_frame-", "012", "b.jpg")));
        assert_eq!(split_number("ü7.png"), Some(("ü", "7", ".png")));
        assert_eq!(split_number("plate.mp4"), None);
    }
}
