//! The Observability section: what the cameras see of the pose, direction by direction, and why not.

mod chart;

use backlit_document::observability_words as words;
use backlit_tracking::observability::{Direction, Observability as Figures};
use backlit_ui::drawing::FACTORS;
use backlit_ui::drawing::joint_name;
use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{
    Icon, SliderRow, checkbox, first_that_fits, hint, icon_button, named_row, section, two_words, within,
};
use egui::{Align, ComboBox, Rect, RichText, Role, Sense, TextStyle, Ui, WidgetInfo, vec2};

use super::Observability;
use super::sway::{AMPLITUDES_MM, SPEEDS};
use crate::context::command::{Command, ObservabilityCommand};
use crate::context::command_button::named_button;
use crate::context::preferences::Layout;
use crate::context::{Context, Requests, unavailable};

/// Width of the name of the ellipses' factor.
const FACTOR_NAME: f32 = 68.0;
/// Joints that are listed.
const LISTED: usize = 3;
/// A joint that sways by less than this share of the one that sways most is not listed.
const WORTH_LISTING: f64 = 0.1;

impl Observability {
    pub(super) fn section(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let open = context.preferences.layout == Layout::Debug;
        section(ui, "Observability", &summary(self), open, |ui| {
            self.drawn.figures = true;
            let Some(found) = self.found.clone() else {
                hint(ui, waiting_for(context));
                return;
            };
            let shown = &found.shown;
            if shown.cameras.is_empty() {
                hint(ui, "No camera in the fit has a silhouette of this frame: nothing is seen.");
                return;
            }
            chart::ui(ui, self, shown);
            if let Some(direction) = self.picked().and_then(|picked| shown.directions.get(picked)) {
                title_row(ui, self, shown, requests);
                words(ui, self.is_stale(), shown, direction);
                movers(ui, self, shown, direction);
                sway(ui, context, self, direction, requests);
            }
            uncertainty(ui, context, self, shown);
        });
    }
}

fn summary(observability: &Observability) -> String {
    observability.found().map_or_else(String::new, |found| {
        let count = found.shown.directions.len();
        format!("{} of {count} seen", count - found.shown.null_count())
    })
}

/// Why there are no figures yet.
fn waiting_for(context: &Context<'_>) -> &'static str {
    let has_frame = context.session.frames.get(context.selection.frame).is_some();
    match has_frame {
        _ if context.session.take.is_none() => "Open a take to see what its cameras see.",
        false => "Waiting for the frame…",
        true => "Looking through every camera…",
    }
}

/// The ground of the row that is looked at or in use.
pub(super) fn paint_selected(ui: &Ui, row: Rect) {
    let palette = theme::palette(ui);
    let band = row.expand2(vec2(space::PANEL_MARGIN, 0.0));
    ui.painter().rect_filled(band, 0.0, palette.select);
    let bar = Rect::from_min_size(band.min, vec2(3.0, band.height()));
    ui.painter().rect_filled(bar, 0.0, palette.accent);
}

/// Which direction is looked at, and buttons to its neighbours.
fn title_row(ui: &mut Ui, observability: &Observability, shown: &Figures, requests: &mut Requests) {
    let palette = theme::palette(ui);
    let (at, count) = (observability.picked().unwrap_or_default(), shown.directions.len());
    let Some(direction) = shown.directions.get(at) else { return };
    let (row, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), size::SLIDER_ROW), Sense::hover());
    let text = format!("{} of {count}: {}", at + 1, words::title(shown, direction));
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("Direction {text}")));
    paint_selected(ui, row);
    let buttons = Rect::from_min_max(egui::pos2(row.right() - 2.0 * size::BUTTON, row.top()), row.max);
    let colour = if observability.is_stale() { palette.text3 } else { palette.accent_text };
    let font = TextStyle::Body.resolve(ui.style());
    // As many of its parts as there is room for.
    let room = buttons.left() - row.left() - space::ROW;
    let shorter = text.rmatch_indices(", ").map(|(end, _)| &text[..end]);
    let texts: Vec<&str> = std::iter::once(&text[..]).chain(shorter).collect();
    let said = first_that_fits(ui, &texts, &TextStyle::Body, room).unwrap_or_default();
    let (galley, is_cut) = (ui.painter().layout_no_wrap(said.to_owned(), font, colour), said != text);
    let at_text = egui::pos2(row.left(), row.center().y - 0.5 * galley.size().y);
    ui.painter().galley(at_text, galley, colour);
    if is_cut {
        response.on_hover_text(text);
    }
    within(ui, buttons, egui::Layout::left_to_right(Align::Center), |ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        let neighbours = [
            (Icon::Previous, Command::Observability(ObservabilityCommand::StrongerDirection), at > 0),
            (Icon::Next, Command::Observability(ObservabilityCommand::WeakerDirection), at + 1 < count),
        ];
        for (icon, command, is_there) in neighbours {
            ui.add_enabled_ui(is_there, |ui| {
                if icon_button(ui, icon, command.text(), &command.tooltip()).clicked() {
                    requests.run(command);
                }
            });
        }
    });
}

/// Why it is weak, what would help, and by how much it is known.
fn words(ui: &mut Ui, is_stale: bool, shown: &Figures, direction: &Direction) {
    let palette = theme::palette(ui);
    let colour = if is_stale { palette.text3 } else { palette.text };
    ui.add(egui::Label::new(RichText::new(words::why(shown, direction)).color(colour)).wrap());
    let remedy = words::remedy(direction);
    let known = known(shown, direction);
    let rest = [remedy, &known].into_iter().filter(|text| !text.is_empty());
    let rest = rest.collect::<Vec<_>>().join(" ");
    if !rest.is_empty() {
        hint(ui, rest);
    }
}

