//! Dialogs of the desktop's that ask for a file or a folder.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum DialogKind {
    /// A folder that is there.
    Folder,
    /// A file that is there, of these endings where any are named.
    File(&'static [&'static str]),
    /// A file to be written: its suggested name, and the endings that are offered.
    NewFile(String, &'static [&'static str]),
}

/// The dialogs of a feature. `Purpose` says what for; it comes back with the answer.
#[derive(Debug)]
pub(crate) struct FileDialogs<Purpose> {
    sender: Sender<(Purpose, PathBuf)>,
    answers: Receiver<(Purpose, PathBuf)>,
}

impl<Purpose> Default for FileDialogs<Purpose> {
    fn default() -> Self {
        let (sender, answers) = channel();
        Self { sender, answers }
    }
}

impl<Purpose: Send + 'static> FileDialogs<Purpose> {
    /// Asks, on a thread that lives as long as the dialog; complains if the system gives none.
    pub(crate) fn ask(
        &self,
        egui: &egui::Context,
        purpose: Purpose,
        (title, kind): (&'static str, DialogKind),
        complain: impl FnOnce(String),
    ) {
        let (sender, egui) = (self.sender.clone(), egui.clone());
        let thread = std::thread::Builder::new().name("backlit file dialog".to_owned()).spawn(move || {
            if let Some(path) = show(title, &kind) {
                // The window may be gone by now.
                let _ = sender.send((purpose, path));
                egui.request_repaint();
            }
        });
        if let Err(why) = thread {
            complain(format!("No file dialog can be shown: {why}. Drop the file on the window instead."));
        }
    }

    /// The answers since the last call.
    pub(crate) fn answers(&self) -> Vec<(Purpose, PathBuf)> {
        self.answers.try_iter().collect()
    }
}

fn show(title: &str, kind: &DialogKind) -> Option<PathBuf> {
    let dialog = rfd::FileDialog::new().set_title(title);
    let with = |dialog: rfd::FileDialog, endings: &[&str]| match endings {
        [] => dialog,
        [ending] if *ending == "backlit" => dialog.add_filter("Backlit", endings),
        [first, ..] => dialog.add_filter(first.to_uppercase(), endings),
    };
    match kind {
        DialogKind::Folder => dialog.pick_folder(),
        DialogKind::File(endings) => with(dialog, endings).pick_file(),
        DialogKind::NewFile(name, endings) => with(dialog, endings).set_file_name(name).save_file(),
    }
}
