//! The toolbar: the choices that are made all day, and the one button that is the likely next act.

use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{Icon, fitting_label, paint_text, segmented, within};
use egui::{
    Align, Frame, Label, Layout as Direction, Margin, Panel, RichText, Sense, TextStyle, Ui, UiBuilder, vec2,
};

use super::menus;
use crate::context::activity::WorkShare;
use crate::context::command::{
    Command, FileCommand, FitCommand, HistoryCommand, TrackingCommand, WindowCommand,
};
use crate::context::command_button::{icon, preset_box, primary};
use crate::context::preferences::Layout;
use crate::context::{Context, Requests, ShellRequest};
use crate::features::Features;
use crate::features::fit::renderer;

/// Below this width the take's second line and the menus' labels fold.
const FOLD_MENUS: f32 = 1440.0;
/// Width of the layout switch.
const SWITCH: f32 = 318.0;
/// Height of the bar that says that something takes its time.
const BUSY: f32 = 2.0;

pub(crate) fn ui(ui: &mut Ui, context: &Context<'_>, features: &mut Features, requests: &mut Requests) {
    let palette = theme::palette(ui);
    let frame = Frame::NONE.fill(palette.raised).inner_margin(Margin::symmetric(8, 0));
    let panel = Panel::top("toolbar").exact_size(size::TOOLBAR).resizable(false).frame(frame);
    let response = panel.show(ui, |ui| {
        let rect = ui.max_rect();
        let width = rect.width();
        let (row, row_from_right) =
            (Direction::left_to_right(Align::Center), Direction::right_to_left(Align::Center));
        let menus_end = within(ui, rect, row, |ui| left(ui, context, requests, width));
        let right_side = within(ui, rect, row_from_right, |ui| {
            right(ui, context, features, requests, width);
            ui.min_rect()
        });
        // The name of the take has what is left, and the switch stands in the middle of the window or where they leave room.
        let mut room = rect.with_min_x(menus_end + space::ROW);
        room.max.x = (right_side.left() - SWITCH - 2.0 * space::ROW).max(room.min.x);
        let named = within(ui, room, row, |ui| {
            take(ui, context, width < FOLD_MENUS);
            ui.min_rect()
        });
        let aside = 0.5 * SWITCH + space::ROW;
        let centre = rect.center().x.max(named.right() + aside).min(right_side.left() - aside);
        let middle =
            egui::Rect::from_center_size(egui::pos2(centre, rect.center().y), vec2(SWITCH, size::BUTTON));
        ui.scope_builder(UiBuilder::new().max_rect(middle), |ui| {
            let mut layout = context.preferences.layout;
            if segmented(ui, &mut layout, &Layout::ALL).changed() {
                requests.request(ShellRequest::Layout(layout));
            }
        });
    });
    if context.busy.is_long() {
        let mut bar = response.response.rect;
        bar.set_top(bar.bottom() - BUSY);
        let palette = theme::palette(ui);
        let share = context.busy.share.map_or(1.0, WorkShare::value);
        bar.set_width(bar.width() * share.max(0.02));
        ui.painter().rect_filled(bar, 0.0, palette.accent);
    }
}

/// The menus and undo; says where they end.
fn left(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, width: f32) -> f32 {
    let folded = width < FOLD_MENUS;
    let bar = egui::MenuBar::new().ui(ui, |ui| {
        ui.spacing_mut().button_padding = vec2(8.0, 2.0);
        ui.spacing_mut().item_spacing.x = space::TILE_GAP;
        menus::ui(ui, context, requests, folded);
        ui.add_space(space::ROW);
        divider(ui);
        icon(ui, context, requests, Command::History(HistoryCommand::Undo), Icon::Undo);
        icon(ui, context, requests, Command::History(HistoryCommand::Redo), Icon::Redo);
        divider(ui);
        ui.cursor().left()
    });
    bar.inner
}

fn divider(ui: &mut Ui) {
    let (rect, _) = ui.allocate_exact_size(vec2(space::WIDGET + 1.0, size::BUTTON), Sense::hover());
    ui.painter().vline(rect.center().x, rect.y_range(), theme::palette(ui).hairline());
}

