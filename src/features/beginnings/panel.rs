//! The pane: a row a method, and the step that is looked at, played, in words, taken.

mod table;

use backlit_ui::style::theme::space;
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{Icon, ValueSlider, checkbox, hint, icon_button, segmented, text_button};
use egui::{Label, RichText, ScrollArea, TextStyle, Ui, vec2};

use super::{AttemptIndex, Beginnings, COMPARED, Method, MethodWords};
use crate::context::command::{BeginningCommand, Command};
use crate::context::command_button::named_button;
use crate::context::pane::{HEADER_BUTTONS, Pane};
use crate::context::{Context, Requests, pane_title};

/// Joints of a pose that is home are nearer to the reference than this, millimetres.
const HOME_MM: f64 = 20.0;
/// Lines that are kept for the words about a step.
const LINES: f32 = 4.0;

impl Beginnings {
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        siblings: &[Pane],
        requests: &mut Requests,
    ) {
        pane_title::ground(ui, |ui| {
            ui.spacing_mut().item_spacing = vec2(space::ROW, space::ROW);
            pane_title::row(ui, |ui| {
                pane_title::show(ui, Pane::Beginnings, siblings, requests);
                ui.add_space(HEADER_BUTTONS);
            });
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                self.controls(ui, context, requests);
                table::ui(ui, self, context, requests);
                ui.add_space(space::ROW);
                self.player(ui, context, requests);
            });
        });
    }

    /// Where all begin, and the button that tries them all.
    fn controls(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        ui.horizontal_wrapped(|ui| {
            segmented(ui, &mut self.no_start, &[(false, "This pose"), (true, "No start")]).on_hover_text(
                "Where all ways begin: at the pose of this frame, or nowhere, as if nothing were known of it",
            );
            let (command, text) = match self.is_running() {
                true => (BeginningCommand::Stop, "Stop"),
                false => (BeginningCommand::RunAll, "Run all"),
            };
            named_button(ui, context, requests, Command::Beginning(command), text);
        });
        let text = if self.ended.is_empty() && !self.is_running() {
            "Where may a fit begin when the pose is hardly known? Each way is tried on this frame, its steps are kept and can \
             be played in the views."
                .to_owned()
        } else {
            summary(self)
        };
        hint(ui, text);
    }

    /// A step is looked at that was chosen by hand.
    fn choose(&mut self, at: AttemptIndex, context: &Context<'_>) {
        self.plays = None;
        self.look_at(at);
        context.egui.request_repaint();
    }

    /// The controls of the step and what it does.
    fn player(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let Some((at, outcome)) = self.at.zip(self.outcome().cloned()) else { return };
        let last = outcome.steps.len().saturating_sub(1);
        let Some(step) = outcome.steps.get(at.step) else { return };
        let palette = theme::palette(ui);
        ui.separator();
        let mut chosen = at.step;
        ui.horizontal(|ui| {
            ui.add_enabled_ui(at.step > 0, |ui| {
                if icon_button(ui, Icon::Previous, "Previous step of the way", "Previous step").clicked() {
                    chosen = at.step - 1;
                }
            });
            let (icon, label) = match self.plays {
                Some(_) => (Icon::Pause, "Pause the steps"),
                None => (Icon::Play, "Play the steps"),
            };
            ui.add_enabled_ui(last > 0, |ui| {
                if icon_button(ui, icon, label, label).clicked() {
                    self.toggle_play(context.now);
                    context.egui.request_repaint();
                }
            });
            ui.add_enabled_ui(at.step < last, |ui| {
                if icon_button(ui, Icon::Next, "Next step of the way", "Next step").clicked() {
                    chosen = at.step + 1;
                }
            });
            let text = format!("Step {} of {}", at.step + 1, last + 1);
            ui.add(Label::new(RichText::new(text).color(palette.text)).truncate());
        });
        if last > 0 {
            let mut value = at.step as f64;
            let slider = ValueSlider::new(&mut value, 0.0..=last as f64, "Step of the way");
            let width = ui.available_width();
            if ui.add(ValueSlider { width, is_held: true, ..slider }).changed() {
                chosen = value.round() as usize;
            }
        }
        if chosen != at.step {
            self.choose(AttemptIndex { step: chosen, ..at }, context);
        }
        let words = ui.add(Label::new(RichText::new(&step.words).color(palette.text)).wrap());
        // What is below stays where it is.
        let line = ui.text_style_height(&TextStyle::Body) + space::ROW;
        ui.add_space((LINES * line - words.rect.height()).max(0.0));
        ui.horizontal_wrapped(|ui| {
            let (text, tooltip) = match at.method {
                Method::Body => (
                    "Take this body",
                    "The body gets the sizes of this step, and the frame its pose; one undo takes both back",
                ),
                _ => ("Take this pose", "The frame gets the pose of this step, as a key pose"),
            };
            let button = text_button(ui, text);
            if button.on_hover_text(tooltip).clicked() {
                self.take(context, requests);
                context.egui.request_repaint();
            }
            let mut is_shown = self.is_shown;
            let shown = checkbox(ui, &mut is_shown, "Show in the views").on_hover_text(
                "Draw the step in views and scene, in the place of the pose; Esc brings the pose back",
            );
            if shown.changed() {
                self.leave();
                self.is_shown = is_shown;
                context.egui.request_repaint();
            }
        });
    }
}

/// Which ways are home, or which one costs least.
fn summary(beginnings: &Beginnings) -> String {
    let outcome = |method: &Method| {
        Some((MethodWords::of(*method).lower_case, beginnings.ended.get(method)?.as_ref().ok()?))
    };
    let compared: Vec<_> = COMPARED.iter().filter_map(outcome).collect();
    let best = compared.iter().min_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
    let errors: Vec<_> =
        compared.iter().filter_map(|(name, outcome)| Some((*name, outcome.error_mm?))).collect();
    let nearest = errors.iter().min_by(|a, b| a.1.total_cmp(&b.1));
    let home: Vec<&str> =
        errors.iter().filter(|(_, error)| *error < HOME_MM).map(|(name, _)| *name).collect();
    match (home.as_slice(), nearest, best) {
        ([_, ..], ..) => format!("Found, with joints less than 20 mm off on average: {}.", home.join(", ")),
        (_, Some((name, error)), _) => {
            let off = format::length(error / 1e3);
            format!("Nearest to the reference: {name}, its joints {off} off on average.")
        }
        (.., Some((name, _))) => format!("The true pose is not known here. The cost is least after {name}."),
        _ => String::new(),
    }
}
