//! The numbers of the pixel under the pointer, on a card beside it. Holding H keeps the card while the pointer moves.

use backlit_ui::drawing::{JointId, Sample, ViewMode, decision};
use backlit_ui::style::format;
use backlit_ui::style::theme;
use backlit_ui::style::theme::data_colours::{CASING, JOINT};
use backlit_ui::style::theme::size;
use backlit_ui::widgets::{Grip, cased, two_words};
use egui::{Area, Id, Margin, Order, Pos2, Rect, TextStyle, Ui, Vec2, pos2, vec2};
use glam::DVec2;

use super::gutter::grip_name;
use super::picture_view::ShownPicture;
use super::{TileInput, overlays};

/// From the pixel to the card, across.
const DISTANCE: f32 = 26.0;
const ROW: f32 = 18.0;
/// Stretches of a limb's axis that the card keeps off.
const AXIS_POINTS: usize = 16;

/// Between the card's edge and its text.
const MARGIN: f32 = 12.0;

/// The card of one pixel.
pub(crate) struct HoverCard {
    pub(crate) pixel: [usize; 2],
    /// It is held by a key.
    pub(crate) is_frozen: bool,
    /// The view mode at that pixel.
    pub(crate) mode: ViewMode,
    /// What can be taken hold of there.
    pub(crate) grip: Option<Grip>,
    /// What the modifiers do is said nowhere else.
    pub(crate) has_keys: bool,
}

impl HoverCard {
    pub(super) fn show(&self, shown: &ShownPicture<'_>, id: Id, picture: Rect) {
        let (ui, pixel, input) = (shown.ui, self.pixel, shown.input);
        let Some(sample) = input.picture.sample(pixel[0], pixel[1]) else { return };
        let rows = self.grip_rows(input);
        let derivative = self.derivative_row(input);
        let at = shown.overlay.at(DVec2::new(pixel[0] as f64, pixel[1] as f64));
        let decided = input
            .steered
            .steps
            .and_then(|steps| decision(steps, pixel[1] * input.picture.size[0] + pixel[0]));
        let more = rows.len() + usize::from(derivative.is_some()) + usize::from(decided.is_some());
        let height = size::HOVER_CARD.y + more as f32 * ROW;
        let bounds = picture.intersect(ui.ctx().content_rect());
        let limb = self.limb_points(shown);
        let card = place(at, vec2(size::HOVER_CARD.x, height), bounds, &limb);
        let edge = if card.left() > at.x { card.left() } else { card.right() };
        let painter = ui.painter_at(picture);
        let leader = [at, pos2(edge, at.y.clamp(card.top(), card.bottom()))];
        for stroke in cased(1.0, JOINT) {
            painter.line_segment(leader, stroke);
        }
        painter.circle_filled(at, 2.5 + size::CASING, CASING);
        painter.circle_filled(at, 2.5, JOINT);

        let area = Area::new(id).order(Order::Tooltip).fixed_pos(card.min).interactable(false).fade_in(false);
        area.show(ui.ctx(), |ui| {
            let palette = theme::palette(ui);
            palette.raised_frame(size::BUTTON_RADIUS, Margin::same(MARGIN as i8 - 1)).show(ui, |ui| {
                ui.set_width(size::HOVER_CARD.x - 2.0 * MARGIN);
                ui.spacing_mut().item_spacing.y = 0.0;
                for (index, (label, value)) in rows.iter().enumerate() {
                    match index {
                        0 => title_row(ui, label, value),
                        _ => row(ui, label, value, TextStyle::Small),
                    }
                }
                let title = format!("Pixel {}, {}", pixel[0], pixel[1]);
                title_row(ui, &title, if self.is_frozen { "held" } else { "H holds" });
                pixel_rows(ui, input, &sample);
                if let Some(decided) = &decided {
                    row(ui, "Decided by", decided, TextStyle::Small);
                }
                if let Some((label, value)) = &derivative {
                    row(ui, label, value, TextStyle::Monospace);
                }
            });
        });
    }

    /// The limb that is held at the pixel.
    fn limb(&self) -> Option<usize> {
        match self.grip {
            Some(Grip::Limb(limb) | Grip::Joint(JointId::End(limb))) => Some(limb),
            _ => None,
        }
    }

