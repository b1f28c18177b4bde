//! The Motions pane: the plane of motions, and the probabilities of the frame on the screen.

pub(super) mod plane;

use backlit_recognition::Method;
use backlit_ui::style::theme::{motion_colours, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{choice, segmented};
use egui::{Align2, Button, Id, Rect, Role, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};

use super::job::{Missing, RecognisedMotions};
use super::{Motions, Plane, words};
use crate::context::command::{Command, TrackingCommand};
use crate::context::command_button as command;
use crate::context::marks::whole_percent;
use crate::context::pane::{HEADER_BUTTONS, Pane};
use crate::context::{Context, Requests, SessionRequest, pane_title};

/// A pane narrower than this has two rows above the plane.
const ONE_ROW: f32 = 500.0;
const METHODS: f32 = 110.0;
/// The plane is not made lower than this for the probabilities' sake.
const LEAST_PLANE: f32 = 110.0;
/// Height of the line that says what the frame is.
const TITLE: f32 = 20.0;
const ROW: f32 = 17.0;
/// Width of the longest name and of a percentage.
const NAME: f32 = 112.0;
const PERCENT: f32 = 50.0;
/// From this width on there are two columns.
const TWO_COLUMNS: f32 = 430.0;
/// Side of the mark of a colour.
const SWATCH: f32 = 9.0;

impl Motions {
    /// The name and what can be chosen: in one row, or in two where the pane is a narrow column.
    pub(super) fn head(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        siblings: &[Pane],
        requests: &mut Requests,
    ) {
        let is_narrow = ui.available_width() < ONE_ROW;
        pane_title::row(ui, |ui| {
            pane_title::show(ui, Pane::Motions, siblings, requests);
            ui.add_space(space::ROW);
            if !is_narrow {
                self.choices(ui);
            }
            self.models(ui, context, requests);
            ui.add_space(HEADER_BUTTONS);
        });
        if is_narrow {
            ui.horizontal_wrapped(|ui| self.choices(ui));
        }
    }

    fn choices(&mut self, ui: &mut Ui) {
        let planes = [Plane::Apart, Plane::Principal].map(|plane| (plane, words::plane(plane).0));
        let tooltip = words::plane(self.preferences.plane).1;
        segmented(ui, &mut self.preferences.plane, &planes).on_hover_text(tooltip);
        let is_there = |method: &Method| match &self.found {
            Some(found) => found.recognizer.methods().any(|other| other == *method),
            None => *method != Method::Nearest,
        };
        let methods =
            [Method::Combined, Method::Hmm, Method::Svm, Method::Nearest].into_iter().filter(is_there);
        let rows: Vec<_> = methods
            .map(|method| {
                let (text, tooltip) = words::method(method);
                (method, text, tooltip.to_owned())
            })
            .collect();
        let chosen = self.found.as_ref().map_or(self.preferences.method, |found| found.method);
        if let Some(method) = choice(ui, "Method", METHODS, words::method(chosen).0, &rows) {
            self.preferences.method = method;
        }
    }

    fn models(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let name = self.model.as_ref().and_then(|path| path.file_name());
        let name = name.map(|name| name.to_string_lossy().into_owned());
        let menu = ui.menu_button("Model", |ui| {
            if ui.add_enabled(self.model.is_some(), Button::new("Built-in model")).clicked() {
                self.model = None;
                ui.close();
            }
            if ui.add(Button::new("Open model…")).clicked() {
                self.ask_for_model(context, requests);
                ui.close();
            }
        });
        let name =
            name.as_deref().unwrap_or("the built-in one, learnt from 72 recordings of seven kinds of motion");
        menu.response.on_hover_text(format!(
            "What was learnt: {name}. `backlit recognise --train` makes one of recordings of yours"
        ));
    }

    /// The plane, and below it the probabilities.
    pub(super) fn shown(
        &self,
        ui: &mut Ui,
        found: &RecognisedMotions,
        context: &Context<'_>,
        requests: &mut Requests,
    ) {
        let area = ui.available_rect_before_wrap().shrink2(vec2(0.0, space::ROW));
        let wanted = shares_height(found, area.width());
        let room = if area.height() >= LEAST_PLANE + wanted { wanted } else { TITLE };
        let [above, below] =
            [area.top()..=area.bottom() - room - space::ROW, area.bottom() - room..=area.bottom()];
        let plane = Rect::from_x_y_ranges(area.x_range(), above);
        if let Some(frame) = plane::ui(ui, plane, self, context)
            && frame != context.selection.frame
        {
            requests.request(SessionRequest::Frame(frame));
        }
        shares(ui, Rect::from_x_y_ranges(area.x_range(), below), found, context.selection.frame);
        ui.advance_cursor_after_rect(area);
    }

    /// What is missing, and a button for it.
    pub(super) fn nothing(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let area = ui.available_rect_before_wrap();
        let text = match &self.missing {
            _ if context.session.take.is_none() => {
                "Open a take first: its tracked motion gets names here.".to_owned()
            }
            _ if context.busy.tracking => "The tracker is at work. Names come when it has ended.".to_owned(),
            Some(missing) => words::missing(missing),
            None => "Naming the tracked motion…".to_owned(),
        };
        pane_title::in_the_middle(ui, 380.0, &text, |ui| {
            let is_idle = context.session.take.is_some() && !context.busy.tracking;
            match &self.missing {
                Some(Missing::Track | Missing::Short { .. }) if is_idle => {
                    command::button(ui, context, requests, Command::Tracking(TrackingCommand::Forward));
                }
                Some(Missing::Model(_)) if ui.add(Button::new("Built-in model")).clicked() => {
                    self.model = None;
                }
                _ => {}
            }
        });
        ui.advance_cursor_after_rect(area);
    }
}

fn columns(width: f32) -> usize {
    if width >= TWO_COLUMNS { 2 } else { 1 }
}

/// The room that all rows want.
fn shares_height(found: &RecognisedMotions, width: f32) -> f32 {
    TITLE + ROW * found.names.len().div_ceil(columns(width)) as f32
}

/// What the frame is, and as many rows as there is room for.
fn shares(ui: &Ui, area: Rect, found: &RecognisedMotions, frame: usize) {
    let palette = theme::palette(ui);
    let painter = ui.painter().with_clip_rect(area);
    let [body, small] = [TextStyle::Body, TextStyle::Small].map(|style| style.resolve(ui.style()));
    let mono = TextStyle::Monospace.resolve(ui.style());
    let number = format::count(frame as i64);
    let named = found.frame(frame);
    let title = match named {
        None => format!("Frame {number} has no name: it is not tracked, or in a piece that is too short."),
        Some(named) => {
            let nearest = match named.class {
                Some(_) => String::new(),
                None => format!(". Nearest is {}", found.likeliest(named)),
            };
            let sure = whole_percent(named.confidence);
            format!("Frame {number}: {}{nearest}, {sure}", found.name(named.class))
        }
    };
    let swatch =
        Rect::from_center_size(pos2(area.left() + 6.0, area.top() + 0.5 * TITLE), vec2(SWATCH, SWATCH));
    let mut left = area.left();
    if let Some(named) = named {
        painter.rect_filled(swatch, 2.0, motion_colours(named.class).fill);
        left = swatch.right() + space::ROW + 2.0;
    }
    painter.text(pos2(left, swatch.center().y), Align2::LEFT_CENTER, &title, body, palette.text);
    let place = Rect::from_min_size(area.min, vec2(area.width(), TITLE));
    let said = ui.interact(place, Id::unique("frame's motion"), Sense::hover());
    said.widget_info(|| WidgetInfo::labeled(Role::Label, true, &title));
    let (Some(named), columns) = (named, columns(area.width())) else { return };
    let rows = found.names.len().div_ceil(columns);
    let width = (area.width() - space::GROUP * (columns - 1) as f32) / columns as f32;
    for (class, (name, share)) in found.names.iter().zip(&named.shares).enumerate() {
        let corner =
            vec2((width + space::GROUP) * (class / rows) as f32, TITLE + ROW * (class % rows) as f32);
        let row = Rect::from_min_size(area.min + corner, vec2(width, ROW));
        if row.bottom() > area.bottom() + 0.5 {
            continue;
        }
        let y = row.center().y;
        painter.text(pos2(row.left(), y), Align2::LEFT_CENTER, name, small.clone(), palette.text2);
        let text = whole_percent(*share);
        painter.text(pos2(row.right(), y), Align2::RIGHT_CENTER, text, mono.clone(), palette.text);
        let across = row.left() + NAME..=(row.right() - PERCENT).max(row.left() + NAME);
        let bar = Rect::from_x_y_ranges(across, y - 4.0..=y + 4.0);
        painter.rect_filled(bar, 2.0, palette.field);
        let part = Rect::from_min_size(bar.min, vec2(bar.width() * *share as f32, bar.height()));
        painter.rect_filled(part, 2.0, motion_colours(Some(class)).fill);
        let said = ui.interact(row, Id::unique(("motion's share", class)), Sense::hover());
        said.widget_info(|| {
            WidgetInfo::labeled(Role::Label, true, format!("{name}: {}", whole_percent(*share)))
        });
    }
}
