//! The program's window: mouse and keyboard go in by `xdotool`, what became of it comes out of the exported state.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::desk::Desk;

/// Longer than anything takes, with software GL on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);
/// Between two looks.
const GLANCE: Duration = Duration::from_millis(40);

/// A running program and its window.
pub(crate) struct Window<'a> {
    desk: &'a Desk,
    process: Child,
    id: String,
    state: PathBuf,
    stderr: PathBuf,
    pointer: [i32; 2],
}

impl<'a> Window<'a> {
    /// Starts the program and waits for its window and its first state.
    pub(crate) fn open(desk: &'a Desk, arguments: &[&str]) -> Self {
        let number = desk.next_window();
        let file = |kind: &str| desk.home().join(format!("window-{number}.{kind}"));
        let (state, stderr) = (file("json"), file("stderr"));
        let mut command = desk.program(&["--state", state.to_str().unwrap()]);
        command.args(arguments).stdout(Stdio::null()).stderr(fs::File::create(&stderr).unwrap());
        let process = command.spawn().unwrap();
        let mut window = Self { desk, process, id: String::new(), state, stderr, pointer: [1, 1] };
        let pid = window.process.id().to_string();
        let missing = |_: &Self| "no window".to_owned();
        window.id = window.wait(GLANCE, missing, |window| {
            let search = ["search", "--onlyvisible", "--pid", &pid];
            let found = window.desk.command("xdotool").args(search).output().unwrap().stdout;
            let id = String::from_utf8_lossy(&found).lines().next()?.to_owned();
            window.state.is_file().then_some(id)
        });
        window.xdotool(&["mousemove", "1", "1"]);
        window.focus();
        window
    }

    /// Starts the program with the built-in take.
    pub(crate) fn of_built_in_take(desk: &'a Desk) -> Self {
        let mut window = Self::open(desk, &[]);
        window.until_still("the built-in take is there", |_| true);
        window.dismiss("Not now");
        window
    }

    /// Brings it before other windows; keys go to it from now on.
    pub(crate) fn focus(&self) {
        self.xdotool(&["windowraise", &self.id, "windowfocus", "--sync", &self.id]);
        sleep(4 * GLANCE);
    }

    fn complaints(&self) -> String {
        fs::read_to_string(&self.stderr).unwrap_or_default()
    }

    fn must_live(&mut self) {
        if let Some(status) = self.process.try_wait().unwrap() {
            panic!("the program ended with {status}: {}", self.complaints());
        }
    }

    /// Looks until there is something, with pauses.
    fn wait<T>(
        &mut self,
        pause: Duration,
        missing: impl Fn(&Self) -> String,
        mut look: impl FnMut(&mut Self) -> Option<T>,
    ) -> T {
        let began = Instant::now();
        loop {
            if let Some(found) = look(self) {
                return found;
            }
            self.must_live();
            assert!(began.elapsed() < PATIENCE, "{}: {}", missing(self), self.complaints());
            sleep(pause);
        }
    }

    fn xdotool(&self, arguments: &[&str]) {
        let status = self.desk.command("xdotool").args(arguments).status().unwrap();
        assert!(status.success(), "xdotool {arguments:?}");
    }

    fn exported(&self) -> Value {
        serde_json::from_str(&fs::read_to_string(&self.state).unwrap()).unwrap()
    }

    /// What matters of the window, as it is.
    pub(crate) fn state(&self) -> Value {
        self.exported()["state"].clone()
    }

    /// Waits until the state is as it should be, and returns it.
    pub(crate) fn until(&mut self, what: &str, is_so: impl Fn(&Value) -> bool) -> Value {
        let missing = |window: &Self| {
            let mut short = window.state();
            short["pose"] = Value::Null;
            format!("not so: {what}\n{short:#}\n")
        };
        let state = self.wait(GLANCE, missing, |window| Some(window.state()).filter(&is_so));
        println!("ok: {what}");
        state
    }

    /// The same, and waits until the take is there and nothing is being computed.
    pub(crate) fn until_still(&mut self, what: &str, is_so: impl Fn(&Value) -> bool) -> Value {
        self.until(what, |state| is_so(state) && state["take"]["loaded"] == true && state["idle"] == true)
    }

    /// Presses keys, and waits until the state is as it should be.
    pub(crate) fn key_until(&mut self, keys: &str, what: &str, is_so: impl Fn(&Value) -> bool) -> Value {
        self.key(keys);
        self.until(what, is_so)
    }

    /// Presses keys, and waits as [`until_still`](Self::until_still) does.
    pub(crate) fn key_until_still(
        &mut self,
        keys: &str,
        what: &str,
        is_so: impl Fn(&Value) -> bool,
    ) -> Value {
        self.key(keys);
        self.until_still(what, is_so)
    }

    /// Gives a command by its name in the palette.
    pub(crate) fn command(&mut self, name: &str) {
        self.key_until("ctrl+k", "the palette is there", |state| state["over"] == "palette");
        self.type_text(name);
        self.key("Return");
    }

    /// Presses keys, as `xdotool` names them.
    pub(crate) fn key(&self, keys: &str) {
        self.xdotool(&["key", keys]);
    }

    pub(crate) fn type_text(&self, text: &str) {
        self.xdotool(&["type", "--delay", "20", text]);
    }

    pub(crate) fn resize(&self, width: u32, height: u32) {
        self.xdotool(&["windowsize", "--sync", &self.id, &width.to_string(), &height.to_string()]);
    }