/// One standard deviation in plain numbers.
fn known(shown: &Figures, direction: &Direction) -> String {
    if direction.is_null {
        return String::new();
    }
    let (limb, moved) = direction.largest_move();
    let moved = moved * direction.deviation;
    let turned = direction.largest_turn() * direction.deviation;
    if direction.moves_no_joint() {
        format!("One standard deviation along it: ±{}.", format::degrees(turned))
    } else {
        format!(
            "One standard deviation along it: ±{} at the {}.",
            format::length(moved),
            joint_name(&shown.model, limb.into())
        )
    }
}

/// The joints that sway most, and how far.
fn movers(ui: &mut Ui, observability: &Observability, shown: &Figures, direction: &Direction) {
    let palette = theme::palette(ui);
    let amount = observability.largest_amount(direction);
    if direction.moves_no_joint() {
        let turned = amount * direction.largest_turn();
        mover_row(ui, "No joint moves; turns by", &format!("±{}", format::degrees(turned)), palette.text2);
        return;
    }
    let movers = direction.movers();
    let most = movers.first().map_or(0.0, |first| first.1);
    for (limb, by) in movers.iter().take(LISTED).filter(|(_, by)| *by >= WORTH_LISTING * most) {
        let (name, by) = (joint_name(&shown.model, (*limb).into()), format::length(by * amount));
        mover_row(ui, &name, &format!("±{by}"), palette.text2);
    }
}

fn mover_row(ui: &mut Ui, name: &str, value: &str, colour: egui::Color32) {
    let words = [(name, TextStyle::Small, theme::palette(ui).text3), (value, TextStyle::Monospace, colour)];
    two_words(ui, 18.0, &format!("{name} {value}"), words);
}

/// How far and how fast the body sways, and whether it does.
fn sway(
    ui: &mut Ui,
    context: &Context<'_>,
    observability: &mut Observability,
    direction: &Direction,
    requests: &mut Requests,
) {
    let is_swaying = observability.is_swaying();
    let choices = &mut observability.choices;
    let tooltip = if direction.moves_no_joint() {
        "How far the body sways; 60 mm stand for 30° where no joint moves"
    } else {
        "How far the joint that moves most sways to each side"
    };
    let sliders = [
        (&mut choices.amplitude_mm, "Sway", " mm", 0, AMPLITUDES_MM, is_swaying, tooltip),
        (&mut choices.speed, "Speed", " Hz", 1, SPEEDS, false, "Sways a second"),
    ];
    for (value, name, unit, decimals, [low, high], is_held, tooltip) in sliders {
        let row = SliderRow { is_held, ..SliderRow::new(name, unit, decimals, low..=high, tooltip) };
        if row.show(ui, value).changed() {
            *value = value.clamp(low, high);
        }
    }
    ui.horizontal(|ui| {
        let text = if observability.is_playing() { "Hold" } else { "Sway" };
        named_button(ui, context, requests, Command::Observability(ObservabilityCommand::Sway), text);
        ui.add_enabled_ui(is_swaying, |ui| {
            let tooltip = "The body goes back to where it is (Esc)";
            if ui.button("Put back").on_hover_text(tooltip).on_disabled_hover_text(tooltip).clicked() {
                observability.stop_sway();
            }
        });
    });
}

/// Ellipses in the views, and the joint that is known worst.
fn uncertainty(ui: &mut Ui, context: &Context<'_>, observability: &mut Observability, shown: &Figures) {
    let noise = shown.noise;
    let command = Command::Observability(ObservabilityCommand::Ellipses);
    let tooltip = format!(
        "Ellipses of two standard deviations: pixels on the outline err by {} grey levels, and {} times as much \
         together as by themselves. From the data alone, without priors. {}",
        format::number(noise.pixel_deviation, 0),
        format::number(noise.together.sqrt(), 1),
        command.keys_text().unwrap_or_default(),
    );
    let is_possible = unavailable(command, context).is_none();
    let ellipses = &mut observability.choices.ellipses;
    let response = ui.add_enabled_ui(is_possible, |ui| checkbox(ui, ellipses, "Uncertainty in the views"));
    response.inner.on_hover_text(tooltip);
    if observability.choices.ellipses {
        factor_row(ui, observability);
    }
    if let Some((limb, deviation)) = shown.worst_joint() {
        let palette = theme::palette(ui);
        let colour = if observability.is_stale() { palette.text3 } else { palette.text2 };
        let name = format!("Least certain: {}", joint_name(&shown.model, limb.into()));
        mover_row(ui, &name, &format!("{} (1σ)", format::deviation(deviation)), colour);
    }
}

/// How much larger than life the ellipses are drawn.
fn factor_row(ui: &mut Ui, observability: &mut Observability) {
    let automatic = format!("Automatic, ×{}", observability.automatic_factor());
    let chosen = observability.choices.factor;
    let text = chosen.map_or_else(|| automatic.clone(), |factor| format!("×{factor}"));
    named_row(ui, "Drawn", FACTOR_NAME, |ui| {
        let combo = ComboBox::from_id_salt("ellipse factor").selected_text(text.as_str());
        let response = combo.width(ui.available_width()).show_ui(ui, |ui| {
            let choices = std::iter::once((None, automatic.clone()))
                .chain(FACTORS.into_iter().map(|factor| (Some(factor), format!("×{factor}"))));
            for (factor, text) in choices {
                if ui.selectable_label(chosen == factor, text).clicked() {
                    observability.choices.factor = factor;
                }
            }
        });
        let label = format!("Ellipses drawn {text}");
        response.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, &label));
        response.response.on_hover_text(
            "Several cameras know a joint to millimetres: ellipses are drawn larger than life, all by the same \
             factor. The legend under each picture says by how much; point at a joint for the true size.",
        );
    });
}
