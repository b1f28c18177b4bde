//! The Observability section: what the cameras see of the pose, direction by direction, and why not.

mod chart;

use backlit_tracking::camera::Camera;
use backlit_tracking::observability::{Direction, JointUncertainty, Observability};
use egui::{Align, ComboBox, Layout, Rect, RichText, Role, Sense, Ui, WidgetInfo, vec2};

use crate::context::action::Action;
use crate::context::command_button::named_button;
use crate::context::{Context, Request, Requests, unavailable};
use crate::drawing::ellipse_factor::FACTORS;
use crate::drawing::{JointEllipse, JointId, joint_ellipses, joint_name};
use crate::features::observability::words;
use crate::features::observability::{AMPLITUDES_MM, ObserveRequest, Observing, SPEEDS};
use crate::style::format;
use crate::style::theme;
use crate::style::theme::{size, space};
use crate::widgets::{Icon, SliderRow, checkbox, icon_button, named_row, section};

/// Width of the name of the ellipses' factor.
const FACTOR_NAME: f32 = 68.0;
/// Joints that are listed.
const LISTED: usize = 3;
/// A joint that sways by less than this share of the one that sways most is not listed.
const WORTH_LISTING: f64 = 0.1;

/// The Observability section.
pub(crate) fn ui(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, open: bool) {
    let observing = context.observing;
    let summary = summary(observing);
    section(ui, "Observability", &summary, open, |ui| {
        requests.glance.at_figures = true;
        let Some(found) = observing.found() else {
            hint(ui, waiting_for(context));
            return;
        };
        if found.shown.cameras.is_empty() {
            hint(ui, "No camera in the fit has a silhouette of this frame: nothing is seen.");
            return;
        }
        chart::ui(ui, observing, requests);
        if let Some((shown, direction)) = observing.direction() {
            title_row(ui, observing, shown, direction, requests);
            words(ui, observing, shown, direction);
            movers(ui, context, shown, direction);
            sway(ui, context, direction, requests);
        }
        uncertainty(ui, context, &found.shown, requests);
    });
}

/// A length in the unit that leaves one to three figures before the point; not finite is without bound.
pub(crate) fn length(metres: f64) -> String {
    let mm = 1e3 * metres;
    if !mm.is_finite() {
        "no bound".to_owned()
    } else if mm >= 1000.0 {
        format!("{} m", format::number(metres, 1))
    } else {
        format!("{} mm", format::number(mm, usize::from(mm < 9.95)))
    }
}

/// "±2.3 mm", or that nothing bounds it.
pub(crate) fn deviation(metres: f64) -> String {
    if metres.is_finite() { format!("±{}", length(metres)) } else { length(metres) }
}

/// What people call the joint at the end of a limb; `None` is the root.
pub(crate) fn name_of(shown: &Observability, limb: Option<usize>) -> String {
    joint_name(&shown.model, limb.map_or(JointId::Root, JointId::End))
}

/// Ellipses of the joints in a camera's view, and whether they are of other cameras than those in use.
pub(crate) fn ellipses(observing: &Observing, camera: &Camera) -> (Vec<JointEllipse>, bool) {
    let Some((shown, (joints, others))) = observing.found().map(|f| &f.shown).zip(observing.ellipses())
    else {
        return (Vec::new(), false);
    };
    let text = |joint: &JointUncertainty, deviations_m: [f64; 2]| {
        let [across, depth] = deviations_m.map(deviation);
        format!("{}: {across} across, {depth} in depth (1σ)", name_of(shown, joint.limb))
    };
    (joint_ellipses(joints, camera, text), others.is_some())
}

fn summary(observing: &Observing) -> String {
    observing.found().map_or_else(String::new, |found| {
        let count = found.shown.directions.len();
        format!("{} of {count} seen", count - found.shown.null_count())
    })
}

