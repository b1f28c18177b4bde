//! Edits of what is drawn over silhouettes: regions, and strokes in one frame, in several, or carried along with the body.

use backlit_document::edit::Edit;
use backlit_formats::footage::BrushStroke;
use backlit_tracking::body::{Kinematics, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::silhouette::{Label, Region, Stroke};
use backlit_ui::drawing::{ProjectedLimb, project_limbs};
use backlit_ui::style::format;
use glam::{DVec2, Vec2};

use super::{BrushScope, SilhouetteSteering};
use crate::context::marks::SilhouetteTool;
use crate::context::{Context, Requests};

/// A region that is smaller was a slip of the hand, pixels.
const LEAST_SIDE: f32 = 3.0;
/// A limb that is seen end on has no direction in the picture: it is shorter than this, in its radii.
const END_ON: f64 = 1.0;

/// The frames that are marked, else the one on the screen.
pub(super) fn marked_or_shown(context: &Context<'_>) -> [usize; 2] {
    let frame = context.selection.frame;
    context.playback.range.map_or([frame, frame], |range| [range.first, range.last])
}

/// The frames that are marked, else all.
fn marked_or_all(context: &Context<'_>) -> [usize; 2] {
    let last = context.session.frame_count().saturating_sub(1);
    context.playback.range.map_or([0, last], |range| [range.first, range.last.min(last)])
}

impl SilhouetteSteering {
    /// Makes an edit of a line that was drawn in a camera's view.
    pub(super) fn draw(
        &self,
        camera: usize,
        points: &[[f32; 2]],
        context: &Context<'_>,
        requests: &mut Requests,
    ) {
        let Some(view) = context.session.take.as_ref().and_then(|take| take.cameras.get(camera)) else {
            return;
        };
        match self.tool {
            None => {}
            Some(SilhouetteTool::Region) => {
                let region = region(points, [view.width(), view.height()]);
                if region.is_some() {
                    requests.edit(Edit::SetRegion { camera, region });
                }
            }
            Some(SilhouetteTool::Brush(label)) => {
                let stroke = Stroke { label, radius_px: self.radius_px as f32, points: points.to_vec() };
                match self.scope {
                    BrushScope::Frame => {
                        let frame = context.selection.frame;
                        paint(vec![BrushStroke { camera, frames: [frame, frame], stroke }], label, requests);
                    }
                    BrushScope::Range => {
                        paint(
                            vec![BrushStroke { camera, frames: marked_or_all(context), stroke }],
                            label,
                            requests,
                        );
                    }
                    BrushScope::Body => paint(with_body(camera, view, &stroke, context), label, requests),
                }
            }
        }
    }
}

fn paint(strokes: Vec<BrushStroke>, label: Label, requests: &mut Requests) {
    let frames: usize = strokes.iter().map(|one| one.frames[1] + 1 - one.frames[0]).sum();
    if frames > 1 {
        let what = match label {
            Label::Subject => "Subject",
            Label::Background => "Background",
            Label::Unknown => "Unknown",
        };
        requests.status(format!("{what} in {}.", format::counted(frames, "frame")));
    }
    requests.edit(Edit::Paint(strokes));
}

/// The stroke in every frame that has a pose, moved with the limb that it lies on; in the frame on the screen as it is.
fn with_body(camera: usize, view: &Camera, stroke: &Stroke, context: &Context<'_>) -> Vec<BrushStroke> {
    let (document, shown) = (context.document(), context.selection.frame);
    let limbs = |pose: &Pose| {
        let kinematics = Kinematics::new(&document.model, pose);
        project_limbs(&document.model, &kinematics, view, document.fit.renderer)
    };
    let from = limbs(context.shown_pose());
    let [first, last] = marked_or_all(context);
    let mut strokes = vec![BrushStroke { camera, frames: [shown, shown], stroke: stroke.clone() }];
    for frame in (first..=last).filter(|frame| *frame != shown && document.has_pose(*frame)) {
        if let Some(stroke) = carried(stroke, &from, &limbs(document.pose_at(frame))) {
            strokes.push(BrushStroke { camera, frames: [frame, frame], stroke });
        }
    }
    strokes
}

/// A stroke moved with the limb that it lies on, nearest on average: along the limb by shares of its length, across it by its
/// thickness. `None` where that limb is not before the camera.
fn carried(stroke: &Stroke, from: &[Option<ProjectedLimb>], to: &[Option<ProjectedLimb>]) -> Option<Stroke> {
    let points: Vec<DVec2> = stroke.points.iter().map(|point| Vec2::from_array(*point).as_dvec2()).collect();
    let off =
        |limb: &ProjectedLimb| points.iter().map(|point| limb.distance_px(*point).max(0.0)).sum::<f64>();
    let limbs = from.iter().zip(to).filter_map(|(from, to)| Some((from.as_ref()?, to)));
    let (from, to) = limbs.min_by(|a, b| off(a.0).total_cmp(&off(b.0)))?;
    let to = to.as_ref()?;
    let radius = |limb: &ProjectedLimb| limb.radii_px.iter().sum::<f64>() / 2.0;
    let scale = radius(to) / radius(from).max(f64::MIN_POSITIVE);
    let axis = |limb: &ProjectedLimb| limb.ends_px[1] - limb.ends_px[0];
    let has_direction = |limb: &ProjectedLimb| axis(limb).length() > END_ON * radius(limb);
    let middle = |limb: &ProjectedLimb| limb.ends_px[0].midpoint(limb.ends_px[1]);
    let moved = |point: &DVec2| {
        if !(has_direction(from) && has_direction(to)) {
            return middle(to) + scale * (*point - middle(from));
        }
        let along = (*point - from.ends_px[0]).dot(axis(from)) / axis(from).length_squared();
        let across = (*point - from.ends_px[0]).perp_dot(axis(from)) / axis(from).length();
        let normal = -axis(to).perp().normalize_or_zero();
        to.ends_px[0] + along * axis(to) + scale * across * normal
    };
    let points = points.iter().map(|point| moved(point).as_vec2().to_array()).collect();
    Some(Stroke { label: stroke.label, radius_px: (scale * f64::from(stroke.radius_px)) as f32, points })
}

/// The rectangle between the first point of a line and its last, within the picture.
fn region(points: &[[f32; 2]], size: [usize; 2]) -> Option<Region> {
    let (from, to) = (points.first()?, points.last()?);
    let span = |axis: usize| {
        let [low, high] = [from[axis].min(to[axis]), from[axis].max(to[axis])];
        let [low, high] = [low, high].map(|at| at.clamp(0.0, size[axis] as f32));
        (high - low >= LEAST_SIDE).then_some((low as usize, (high - low).round() as usize))
    };
    let ((x, width), (y, height)) = (span(0)?, span(1)?);
    Some(Region { x, y, width, height })
}

#[cfg(test)]
mod tests {
    use backlit_tracking::render::RendererKind;

    use super::*;

    fn limb(ends: [[f64; 2]; 2], radius: f64) -> Option<ProjectedLimb> {
        let ends_px = ends.map(DVec2::from_array);
        Some(ProjectedLimb {
            ends_px,
            radii_px: [radius; 2],
            depths_m: [1.0; 2],
            solid: RendererKind::Capsule,
        })
    }

    #[test]
    fn a_stroke_moves_with_the_limb_that_it_lies_on() {
        let stroke = Stroke { label: Label::Subject, radius_px: 2.0, points: vec![[5.0, 3.0], [10.0, 0.0]] };
        let from = [limb([[90.0, 90.0], [99.0, 90.0]], 1.0), limb([[0.0, 0.0], [10.0, 0.0]], 2.0)];
        // Turned by a quarter, twice as near.
        let to = [None, limb([[50.0, 50.0], [50.0, 70.0]], 4.0)];
        let moved = carried(&stroke, &from, &to).unwrap();
        assert_eq!((moved.radius_px, moved.points), (4.0, vec![[44.0, 60.0], [50.0, 70.0]]));
        assert_eq!(carried(&stroke, &from, &from).unwrap(), stroke);
        assert_eq!(carried(&stroke, &from, &[to[1], None]), None, "the limb is behind the camera");
        // Seen end on it has no direction: what lies on it goes along with its middle.
        let end_on = [None, limb([[20.0, 20.0], [20.0, 21.0]], 2.0)];
        assert_eq!(carried(&stroke, &from, &end_on).unwrap().points, [[20.0, 23.5], [25.0, 20.5]]);
    }

    #[test]
    fn a_region_lies_in_the_picture() {
        let drawn = |points: &[[f32; 2]]| region(points, [100, 50]);
        assert_eq!(
            drawn(&[[80.0, 40.0], [3.0, 3.0], [-9.0, 10.0]]),
            Some(Region { x: 0, y: 10, width: 80, height: 30 })
        );
        assert_eq!(drawn(&[[8.0, 4.0], [9.0, 40.0]]), None, "too narrow to be meant");
        assert_eq!(drawn(&[]), None);
    }
}
