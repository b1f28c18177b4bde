//! How well the body covers the silhouettes in its own poses and in the selected reference's, measured while the window goes on.

use std::sync::Arc;

use backlit_formats::Footage;
use backlit_formats::motion::Motion;
use backlit_jobs::{Task, once};
use backlit_runs::comparison::{CameraOverlap, ComparedOverlap, compare_overlap};
use backlit_tracking::metrics::comparison::TrackComparison;
use backlit_tracking::segment::SegmentOptions;
use backlit_ui::style::format;
use backlit_ui::style::theme::space;
use egui::Ui;

use super::panel::{row, titles};
use super::work::NamedReference;
use crate::context::{Context, Requests, ShellRequest, priority};

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
        // A pose that is being dragged is another in each frame of the window.
        if context.egui.input(|input| input.pointer.any_down()) {
            return;
        }
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
    pub(super) fn show(
        &self,
        ui: &mut Ui,
        found: &Arc<TrackComparison>,
        context: &Context<'_>,
        requests: &mut Requests,
    ) {
        let Some(take) = context.session.take.as_ref().filter(|_| found.overall.is_some()) else { return };
        let columns = [
            ("poses", "Mean IoU of the silhouettes and the body in its poses"),
            ("reference", "Mean IoU of the silhouettes and the body in the reference’s poses"),
        ];
        let measured = self.measured.as_ref().filter(|(of, _)| Arc::ptr_eq(of, found));
        let (of, rows) = match measured {
            None => ("measuring…".to_owned(), None),
            Some((_, None)) => return,
            Some((_, Some(overlap))) => (format::counted(overlap.frames, "frame"), Some(&overlap.cameras)),
        };
        titles(ui, &format!("Overlap (IoU), {of}"), &columns);
        for (index, camera) in take.cameras.iter().enumerate() {
            let of_camera =
                |rows: &Vec<CameraOverlap>| rows.iter().find(|row| row.camera == camera.name()).cloned();
            let cells = match rows.map(of_camera) {
                Some(None) => continue,
                Some(Some(row)) => [row.track, row.reference].map(|iou| format::number(iou, 3)),
                None => [format::MISSING; 2].map(str::to_owned),
            };
            let response = row(ui, camera.name(), &cells, false, None);
            if response.on_hover_text("Select this camera").clicked() {
                requests.request(ShellRequest::Camera(index));
            }
        }
        ui.add_space(space::WIDGET);
    }

    #[cfg(test)]
    pub(super) fn measured(&self) -> Option<&ComparedOverlap> {
        self.measured.as_ref()?.1.as_ref()
    }
}
