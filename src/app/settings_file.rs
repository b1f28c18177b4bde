//! The settings file: how the window is arranged, from start to start (`docs/formats.md`).
//!
//! It is read field by field: what is not understood, because it is damaged or of another version, is as it was at
//! first, and the rest stays.

use std::path::{Path, PathBuf};

use backlit_formats::{DiskFiles, FileError, MAX_TEXT_BYTES, TakeFiles, atomic};
use backlit_jobs::{Pool, Task, once};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::app::settings::Settings;
use crate::context::notices::Notices;
use crate::context::priority;
use crate::context::write_advice::write_advice;

/// Name and version of the settings file's format.
pub(crate) const FORMAT: &str = "backlit-settings 1";
/// Its name in the data folder.
const NAME: &str = "settings.json";

#[derive(Debug, Serialize)]
struct File<'a> {
    format: &'static str,
    #[serde(flatten)]
    look: &'a Settings,
}

/// The settings file of a data folder.
pub fn path_in(folder: &Path) -> PathBuf {
    folder.join(NAME)
}

/// Writes the settings to a folder, which is made if it is not there. The file appears whole or not at all.
///
/// # Errors
/// The file system says no.
pub fn write(folder: &Path, look: &Settings) -> Result<(), FileError> {
    // If it cannot be made, the file cannot be written, and that is said.
    let _ = std::fs::create_dir_all(folder);
    atomic::write_with(&path_in(folder), |out| {
        serde_json::to_writer_pretty(&mut *out, &File { format: FORMAT, look })?;
        out.write_all(b"\n")
    })
}

/// The settings of a folder, and a sentence about what of them could not be read. Without a file they are as at first.
pub fn read(folder: &Path) -> (Settings, Option<String>) {
    let path = path_in(folder);
    let text = match DiskFiles.read(&path, MAX_TEXT_BYTES) {
        Ok(text) => text,
        Err(error) if error.is_missing() => return (Settings::default(), None),
        Err(error) => {
            return (Settings::default(), Some(format!("{error}. The default settings are used.")));
        }
    };
    match serde_json::from_slice::<Map<String, Value>>(&text) {
        Ok(fields) => {
            let (look, unread) = read_fields(fields);
            let said =
                format!("{}: {} could not be read; the default is used.", path.display(), unread.join(", "));
            (look, (!unread.is_empty()).then_some(said))
        }
        Err(error) => {
            let said = format!("{}: {error}. The default settings are used.", path.display());
            (Settings::default(), Some(said))
        }
    }
}

/// The settings with all fields that can be read, and the names of the others.
fn read_fields(fields: Map<String, Value>) -> (Settings, Vec<String>) {
    let mut unread = Vec::new();
    let (mut look, mut known) = (Settings::default(), Map::new());
    for (name, value) in fields {
        if name == "format" {
            continue;
        }
        known.insert(name.clone(), value);
        match serde_json::from_value(Value::Object(known.clone())) {
            Ok(with) => look = with,
            Err(_) => {
                known.remove(&name);
                unread.push(format!("`{name}`"));
            }
        }
    }
    (look, unread)
}

/// Writes the settings file when the arrangement has changed; knows what is in it.
#[derive(Debug)]
pub(crate) struct SettingsWriter {
    /// `None` without a folder for it.
    folder: Option<PathBuf>,
    written: Settings,
    failed: bool,
    task: Task<(), Result<(), FileError>, { priority::SETTINGS }>,
}

impl SettingsWriter {
    /// They are in the file as they are.
    pub(crate) fn new(folder: Option<PathBuf>, settings: &Settings) -> Self {
        Self { folder, written: settings.clone(), failed: false, task: Task::default() }
    }

    /// Writes the settings, if they are others than in the file.
    pub(crate) fn write(&mut self, settings: Settings, pool: &Pool) {
        let Some(folder) = self.folder.clone() else { return };
        if self.failed || self.written != settings {
            self.written = settings.clone();
            self.task.begin(pool, (), |()| once(move |_| write(&folder, &settings)));
        }
    }

    /// Hears whether the settings were written. A failure is said once, until it works again.
    pub(crate) fn take_in(&mut self, notices: &mut Notices) {
        for written in notices.outputs("Keeping the settings", &mut self.task) {
            let had_failed = std::mem::replace(&mut self.failed, written.is_err());
            if let Err(why) = written
                && !had_failed
            {
                let advice = write_advice(&why);
                notices.error(format!(
                    "The window’s settings were not saved for the next start: {why}. {advice}"
                ));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::preferences::Layout;
    use backlit_ui::style::theme::Theme;

    fn look() -> Settings {
        let recent = vec![PathBuf::from("/takes/balancing")];
        Settings { theme: Theme::Light, layout: Layout::Debug, panel: false, recent, ..Settings::default() }
    }

    #[test]
    fn settings_are_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("not/there/yet");
        assert_eq!(read(&inner), (Settings::default(), None));
        write(&inner, &look()).unwrap();
        assert_eq!(read(&inner), (look(), None));
        let text = std::fs::read_to_string(path_in(&inner)).unwrap();
        assert!(text.contains(FORMAT), "{text}");
    }

    #[test]
    fn what_cannot_be_read_is_as_at_first_and_the_rest_stays() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &look()).unwrap();
        let path = path_in(folder.path());
        let good = std::fs::read_to_string(&path).unwrap();
        assert!(good.contains("\"debug\""));
        std::fs::write(&path, good.replace("\"debug\"", "\"upside-down\"").replace('{', "{\"new\": 1,"))
            .unwrap();
        let (read_back, said) = read(folder.path());
        assert_eq!(read_back.layout, Layout::Pose);
        assert_eq!((read_back.theme, read_back.recent), (Theme::Light, look().recent));
        let said = said.unwrap();
        assert!(said.contains("settings.json: ") && said.contains("`layout`"), "{said}");
        for broken in ["", "[]", &good[..good.len() / 2]] {
            std::fs::write(&path, broken).unwrap();
            let (read_back, said) = read(folder.path());
            assert_eq!(read_back, Settings::default());
            assert!(said.unwrap().contains("settings.json: "));
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_in_the_place_of_the_settings_is_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = path_in(folder.path());
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let (read_back, said) = read(folder.path());
        assert_eq!(read_back, Settings::default());
        assert!(said.unwrap().contains("settings.json: "));
    }

    #[test]
    fn settings_that_cannot_be_written_are_an_error_that_names_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        let message = write(&file, &look()).unwrap_err().to_string();
        assert!(message.contains("file/settings.json: cannot be written"), "{message}");
    }
}
