//! The whole window, driven by label and role.

use std::path::Path;
use std::time::{Duration, Instant};

use backlit::app::settings::Settings;
use backlit::app::{App, AppOptions, Inspector, Opening};
use backlit::context::preferences::Layout;
use backlit::features::convergence::CurvesFile;
use backlit::session::Session;
use backlit::session::selection::Selection;
use backlit_document::Document;
use backlit_document::run::Run;
use backlit_formats::Take;
use backlit_take::demonstration::Demonstration;
use backlit_take::source::TakeSource;
use backlit_tracking::processor::use_narrow_vectors;
use backlit_ui::style::theme::Theme;
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, MouseWheelUnit, PointerButton, Pos2, Rect, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

use super::take;

/// The program's window.
pub(crate) type Window = Harness<'static, App>;

/// Nothing of the tiny take may take longer.
pub(crate) const PATIENCE: Duration = Duration::from_secs(120);

/// What has come to rest so often is at rest; what plays never is.
const ROUNDS: usize = 2;

/// A window that is about to open, of 1500 × 900 points unless told otherwise.
pub(crate) struct Setup {
    options: AppOptions,
    size: Vec2,
}

/// A window on nothing.
pub(crate) fn empty() -> Setup {
    Setup { options: AppOptions::default(), size: vec2(1500.0, 900.0) }
}

/// A window that opens something.
pub(crate) fn opening(opening: Opening) -> Setup {
    empty().with(|options| options.opening = Some(opening))
}

/// A window on a take in memory.
pub(crate) fn of_take(take: Take) -> Setup {
    opening(Opening::Ready(Box::new(take)))
}

/// A window on the tiny take.
pub(crate) fn arm() -> Setup {
    of_take(take::take())
}

/// A window on a take's folder or a project.
pub(crate) fn at(path: &Path) -> Setup {
    opening(Opening::of(path))
}

/// A window on the take that comes with the program.
pub(crate) fn built_in() -> Setup {
    opening(Opening::Take(TakeSource::BuiltIn))
}

/// A window on a demonstration.
pub(crate) fn demonstration(which: Demonstration) -> Setup {
    opening(Opening::Take(TakeSource::Demonstration(which)))
}

impl Setup {
    pub(crate) fn with(mut self, change: impl FnOnce(&mut AppOptions)) -> Self {
        change(&mut self.options);
        self
    }

    pub(crate) fn sized(self, width: f32, height: f32) -> Self {
        Self { size: vec2(width, height), ..self }
    }

    pub(crate) fn settings(self, settings: Settings) -> Self {
        self.with(|options| options.settings = settings)
    }

    pub(crate) fn theme(self, theme: Theme) -> Self {
        self.with(|options| options.settings.theme = theme)
    }

    pub(crate) fn layout(self, layout: Layout) -> Self {
        self.with(|options| options.settings.layout = layout)
    }

    /// Where settings and copies of unsaved work are kept.
    pub(crate) fn data_in(self, folder: &Path) -> Self {
        self.with(|options| options.data_folder = Some(folder.to_owned()))
    }

    /// The window, when nothing is being worked on any more.
    pub(crate) fn open(self) -> Window {
        use_narrow_vectors();
        let theme = self.options.settings.theme;
        let options = AppOptions { is_inline: true, ..self.options };
        let app = App::new(egui::Context::default(), options).unwrap();
        let builder = crate::support::harness_builder(self.size, theme);
        let mut window = builder.build_ui_state(|ui, app: &mut App| app.frame(ui), app);
        settle(&mut window);
        window
    }
}

/// What is read of a window.
pub(crate) trait WindowState {
    fn inspector(&self) -> &Inspector;

    fn document(&self) -> &Document {
        self.inspector().document()
    }

    fn runs(&self) -> &[Run] {
        self.inspector().runs()
    }

    fn settings(&self) -> Settings {
        self.inspector().settings()
    }

    fn selection(&self) -> Selection {
        self.inspector().state.selection
    }

    fn session(&self) -> &Session {
        &self.inspector().state.session
    }

    /// All that was said so far.
    fn said(&self) -> Vec<String> {
        self.inspector().state.notices.all().iter().map(|notice| notice.text.clone()).collect()
    }

    fn last_said(&self) -> String {
        self.said().pop().unwrap_or_default()
    }
}

impl WindowState for Window {
    fn inspector(&self) -> &Inspector {
        &self.state().inspector
    }
}

/// Runs frames until the worker has nothing to do and the screen shows it.
pub(crate) fn settle(window: &mut Window) {
    let start = Instant::now();
    window.run_steps(2);
    // Sizes settle over two frames, and may ask for more.
    for _ in 0..ROUNDS {
        while !window.state().inspector.is_idle() {
            assert!(start.elapsed() < PATIENCE, "the worker hangs");
            window.step();
        }
        window.run_steps(2);
    }
}

/// Runs frames until something is true.
pub(crate) fn wait_until(window: &mut Window, what: &str, is_true: impl Fn(&Window) -> bool) {
    let start = Instant::now();
    while !is_true(window) {
        assert!(start.elapsed() < PATIENCE, "never: {what}");
        window.step();
    }
}