fn take(ui: &mut Ui, context: &Context<'_>, folded: bool) {
    let palette = theme::palette(ui);
    let Some(take) = &context.session.take else { return };
    let dirty = if context.is_unsaved() { " •" } else { "" };
    let project = context.project.map(|path| path.display().to_string());
    let hover = format!(
        "{}\n{}",
        project.unwrap_or_else(|| "Not saved to a project file yet".to_owned()),
        if context.is_unsaved() {
            "There is unsaved work; it is also kept for the next start."
        } else {
            "All work is saved."
        }
    );
    let name = RichText::new(format!("{}{dirty}", take.take().name())).color(palette.text);
    ui.add(Label::new(name).truncate()).on_hover_text(hover);
    if !folded {
        ui.add_space(space::ROW);
        let short = format::counted(take.cameras.len(), "camera");
        let text = format!("{short}, {} fps", format::number(take.take().frame_rate(), 0));
        fitting_label(ui, &[&text, &short], TextStyle::Body, palette.text3);
    }
}

fn right(ui: &mut Ui, context: &Context<'_>, features: &mut Features, requests: &mut Requests, width: f32) {
    ui.spacing_mut().item_spacing.x = space::ROW;
    find(ui, requests, width < size::FOLD_CHOICES);
    ui.add_space(space::ROW);
    if context.preferences.layout == Layout::Demonstrate && context.session.take.is_some() {
        // The laboratory has buttons of its own.
        if width >= size::FOLD_CHOICES {
            preset_box(ui, context, requests, 92.0);
            features.laboratory.lineup_box(ui);
        }
        return;
    }
    primary(ui, context, requests, likely_next(context));
    ui.add_space(space::ROW);
    icon(ui, context, requests, Command::Fit(FitCommand::Stop), Icon::Stop);
    icon(ui, context, requests, Command::Fit(FitCommand::Run), Icon::Run);
    icon(ui, context, requests, Command::Fit(FitCommand::Step), Icon::Step);
    icon(ui, context, requests, Command::Fit(FitCommand::StepBack), Icon::StepBack);
    if width >= size::FOLD_CHOICES && context.session.take.is_some() {
        ui.add_space(space::WIDGET);
        preset_box(ui, context, requests, 92.0);
        ui.add_space(space::ROW);
        renderer::kind_box(ui, context, requests, 100.0);
    }
}

/// The likely next act: stop what runs, else track on, else open something.
fn likely_next(context: &Context<'_>) -> Command {
    if context.busy.tracking || context.busy.fitting {
        Command::Fit(FitCommand::Stop)
    } else if context.session.take.is_some() {
        Command::Tracking(TrackingCommand::Forward)
    } else {
        Command::File(FileCommand::OpenTake)
    }
}

fn find(ui: &mut Ui, requests: &mut Requests, small: bool) {
    let palette = theme::palette(ui);
    let width = if small { 74.0 } else { 118.0 };
    let (rect, response) = ui.allocate_exact_size(vec2(width, size::BUTTON), Sense::click());
    let enabled = ui.is_enabled();
    let command = Command::Window(WindowCommand::Palette);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, enabled, command.text()));
    let fill = if response.hovered() { palette.hover } else { palette.field };
    ui.painter().rect(
        rect,
        f32::from(size::FIELD_RADIUS),
        fill,
        palette.hairline(),
        egui::StrokeKind::Inside,
    );
    let icon_rect = egui::Rect::from_center_size(rect.left_center() + vec2(14.0, 0.0), vec2(14.0, 14.0));
    Icon::Search.paint_scaled(ui.painter(), icon_rect, palette.text2, 0.85);
    let at = rect.left_center() + vec2(27.0, 0.0);
    paint_text(ui, at, egui::Align2::LEFT_CENTER, "Ctrl K", TextStyle::Small, palette.text3);
    if response.on_hover_text(command.tooltip()).clicked() {
        requests.run(command);
    }
}
