//! Where the subject is over the whole take, so that the views need not jump while frames go by.

use std::sync::Arc;

use backlit_formats::Footage;
use backlit_jobs::{Job, Outbox, Turn};
use backlit_tracking::body::Kinematics;
use backlit_tracking::render::{DrawOptions, Ramp, RendererKind, View, draw};
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::silhouette::{Label, Mask};

use crate::session::{Extent, union};

/// This many frames are looked at.
const FRAMES: usize = 6;
/// This share of the subject's pixels may lie outside on each side: specks are not the subject.
const OUTSIDE: f64 = 0.004;
/// The body at its start belongs to what is seen where it stands beyond the subject by this share of its size.
const BEYOND: f32 = 0.1;

/// A look at a few frames of the take.
#[derive(Debug)]
pub(crate) struct SurveyJob {
    footage: Arc<Footage>,
    measurement: Arc<Vec<SegmentOptions>>,
    /// Frame and camera of every picture that is still to be looked at.
    left: Vec<(usize, usize)>,
    extents: Vec<Option<Extent>>,
}

impl SurveyJob {
    /// Frames spread over the take, all cameras.
    pub(crate) fn new(footage: Arc<Footage>, measurement: Arc<Vec<SegmentOptions>>) -> Self {
        let (count, cameras) = (footage.frame_count(), footage.cameras.len());
        let shown = FRAMES.min(count);
        let frame = |index: usize| index * (count - 1) / shown.saturating_sub(1).max(1);
        let left =
            (0..shown).flat_map(|index| (0..cameras).map(move |camera| (frame(index), camera))).collect();
        Self { footage, measurement, left, extents: vec![None; cameras] }
    }
}

impl Job<Vec<Option<Extent>>> for SurveyJob {
    fn step(&mut self, out: &Outbox<Vec<Option<Extent>>>) -> Turn {
        if out.cancel().is_cancelled() {
            return Turn::Done;
        }
        if let Some((frame, camera)) = self.left.pop() {
            let options = self.measurement.get(camera).cloned().unwrap_or_default();
            let found = self.footage.load(camera, frame, &options).mask.as_deref().and_then(extent);
            let known = &mut self.extents[camera];
            *known = match (*known, found) {
                (Some(a), Some(b)) => Some(union(a, b)),
                (a, b) => a.or(b),
            };
            return Turn::Again;
        }
        let mut extents = std::mem::take(&mut self.extents);
        for (camera, extent) in extents.iter_mut().enumerate() {
            *extent = extent.map(|subject| with_start(&self.footage, camera, subject));
        }
        out.send(extents);
        Turn::Done
    }
}

/// The subject together with the body at the take's start, where that stands beside it.
fn with_start(footage: &Footage, camera: usize, subject: Extent) -> Extent {
    let (Some(start), model) = (footage.take().start(), footage.take().model()) else { return subject };
    let kinematics = Kinematics::new(model, start);
    let view = View::new(model, &kinematics, &footage.cameras[camera], RendererKind::Capsule, Ramp::Half);
    let drawn = draw(&view, DrawOptions { gradient: false, motion: None }).prediction;
    let is_body = |lambda: &f32| if *lambda < 128.0 { Label::Subject } else { Label::Background };
    let labels = drawn.lambda.iter().map(is_body).collect();
    let body = Mask::new(drawn.width, drawn.height, labels).ok().as_ref().and_then(extent);
    body.map_or(subject, |body| grown(subject, body))
}

/// Both, if the second touches the first and stands beyond it by more than a little.
fn grown(subject: Extent, body: Extent) -> Extent {
    let touches = (0..2).all(|axis| subject[axis] <= body[axis + 2] && body[axis] <= subject[axis + 2]);
    let beyond = (0..4).any(|side| {
        let size = subject[side % 2 + 2] - subject[side % 2];
        let out = if side < 2 { subject[side] - body[side] } else { body[side] - subject[side] };
        out > BEYOND * size
    });
    if !(touches && beyond) {
        return subject;
    }
    union(subject, body)
}

/// Where nearly all of the subject's pixels are.
fn extent(mask: &Mask) -> Option<Extent> {
    let mut columns = vec![0_usize; mask.width()];
    let mut rows = vec![0_usize; mask.height()];
    for (index, label) in mask.labels().iter().enumerate() {
        if *label == Label::Subject {
            columns[index % mask.width()] += 1;
            rows[index / mask.width()] += 1;
        }
    }
    let (left, right) = middle(&columns)?;
    let (top, bottom) = middle(&rows)?;
    Some([left as f32, top as f32, right as f32, bottom as f32])
}

/// First and last place between which nearly all counts are.
fn middle(counts: &[usize]) -> Option<(usize, usize)> {
    let total: usize = counts.iter().sum();
    let outside = (total as f64 * OUTSIDE) as usize;
    let counted = |places: &mut dyn Iterator<Item = usize>| {
        let mut sum = 0;
        for place in places {
            sum += counts[place];
            if sum > outside {
                return Some(place);
            }
        }
        None
    };
    Some((counted(&mut (0..counts.len()))?, counted(&mut (0..counts.len()).rev())?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_that_stands_beside_the_subject_is_seen_too() {
        let subject = [20.0, 10.0, 60.0, 90.0];
        assert_eq!(grown(subject, [18.0, 12.0, 62.0, 92.0]), subject, "it hardly differs");
        assert_eq!(grown(subject, [40.0, 12.0, 80.0, 92.0]), [20.0, 10.0, 80.0, 92.0]);
        assert_eq!(grown(subject, [70.0, 12.0, 110.0, 92.0]), subject, "it is somewhere else");
    }

    #[test]
    fn specks_do_not_count() {
        let mut rows = vec![".".repeat(60); 40];
        for row in &mut rows[10..30] {
            row.replace_range(20..50, &"#".repeat(30));
        }
        rows[0].replace_range(0..1, "#");
        let mask = Mask::from_ascii(&rows.join("\n")).unwrap();
        assert_eq!(extent(&mask), Some([20.0, 10.0, 49.0, 29.0]));
        assert_eq!(extent(&Mask::filled(4, 4, Label::Background).unwrap()), None);
    }
}
