//! What is compared, and the controls of the step.

use backlit_document::fit_words::preset_like;
use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::choice;
use backlit_ui::widgets::{Icon, fitting_label, icon_button};
use egui::{Align, Frame, Label, Layout as Direction, Margin, Panel, RichText, TextStyle, Ui, vec2};

use crate::context::command::{Command, FitCommand, LaboratoryCommand};
use crate::context::command_button as command;
use crate::context::command_button::preset_box;
use crate::context::{Context, Requests, SessionRequest, unavailable};
use crate::features::laboratory::{LaboratoryChoices, Lineup, PushAxis, StartChoice};
use crate::session::selection::Selection;

const HEIGHT: f32 = 66.0;
const ROW: f32 = 28.0;
/// The toolbar is so much narrower than the window.
const TOOLBAR_MARGINS: f32 = 16.0;
/// With more room than this left there are words before the boxes.
const PREFIX_FROM: f32 = 620.0;

/// Two rows: title and step; what it is of, and what is looked at.
pub(super) fn ui(
    ui: &mut Ui,
    context: &Context<'_>,
    chosen: &mut LaboratoryChoices,
    requests: &mut Requests,
    margin: f32,
) {
    let palette = theme::palette(ui);
    let frame = Frame::NONE.fill(palette.panel).inner_margin(Margin::symmetric(margin as i8, 5));
    Panel::top("laboratory header").exact_size(HEIGHT).resizable(false).frame(frame).show(ui, |ui| {
        ui.spacing_mut().item_spacing = vec2(space::WIDGET, 0.0);
        row(ui, |ui| {
            controls(ui, context, chosen, requests);
            left(ui, |ui| {
                let title = chosen.lineup.words().title;
                let text = RichText::new(title).text_style(theme::title()).color(palette.text);
                ui.add(Label::new(text).truncate());
            });
        });
        row(ui, |ui| {
            choices(ui, context, chosen, requests);
            left(ui, |ui| {
                let text = sentence(chosen.lineup, context);
                // The first sentences say most.
                let short: Vec<&str> = text.match_indices(". ").map(|(end, _)| &text[..=end]).collect();
                let texts: Vec<&str> = std::iter::once(&text[..]).chain(short.into_iter().rev()).collect();
                fitting_label(ui, &texts, TextStyle::Body, palette.text2);
            });
        });
    });
}

fn row(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    let size = vec2(ui.available_width(), ROW);
    ui.allocate_ui_with_layout(size, Direction::right_to_left(Align::Center), add);
}

fn left(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    ui.with_layout(Direction::left_to_right(Align::Center), add);
}

fn sentence(lineup: Lineup, context: &Context<'_>) -> String {
    let Some(take) = &context.session.take else { return String::new() };
    let frames = take.frame_count();
    let frame = if frames > 1 {
        format!(", frame {} of {}", context.selection.frame, format::count(frames as i64 - 1))
    } else {
        String::new()
    };
    let solver = match (lineup, preset_like(&context.document().fit)) {
        (Lineup::Presets, _) | (_, None) => String::new(),
        (_, Some(preset)) => format!(" Solver: {}.", preset.label()),
    };
    format!("{}{frame}. {}{solver}", take.take().name(), lineup.words().sentence)
}

/// From right to left: start, stop, run, step, back, restart.
fn controls(ui: &mut Ui, context: &Context<'_>, chosen: &mut LaboratoryChoices, requests: &mut Requests) {
    ui.spacing_mut().item_spacing.x = space::ROW + 2.0;
    start_box(ui, context, chosen);
    command::icon(ui, context, requests, Command::Fit(FitCommand::Stop), Icon::Stop);
    let run = format!("Run {}", chosen.lineup.words().all);
    command::named_button(ui, context, requests, Command::Fit(FitCommand::Run), &run);
    command::primary(ui, context, requests, Command::Fit(FitCommand::Step));
    command::icon(ui, context, requests, Command::Fit(FitCommand::StepBack), Icon::StepBack);
    let restart = Command::Laboratory(LaboratoryCommand::Restart);
    let tooltip = unavailable(restart, context);
    let is_enabled = tooltip.is_none();
    let tooltip = tooltip.map_or_else(|| restart.tooltip(), |why| format!("{why}."));
    let response =
        ui.add_enabled_ui(is_enabled, |ui| icon_button(ui, Icon::First, "Restart", &tooltip)).inner;
    if response.clicked() {
        requests.run(restart);
    }
}

