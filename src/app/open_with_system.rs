//! Showing something in another program: a folder in the desktop's, a page in the browser.

use std::process::{Command, Stdio};

use super::App;

/// The program that opens anything with the program that the user likes for it.
const OPENER: &str = if cfg!(target_os = "macos") {
    "open"
} else if cfg!(target_os = "windows") {
    "explorer"
} else {
    "xdg-open"
};

impl App {
    /// Opens a folder or a page outside; where that cannot be done, the address goes to the clipboard.
    pub(crate) fn open_outside(&mut self, address: String) {
        let child = Command::new(OPENER)
            .arg(&address)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn();
        match child {
            Ok(mut child) => {
                // Somebody has to hear that it has ended.
                let waits = std::thread::Builder::new().name("backlit opener".to_owned());
                let _ = waits.spawn(move || child.wait());
            }
            Err(_) => {
                self.inspector.state.egui.copy_text(address.clone());
                let text = format!("{OPENER} cannot be started; {address} is in the clipboard now.");
                self.inspector.state.notices.info(self.inspector.state.now, text, None);
            }
        }
    }
}
