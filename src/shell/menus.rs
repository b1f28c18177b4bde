//! The menus: every command stands in one of them.

use backlit_take::demonstration::Demonstration;
use backlit_tracking::fit::Preset;
use backlit_tracking::render::RendererKind;
use backlit_ui::drawing::{ModeComparison, ViewMode};
use backlit_ui::style::theme::{size, space};
use backlit_ui::widgets::{checkbox, hint};
use egui::Ui;

use crate::context::command::{
    BodyPart, Command, ConvergenceCommand, ExportCommand, FileCommand, FitCommand, HistoryCommand,
    LaboratoryCommand, Menu, PoseCommand, TimelineCommand, ViewCommand, WindowCommand,
};
use crate::context::command_button::menu_row;
use crate::context::pane::Pane;
use crate::context::preferences::Layout;
use crate::context::{Context, PaneEvent, Requests, ShellRequest};

/// All menus in a row, or one menu of menus where there is little room.
pub(crate) fn ui(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, folded: bool) {
    if folded {
        ui.menu_button("Menu", |ui| {
            for menu in Menu::ALL {
                ui.menu_button(menu.text(), |ui| contents(ui, context, requests, menu));
            }
        });
    } else {
        for menu in Menu::ALL {
            ui.menu_button(menu.text(), |ui| contents(ui, context, requests, menu));
        }
    }
}

fn contents(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, menu: Menu) {
    ui.set_min_width(230.0);
    // A menu that is longer than the window scrolls.
    let most = ui.ctx().content_rect().height() - size::TOOLBAR - 2.0 * space::ROW;
    let area = egui::ScrollArea::vertical().max_height(most).auto_shrink(true);
    area.show(ui, |ui| rows(ui, context, requests, menu));
}

fn rows(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, menu: Menu) {
    let shown: Vec<Command> =
        Command::in_menu(menu).filter(|command| !is_hidden(*command, context)).collect();
    for commands in shown.chunk_by(|one, next| submenu(*one) == submenu(*next)) {
        if begins_group(commands[0]) {
            ui.separator();
        }
        match submenu(commands[0]) {
            Some(name) => {
                ui.menu_button(name, |ui| {
                    ui.set_min_width(230.0);
                    each(ui, context, requests, commands);
                });
            }
            None => each(ui, context, requests, commands),
        }
    }
}

/// The menu of a menu that a command stands in: what belongs together, so that a menu is no taller than a window.
fn submenu(command: Command) -> Option<&'static str> {
    match command {
        Command::View(ViewCommand::Mode(_) | ViewCommand::Compare(_)) => Some("View mode"),
        Command::View(ViewCommand::CameraAlone(_)) => Some("Camera alone"),
        Command::Window(WindowCommand::Enlarge | WindowCommand::Shrink | WindowCommand::NormalSize) => {
            Some("Size of letters")
        }
        Command::Fit(FitCommand::Refit(_)) => Some("Refit"),
        Command::Fit(FitCommand::RunAgain(_) | FitCommand::RunAgainWithCameras) => Some("Run again"),
        Command::Convergence(_) => Some("Curves"),
        Command::Observability(_) | Command::CameraPlan => Some("What cameras see"),
        Command::Silhouettes(_) => Some("Silhouettes"),
        Command::Offsets | Command::CameraCheck | Command::CameraRefinement => Some("Cameras"),
        Command::Compare(_) => Some("Compare"),
        Command::Basin(_) => Some("Basin"),
        Command::Beginning(_) => Some("Ways to begin"),
        Command::Timeline(
            TimelineCommand::PreviousFrame
            | TimelineCommand::NextFrame
            | TimelineCommand::TenFramesBack
            | TimelineCommand::TenFramesOn
            | TimelineCommand::FirstFrame
            | TimelineCommand::LastFrame
            | TimelineCommand::Play
            | TimelineCommand::ToggleLoop
            | TimelineCommand::Slower
            | TimelineCommand::Faster,
        ) => Some("Frames"),
        _ => None,
    }
}

fn each(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, commands: &[Command]) {
    for (index, &command) in commands.iter().enumerate() {
        if index > 0 && begins_group(command) {
            ui.separator();
        }
        let text = match command {
            Command::History(HistoryCommand::Undo) => with_object("Undo", context.history.undo_text()),
            Command::History(HistoryCommand::Redo) => with_object("Redo", context.history.redo_text()),
            _ => command.text().to_owned(),
        };
        menu_row(ui, context, requests, command, &text);
        if command == Command::Window(WindowCommand::RestoreLayout) {
            panes(ui, context, requests);
        }
        if command == Command::File(FileCommand::OpenProject) {
            recent(ui, context, requests);
        }
    }
}

fn with_object(verb: &str, object: Option<&str>) -> String {
    object.map_or_else(|| verb.to_owned(), |object| format!("{verb}: {object}"))
}

/// Cameras that the take does not have, what only keys are good for, and what stands in the scene's own menu.
fn is_hidden(command: Command, context: &Context<'_>) -> bool {
    match command {
        Command::Scene(_) | Command::Pose(PoseCommand::Nudge(_)) => true,
        Command::Demonstration(which) => !which.is_available(),
        Command::View(ViewCommand::CameraAlone(camera)) => camera >= context.session.camera_count(),
        _ => false,
    }
}

fn begins_group(command: Command) -> bool {
    use {FileCommand as F, FitCommand as Fit, PoseCommand as P, TimelineCommand as T, ViewCommand as V};
    matches!(
        command,
        Command::File(F::OpenProject | F::Save | F::Quit)
            | Command::Export(ExportCommand::View)
            | Command::Pose(P::Copy | P::Mirror | P::NextJoint)
            | Command::Window(
                WindowCommand::ToggleTheme
                    | WindowCommand::TogglePane(Pane::Scene)
                    | WindowCommand::Enlarge
                    | WindowCommand::Messages
            )
            | Command::View(V::FitSubject | V::LinkZoom | V::Mode(ViewMode::Footage))
            | Command::View(V::Compare(ModeComparison::Wipe) | V::CameraAlone(0))
            | Command::Fit(Fit::EarlierStep | Fit::Refit(BodyPart::Limb) | Fit::SearchPoses)
            | Command::Fit(Fit::Renderer(RendererKind::Capsule) | Fit::Preset(Preset::Report))
            | Command::Convergence(ConvergenceCommand::ClearRuns)
            | Command::Timeline(T::SetKeyPose | T::PreviousFrame | T::Play | T::WholeTake)
            | Command::Demonstration(
                Demonstration::OneCamera
                    | Demonstration::Sequence
                    | Demonstration::Bias
                    | Demonstration::Motions
            )
            | Command::Laboratory(LaboratoryCommand::Restart)
    )
}

/// All panes of the centre, ticked while they are open.
fn panes(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
    let cameras = context.session.camera_count();
    if cameras == 0 || context.preferences.layout == Layout::Demonstrate {
        return;
    }
    ui.menu_button("Tiles", |ui| {
        ui.set_min_width(160.0);
        for pane in Pane::all(cameras) {
            let mut is_open = context.preferences.is_open(pane, cameras);
            if checkbox(ui, &mut is_open, &pane.title()).on_hover_text(pane.explanation()).changed() {
                let event = if is_open { PaneEvent::Open } else { PaneEvent::Close };
                requests.request(ShellRequest::Pane(pane, event));
            }
        }
    });
}

fn recent(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
    if context.preferences.recent.is_empty() {
        return;
    }
    ui.separator();
    hint(ui, "Recent takes and projects");
    if super::recent::rows(ui, context, requests, true) {
        ui.close();
    }
}
