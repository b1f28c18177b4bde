//! The whole window, driven by label and role.

use std::path::Path;
use std::time::{Duration, Instant};

use backlit::app::settings::Settings;
use backlit::app::{App, AppOptions, Inspector};
use backlit::features::convergence::CurvesFile;
use backlit::session::Session;
use backlit::session::selection::Selection;
use backlit_document::Document;
use backlit_document::run::Run;
use backlit_tracking::processor::use_narrow_vectors;
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

/// Nothing of the tiny take may take longer.
pub(crate) const PATIENCE: Duration = Duration::from_secs(120);

/// What has come to rest so often is at rest; what plays never is.
const ROUNDS: usize = 2;

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
}

impl WindowState for Harness<'_, App> {
    fn inspector(&self) -> &Inspector {
        &self.state().inspector
    }
}

/// A window of `size` points, when nothing is being worked on any more.
pub(crate) fn open_sized(options: AppOptions, size: Vec2) -> Harness<'static, App> {
    use_narrow_vectors();
    let theme = options.settings.theme;
    let options = AppOptions { is_inline: true, ..options };
    let app = App::new(egui::Context::default(), options).unwrap();
    let builder = crate::support::harness_builder(size, theme);
    let mut harness = builder.build_ui_state(|ui, app: &mut App| app.frame(ui), app);
    settle(&mut harness);
    harness
}

/// Runs frames until the worker has nothing to do and the screen shows it.
pub(crate) fn settle(harness: &mut Harness<'_, App>) {
    let start = Instant::now();
    harness.run_steps(2);
    // Sizes settle over two frames, and may ask for more.
    for _ in 0..ROUNDS {
        while !harness.state().inspector.is_idle() {
            assert!(start.elapsed() < PATIENCE, "the worker hangs");
            harness.step();
        }
        harness.run_steps(2);
    }
}

pub(crate) fn click(harness: &mut Harness<'_, App>, label: &str) {
    harness.get_by_role_and_label(Role::Button, label).click();
    settle(harness);
}

pub(crate) fn press(harness: &mut Harness<'_, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    settle(harness);
}

/// Finds a command in the palette and does it.
pub(crate) fn command(harness: &mut Harness<'_, App>, name: &str) {
    type_into_palette(harness, name);
    press(harness, Modifiers::NONE, Key::Enter);
}

/// Types into the palette, which stays open.
pub(crate) fn type_into_palette(harness: &mut Harness<'_, App>, text: &str) {
    press(harness, Modifiers::COMMAND, Key::K);
    harness.get_by_role(Role::TextInput).type_text(text);
    settle(harness);
}

pub(crate) fn pointer(at: Pos2, pressed: bool) -> Event {
    Event::PointerButton { pos: at, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
}

/// Drags a joint's handle in a camera's view by some points, in a few moves, and lets go.
pub(crate) fn drag(harness: &mut Harness<'_, App>, handle: &str, by: Vec2) {
    let from = harness.get_by_label(handle).rect().center();
    harness.event(Event::PointerMoved(from));
    harness.event(pointer(from, true));
    harness.step();
    for share in [0.2, 0.5, 0.8, 1.0] {
        harness.event(Event::PointerMoved(from + share * by));
        harness.step();
    }
    harness.event(pointer(from + by, false));
    settle(harness);
}

/// Writes the runs to a file, as the dialog of the desktop would ask for.
pub(crate) fn write_curves(app: &mut App, file: CurvesFile, path: &Path) {
    app.inspector
        .ask(|features, context, requests| features.convergence.write(file, path, context, requests));
}
