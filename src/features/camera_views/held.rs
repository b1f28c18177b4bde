//! What held limbs that silhouettes did not: their outlines in a colour, and words for it.

use backlit_tracking::body::Model;
use backlit_tracking::cues::{Cue, LimbHold};
use backlit_ui::drawing::{ProjectedLimb, joined_outline};
use backlit_ui::style::theme::data_colours::{CASING, HELD_BY_CUE, UNSURE, mark};
use backlit_ui::style::theme::size;
use backlit_ui::widgets::ViewTransform;
use egui::{Color32, Painter, Pos2, Shape, Stroke};

use super::picture_view::turning_with;
use super::pointer::rotation_owner;

/// Dash and gap of a limb that nothing holds, points.
const DASH: [f32; 2] = [5.0, 4.0];

/// What the outlines mean, for the legend: those that are to be seen.
pub(crate) fn legend(held: &[LimbHold]) -> impl Iterator<Item = (&'static str, Color32)> {
    let by_cue = held.iter().any(|hold| !hold.by_silhouettes && !hold.is_unsure());
    let unsure = held.iter().any(LimbHold::is_unsure);
    let entries = [("Held by a cue", HELD_BY_CUE, by_cue), ("Unsure: nothing holds it", UNSURE, unsure)];
    entries.into_iter().filter(|entry| entry.2).map(|(text, colour, _)| (text, colour))
}

/// What held the part that a limb belongs to, in words.
pub(crate) fn words(held: &[LimbHold], body: &Model, limb: usize) -> Option<String> {
    let owner = rotation_owner(body, limb);
    let hold = held.iter().find(|hold| hold.limb == owner)?;
    if hold.is_unsure() {
        return Some("nothing: unsure".to_owned());
    }
    let cues = hold.cues.iter().map(|cue| Cue::name(*cue));
    let words: Vec<&str> = hold.by_silhouettes.then_some("silhouettes").into_iter().chain(cues).collect();
    Some(words.join(", "))
}

/// Outlines the parts that silhouettes did not hold.
pub(crate) fn paint(
    painter: &Painter,
    view: &ViewTransform,
    held: &[LimbHold],
    body: &Model,
    limbs: &[Option<ProjectedLimb>],
) {
    for hold in held.iter().filter(|hold| !hold.by_silhouettes) {
        for line in joined_outline(&turning_with(body, limbs, hold.limb)) {
            let line: Vec<Pos2> = line.into_iter().map(|px| view.screen_from_px(px)).collect();
            let width = mark::SELECTED_LIMB_WIDTH;
            painter.add(Shape::line(line.clone(), Stroke::new(width + 2.0 * size::CASING, CASING)));
            if hold.is_unsure() {
                painter.extend(Shape::dashed_line(&line, Stroke::new(width, UNSURE), DASH[0], DASH[1]));
            } else {
                painter.add(Shape::line(line, Stroke::new(width, HELD_BY_CUE)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    fn hold(limb: usize, by_silhouettes: bool, cues: &[Cue]) -> LimbHold {
        LimbHold { limb, cameras: 0, by_silhouettes, cues: cues.to_vec() }
    }

    #[test]
    fn a_limb_that_nothing_holds_is_said_to_be_unsure() {
        let body = builtin::full_body();
        let limb = |name: &str| body.limb_index(name).unwrap();
        let [upper, fore, thigh] = ["left upper arm", "left forearm", "left thigh"].map(limb);
        let held = [
            hold(upper, true, &[Cue::Keypoints]),
            hold(fore, false, &[]),
            hold(thigh, false, &[Cue::Flow, Cue::Stereo]),
        ];
        assert_eq!(words(&held, &body, upper).unwrap(), "silhouettes, keypoints");
        assert_eq!(words(&held, &body, fore).unwrap(), "nothing: unsure");
        assert_eq!(words(&held, &body, thigh).unwrap(), "flow, stereo");
        // The lower half of a thigh turns with the upper one.
        assert_eq!(words(&held, &body, limb("left lower thigh")).unwrap(), "flow, stereo");
        assert_eq!(words(&held, &body, limb("right forearm")), None);
        assert_eq!(legend(&held).count(), 2);
        assert_eq!(legend(&held[..1]).count(), 0, "silhouettes need no legend");
    }
}
