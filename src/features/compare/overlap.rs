//! How well the body covers the silhouettes in its own poses and in the selected reference's, measured while the window goes on.

use std::sync::Arc;

use backlit_formats::Footage;
use backlit_formats::motion::Motion;
use backlit_jobs::{Task, once};
use backlit_runs::comparison::{ComparedOverlap, compare_overlap};
use backlit_tracking::metrics::comparison::TrackComparison;
use backlit_tracking::segment::SegmentOptions;
use backlit_ui::style::format;
use backlit_ui::style::theme::space;
use egui::Ui;

use super::panel::{row, titles};
use super::work::NamedReference;
use crate::context::{Context, Requests, priority};

/// What an overlap is measured of. Parts are shared: those of other places in memory are others.
#[derive(Debug, Clone)]
struct OverlapInputs {
    reference: Arc<NamedReference>,
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
        (reference, found): (&Arc<NamedReference>, &Arc<TrackComparison>),
        motion: &Arc<Motion>,
        context: &Context<'_>,
        requests: &mut Requests,
    ) {
        for measured in requests.outputs("Measuring overlaps", &mut self.measuring) {
            self.measured = Some(measured);
        }
        let Some(footage) = context.session.take.clone().filter(|_| found.overall.is_some()) else { return };
        let measurement = context.document().measurement.clone();
        let (reference, found, motion) = (reference.clone(), found.clone(), motion.clone());
        let inputs = OverlapInputs { reference, found, motion, footage, measurement };
        self.measuring.ask(context.pool, inputs, |inputs| {
            let OverlapInputs { reference, found, motion, footage, measurement } = inputs.clone();
            once(move |cancel| {
                let compared = (&reference.reference, &*found);
                let overlap = compare_overlap(&motion, compared, &footage, &measurement, cancel);
                (found, overlap)
            })
        });
    }

    pub(super) fn at_rest(&self) -> Self {
        Self { measured: self.measured.clone(), ..Self::default() }
    }

    /// The table of a comparison. While it is measured the cameras have their rows: what stands below does not move then.
    pub(super) fn show(&self, ui: &mut Ui, found: &Arc<TrackComparison>, context: &Context<'_>) {
        let Some(take) = context.session.take.as_ref().filter(|_| found.overall.is_some()) else { return };
        let columns = [
            ("poses", "Mean IoU of the silhouettes and the body in its poses"),
            ("reference", "Mean IoU of the silhouettes and the body in the reference’s poses"),
        ];
        let titled = |ui: &mut Ui, of: &str| titles(ui, &format!("Overlap (IoU), {of}"), &columns);
        match self.measured.as_ref().filter(|(of, _)| Arc::ptr_eq(of, found)) {
            None => {
                titled(ui, "measuring…");
                for camera in take.cameras.iter() {
                    row(
                        ui,
                        camera.name(),
                        &[format::MISSING, format::MISSING].map(str::to_owned),
                        false,
                        None,
                    );
                }
            }
            Some((_, None)) => return,
            Some((_, Some(ComparedOverlap { frames, cameras }))) => {
                titled(ui, &format::counted(*frames, "frame"));
                for camera in cameras {
                    let cells = [camera.track, camera.reference].map(|iou| format::number(iou, 3));
                    row(ui, &camera.camera, &cells, false, None);
                }
            }
        }
        ui.add_space(space::WIDGET);
    }

    #[cfg(test)]
    pub(super) fn measured(&self) -> Option<&ComparedOverlap> {
        self.measured.as_ref()?.1.as_ref()
    }
}