fn start_box(ui: &mut Ui, context: &Context<'_>, chosen: &mut LaboratoryChoices) {
    let offered = StartChoice::offered(context.session.demonstration());
    let choices: Vec<_> = offered.iter().map(|start| (*start, start.text(), start.tooltip())).collect();
    let text = chosen.start.text();
    chosen.start = choice(ui, "Start", 126.0, &text, &choices).unwrap_or(chosen.start);
}

/// From right to left: axis, limb, camera, and what is compared where the toolbar has no room for it.
fn choices(ui: &mut Ui, context: &Context<'_>, chosen: &mut LaboratoryChoices, requests: &mut Requests) {
    ui.spacing_mut().item_spacing.x = space::ROW + 2.0;
    let model = &context.document().model;
    let axis = chosen.axis_for(model);
    let axes = PushAxis::ALL.map(|(axis, text)| {
        let whose = if matches!(axis, PushAxis::Move(_)) { "" } else { "limb " };
        (axis, text, format!("Show which pixels change as the {whose}{text}"))
    });
    chosen.axis = choice(ui, "Motion", 136.0, axis.text(), &axes).or(chosen.axis);
    let has_limbs = model.rotation_count() > 1;
    if has_limbs {
        limb_box(ui, context, requests);
    }
    if ui.available_width() > PREFIX_FROM {
        let text = if has_limbs { "Pushes as the" } else { "Pushes as the limb" };
        ui.label(RichText::new(text).color(theme::palette(ui).text3));
    }
    if context.session.camera_count() > 1 {
        camera_box(ui, context, &mut chosen.camera);
    }
    if ui.ctx().content_rect().width() - TOOLBAR_MARGINS < size::FOLD_CHOICES {
        preset_box(ui, context, requests, 92.0);
        lineup_box(ui, &mut chosen.lineup);
    }
}

fn limb_box(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
    let model = &context.document().model;
    let tooltip = "The limb whose motion the lower pictures show";
    let row = |&limb: &usize| (limb, format::capitalised(&model.limbs()[limb].name), tooltip.to_owned());
    let choices: Vec<_> = model.rotation_owners().iter().map(row).collect();
    let held = context.selection.limb(model);
    let chosen = choices.iter().find(|(limb, ..)| *limb == held).map_or("", |(_, name, _)| name.as_str());
    if let Some(limb) = choice(ui, "Limb", 126.0, chosen, &choices) {
        requests.request(SessionRequest::Joint(Selection::joint_of(model, limb)));
    }
}

fn camera_box(ui: &mut Ui, context: &Context<'_>, camera: &mut usize) {
    let Some(take) = &context.session.take else { return };
    let name = |index: usize| format!("Camera {}", index + 1);
    let choices: Vec<_> =
        take.cameras.iter().enumerate().map(|(i, camera)| (i, name(i), camera.name().to_owned())).collect();
    *camera = choice(ui, "Camera", 84.0, &name(*camera), &choices).unwrap_or(*camera);
}

/// What is to be compared instead.
pub(super) fn lineup_box(ui: &mut Ui, lineup: &mut Lineup) {
    let choices = Lineup::ALL.map(|other| (other, other.words().name, other.words().tooltip.into_owned()));
    *lineup = choice(ui, "Compare", 92.0, lineup.words().name, &choices).unwrap_or(*lineup);
}
