//! A virtual screen and a home folder of its own.

use std::cell::Cell;
use std::fs;
use std::io::{BufRead, BufReader};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::TempDir;

/// Programs without which there is nothing to drive.
const PROGRAMS: [&str; 3] = ["Xvfb", "xdotool", "import"];

/// One screen at a time: frames drawn without a GPU are slow enough alone.
static TURN: Mutex<()> = Mutex::new(());

/// A screen that nobody sees.
pub(crate) struct Desk {
    _turn: MutexGuard<'static, ()>,
    server: Child,
    display: String,
    home: TempDir,
    windows: Cell<usize>,
}

impl Desk {
    /// Starts a screen; `None`, and a word about why, where the programs for that are not installed.
    pub(crate) fn new() -> Option<Self> {
        let paths: Vec<PathBuf> =
            std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()).collect();
        for program in PROGRAMS {
            if !paths.iter().any(|path| path.join(program).is_file()) {
                println!("skipped: {program} is not installed");
                return None;
            }
        }
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let home = TempDir::new().unwrap();
        for folder in ["run", "data", "config", "bin"] {
            fs::create_dir(home.path().join(folder)).unwrap();
        }
        fs::set_permissions(home.path().join("run"), fs::Permissions::from_mode(0o700)).unwrap();
        // The server chooses a number that is free and writes it.
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1600x1000x24", "-nolisten", "tcp", "-noreset"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        assert!(!number.trim().is_empty(), "the virtual screen does not start");
        Some(Self {
            _turn: turn,
            server,
            display: format!(":{}", number.trim()),
            home,
            windows: Cell::new(0),
        })
    }

    pub(crate) fn home(&self) -> &Path {
        self.home.path()
    }

    /// A number for a window that no other of this screen has.
    pub(crate) fn next_window(&self) -> usize {
        self.windows.update(|number| number + 1);
        self.windows.get()
    }

    /// A command that sees this screen and this home only.
    pub(crate) fn command(&self, program: impl AsRef<std::ffi::OsStr>) -> Command {
        let home = self.home();
        let path = std::env::var("PATH").unwrap_or_default();
        let mut command = Command::new(program);
        command
            .env("DISPLAY", &self.display)
            .env("LIBGL_ALWAYS_SOFTWARE", "1")
            .env("PATH", format!("{}:{path}", home.join("bin").display()))
            .env("HOME", home)
            .env("XDG_DATA_HOME", home.join("data"))
            .env("XDG_CONFIG_HOME", home.join("config"))
            .env("XDG_RUNTIME_DIR", home.join("run"))
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET")
            .env_remove("DBUS_SESSION_BUS_ADDRESS");
        command
    }

    /// The program with these arguments.
    pub(crate) fn program(&self, arguments: &[&str]) -> Command {
        let given = std::env::var_os("BACKLIT_BIN").map(PathBuf::from);
        let mut command = self.command(given.unwrap_or_else(|| env!("CARGO_BIN_EXE_backlit").into()));
        command.args(arguments);
        command
    }

    /// Every file dialog is answered with this path: where no portal runs, `zenity` asks.
    pub(crate) fn answer_dialogs_with(&self, path: &Path) {
        let zenity = self.home().join("bin/zenity");
        fs::write(&zenity, format!("#!/bin/sh\necho '{}'\n", path.display())).unwrap();
        fs::set_permissions(&zenity, fs::Permissions::from_mode(0o755)).unwrap();
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}