    /// Points of the outline and the axis of the limb that the card tells of, on the screen.
    fn limb_points(&self, shown: &ShownPicture<'_>) -> Vec<Pos2> {
        let owner = || shown.input.picture.sample(self.pixel[0], self.pixel[1])?.owner;
        let limb = self.limb().or_else(owner).and_then(|limb| shown.input.marks.limbs.get(limb)?.as_ref());
        let Some(limb) = limb else { return Vec::new() };
        let [start, end] = limb.ends_px;
        let axis = (0..=AXIS_POINTS).map(|step| start.lerp(end, step as f64 / AXIS_POINTS as f64));
        axis.chain(limb.outline()).map(|px| shown.overlay.at(px)).collect()
    }

    /// What is under the pointer, what the modifiers do, and how well a joint is known.
    fn grip_rows(&self, input: &TileInput<'_>) -> Vec<(String, String)> {
        let mut rows = Vec::new();
        let Some(grip) = self.grip else { return rows };
        let joint = if let Grip::Joint(joint) = grip { Some(joint) } else { None };
        let limb = self.limb();
        let held = limb.and_then(|limb| overlays::held_words(input.held, input.body, limb));
        let known = input.marks.ellipses.joints.iter().find(|known| Some(known.joint) == joint);
        let drag = if joint.is_some() { "drag moves it" } else { "drag turns it" };
        rows.push((grip_name(input, grip), drag.to_owned()));
        rows.extend(held.map(|held| ("Held by".to_owned(), held)));
        let doubt = limb.and_then(|limb| overlays::doubt_words(input.doubts, input.body, limb));
        rows.extend(doubt.map(|doubt| ("Believed".to_owned(), doubt)));
        if let Some(known) = known {
            let [across, depth] = known.deviations_m.map(format::deviation);
            rows.push(("Across, 1σ".to_owned(), across));
            rows.push(("In depth, 1σ".to_owned(), depth));
        }
        if self.has_keys && matches!(grip, Grip::Joint(_) | Grip::Limb(_)) {
            rows.push(("Shift: depth".to_owned(), "Ctrl: twist".to_owned()));
        }
        rows
    }

    /// What the picture's own colour says at the pixel, where it is a derivative.
    fn derivative_row(&self, input: &TileInput<'_>) -> Option<(&'static str, String)> {
        let (picture, [x, y]) = (&input.picture, self.pixel);
        let (label, derivative, unit) = match self.mode {
            ViewMode::Gradient => ("Pull, grey", picture.gradient?, "m"),
            ViewMode::JacobianColumn => ("Change, grey", picture.jacobian?, input.settings.axis.unit()),
            _ => return None,
        };
        let value = *derivative.values.get(y * picture.size[0] + x)?;
        Some((label, format!("{} / {unit}", format::number(f64::from(value), 0))))
    }
}

fn pixel_rows(ui: &mut Ui, input: &TileInput<'_>, sample: &Sample) {
    let number = |value: Option<f32>, decimals: usize| {
        value.map_or(format::MISSING.to_owned(), |value| format::number(f64::from(value), decimals))
    };
    let data = match (sample.is_unknown, sample.is_shadow) {
        (true, true) => "shadow".to_owned(),
        (true, false) => "don’t know".to_owned(),
        (false, true) => format!("{}, shadow", number(sample.data, 0)),
        (false, false) => match sample.data {
            Some(data) if data < 0.5 => "0, subject".to_owned(),
            Some(data) if data > 254.5 => "255, background".to_owned(),
            data => number(data, 0),
        },
    };
    let owner = sample.owner.and_then(|owner| input.body.limbs().get(owner));
    let owner = owner.map_or(format::MISSING, |limb| limb.name.as_str());
    let depth = match sample.depth_m {
        Some(depth) => format!("{} m", format::number(f64::from(depth), 2)),
        None => format::MISSING.to_owned(),
    };
    let mono = TextStyle::Monospace;
    row(ui, "Data D", &data, mono.clone());
    row(ui, "Prediction Λ", &number(sample.prediction, 0), mono.clone());
    row(ui, "Residual D − Λ", &number(sample.residual, 0), mono.clone());
    row(ui, "Owner", owner, TextStyle::Small);
    row(ui, "d / r", &number(sample.distance_over_radius, 2), mono.clone());
    row(ui, "Distance", &depth, mono);
}