/// Clicks a button.
pub(crate) fn click(window: &mut Window, label: &str) {
    choose(window, Role::Button, label);
}

/// Clicks what has a role and a name.
pub(crate) fn choose(window: &mut Window, role: Role, label: &str) {
    window.get_by_role_and_label(role, label).click();
    settle(window);
}

pub(crate) fn press(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    settle(window);
}

pub(crate) fn undo(window: &mut Window) {
    press(window, Modifiers::COMMAND, Key::Z);
}

/// Saves the project to a file.
pub(crate) fn save(window: &mut Window, path: &Path) {
    window.state_mut().save_to(path);
    settle(window);
}

/// Closes all notices.
pub(crate) fn close_notices(window: &mut Window) {
    window.state_mut().inspector.state.notices.close_all();
    settle(window);
}

/// Opens a menu; a narrow window has one button for all of them.
pub(crate) fn open_menu(window: &mut Window, menu: &str) {
    if window.query_by_role_and_label(Role::Button, menu).is_none() {
        window.get_by_role_and_label(Role::Button, "Menu").click();
        window.run_steps(3);
    }
    window.get_all_by_role_and_label(Role::Button, menu).next().unwrap().click();
    window.run_steps(3);
}

/// Finds a command in the palette and does it.
pub(crate) fn command(window: &mut Window, name: &str) {
    type_into_palette(window, name);
    press(window, Modifiers::NONE, Key::Enter);
}

/// Types into the palette, which stays open.
pub(crate) fn type_into_palette(window: &mut Window, text: &str) {
    press(window, Modifiers::COMMAND, Key::K);
    window.get_by_role(Role::TextInput).type_text(text);
    settle(window);
}

/// Replaces what stands in a field, and does not leave it.
pub(crate) fn type_over(window: &mut Window, field: &str, text: &str) {
    window.get_by_role_and_label(Role::TextInput, field).focus();
    window.run_steps(2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.run_steps(2);
    window.event(Event::Text(text.to_owned()));
    window.run_steps(2);
}

/// Says why a button cannot be used, by its tooltip.
pub(crate) fn refuses(window: &mut Window, label: &str, why: &str) {
    let node = window.get_by_role_and_label(Role::Button, label);
    assert!(node.accesskit_node().is_disabled(), "{label} can be used");
    node.hover();
    window.run_steps(6);
    window.get_by_label_contains(why);
    window.remove_cursor();
    window.run_steps(2);
}

/// The middle of what has a name.
pub(crate) fn centre(window: &Window, label: &str) -> Pos2 {
    window.get_by_label(label).rect().center()
}

pub(crate) fn button(pos: Pos2, button: PointerButton, pressed: bool) -> Event {
    Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE }
}

pub(crate) fn pointer(at: Pos2, pressed: bool) -> Event {
    button(at, PointerButton::Primary, pressed)
}

/// Presses on something and moves by these points, one frame each; the button stays down.
pub(crate) fn grab(window: &mut Window, from: Pos2, way: &[Vec2]) {
    window.event(Event::PointerMoved(from));
    window.step();
    window.event(pointer(from, true));
    window.step();
    for by in way {
        window.event(Event::PointerMoved(from + *by));
        window.step();
    }
}

pub(crate) fn release(window: &mut Window, at: Pos2) {
    window.event(pointer(at, false));
    settle(window);
}

/// Clicks a place.
pub(crate) fn point(window: &mut Window, at: Pos2) {
    window.event(Event::PointerMoved(at));
    window.event(pointer(at, true));
    window.step();
    release(window, at);
}

/// Drags a joint's handle in a camera's view by some points, in a few moves, and lets go.
pub(crate) fn drag(window: &mut Window, handle: &str, by: Vec2) {
    let from = centre(window, handle);
    window.event(Event::PointerMoved(from));
    window.event(pointer(from, true));
    window.step();
    for share in [0.2, 0.5, 0.8, 1.0] {
        window.event(Event::PointerMoved(from + share * by));
        window.step();
    }
    release(window, from + by);
}

/// A turn of the wheel.
pub(crate) fn wheel(delta: Vec2) -> Event {
    let (unit, phase) = (MouseWheelUnit::Point, egui::TouchPhase::Move);
    Event::MouseWheel {
        unit,
        delta,
        phase,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    }
}

/// What has changed, without times: for pictures.
pub(crate) fn freeze(window: &mut Window) {
    for _ in 0..3 {
        window.state_mut().inspector.freeze_times();
        window.step();
    }
}

/// Writes the runs to a file, as the dialog of the desktop would ask for.
pub(crate) fn write_curves(app: &mut App, file: CurvesFile, path: &Path) {
    app.inspector
        .ask(|features, context, requests| features.convergence.write(file, path, context, requests));
}

/// What lies around something that has a name.
pub(crate) fn around(window: &Window, label: &str, margin: Vec2) -> Rect {
    window.get_by_label(label).rect().expand2(margin).round()
}
