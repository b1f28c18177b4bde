//! The status bar: one sentence on the left, four numbers on the right that stay in their places.

use backlit_document::run::Run;
use backlit_ui::drawing::joint_name;
use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::Icon;
use egui::{Align, Frame, Layout as Direction, Margin, Panel, RichText, Sense, Ui, vec2};

use crate::context::activity::WorkShare;
use crate::context::command::{BasinCommand, Command, ExportCommand, FitCommand};
use crate::context::preferences::Layout;
use crate::context::{Context, Requests, command_button as command};
use crate::features::Features;

pub(crate) fn ui(ui: &mut Ui, context: &Context<'_>, features: &Features, requests: &mut Requests) {
    let palette = theme::palette(ui);
    let frame = Frame::NONE.fill(palette.raised).inner_margin(Margin::symmetric(8, 0));
    Panel::bottom("status bar").exact_size(size::STATUS_BAR).resizable(false).frame(frame).show(ui, |ui| {
        ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
            numbers(ui, context, features);
            ui.with_layout(Direction::left_to_right(Align::Center), |ui| {
                let (rect, _) = ui.allocate_exact_size(vec2(size::ICON, size::ICON), Sense::hover());
                Icon::Info.paint_scaled(ui.painter(), rect, palette.text3, 0.85);
                let cancels = match context.busy.is_long() {
                    true => (!context.busy.opening).then_some(Command::Fit(FitCommand::Stop)),
                    false => context.busy.basin.then_some(Command::Basin(BasinCommand::Cancel)),
                };
                if let Some(cancel) = cancels {
                    command::named_button(ui, context, requests, cancel, "Cancel");
                }
                if let Some((done, total)) = context.busy.exporting {
                    command::button(ui, context, requests, Command::Export(ExportCommand::Stop));
                    let text = format!("Exporting, {done} of {total}.");
                    ui.label(RichText::new(text).small().color(palette.text2));
                }
                let text = RichText::new(sentence(context, features)).small().color(palette.text2);
                ui.add(egui::Label::new(text).truncate());
            });
        });
    });
}

/// What is happening, or what one may do.
fn sentence(context: &Context<'_>, features: &Features) -> String {
    let session = context.session;
    if let Some(doing) = context.doing {
        return doing.to_owned();
    }
    if context.busy.opening && !context.busy.tracking {
        return match context.busy.share {
            Some(WorkShare { done, total }) => format!("Drawing the take: {done} of {total} pictures."),
            None => "Opening the take…".to_owned(),
        };
    }
    if session.take.is_none() {
        return "Open a take, or drop its folder anywhere.".to_owned();
    }
    if let Some(sentence) = features.all().find_map(|feature| feature.sentence(context)) {
        return sentence;
    }
    if let Some(step) = context.selection.step {
        let steps = context.runs().get(step.run).map_or(0, Run::last_step);
        return format!(
            "Looking at step {} of {steps}. Comma and period step on; an edit here starts a branch.",
            step.step
        );
    }
    if let Some(run) = context.runs().newest_of(context.selection.frame)
        && run.ending.is_some()
    {
        return format!("{}: {}. {}.", run.name, run.reached_text(context.runs().all()), run.ending_text());
    }
    if context.busy.loading {
        return "Reading the frame…".to_owned();
    }
    let joint = joint_name(&context.document().model, context.selection.joint);
    format!("Drag the {joint} in any view, or press Space for one step of the fit.")
}

fn numbers(ui: &mut Ui, context: &Context<'_>, features: &Features) {
    let session = context.session;
    let rms = session.predicted.as_ref().and_then(|predicted| predicted.rms);
    ui.spacing_mut().item_spacing.x = space::GROUP;
    let known =
        |value: Option<f64>, text: fn(f64) -> String| value.map_or_else(|| format::MISSING.to_owned(), text);
    let entries = [
        (
            "CPU frame",
            format::duration(context.frame_seconds),
            140.0,
            "Time that the window needed for its last frame",
        ),
        (
            "step",
            known(features.fit.step_seconds, format::duration),
            104.0,
            "Time of the last step of the fit",
        ),
        (
            "IoU",
            known(session.iou(), format::ratio),
            76.0,
            "Intersection over union of body and silhouettes, all cameras together, without unknown pixels",
        ),
        (
            "RMS",
            known(rms, |rms| format::number(rms, 1)),
            72.0,
            "Root mean square of D − Λ, in grey levels, all cameras together",
        ),
    ];
    let all_fits = (
        "all fits, a step",
        known(features.laboratory.step_seconds, format::duration),
        188.0,
        "Time of the last step of all the laboratory’s fits together",
    );
    let palette = theme::palette(ui);
    let [frame, step, iou, rms] = entries;
    let shown = match context.preferences.layout {
        Layout::Demonstrate => vec![frame, all_fits],
        _ => vec![frame, step, iou, rms],
    };
    for (name, value, width, tooltip) in shown {
        let stale = session.is_stale && matches!(name, "IoU" | "RMS");
        let colour = if stale { palette.text3 } else { palette.text2 };
        let text = RichText::new(format!("{name} {value}")).monospace().color(colour);
        ui.allocate_ui_with_layout(
            vec2(width, size::STATUS_BAR),
            Direction::right_to_left(Align::Center),
            |ui| ui.label(text).on_hover_text(tooltip),
        );
    }
}
