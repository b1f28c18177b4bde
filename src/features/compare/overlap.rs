//! How well the body covers the silhouettes in its own poses and in the selected reference's, measured while the window goes on.

use std::sync::Arc;

use backlit_formats::Footage;
use backlit_formats::motion::Motion;
use backlit_jobs::{Task, once};
use backlit_runs::comparison::{ComparedOverlap, compare_overlap};
use backlit_tracking::metrics::comparison::TrackComparison;
use backlit_tracking::segment::SegmentOptions;
use backlit_ui::style::{format, theme};
use egui::{RichText, Ui};

use super::panel::{row, titles};
use crate::context::{Context, Requests, priority};

/// What an overlap is measured of. Parts are shared: those of other places in memory are others.
#[derive(Debug, Clone)]
struct OverlapInputs {
    found: Arc<TrackComparison>,
    motion: Arc<Motion>,
    footage: Arc<Footage>,
    measurement: Arc<Vec<SegmentOptions>>,
}

impl PartialEq for OverlapInputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.found, &other.found)
            && Arc::ptr_eq(&self.footage, &other.footage)
            && Arc::ptr_eq(&self.measurement, &other.measurement)
    }
}

/// The overlap beside a comparison; `None` where there is nothing to measure.
type MeasuredOverlap = (Arc<TrackComparison>, Option<ComparedOverlap>);

/// The overlap of the selected reference.
#[derive(Debug, Default)]
pub(super) struct Overlaps {
    measuring: Task<OverlapInputs, MeasuredOverlap, { priority::COMPARE }>,
    measured: Option<MeasuredOverlap>,
}

impl Overlaps {
    /// Measures anew where the comparison, the footage or the making of silhouettes is another.
    pub(super) fn update(
        &mut self,
        found: &Arc<TrackComparison>,
        motion: &Arc<Motion>,
        context: &Context<'_>,
        requests: &mut Requests,
    ) {
        for measured in requests.outputs("Measuring overlaps", &mut self.measuring) {
            self.measured = Some(measured);
        }
        let Some(footage) = context.session.take.clone().filter(|_| found.overall.is_some()) else { return };
        let measurement = context.document().measurement.clone();
        let inputs = OverlapInputs { found: found.clone(), motion: motion.clone(), footage, measurement };
        self.measuring.ask(context.pool, inputs, |inputs| {
            let OverlapInputs { found, motion, footage, measurement } = inputs.clone();
            once(move |cancel| {
                let overlap = compare_overlap(&motion, &found, &footage, &measurement, cancel);
                (found, overlap)
            })
        });
    }

    pub(super) fn at_rest(&self) -> Self {
        Self { measured: self.measured.clone(), ..Self::default() }
    }

    /// The table of a comparison.
    pub(super) fn show(&self, ui: &mut Ui, found: &Arc<TrackComparison>) {
        if found.overall.is_none() {
            return;
        }
        let columns = [
            ("poses", "Mean IoU of the silhouettes and the body in its poses"),
            ("reference", "Mean IoU of the silhouettes and the same body in the reference’s poses"),
        ];
        let faint = |text: String| RichText::new(text).small().color(theme::palette(ui).text3);
        match self.measured.as_ref().filter(|(of, _)| Arc::ptr_eq(of, found)) {
            None => {
                ui.label(faint("Measuring overlaps…".to_owned()));
            }
            Some((_, None)) => {}
            Some((_, Some(ComparedOverlap { frames, cameras }))) => {
                titles(ui, &format!("Overlap, {}", format::counted(*frames, "frame")), &columns);
                for camera in cameras {
                    let cells = [camera.track, camera.reference].map(|iou| format::number(iou, 3));
                    row(ui, &camera.camera, &cells, false, None);
                }
            }
        }
    }

    #[cfg(test)]
    pub(super) fn measured(&self) -> Option<&ComparedOverlap> {
        self.measured.as_ref()?.1.as_ref()
    }
}
