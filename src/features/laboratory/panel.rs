//! The laboratory: several ways to fit, from one start, side by side. It has the whole centre of its layout.

mod caption;
mod column;
mod curves;
mod header;

use backlit_ui::style::theme;
use backlit_ui::style::theme::{size, space};
use egui::{
    CentralPanel, Frame, Rect, RichText, Role, Stroke, StrokeKind, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};

use super::comparison::PushKey;
use super::{Comparison, Laboratory, LaboratoryChoices, PushAxis};
use crate::context::{Context, Requests};

/// Below this height of the centre, type and distances are those of the other layouts.
const COMPACT_BELOW: f32 = 760.0;
/// The plot's share of the height, and its ends.
const PLOT_SHARE: f32 = 0.38;
const PLOT_HEIGHT: std::ops::RangeInclusive<f32> = 212.0..=350.0;
/// With little room the caption with its legend needs this height.
const COMPACT_PLOT_HEIGHT: f32 = 236.0;
/// The caption's share of the width; with little room it is wider, so that it is less high.
const CAPTION_SHARE: f32 = 0.35;
const COMPACT_CAPTION_SHARE: f32 = 0.42;

/// How things are laid out in the room that there is.
#[derive(Clone, Copy)]
struct Room {
    /// Little height: smaller type, less space.
    is_compact: bool,
    /// Around the page.
    margin: f32,
    /// Between cards.
    gap: f32,
}

impl Room {
    fn of(rect: Rect) -> Self {
        let is_compact = rect.height() < COMPACT_BELOW || rect.width() < 1200.0;
        if is_compact {
            Self { is_compact, margin: space::GROUP, gap: space::WIDGET }
        } else {
            Self { is_compact, margin: space::PAGE_MARGIN, gap: space::GUTTER_MARGIN }
        }
    }
}

/// What all parts of the page look at.
#[derive(Clone, Copy)]
struct Bench<'a> {
    context: &'a Context<'a>,
    laboratory: &'a Laboratory,
    comparison: &'a Comparison,
    /// What is pushed, as words.
    limb: &'a str,
    axis: PushAxis,
    key: PushKey,
    room: Room,
}

impl Laboratory {
    pub(crate) fn ui(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let room = Room::of(ui.available_rect_before_wrap());
        let mut choices = self.choices;
        header::ui(ui, context, &mut choices, requests, room.margin);
        let frame = Frame::NONE.fill(theme::palette(ui).well);
        let shown = CentralPanel::default().frame(frame).show(ui, |ui| {
            let Some(comparison) = self.begun() else {
                waiting(ui, context);
                return None;
            };
            let model = &context.document().model;
            let key = self.push_key(context);
            let (_, axis, limb) = key;
            let limb = &model.limbs()[limb].name;
            let bench = Bench { context, laboratory: self, comparison, limb, axis, key, room };
            page(ui, &bench, &mut choices, requests)
        });
        if let Some((step, comparison)) = shown.inner.zip(self.comparison.as_mut()) {
            comparison.go_to(step);
        }
        self.choices = choices;
    }

    /// The box of what is compared.
    pub(crate) fn lineup_box(&mut self, ui: &mut Ui) {
        header::lineup_box(ui, &mut self.choices.lineup);
    }
}

/// Everything below the header; the step that is to be looked at.
fn page(
    ui: &mut Ui,
    bench: &Bench<'_>,
    choices: &mut LaboratoryChoices,
    requests: &mut Requests,
) -> Option<usize> {
    let (rect, Room { margin, gap, is_compact }) = (ui.max_rect(), bench.room);
    let top_gap = margin.min(16.0);
    let inner = Rect::from_min_max(
        pos2(rect.left() + margin, rect.top() + top_gap),
        pos2(rect.right() - margin, rect.bottom() - margin.min(20.0)),
    );
    let plot_height = (PLOT_SHARE * inner.height()).clamp(*PLOT_HEIGHT.start(), *PLOT_HEIGHT.end());
    let plot_height = if is_compact { plot_height.max(COMPACT_PLOT_HEIGHT) } else { plot_height };
    let (above, below) = inner.split_top_bottom_at_y(inner.bottom() - plot_height);
    let above = above.with_max_y(above.bottom() - gap);
    let fits = bench.comparison.contestants.len();
    let count = fits.max(1) as f32;
    let width = (above.width() - gap * (count - 1.0)) / count;
    for index in 0..fits {
        let left = above.left() + (width + gap) * index as f32;
        let column = Rect::from_min_size(pos2(left, above.top()), vec2(width, above.height()));
        card(ui, column);
        inside(ui, column, ("column", index), |ui| column::ui(ui, bench, index, choices));
    }
    let share = if is_compact { COMPACT_CAPTION_SHARE } else { CAPTION_SHARE };
    let caption_width = (share * below.width()).max(330.0);
    let (plot, caption) = below.split_left_right_at_x(below.right() - caption_width - gap);
    let caption = caption.with_min_x(caption.left() + gap);
    card(ui, plot);
    let step =
        inside(ui, plot.shrink2(vec2(14.0, 8.0)), "plot", |ui| curves::ui(ui, bench, choices, requests));
    card(ui, caption);
    let margin = if is_compact { vec2(14.0, 8.0) } else { vec2(18.0, 12.0) };
    inside(ui, caption.shrink2(margin), "caption", |ui| caption::ui(ui, bench, choices));
    step
}

/// The ground of a part of the page.
fn card(ui: &Ui, rect: Rect) {
    let palette = theme::palette(ui);
    let stroke: Stroke = palette.hairline();
    ui.painter().rect(rect, f32::from(size::WINDOW_RADIUS), palette.raised, stroke, StrokeKind::Inside);
}

fn inside<R>(ui: &mut Ui, rect: Rect, salt: impl egui::AsIdSalt, add: impl FnOnce(&mut Ui) -> R) -> R {
    let builder = UiBuilder::new().max_rect(rect).id_salt(salt);
    let inside = ui.scope_builder(builder, |ui| {
        ui.set_clip_rect(rect.expand(2.0).intersect(ui.clip_rect()));
        add(ui)
    });
    inside.inner
}

/// Before there is anything to show.
fn waiting(ui: &mut Ui, context: &Context<'_>) {
    let rect = ui.max_rect();
    let frame = context.session.frames.get(context.selection.frame);
    let has_mask = frame.map(|frame| frame.cameras.iter().any(|camera| camera.mask.is_some()));
    let text = match has_mask {
        None if context.busy.load_broke => "This frame cannot be read: Help › Messages says why",
        None => "Reading the frame…",
        Some(false) => "This frame has no silhouette yet: choose another in the Pose layout",
        Some(true) => "Preparing the fits…",
    };
    let palette = theme::palette(ui);
    let label = RichText::new(text).text_style(theme::title()).color(palette.text2);
    ui.put(Rect::from_center_size(rect.center(), vec2(rect.width(), 40.0)), egui::Label::new(label));
}

/// Names a thing that is painted, for screen readers and tests.
fn named(response: &egui::Response, role: Role, text: &str) {
    response.widget_info(|| WidgetInfo::labeled(role, true, text));
}
