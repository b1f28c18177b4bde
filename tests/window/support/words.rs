//! The words that a window paints, and what is wrong with where they stand: cut off, shortened, or over one another.

use egui::epaint::{ClippedShape, RectShape, TextShape};
use egui::{Color32, Rect, Shape};

/// Ink may leave its clip, or lie on other ink, by this many points.
const SLACK: f32 = 1.5;
/// A ground that is at least this opaque hides what is under it.
const HIDES: u8 = 190;

/// Words on the screen.
#[derive(Debug, Clone)]
struct Words {
    text: String,
    /// The ink.
    ink: Rect,
    clip: Rect,
    is_shortened: bool,
}

/// What is painted, in its order.
#[derive(Debug, Clone)]
enum Painted {
    Words(Words),
    /// It hides what was painted before.
    Ground(Rect),
}

fn collect(shape: &Shape, clip: Rect, painted: &mut Vec<Painted>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, clip, painted)),
        Shape::Text(text) => painted.extend(words(text, clip).map(Painted::Words)),
        Shape::Rect(RectShape { rect, fill, .. }) if fill.a() >= HIDES => {
            painted.push(Painted::Ground(rect.intersect(clip)));
        }
        Shape::Circle(circle) if circle.fill.a() >= HIDES => {
            let half = circle.radius * std::f32::consts::FRAC_1_SQRT_2;
            let inside = Rect::from_center_size(circle.center, egui::Vec2::splat(2.0 * half));
            painted.push(Painted::Ground(inside.intersect(clip)));
        }
        Shape::Mesh(mesh) if mesh.vertices.len() == 4 && mesh.vertices[0].color == Color32::WHITE => {
            painted.push(Painted::Ground(mesh.calc_bounds().intersect(clip)));
        }
        _ => {}
    }
}

fn words(shape: &TextShape, clip: Rect) -> Option<Words> {
    let text = shape.galley.text().trim().to_owned();
    let ink = shape.galley.mesh_bounds.translate(shape.pos.to_vec2());
    let is_seen = shape.opacity_factor > 0.05 && shape.angle == 0.0;
    let colour = shape.override_text_color.unwrap_or(Color32::WHITE);
    (is_seen && colour.a() > 0 && !text.is_empty() && ink.is_positive()).then(|| Words {
        text,
        ink,
        clip,
        is_shortened: shape.galley.elided,
    })
}

/// A sentence for each of the words that cannot be read. Words that scroll out of a pane are cut along the pane's edge:
/// `scrolls` says of which panes, by their clip, that is right.
pub(crate) fn unreadable(
    shapes: &[ClippedShape],
    window: Rect,
    scrolls: impl Fn(Rect) -> bool,
) -> Vec<String> {
    let mut painted = Vec::new();
    for shape in shapes {
        collect(&shape.shape, shape.clip_rect.intersect(window), &mut painted);
    }
    let mut wrong = Vec::new();
    for (at, first) in painted.iter().enumerate() {
        let Painted::Words(first) = first else { continue };
        let seen = first.ink.intersect(first.clip);
        if !seen.is_positive() {
            continue;
        }
        let hidden =
            |by: &Painted| matches!(by, Painted::Ground(ground) if ground.contains_rect(seen.shrink(SLACK)));
        if painted[at + 1..].iter().any(hidden) {
            continue;
        }
        if first.is_shortened {
            wrong.push(format!("{:?} is shortened at {}", first.text, first.ink));
        }
        let cut = first.ink.shrink(SLACK);
        let is_cut_across = cut.left() < first.clip.left() || cut.right() > first.clip.right();
        let is_cut_along = cut.top() < first.clip.top() || cut.bottom() > first.clip.bottom();
        if is_cut_across || (is_cut_along && !scrolls(first.clip)) {
            wrong.push(format!("{:?} at {} is cut off by {}", first.text, first.ink, first.clip));
        }
        for (later, second) in painted.iter().enumerate().skip(at + 1) {
            let Painted::Words(second) = second else { continue };
            let both = seen.intersect(second.ink.intersect(second.clip)).shrink(SLACK);
            if !both.is_positive() {
                continue;
            }
            let lies_between = |ground: &Painted| matches!(ground, Painted::Ground(rect) if rect.expand(SLACK).contains_rect(both));
            if !painted[at + 1..later].iter().any(lies_between) {
                wrong.push(format!("{:?} lies over {:?} at {both}", second.text, first.text));
            }
        }
        // A ground that hides a part of the words alone cuts them too.
        for ground in &painted[at + 1..] {
            let Painted::Ground(ground) = ground else { continue };
            let both = ground.intersect(seen);
            if both.width() > 2.0 * SLACK
                && both.height() > 2.0 * SLACK
                && !ground.contains_rect(seen.shrink(SLACK))
            {
                wrong.push(format!("{:?} at {} is covered by {}", first.text, first.ink, both));
            }
        }
    }
    wrong
}
