//! Linked zoom and pan: other cameras' views go along by the point of the world that the pointer is on.
//!
//! A zoom keeps a pixel in place. The point of the body that this pixel shows, or one as far away as the body, is
//! kept in place in the other views too, and they are magnified by the same factor. A pan moves the others by as much
//! as their pictures of the world's point in the middle move: along their own optical axis, that is nothing.

use backlit_tracking::camera::Camera;
use backlit_ui::drawing::point_at;
use backlit_ui::widgets::ViewTransform;
use glam::{DVec2, DVec3};

/// A smaller relative change of magnification is a pan.
const SAME_SCALE: f32 = 1e-4;

/// The view of camera `into` after the view of camera `from` has changed from `before` to `after`. `depth` gives how far
/// away from `from` a pixel's point is, along the optical axis.
pub(crate) fn follow(
    before: &ViewTransform,
    after: &ViewTransform,
    from: &Camera,
    depth: impl Fn(DVec2) -> f64,
    into: &Camera,
    view: &ViewTransform,
) -> ViewTransform {
    let ratio = after.points_per_px / before.points_per_px;
    let centre = |view: &ViewTransform| DVec2::new(view.centre_px.x.into(), view.centre_px.y.into());
    let seen = |point: Option<DVec3>| point.and_then(|point| into.project(point)).filter(|px| px.is_finite());
    if (ratio - 1.0).abs() < SAME_SCALE {
        let (was, is) = (centre(before), centre(after));
        let depth = depth(was);
        let moved = seen(point_at(from, was, depth)).zip(seen(point_at(from, is, depth)));
        return moved.map_or(*view, |(was, is)| {
            let by = (is - was) * f64::from(view.points_per_px);
            view.panned(egui::vec2(-by.x as f32, -by.y as f32))
        });
    }
    let share = f64::from(ratio);
    let fixed = (centre(after) * share - centre(before)) / (share - 1.0);
    let at =
        seen(point_at(from, fixed, depth(fixed))).map_or(view.rect.center(), |px| view.screen_from_px(px));
    view.zoomed_at(at, ratio)
}

#[cfg(test)]
mod tests {
    use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};
    use egui::{Rect, pos2, vec2};

    use super::*;

    fn camera(centre: DVec3, focal: f64) -> Camera {
        let intrinsics = Intrinsics { fx: focal, fy: focal, cx: 160.0, cy: 120.0 };
        let place = CameraFromWorld::looking_at(centre, DVec3::Z, DVec3::Z);
        Camera::new("camera", [320, 240], intrinsics, Distortion::None, place).unwrap()
    }

    fn view(points_per_px: f32) -> ViewTransform {
        let rect = Rect::from_min_size(pos2(20.0, 30.0), vec2(400.0, 300.0));
        ViewTransform { rect, points_per_px, centre_px: pos2(160.0, 120.0) }
    }

    #[test]
    fn a_zoom_keeps_the_same_point_of_the_world_in_place_in_every_view() {
        let (front, side) =
            (camera(DVec3::new(0.0, -4.0, 1.0), 400.0), camera(DVec3::new(3.0, 0.5, 1.2), 300.0));
        let hand = DVec3::new(0.4, 0.1, 1.3);
        let (before, other) = (view(1.5), view(2.0));
        let at = before.screen_from_px(front.project(hand).unwrap());
        let after = before.zoomed_at(at, 1.7);
        let followed = follow(&before, &after, &front, |_| front.depth(hand), &side, &other);
        let seen = side.project(hand).unwrap();
        assert!(followed.screen_from_px(seen).distance(other.screen_from_px(seen)) < 0.05);
        assert!((followed.points_per_px / other.points_per_px - 1.7).abs() < 1e-4);
    }

    #[test]
    fn a_pan_moves_the_others_as_their_pictures_of_that_point_move() {
        let (front, opposite) =
            (camera(DVec3::new(0.0, -4.0, 1.0), 400.0), camera(DVec3::new(0.0, 4.0, 1.0), 400.0));
        let side = camera(DVec3::new(4.0, 0.0, 1.0), 400.0);
        let before = view(1.5);
        let after = before.panned(vec2(30.0, 0.0));
        let moved = |camera: &Camera| {
            let followed = follow(&before, &after, &front, |_| 4.0, camera, &view(1.5));
            followed.centre_px - view(1.5).centre_px
        };
        // What is at the left for one is at the right for the opposite camera, and nearer or farther from the side.
        assert!((moved(&opposite).x - 20.0).abs() < 0.1, "{:?}", moved(&opposite));
        assert!(moved(&side).length() < 0.1, "{:?}", moved(&side));
    }
}