/// Why there are no figures yet.
fn waiting_for(context: &Context<'_>) -> &'static str {
    let has_frame = context.session.frames.get(context.selection.frame).is_some();
    match () {
        () if context.session.take.is_none() => "Open a take to see what its cameras see.",
        () if !has_frame => "Waiting for the frame …",
        () => "Looking through every camera …",
    }
}

fn hint(ui: &mut Ui, text: &str) {
    ui.add(egui::Label::new(RichText::new(text).small().color(theme::palette(ui).text3)).wrap());
}

/// Which direction is looked at, and buttons to its neighbours.
fn title_row(
    ui: &mut Ui,
    observing: &Observing,
    shown: &Observability,
    direction: &Direction,
    requests: &mut Requests,
) {
    let palette = theme::palette(ui);
    let (at, count) = (observing.picked().unwrap_or_default(), shown.directions.len());
    let (row, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), size::SLIDER_ROW), Sense::hover());
    let text = format!("{} of {count}: {}", at + 1, words::title(shown, direction));
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("Direction {text}")));
    let band = row.expand2(vec2(space::PANEL_MARGIN, 0.0));
    ui.painter().rect_filled(band, 0.0, palette.select);
    let bar = Rect::from_min_size(band.min, vec2(3.0, band.height()));
    ui.painter().rect_filled(bar, 0.0, palette.accent);
    let buttons = Rect::from_min_max(egui::pos2(row.right() - 2.0 * size::BUTTON, row.top()), row.max);
    let colour = if observing.is_stale() { palette.text3 } else { palette.accent_text };
    let font = egui::TextStyle::Body.resolve(ui.style());
    let mut job = egui::text::LayoutJob::simple_singleline(text.clone(), font, colour);
    job.wrap = egui::text::TextWrapping::truncate_at_width(buttons.left() - row.left() - space::ROW);
    let galley = ui.painter().layout_job(job);
    let is_cut = galley.elided;
    let at_text = egui::pos2(row.left(), row.center().y - 0.5 * galley.size().y);
    ui.painter().galley(at_text, galley, colour);
    if is_cut {
        response.on_hover_text(text);
    }
    let builder = egui::UiBuilder::new().max_rect(buttons).layout(Layout::left_to_right(Align::Center));
    ui.scope_builder(builder, |ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        let neighbours = [
            (Icon::Previous, Action::StrongerDirection, at > 0),
            (Icon::Next, Action::WeakerDirection, at + 1 < count),
        ];
        for (icon, action, is_there) in neighbours {
            ui.add_enabled_ui(is_there, |ui| {
                if icon_button(ui, icon, action.text(), &action.tooltip()).clicked() {
                    requests.act(action);
                }
            });
        }
    });
}

/// Why it is weak, what would help, and by how much it is known.
fn words(ui: &mut Ui, observing: &Observing, shown: &Observability, direction: &Direction) {
    let palette = theme::palette(ui);
    let colour = if observing.is_stale() { palette.text3 } else { palette.text };
    ui.add(egui::Label::new(RichText::new(words::why(shown, direction)).color(colour)).wrap());
    let remedy = words::remedy(direction);
    let known = known(shown, direction);
    let rest = [remedy, &known].into_iter().filter(|text| !text.is_empty());
    let rest = rest.collect::<Vec<_>>().join(" ");
    if !rest.is_empty() {
        hint(ui, &rest);
    }
}

/// One standard deviation in plain numbers.
fn known(shown: &Observability, direction: &Direction) -> String {
    if direction.is_null {
        return String::new();
    }
    let (limb, moved) = direction.largest_move();
    let moved = moved * direction.deviation;
    let turned = direction.largest_turn() * direction.deviation;
    if direction.moves_no_joint() {
        format!("Known to ±{}.", format::degrees(turned))
    } else {
        format!("Known to ±{} at the {}.", length(moved), name_of(shown, limb))
    }
}

/// The joints that sway most, and how far.
fn movers(ui: &mut Ui, context: &Context<'_>, shown: &Observability, direction: &Direction) {
    let palette = theme::palette(ui);
    if direction.moves_no_joint() {
        let turned = context.observing.largest_amount(direction) * direction.largest_turn();
        mover_row(ui, "No joint moves; turns by", &format!("±{}", format::degrees(turned)), palette.text2);
        return;
    }
    let amount = context.observing.largest_amount(direction);
    let movers = direction.movers();
    let most = movers.first().map_or(0.0, |first| first.1);
    for (limb, by) in movers.iter().take(LISTED).filter(|(_, by)| *by >= WORTH_LISTING * most) {
        mover_row(ui, &name_of(shown, *limb), &format!("±{}", length(by * amount)), palette.text2);
    }
}

fn mover_row(ui: &mut Ui, name: &str, value: &str, colour: egui::Color32) {
    let (row, response) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("{name} {value}")));
    let small = egui::TextStyle::Small.resolve(ui.style());
    let mono = egui::TextStyle::Monospace.resolve(ui.style());
    let palette = theme::palette(ui);
    ui.painter().text(row.left_center(), egui::Align2::LEFT_CENTER, name, small, palette.text3);
    ui.painter().text(row.right_center(), egui::Align2::RIGHT_CENTER, value, mono, colour);
}