    /// The middle of the first widget of this name.
    fn place(&self, name: &str) -> Option<[i32; 2]> {
        let exported = self.exported();
        let scale = exported["pixels_per_point"].as_f64().unwrap();
        let widget = exported["widgets"].as_array()?.iter().find(|widget| widget["name"] == name)?;
        let rect: Vec<f64> = widget["rect"].as_array()?.iter().filter_map(Value::as_f64).collect();
        let middle = |from: f64, size: f64| (scale * (from + 0.5 * size)).round() as i32;
        Some([middle(rect[0], rect[2]), middle(rect[1], rect[3])])
    }

    /// The place of a widget once it is there and stays there.
    fn waited_for(&mut self, name: &str) -> [i32; 2] {
        let mut before = None;
        let missing = |_: &Self| format!("there is no {name}");
        self.wait(4 * GLANCE, missing, |window| {
            let place = window.place(name);
            let last = std::mem::replace(&mut before, place);
            place.filter(|_| place == last)
        })
    }

    /// Waits until no widget has this name.
    pub(crate) fn until_gone(&mut self, name: &str) {
        let missing = |_: &Self| format!("{name} is still there");
        self.wait(GLANCE, missing, |window| window.place(name).is_none().then_some(()));
        println!("ok: {name} is gone");
    }

    /// Moves the pointer, and waits until the window has seen it there: what is under it is judged once a frame.
    fn point_at(&mut self, place: [i32; 2]) {
        self.pointer = place;
        let [x, y] = place.map(|number| number.to_string());
        let id = self.id.clone();
        self.xdotool(&["mousemove", "--window", &id, &x, &y]);
        self.until_pointer("is there", |pointer, scale| {
            let at = |axis: usize| scale * pointer["at"][axis].as_f64().unwrap_or(f64::NAN);
            (0..2).all(|axis| (at(axis) - f64::from(place[axis])).abs() < 1.5)
        });
    }

    /// Presses or lets go the mouse button, and waits until the window has seen it.
    fn button(&mut self, is_down: bool) {
        self.xdotool(&[if is_down { "mousedown" } else { "mouseup" }, "1"]);
        self.until_pointer("is pressed or let go", |pointer, _| pointer["is_down"] == is_down);
    }

    fn until_pointer(&mut self, what: &str, is_so: impl Fn(&Value, f64) -> bool) {
        let missing = |window: &Self| {
            let found = &window.exported()["pointer"];
            format!("the pointer, sent to {:?}: not so that it {what}: {found}", window.pointer)
        };
        self.wait(GLANCE / 4, missing, |window| {
            let exported = window.exported();
            let scale = exported["pixels_per_point"].as_f64().unwrap();
            is_so(&exported["pointer"], scale).then_some(())
        });
    }

    /// Points at the first widget of this name. A frame has been drawn by then; where that has moved the widget, it is followed.
    fn reach(&mut self, name: &str) -> [i32; 2] {
        let began = Instant::now();
        loop {
            let place = self.waited_for(name);
            self.point_at(place);
            if self.place(name) == Some(place) {
                return place;
            }
            assert!(began.elapsed() < PATIENCE, "{name} does not stay where it is");
        }
    }

    /// Clicks the first widget of this name.
    pub(crate) fn click(&mut self, name: &str) {
        let place = self.reach(name);
        self.button(true);
        self.button(false);
        self.point_at([place[0], 2]);
    }

    /// Clicks a widget if there is one.
    pub(crate) fn dismiss(&mut self, name: &str) {
        if self.place(name).is_some() {
            self.click(name);
        }
    }

    /// Presses the mouse button on a widget and holds it.
    pub(crate) fn press_at(&mut self, name: &str) {
        self.reach(name);
        self.button(true);
    }

    pub(crate) fn move_by(&mut self, x: i32, y: i32) {
        let [left, top] = self.pointer;
        self.point_at([left + x, top + y]);
    }

    pub(crate) fn release(&mut self) {
        self.button(false);
    }

    /// Keeps a picture of the screen, where pictures are wanted.
    pub(crate) fn picture(&self, name: &str) {
        if let Some(folder) = std::env::var_os("BACKLIT_SHOTS").map(PathBuf::from) {
            self.picture_in(&folder, name);
        }
    }

    /// Keeps a picture of the window in a folder.
    pub(crate) fn picture_in(&self, folder: &Path, name: &str) {
        fs::create_dir_all(folder).unwrap();
        // What the state says is on the screen one frame later.
        sleep(10 * GLANCE);
        let file = folder.join(format!("{name}.png"));
        let status = self.desk.command("import").args(["-window", &self.id]).arg(&file).status().unwrap();
        assert!(status.success(), "no picture {}", file.display());
    }

    /// Closes the window by its own command; nothing may have been complained about.
    pub(crate) fn quit(mut self) {
        self.key("ctrl+q");
        let began = Instant::now();
        let status = loop {
            if let Some(status) = self.process.try_wait().unwrap() {
                break status;
            }
            assert!(began.elapsed() < PATIENCE, "Ctrl+Q does not close the window");
            sleep(GLANCE);
        };
        assert!(status.success(), "the program ended with {status}: {}", self.complaints());
        assert_eq!(self.complaints(), "", "the program complained");
        println!("ok: closed, nothing was complained about");
    }

    /// As a crash or a lost battery would.
    pub(crate) fn kill(mut self) {
        self.process.kill().unwrap();
        self.process.wait().unwrap();
        self.xdotool(&["mouseup", "1"]);
    }
}

impl Drop for Window<'_> {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
