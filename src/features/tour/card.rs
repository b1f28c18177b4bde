//! The cards of the tour: each beside what it is about, with an arrow to it, and never over it.

use backlit_ui::style::theme;
use backlit_ui::style::theme::{Palette, size, space};
use backlit_ui::widgets::{primary_button, text_button};
use egui::{
    Align, Area, Id, Layout as Direction, Margin, Order, Pos2, Rect, RichText, Role, Sense, Shape, Stroke,
    Ui, Vec2, WidgetInfo, pos2, vec2,
};

/// What the cards say: what is to be done, and what is to be seen.
pub(super) const STEPS: [(&str, &str); 7] = [
    (
        "Orange is subject the body misses, blue is body without subject",
        "The bar of camera 1 counts the pixels of both, and those that agree.",
    ),
    (
        "Drag the right wrist onto the arm",
        "The arm follows; the ray in the other views shows where the point can be.",
    ),
    (
        "Fix the depth in another view",
        "Drag the wrist along the ray in camera {camera}: only another view tells how far it is.",
    ),
    ("Press Space", "One step of the fit; watch orange and blue shrink."),
    (
        "Press Enter, then drag the step slider back",
        "This is the Debug layout. Every step is kept, the rejected ones too.",
    ),
    (
        "Press C, Y and S",
        "Capsules, cylinders, spheres: the same pose by another renderer. The next run gets a colour of its own.",
    ),
    ("Track forward", "Press Ctrl+Enter. Stop when you like, with Esc; N jumps to the worst frame."),
];

const WIDTH: f32 = 316.0;
/// What is pointed at, and this much around it, stays free.
const CLEAR: f32 = 14.0;
/// A joint is to be dragged: this much around it stays free.
const CLEAR_JOINT: f32 = 84.0;
/// From the clear space to the card.
const GAP: f32 = 26.0;
/// To the edges of the window.
const EDGE: f32 = 12.0;

/// What was asked for on a card.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CardAnswer {
    Begin,
    Skip,
    Back,
    Next,
}

/// The offer at the first start, above `bottom`.
pub(super) fn offer(ui: &Ui, bottom: f32) -> Option<CardAnswer> {
    let mut event = None;
    let window = ui.ctx().content_rect();
    let area = Area::new(Id::unique("tour offer")).order(Order::Foreground).pivot(egui::Align2::LEFT_BOTTOM);
    let corner = pos2(window.left() + EDGE, bottom - EDGE);
    area.fixed_pos(corner).show(ui.ctx(), |ui| {
        framed(ui, "Offer of the tour", |ui, palette| {
            ui.label(RichText::new("New here?").heading().color(palette.text));
            let text = "Seven short steps on the built-in take show what can be seen and done. You do them yourself.";
            ui.label(RichText::new(text).color(palette.text2));
            ui.add_space(space::ROW);
            ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
                if primary_button(ui, "Take the tour").clicked() {
                    event = Some(CardAnswer::Begin);
                }
                if text_button(ui, "Not now").on_hover_text("Help › Tour begins it at any time").clicked() {
                    event = Some(CardAnswer::Skip);
                }
            });
        });
    });
    event
}

/// The card of a step, counted from zero: what it points at, and the camera that it is about, counted from one.
pub(super) fn card(
    ui: &Ui,
    step: usize,
    (target, camera): (Option<Rect>, usize),
    can_go_on: bool,
) -> Option<CardAnswer> {
    let mut event = None;
    let ctx = ui.ctx();
    let id = Id::unique("tour card");
    let window = ctx.content_rect().shrink(EDGE);
    let before = ctx.memory(|memory| memory.area_rect(id)).filter(|rect| rect.width() > WIDTH);
    let size = before.map_or(vec2(WIDTH + 24.0, 130.0), |rect| rect.size());
    let clear = if matches!(step, 1 | 2) { CLEAR_JOINT } else { CLEAR };
    let place = place(window, target.map(|target| target.expand(clear)), size);
    let area = Area::new(id).order(Order::Foreground).constrain(false).fixed_pos(place.min);
    let shown = area.show(ctx, |ui| {
        let name = format!("Tour, step {} of {}", step + 1, STEPS.len());
        framed(ui, &name, |ui, palette| {
            let (title, text) = STEPS[step.min(STEPS.len() - 1)];
            ui.label(RichText::new(title).heading().color(palette.text));
            let text = text.replace("{camera}", &camera.to_string());
            ui.label(RichText::new(text).color(palette.text2));
            ui.add_space(space::ROW);
            ui.horizontal(|ui| {
                let count = format!("{} of {}", step + 1, STEPS.len());
                ui.label(RichText::new(count).monospace().color(palette.text3));
                ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
                    if can_go_on && primary_button(ui, "Next").clicked() {
                        event = Some(CardAnswer::Next);
                    }
                    let back =
                        |ui: &mut Ui| text_button(ui, "Back").on_hover_text("To the step before").clicked();
                    if ui.add_enabled_ui(step > 0, back).inner {
                        event = Some(CardAnswer::Back);
                    }
                    if text_button(ui, "Skip")
                        .on_hover_text("End the tour; Help › Tour begins it again")
                        .clicked()
                    {
                        event = Some(CardAnswer::Skip);
                    }
                });
            });
        });
    });
    if let Some(target) = target {
        let painter = ctx.layer_painter(shown.response.layer_id);
        let palette = theme::palette(ui);
        painter.extend(arrow(shown.response.rect, target, palette));
    }
    event
}

