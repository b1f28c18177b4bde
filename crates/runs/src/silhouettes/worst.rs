//! Which silhouettes are worst: those that other cameras, their neighbours in time or the body contradict.

use std::collections::BTreeMap;
use std::sync::Arc;

use backlit_formats::Footage;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::FitView;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::silhouette::Label;
use backlit_tracking::statistics::median;
use backlit_tracking::track::overlaps;
use backlit_words::format::number;

use super::PosedBody;

/// Frames no more than this before and after one tell how large a silhouette should be, seconds.
const AROUND_S: f64 = 0.1;
/// Areas of neighbours differ by this factor, as a logarithm, as a person moves.
const USUAL_CHANGE: f64 = 0.1;

/// What is less bad is not listed.
const LEAST_BADNESS: f64 = 0.02;

/// What speaks against one silhouette. Shares are from 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct SilhouetteQuality {
    /// The camera.
    pub camera: usize,
    /// The frame.
    pub frame: usize,
    /// How many pixels are subject.
    pub subject_px: usize,
    /// Which share of the subject no other camera supports.
    pub unsupported: f64,
    /// The logarithm of how much larger it is than those of the frames around it.
    pub growth: f64,
    /// How much less it overlaps the body than this camera's silhouettes do as a rule; `None` where no pose is known.
    pub mismatch: Option<f64>,
}

impl SilhouetteQuality {
    /// How bad it is: the largest of what speaks against it.
    #[must_use]
    pub fn badness(&self) -> f64 {
        let change = self.growth.abs() - USUAL_CHANGE;
        [change, self.mismatch.unwrap_or(0.0)].into_iter().fold(self.unsupported, f64::max)
    }

    /// What speaks most against it.
    #[must_use]
    pub fn reason(&self) -> String {
        let percent = |share: f64| format!("{} %", number(100.0 * share, 0));
        let (badness, growth) = (self.badness(), self.growth.exp());
        if self.subject_px == 0 {
            "is empty".to_owned()
        } else if self.unsupported >= badness {
            format!("no other camera sees {} of it", percent(self.unsupported))
        } else if self.mismatch.is_some_and(|mismatch| mismatch >= badness) {
            format!("overlaps the body {} less than usual", percent(badness))
        } else if growth > 1.0 {
            format!("is {} larger than around this frame", percent(growth - 1.0))
        } else {
            format!("is {} smaller than around this frame", percent(1.0 - growth))
        }
    }
}

/// One silhouette before it is compared with others.
struct MeasuredSilhouette {
    subject_px: usize,
    unsupported_px: usize,
    iou: Option<f64>,
}

/// Looks at the silhouettes of some frames of all cameras, by each camera's options, and lists those that something speaks
/// against, the worst first. A body is compared where its pose is known. `tell` hears how many frames are done. A cancelled search gives what it has.
pub fn worst(
    footage: &Footage,
    measurement: &Arc<Vec<SegmentOptions>>,
    frames: &[usize],
    body: Option<&PosedBody>,
    cancel: &CancelToken,
    mut tell: impl FnMut(usize),
) -> Vec<SilhouetteQuality> {
    let mut measured: Vec<BTreeMap<usize, MeasuredSilhouette>> =
        (0..footage.cameras.len()).map(|_| BTreeMap::new()).collect();
    for (done, &frame) in frames.iter().enumerate() {
        if cancel.is_cancelled() {
            break;
        }
        let data = footage.load_frame(measurement, frame);
        let known = body.and_then(|body| Some((body, body.poses.get(&frame)?)));
        for (number, camera) in data.cameras.iter().enumerate() {
            let Some(mask) = &camera.mask else { continue };
            let iou = known.and_then(|(body, pose)| {
                let view = FitView::of_mask(footage.cameras[number].clone(), mask.clone());
                let overlap = overlaps(&body.model, pose, body.fit.renderer, &[view]);
                overlap.first().copied().flatten()?.iou()
            });
            let one = MeasuredSilhouette {
                subject_px: mask.count(Label::Subject),
                unsupported_px: camera.unsupported_px,
                iou,
            };
            measured[number].insert(frame, one);
        }
        tell(done + 1);
    }
    let reach = (AROUND_S * footage.take().frame_rate()).ceil() as usize;
    let all = measured.iter().enumerate().flat_map(|(camera, frames)| of_camera(camera, frames, reach));
    let mut found: Vec<SilhouetteQuality> = all.filter(|one| one.badness() >= LEAST_BADNESS).collect();
    found.sort_by(|a, b| {
        b.badness().total_cmp(&a.badness()).then((a.frame, a.camera).cmp(&(b.frame, b.camera)))
    });
    found
}

/// What speaks against each silhouette of a camera; `reach` frames before and after one count as around it.
fn of_camera(
    camera: usize,
    frames: &BTreeMap<usize, MeasuredSilhouette>,
    reach: usize,
) -> Vec<SilhouetteQuality> {
    let usual_iou = median(&mut frames.values().filter_map(|one| one.iou).collect::<Vec<_>>());
    let quality = |(&frame, one): (&usize, &MeasuredSilhouette)| {
        let MeasuredSilhouette { subject_px, unsupported_px, iou } = *one;
        let around = frames.range(frame.saturating_sub(reach)..=frame + reach);
        let others = around.filter(|(other, _)| **other != frame);
        let mut areas: Vec<f64> = others.map(|(_, other)| other.subject_px as f64).collect();
        let usual = median(&mut areas).unwrap_or(subject_px as f64);
        let whole = (subject_px + unsupported_px) as f64;
        SilhouetteQuality {
            camera,
            frame,
            subject_px,
            unsupported: if whole > 0.0 { unsupported_px as f64 / whole } else { 0.0 },
            // One pixel more keeps an empty silhouette a number.
            growth: ((subject_px as f64 + 1.0) / (usual + 1.0)).ln(),
            mismatch: usual_iou.zip(iou).map(|(usual, iou)| (usual - iou).max(0.0)),
        }
    };
    frames.iter().map(quality).collect()
}