/// How far and how fast the body sways, and whether it does.
fn sway(ui: &mut Ui, context: &Context<'_>, direction: &Direction, requests: &mut Requests) {
    let observing = context.observing;
    let mut amplitude = observing.amplitude_mm();
    let row = SliderRow {
        name: "Sway",
        unit: " mm",
        decimals: 0,
        range: AMPLITUDES_MM[0]..=AMPLITUDES_MM[1],
        limits: None,
        origin: AMPLITUDES_MM[0],
        is_held: observing.is_swaying(),
        tooltip: if direction.moves_no_joint() {
            "How far the body sways; 60 mm stand for a third of a right angle where no joint moves"
        } else {
            "How far the joint that moves most sways to each side"
        },
    };
    if row.show(ui, &mut amplitude).changed() {
        requests.request(Request::Observe(ObserveRequest::Amplitude(amplitude)));
    }
    let mut speed = observing.speed();
    let row = SliderRow {
        name: "Speed",
        unit: " Hz",
        decimals: 1,
        range: SPEEDS[0]..=SPEEDS[1],
        limits: None,
        origin: SPEEDS[0],
        is_held: false,
        tooltip: "Sways a second",
    };
    if row.show(ui, &mut speed).changed() {
        requests.request(Request::Observe(ObserveRequest::Speed(speed)));
    }
    ui.horizontal(|ui| {
        let text = if observing.is_playing() { "Hold" } else { "Sway" };
        named_button(ui, context, requests, Action::Sway, text);
        ui.add_enabled_ui(observing.is_swaying(), |ui| {
            let tooltip = "The body goes back to where it is (Esc)";
            if ui.button("Put back").on_hover_text(tooltip).on_disabled_hover_text(tooltip).clicked() {
                requests.request(Request::Observe(ObserveRequest::StopSway));
            }
        });
    });
}

/// Ellipses in the views, and the joint that is known worst.
fn uncertainty(ui: &mut Ui, context: &Context<'_>, shown: &Observability, requests: &mut Requests) {
    let observing = context.observing;
    let mut shows = observing.shows_ellipses();
    let noise = shown.noise;
    let tooltip = format!(
        "Ellipses of two standard deviations: pixels on the outline err by {} grey levels, and {} times as much \
         together as by themselves. From the data alone, without priors. {}",
        format::number(noise.pixel_deviation, 0),
        format::number(noise.together.sqrt(), 1),
        Action::Uncertainty.keys_text().unwrap_or_default(),
    );
    let is_possible = unavailable(Action::Uncertainty, context).is_none();
    let response = ui.add_enabled_ui(is_possible, |ui| checkbox(ui, &mut shows, "Uncertainty in the views"));
    if response.inner.on_hover_text(tooltip).changed() {
        requests.request(Request::Observe(ObserveRequest::Ellipses(shows)));
    }
    if observing.shows_ellipses() {
        factor_row(ui, observing, requests);
    }
    if let Some((limb, deviation)) = shown.worst_joint() {
        let palette = theme::palette(ui);
        let colour = if observing.is_stale() { palette.text3 } else { palette.text2 };
        let name = format!("Known worst: {}", name_of(shown, limb));
        mover_row(ui, &name, &format!("{} (1σ)", self::deviation(deviation)), colour);
    }
}

/// How much larger than life the ellipses are drawn.
fn factor_row(ui: &mut Ui, observing: &Observing, requests: &mut Requests) {
    let automatic = format!("Automatic, ×{}", observing.automatic_factor());
    let chosen = observing.chosen_factor();
    let text = chosen.map_or_else(|| automatic.clone(), |factor| format!("×{factor}"));
    named_row(ui, "Drawn", FACTOR_NAME, |ui| {
        let combo = ComboBox::from_id_salt("ellipse factor").selected_text(text.as_str());
        let response = combo.width(ui.available_width()).show_ui(ui, |ui| {
            let choices = std::iter::once((None, automatic.clone()))
                .chain(FACTORS.into_iter().map(|factor| (Some(factor), format!("×{factor}"))));
            for (factor, text) in choices {
                if ui.selectable_label(chosen == factor, text).clicked() {
                    requests.request(Request::Observe(ObserveRequest::EllipseFactor(factor)));
                }
            }
        });
        let label = format!("Ellipses drawn {text}");
        response.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, &label));
        response.response.on_hover_text(
            "Several cameras know a joint to millimetres: ellipses are drawn larger than life, all by the same \
             factor. The legend under each picture says by how much; hovering a joint says the true size.",
        );
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_have_a_unit_that_suits_them() {
        assert_eq!(length(0.0004), "0.4 mm");
        assert_eq!(length(0.031), "31 mm");
        assert_eq!(length(1.23), "1.2 m");
        assert_eq!(length(f64::INFINITY), "no bound");
    }
}
