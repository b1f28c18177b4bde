//! The menus: every command stands in one of them.

use egui::Ui;

use crate::app::nudge_of;
use crate::context::action::{Action, Menu};
use crate::context::command_button::menu_row;
use crate::context::pane::Pane;
use crate::context::preferences::Layout;
use crate::context::{Intents, PaneEvent, Request, Showing};
use crate::style::theme;
use crate::widgets::checkbox;

/// All menus in a row, or one menu of menus where there is little room.
pub(crate) fn ui(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents, folded: bool) {
    if folded {
        ui.menu_button("Menu", |ui| {
            for menu in Menu::ALL {
                ui.menu_button(menu.text(), |ui| contents(ui, showing, intents, menu));
            }
        });
    } else {
        for menu in Menu::ALL {
            ui.menu_button(menu.text(), |ui| contents(ui, showing, intents, menu));
        }
    }
}

fn contents(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents, menu: Menu) {
    ui.set_min_width(230.0);
    for action in Action::in_menu(menu) {
        if is_hidden(action, showing) {
            continue;
        }
        if begins_group(action) {
            ui.separator();
        }
        let text = match action {
            Action::Undo => with_object("Undo", showing.history.undo_text()),
            Action::Redo => with_object("Redo", showing.history.redo_text()),
            _ => action.text().to_owned(),
        };
        menu_row(ui, showing, intents, action, &text);
        if action == Action::RestoreLayout {
            panes(ui, showing, intents);
        }
        if action == Action::OpenProject {
            recent(ui, showing, intents);
        }
    }
}

fn with_object(verb: &str, object: Option<&str>) -> String {
    object.map_or_else(|| verb.to_owned(), |object| format!("{verb}: {object}"))
}

/// Cameras that the take does not have, what only keys are good for, and what stands in the scene's own menu.
fn is_hidden(action: Action, showing: &Showing<'_>) -> bool {
    use Action as A;
    let is_of_scene =
        matches!(action, A::SceneFront | A::SceneSide | A::SceneTop | A::SceneFromCamera | A::SceneReset);
    if is_of_scene || nudge_of(action).is_some() {
        return true;
    }
    let count = showing.session.camera_count();
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
fn panes(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents) {
    let cameras = showing.session.camera_count();
    if cameras == 0 || showing.look.layout == Layout::Demonstrate {
        return;
    }
    ui.menu_button("Tiles", |ui| {
        ui.set_min_width(160.0);
        for pane in Pane::all(cameras) {
            let mut is_open = showing.look.is_open(pane, cameras);
            if checkbox(ui, &mut is_open, &pane.title()).on_hover_text(pane.explanation()).changed() {
                let event = if is_open { PaneEvent::Open } else { PaneEvent::Close };
                intents.request(Request::Pane(pane, event));
            }
        }
    });
}

fn recent(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents) {
    if !super::recent::has_any(showing) {
        return;
    }
    ui.separator();
    ui.label(egui::RichText::new("Recent takes and projects").small().color(theme::palette(ui).text3));
    if super::recent::rows(ui, showing, intents, true) {
        ui.close();
    }
}
