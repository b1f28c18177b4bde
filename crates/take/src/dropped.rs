//! What files are that are dropped on the window, told by their endings and their first bytes.

use std::io::Read;
use std::path::{Path, PathBuf};

use super::motion::is_motion;

/// Bytes of a file that are looked at.
const HEAD: u64 = 4096;

/// What is to be done with files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Dropped {
    /// A take is made of footage and a calibration.
    New(Vec<PathBuf>),
    /// A take, a project or a motion is opened.
    Open(PathBuf),
    /// Its cameras replace the take's.
    Calibration(PathBuf),
    /// They replace the silhouettes of the frame on the screen.
    Masks(Vec<PathBuf>),
    /// It becomes the pose of the frame on the screen.
    Pose(PathBuf),
    /// Its sizes become the body's.
    Body(PathBuf),
    /// Nothing; why not.
    Unknown(PathBuf, &'static str),
}

impl Dropped {
    /// What these files are. Several are silhouettes, or else the first one counts.
    pub fn of(paths: &[PathBuf]) -> Self {
        let is_png = |path: &PathBuf| ending(path) == "png";
        if !paths.is_empty() && paths.iter().all(|path| is_png(path) && path.is_file()) {
            return Self::Masks(paths.to_vec());
        }
        if paths.iter().any(|path| has_footage(path)) {
            return Self::New(paths.to_vec());
        }
        match paths.first() {
            Some(path) => of_one(path),
            None => Self::Unknown(PathBuf::new(), "nothing was dropped"),
        }
    }

    /// Whether a take has to be open for it.
    pub const fn needs_take(&self) -> bool {
        matches!(self, Self::Calibration(_) | Self::Masks(_) | Self::Pose(_) | Self::Body(_))
    }

    /// What will happen, in a few words, and the name of what is dropped.
    pub fn explanation(&self, frame: usize) -> (String, String) {
        let name = |path: &Path| {
            path.file_name()
                .map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
        };
        match self {
            Self::New(paths) => (
                "Make a take of this footage".to_owned(),
                paths.first().map_or_else(String::new, |path| name(path)),
            ),
            Self::Open(path) if ending(path) == "backlit" => ("Open this project".to_owned(), name(path)),
            Self::Open(path) if is_motion(path) => {
                ("Play this motion without footage".to_owned(), name(path))
            }
            Self::Open(path) => ("Open this take".to_owned(), name(path)),
            Self::Calibration(path) => ("Replace the take’s cameras with these".to_owned(), name(path)),
            Self::Masks(paths) => {
                let what = match paths.as_slice() {
                    [one] => name(one),
                    many => format!("{} pictures", many.len()),
                };
                (format!("Replace the silhouettes of frame {frame}"), what)
            }
            Self::Pose(path) => (format!("Give frame {frame} this pose"), name(path)),
            Self::Body(path) => ("Give the body these sizes".to_owned(), name(path)),
            Self::Unknown(path, why) => {
                ("This cannot be used here".to_owned(), format!("{}: {why}", name(path)))
            }
        }
    }
}

/// Whether it is a video, or a folder with footage in it that is not a take already.
fn has_footage(path: &Path) -> bool {
    const VIDEOS: [&str; 8] = ["mp4", "mov", "avi", "mkv", "webm", "m4v", "mts", "wmv"];
    let is_video = |path: &Path| VIDEOS.contains(&ending(path).as_str());
    if !path.is_dir() {
        return is_video(path);
    }
    let has_config =
        ["Config.toml", "intri.yml", "camera_array.toml"].iter().any(|name| path.join(name).is_file());
    !path.join("take.toml").is_file()
        && (has_config
            || entries(path).any(|inside| {
                is_video(&inside) || inside.is_dir() && entries(&inside).any(|video| is_video(&video))
            }))
}