fn title_row(ui: &mut Ui, title: &str, hint: &str) {
    let palette = theme::palette(ui);
    let words = [(title, TextStyle::Body, palette.text), (hint, TextStyle::Small, palette.text3)];
    two_words(ui, ROW, title, words);
}

fn row(ui: &mut Ui, label: &str, value: &str, style: TextStyle) {
    let palette = theme::palette(ui);
    let words = [(label, TextStyle::Small, palette.text2), (value, style, palette.text)];
    two_words(ui, ROW, &format!("{label} {value}"), words);
}

/// The card's place within `bounds`, never under the pointer: beside the pixel, to the right and above it first, then left or
/// below, then beside the limb that is looked at; where it covers the fewest `points` of that limb.
fn place(at: Pos2, card: Vec2, bounds: Rect, points: &[Pos2]) -> Rect {
    let [left, right] =
        points.iter().fold([at.x; 2], |[left, right], point| [left.min(point.x), right.max(point.x)]);
    let beside = [
        at.x + DISTANCE,
        at.x - DISTANCE - card.x,
        right.max(at.x) + DISTANCE,
        left.min(at.x) - DISTANCE - card.x,
    ];
    let fits = |left: f32| left >= bounds.left() && left + card.x <= bounds.right();
    let lowest = (bounds.bottom() - card.y).max(bounds.top());
    let tops = [at.y - card.y, at.y].map(|top| top.clamp(bounds.top(), lowest));
    let places = beside.iter().filter(|left| fits(**left)).flat_map(|left| tops.map(|top| pos2(*left, top)));
    let places = places.map(|corner| Rect::from_min_size(corner, card));
    let covered = |place: &Rect| points.iter().filter(|point| place.contains(**point)).count();
    let narrow = Rect::from_min_size(pos2(beside[0], tops[0]), card);
    places.min_by_key(covered).unwrap_or(narrow)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_card_flips_at_edges_and_is_never_under_the_pointer() {
        let bounds = Rect::from_min_max(pos2(0.0, 0.0), pos2(500.0, 400.0));
        let at = pos2(100.0, 300.0);
        let card = place(at, size::HOVER_CARD, bounds, &[]);
        assert_eq!((card.left(), card.bottom()), (126.0, 300.0));
        for at in [pos2(480.0, 300.0), pos2(20.0, 20.0), pos2(490.0, 10.0), pos2(0.0, 399.0)] {
            let card = place(at, size::HOVER_CARD, bounds, &[]);
            assert!(bounds.contains_rect(card), "{at:?}: {card:?}");
            assert!(!card.expand(20.0).x_range().contains(at.x), "{at:?}: {card:?}");
        }
        let narrow = Rect::from_min_max(pos2(0.0, 0.0), pos2(220.0, 200.0));
        assert!(!place(pos2(110.0, 100.0), size::HOVER_CARD, narrow, &[]).contains(pos2(110.0, 100.0)));
    }

    #[test]
    fn the_card_does_not_cover_the_limb_that_it_tells_of() {
        let bounds = Rect::from_min_max(pos2(0.0, 0.0), pos2(700.0, 600.0));
        // A forearm that points up and to the right of the pointer, where the card would lie.
        let line = |to: Pos2| {
            (0..=20).map(|step| pos2(350.0, 300.0).lerp(to, step as f32 / 20.0)).collect::<Vec<_>>()
        };
        for to in [pos2(450.0, 200.0), pos2(450.0, 400.0), pos2(250.0, 400.0), pos2(250.0, 200.0)] {
            let points = line(to);
            let card = place(points[2], size::HOVER_CARD, bounds, &points);
            assert!(
                bounds.contains_rect(card) && points.iter().all(|point| !card.contains(*point)),
                "{to:?}: {card:?}"
            );
        }
    }
}
