//! The basin's pane: success over angle, or a map of two directions, while it is tried in the background.

mod map;
mod section;
mod success;

use backlit_runs::basin::FitCount;
use backlit_ui::style::theme::space;
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::segmented;
use egui::{Align, Button, Layout as Direction, Rect, RichText, Ui, vec2};

use super::{Basin, BasinProgress, FileKind};
use crate::context::command::{BasinCommand, BasinView, Command};
use crate::context::command_button::named_button;
use crate::context::pane::{HEADER_BUTTONS, Pane};
use crate::context::{Context, Requests, pane_title};

/// A pane narrower than this has two rows above the plot.
const ONE_ROW: f32 = 470.0;
/// Height of the bar that says how far it is.
const BAR: f32 = 2.0;

impl Basin {
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        siblings: &[Pane],
        requests: &mut Requests,
    ) {
        pane_title::ground(ui, |ui| {
            self.header(ui, context, siblings, requests);
            progress_bar(ui, self);
            conditions(ui, self);
            let view = self.preferences.view;
            match (view, self.results.of(view)) {
                (BasinView::Angles, Some(result)) => success::ui(ui, result),
                (BasinView::Map, Some(_)) => {
                    if let Some(place) = map::ui(ui, &self.results, &mut self.preferences.colour) {
                        self.take_start(place, requests);
                    }
                }
                (_, None) => empty(ui, self, context, requests),
            }
        });
    }

    /// The name and all that can be done: in one row, or in two where the pane is a narrow column.
    fn header(&mut self, ui: &mut Ui, context: &Context<'_>, siblings: &[Pane], requests: &mut Requests) {
        let is_narrow = ui.available_width() < ONE_ROW;
        pane_title::row(ui, |ui| {
            pane_title::show(ui, Pane::Basin, siblings, requests);
            if !is_narrow {
                ui.add_space(space::ROW);
                self.controls(ui, context, requests);
                if self.has_several_maps() {
                    map::choice_box(ui, &mut self.results);
                }
            }
            ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
                ui.add_space(HEADER_BUTTONS);
                self.export(ui, context, requests);
                if let Some(running) = self.results.running {
                    let text = RichText::new(progress_text(running)).small();
                    ui.add(egui::Label::new(text.color(theme::palette(ui).text2)).truncate());
                }
            });
        });
        if is_narrow {
            pane_title::row(ui, |ui| self.controls(ui, context, requests));
            if self.has_several_maps() {
                pane_title::row(ui, |ui| map::choice_box(ui, &mut self.results));
            }
        }
    }

    /// Whether there is more than one map to choose from.
    fn has_several_maps(&self) -> bool {
        let is_map = self.preferences.view == BasinView::Map;
        is_map && self.results.map.as_ref().is_some_and(|map| map.options.choices.len() > 1)
    }

    fn controls(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let shown = self.preferences.view;
        segmented(ui, &mut self.preferences.view, &[(BasinView::Angles, "Angles"), (BasinView::Map, "Map")])
            .on_hover_text("How often fits succeed, by how far starts are off, or a map of two angles");
        run_or_cancel(ui, self, context, requests, shown);
    }

    fn export(&self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        ui.add_enabled_ui(self.results.of(self.preferences.view).is_some(), |ui| {
            ui.menu_button("Export", |ui| {
                for kind in FileKind::ALL {
                    if ui.add(Button::new(kind.words().1)).clicked() {
                        self.ask_for_file(kind, context, requests);
                        ui.close();
                    }
                }
            })
            .response
            .on_hover_text("Write what is shown to a file")
            .on_disabled_hover_text("There is nothing to write yet");
        });
    }
}

/// The button that begins what a view shows, or stops what runs.
fn run_or_cancel(
    ui: &mut Ui,
    basin: &Basin,
    context: &Context<'_>,
    requests: &mut Requests,
    view: BasinView,
) {
    let (command, text) = match (basin.results.running, view) {
        (Some(_), _) => (BasinCommand::Cancel, "Cancel basin"),
        (None, BasinView::Angles) => (BasinCommand::Run(view), "Run starts"),
        (None, BasinView::Map) => (BasinCommand::Run(view), "Run map"),
    };
    named_button(ui, context, requests, Command::Basin(command), text);
}

/// How far an experiment is, in words.
pub(super) fn progress_text(running: BasinProgress) -> String {
    let left = match running.seconds_left {
        Some(seconds) if seconds >= 90.0 => {
            format!(", about {} min left", format::number(seconds / 60.0, 0))
        }
        Some(seconds) => format!(", about {} s left", format::number(seconds.ceil(), 0)),
        None => String::new(),
    };
    format!("{} of {} fits{left}", format::count(running.done as i64), format::count(running.total as i64))
}

fn progress_bar(ui: &mut Ui, basin: &Basin) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), BAR), egui::Sense::hover());
    if let Some(running) = basin.results.running {
        let share = running.done as f32 / running.total.max(1) as f32;
        let bar = Rect::from_min_size(rect.min, vec2(rect.width() * share, BAR));
        ui.painter().rect_filled(bar, 0.0, theme::palette(ui).accent);
    }
}

/// What is shown is about, and whether it is all of it; or why nothing could be begun.
fn conditions(ui: &mut Ui, basin: &Basin) {
    let view = basin.preferences.view;
    let palette = theme::palette(ui);
    if let Some(problem) = &basin.problem {
        ui.label(RichText::new(format!("{problem}.")).color(palette.warn));
        return;
    }
    if let Some(result) = basin.results.of(view) {
        let text = RichText::new(format::capitalised(&result.conditions)).small().color(palette.text3);
        ui.horizontal(|ui| {
            ui.spacing_mut().interact_size.y = 0.0;
            let is_coming = basin.results.running.is_some_and(|running| running.view == view);
            let fits = Some(result.fits()).filter(|fits| !fits.is_whole() && !is_coming);
            if let Some(partial) = fits.and_then(FitCount::partial_text) {
                ui.label(RichText::new(partial).small().color(palette.warn)).on_hover_text(
                    "It was stopped before all fits were done: shares and bars are of those that were. Exported \
                     files say so too",
                );
            }
            ui.add(egui::Label::new(text).truncate());
        });
    }
}

fn empty(ui: &mut Ui, basin: &Basin, context: &Context<'_>, requests: &mut Requests) {
    let text = match basin.preferences.view {
        BasinView::Angles => {
            "How far off may a start be and still find the right pose? Starts are drawn around the pose on the \
             screen, farther and farther off. Each is fitted to this frame, and those that end at the right pose \
             are counted."
        }
        BasinView::Map => {
            "Two angles of the body are turned away on a grid. Each cell is a fit, coloured by how far from the \
             target it ends. Click a cell to take its start and step it."
        }
    };
    pane_title::in_the_middle(ui, 420.0, text, |ui| {
        run_or_cancel(ui, basin, context, requests, basin.preferences.view);
    });
}
