//! The menus: every command stands in one of them.

use egui::Ui;

use crate::app::nudge_of;
use crate::context::action::{Action, Menu};
use crate::context::command_button::menu_row;
use crate::context::pane::Pane;
use crate::context::preferences::Layout;
use crate::context::{Context, PaneEvent, Request, Requests};
use crate::style::theme;
use crate::widgets::checkbox;

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
    for action in Action::in_menu(menu) {
        if is_hidden(action, context) {
            continue;
        }
        if begins_group(action) {
            ui.separator();
        }
        let text = match action {
            Action::Undo => with_object("Undo", context.history.undo_text()),
            Action::Redo => with_object("Redo", context.history.redo_text()),
            _ => action.text().to_owned(),
        };
        menu_row(ui, context, requests, action, &text);
        if action == Action::RestoreLayout {
            panes(ui, context, requests);
        }
        if action == Action::OpenProject {
            recent(ui, context, requests);
        }
    }
}

fn with_object(verb: &str, object: Option<&str>) -> String {
    object.map_or_else(|| verb.to_owned(), |object| format!("{verb}: {object}"))
}

/// Cameras that the take does not have, what only keys are good for, and what stands in the scene's own menu.
fn is_hidden(action: Action, context: &Context<'_>) -> bool {
    use Action as A;
    let is_of_scene =
        matches!(action, A::SceneFront | A::SceneSide | A::SceneTop | A::SceneFromCamera | A::SceneReset);
    if is_of_scene || nudge_of(action).is_some() {
        return true;
    }
    let count = context.session.camera_count();
    (count..8).any(|index| Action::camera_alone(index) == Some(action))
}

const fn begins_group(action: Action) -> bool {
    use Action as A;
    matches!(
        action,
        A::OpenProject
            | A::Save
            | A::ExportView
            | A::Quit
            | A::CopyPose
            | A::Mirror
            | A::NextJoint
            | A::ToggleTheme
            | A::ShowScene
            | A::FitSubject
            | A::LinkZoom
            | A::ViewFootage
            | A::Wipe
            | A::Camera1
            | A::EarlierStep
            | A::RefitLimb
            | A::RendererCapsule
            | A::PresetReport
            | A::ClearRuns
            | A::SetKeyPose
            | A::PreviousFrame
            | A::Play
            | A::WholeTake
            | A::SearchPoses
            | A::ShowOneCamera
            | A::ShowSequence
            | A::ShowBias
            | A::RestartLaboratory
            | A::Messages
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
                requests.request(Request::Pane(pane, event));
            }
        }
    });
}

fn recent(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
    if !super::recent::has_any(context) {
        return;
    }
    ui.separator();
    ui.label(egui::RichText::new("Recent takes and projects").small().color(theme::palette(ui).text3));
    if super::recent::rows(ui, context, requests, true) {
        ui.close();
    }
}