fn framed(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui, &Palette)) {
    let palette = theme::palette(ui);
    let shown = palette.raised_frame(size::WINDOW_RADIUS, Margin::same(12)).show(ui, |ui| {
        ui.set_width(WIDTH);
        add(ui, palette);
    });
    let node = ui.interact(shown.response.rect, ui.scope_id().with("card"), Sense::hover());
    node.widget_info(|| WidgetInfo::labeled(Role::Group, true, name));
}

/// Where a card lies: inside the window and beside what it points at, on the side where it comes nearest to that
/// without lying on it; below in the middle where there is nothing to point at.
fn place(window: Rect, target: Option<Rect>, size: Vec2) -> Rect {
    let lowest = pos2(window.center().x - size.x / 2.0, window.bottom() - size.y - 180.0);
    let Some(target) = target else { return Rect::from_min_size(lowest, size) };
    let inside = |corner: Pos2| {
        let most = (window.max - size).max(window.min);
        Rect::from_min_size(corner.clamp(window.min, most), size)
    };
    let centre = target.center() - size / 2.0;
    let candidates = [
        inside(pos2(target.right() + GAP, centre.y)),
        inside(pos2(target.left() - GAP - size.x, centre.y)),
        inside(pos2(centre.x, target.bottom() + GAP)),
        inside(pos2(centre.x, target.top() - GAP - size.y)),
    ];
    let free = candidates.into_iter().filter(|card| !card.intersects(target));
    let distance = |card: &Rect| card.center().distance(target.center());
    free.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or_else(|| {
        // A very large thing: whichever corner of the window is farthest from its middle.
        let corners = [window.left_top(), window.right_top(), window.left_bottom(), window.right_bottom()];
        let far = corners.into_iter().map(inside).max_by(|a, b| distance(a).total_cmp(&distance(b)));
        far.unwrap_or(Rect::from_min_size(lowest, size))
    })
}

/// An arrow from a card to what it is about, with a casing so that it is seen on everything.
fn arrow(card: Rect, target: Rect, palette: &Palette) -> Vec<Shape> {
    let from = target.center().clamp(card.min, card.max);
    let end = from.clamp(target.min, target.max);
    let way = end - from;
    if way.length() < 12.0 {
        return Vec::new();
    }
    let along = way.normalized();
    let end = end - along * 3.0;
    let across = along.rot90();
    let head = |back: f32, half: f32| {
        vec![end, end - along * back + across * half, end - along * back - across * half]
    };
    let neck = end - along * 9.0;
    vec![
        Shape::line_segment([from, neck], Stroke::new(4.5, palette.raised)),
        Shape::convex_polygon(head(14.0, 8.5), palette.raised, Stroke::new(2.0, palette.raised)),
        Shape::line_segment([from, neck], Stroke::new(1.75, palette.text)),
        Shape::convex_polygon(head(11.0, 5.5), palette.text, Stroke::NONE),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_card_lies_beside_what_it_is_about_wherever_that_is() {
        let window = Rect::from_min_size(pos2(0.0, 0.0), vec2(1100.0, 700.0)).shrink(EDGE);
        let size = vec2(340.0, 130.0);
        for x in (20..1080).step_by(40) {
            for y in (20..680).step_by(40) {
                let target = Rect::from_center_size(pos2(x as f32, y as f32), vec2(22.0, 22.0));
                let clear = target.expand(CLEAR_JOINT);
                let card = place(window, Some(clear), size);
                assert!(!card.intersects(clear), "{target} {card}");
                assert!(window.contains_rect(card), "{target} {card}");
            }
        }
        let everything = place(window, Some(window), size);
        assert!(window.contains_rect(everything));
    }
}