fn of_one(path: &Path) -> Dropped {
    let unknown = |why| Dropped::Unknown(path.to_owned(), why);
    if path.is_dir() {
        return if path.join("take.toml").is_file() {
            Dropped::Open(path.to_owned())
        } else if entries(path).any(|entry| ending(&entry) == "png") {
            Dropped::Masks(vec![path.to_owned()])
        } else {
            unknown("the folder has neither a take.toml nor PNGs")
        };
    }
    let Some(head) = head(path) else { return unknown("it cannot be read") };
    let says = |format: &str| head.contains(format);
    match ending(path).as_str() {
        "backlit" => Dropped::Open(path.to_owned()),
        "toml" if says("backlit-body") => Dropped::Body(path.to_owned()),
        "toml" if says("backlit-take") || path.ends_with("take.toml") => Dropped::Open(path.to_owned()),
        "toml" => unknown("expected a take or a body: `format` says which"),
        "json" if says("backlit-pose") => Dropped::Pose(path.to_owned()),
        "json" if says("backlit-project") => Dropped::Open(path.to_owned()),
        "json" if says("backlit-track") || says("backlit-experiment") => {
            unknown("results cannot be read back")
        }
        "json" => Dropped::Calibration(path.to_owned()),
        "txt" | "xml" | "qca" if head.trim_start_matches('\u{feff}').trim_start().starts_with('<') => {
            Dropped::Calibration(path.to_owned())
        }
        _ if is_motion(path) => Dropped::Open(path.to_owned()),
        "jpg" | "jpeg" => unknown("silhouettes are PNGs; pictures belong to a take"),
        _ => unknown("expected a take, project, motion, calibration, silhouettes, pose or body"),
    }
}

fn ending(path: &Path) -> String {
    path.extension().map_or_else(String::new, |ending| ending.to_string_lossy().to_lowercase())
}

/// The first thousand things in a folder: more are not looked at.
fn entries(folder: &Path) -> impl Iterator<Item = PathBuf> {
    std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).take(1000)
}

/// The beginning of a file as text.
fn head(path: &Path) -> Option<String> {
    // A pipe would block at opening.
    if !path.is_file() {
        return None;
    }
    let mut bytes = Vec::new();
    std::fs::File::open(path).ok()?.take(HEAD).read_to_end(&mut bytes).ok()?;
    Some(String::from_utf8_lossy(&bytes).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_by_ending_and_content() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, content: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, content).unwrap();
            path
        };
        let take = write("take/take.toml", "format = \"backlit-take 1\"");
        let mask = write("masks/cam01.png", "");
        let of = |path: &PathBuf| Dropped::of(std::slice::from_ref(path));
        assert_eq!(of(&take), Dropped::Open(take.clone()));
        assert_eq!(of(&folder.path().join("take")), Dropped::Open(folder.path().join("take")));
        assert_eq!(of(&folder.path().join("masks")), Dropped::Masks(vec![folder.path().join("masks")]));
        assert_eq!(of(&mask), Dropped::Masks(vec![mask.clone()]));
        for (name, content, expected) in [
            ("a.toml", "format = \"backlit-body 1\"", "Give the body these sizes"),
            ("b.json", "{\"format\": \"backlit-pose 1\"}", "Give frame 3 this pose"),
            ("c.json", "{\"format\": \"backlit-cameras 1\"}", "Replace the take’s cameras with these"),
            ("d.json", "{\"cameras\": {}}", "Replace the take’s cameras with these"),
            ("e.qca.txt", "<calibration/>", "Replace the take’s cameras with these"),
            ("f.backlit", "{}", "Open this project"),
            ("g.txt", "hello", "This cannot be used here"),
            ("h.json", "{\"format\": \"backlit-track 1\"}", "This cannot be used here"),
            ("empty/readme", "", "This cannot be used here"),
        ] {
            assert_eq!(of(&write(name, content)).explanation(3).0, expected, "{name}");
        }
        assert_eq!(of(&folder.path().join("empty")).explanation(0).0, "This cannot be used here");
        assert!(matches!(of(&folder.path().join("none.json")), Dropped::Unknown(_, "it cannot be read")));
        assert!(!Dropped::Open(take).needs_take() && Dropped::Pose(mask).needs_take());
    }
}
