//! The pane: a row a method, and the step that is looked at.

mod player;
mod table;

use backlit_ui::style::format;
use backlit_ui::style::theme;
use backlit_ui::style::theme::{size, space};
use backlit_ui::widgets::segmented;
use egui::{Align, Layout as Direction, RichText, ScrollArea, Ui, vec2};

use super::{AttemptIndex, Beginnings, COMPARED, Method, MethodWords};
use crate::context::command::{BeginningCommand, Command};
use crate::context::command_button::named_button;
use crate::context::pane::{HEADER_BUTTONS, Pane};
use crate::context::pane_title;
use crate::context::{Context, Requests};

/// Joints of a pose that is home are nearer to the reference than this, millimetres.
const HOME_MM: f64 = 20.0;

/// What is asked for in the pane, done when it is drawn.
enum PaneAction {
    NoStart(bool),
    Run(Method),
    LookAt(AttemptIndex),
    Play,
    Take,
    Show(bool),
}

impl Beginnings {
    /// The pane, in all of the space that is left.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        siblings: &[Pane],
        requests: &mut Requests,
    ) {
        let mut actions = Vec::new();
        pane(ui, self, context, siblings, requests, &mut actions);
        for action in actions {
            match action {
                PaneAction::NoStart(no_start) => self.no_start = no_start,
                PaneAction::Run(method) => self.begin(&[method], context, requests),
                PaneAction::LookAt(at) => {
                    self.plays = None;
                    self.look_at(at);
                }
                PaneAction::Play => self.toggle_play(context.now),
                PaneAction::Take => self.take(context, requests),
                PaneAction::Show(true) => self.is_shown = true,
                PaneAction::Show(false) => drop(self.leave()),
            }
            ui.ctx().request_repaint();
        }
    }
}

fn pane(
    ui: &mut Ui,
    beginnings: &Beginnings,
    context: &Context<'_>,
    siblings: &[Pane],
    requests: &mut Requests,
    actions: &mut Vec<PaneAction>,
) {
    pane_title::ground(ui, |ui| {
        ui.spacing_mut().item_spacing = vec2(space::ROW, space::ROW);
        let size = vec2(ui.available_width(), size::TILE_HEADER);
        ui.allocate_ui_with_layout(size, Direction::left_to_right(Align::Center), |ui| {
            ui.set_min_height(size::TILE_HEADER);
            pane_title::show(ui, Pane::Beginnings, siblings, requests);
            ui.add_space(HEADER_BUTTONS);
        });
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            controls(ui, beginnings, context, requests, actions);
            table::ui(ui, beginnings, context, actions);
            ui.add_space(space::ROW);
            player::ui(ui, beginnings, actions);
        });
    });
}

/// Where all begin, and the button that tries them all.
fn controls(
    ui: &mut Ui,
    beginnings: &Beginnings,
    context: &Context<'_>,
    requests: &mut Requests,
    actions: &mut Vec<PaneAction>,
) {
    ui.horizontal_wrapped(|ui| {
        let mut no_start = beginnings.no_start;
        segmented(ui, &mut no_start, &[(false, "This pose"), (true, "No start")]).on_hover_text(
            "Where all ways begin: at the pose of this frame, or nowhere, as if nothing were known of it",
        );
        if no_start != beginnings.no_start {
            actions.push(PaneAction::NoStart(no_start));
        }
        let (command, text) = match beginnings.is_running() {
            true => (BeginningCommand::Stop, "Stop"),
            false => (BeginningCommand::RunAll, "Run all"),
        };
        named_button(ui, context, requests, Command::Beginning(command), text);
    });
    let text = if beginnings.ended.is_empty() && !beginnings.is_running() {
        "Where may a fit begin when the pose is hardly known? Each way is tried on this frame, its steps are kept and can \
         be played in the views."
            .to_owned()
    } else {
        summary(beginnings)
    };
    ui.add(egui::Label::new(RichText::new(text).small().color(theme::palette(ui).text3)).wrap());
}

/// Which ways are home, or which one costs least.
fn summary(beginnings: &Beginnings) -> String {
    let compared = COMPARED.iter().filter_map(|method| {
        let outcome = beginnings.ended.get(method)?.as_ref().ok()?;
        Some((*method, outcome))
    });
    let compared: Vec<_> = compared.collect();
    let knows_truth = compared.iter().any(|(_, outcome)| outcome.error_mm.is_some());
    let home = compared.iter().filter(|(_, outcome)| outcome.error_mm.is_some_and(|error| error < HOME_MM));
    let home: Vec<&str> = home.map(|(method, _)| MethodWords::of(*method).lower_case).collect();
    let errors = compared.iter().filter_map(|(method, outcome)| Some((*method, outcome.error_mm?)));
    let nearest = errors.min_by(|a, b| a.1.total_cmp(&b.1));
    let best = compared.iter().min_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
    match (best, home.as_slice()) {
        (None, _) => String::new(),
        (Some((method, _)), []) if !knows_truth => {
            format!(
                "The true pose is not known here. The cost is least after {}.",
                MethodWords::of(*method).lower_case
            )
        }
        (_, []) => nearest.map_or_else(String::new, |(method, error)| {
            format!(
                "Nearest to the reference: {}, its joints {} off on average.",
                MethodWords::of(method).lower_case,
                format::length(error / 1e3)
            )
        }),
        (_, home) => {
            format!("Found, with joints less than 20 mm off on average: {}.", home.join(", "))
        }
    }
}
