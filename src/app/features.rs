//! What the features do by themselves in every frame.

use std::path::Path;

use backlit_ui::drawing::DragEvent;

use super::Inspector;
use crate::features::basin::{BasinSettings, FileKind};
use crate::features::convergence::CurvesFile;

impl Inspector {
    /// Every feature takes in what its tasks have done, and asks for what it lacks.
    pub(crate) fn update_features(&mut self) {
        self.keep_to_memory();
        self.update_feature(
            |features| &mut features.fit,
            |fit, context, requests| fit.update(context, requests),
        );
        self.with(|features| &mut features.basin, |basin, context, requests| basin.update(context, requests));
        self.update_feature(
            |features| &mut features.new_take,
            |new_take, context, requests| new_take.update(context, requests),
        );
        self.update_feature(
            |features| &mut features.offsets,
            |offsets, _, requests| offsets.update(requests),
        );
        self.update_feature(|features| &mut features.export, |export, _, requests| export.update(requests));
        self.update_feature(
            |features| &mut features.convergence,
            |convergence, context, requests| convergence.update(context, requests),
        );
        self.update_feature(
            |features| &mut features.tracking,
            |tracking, context, requests| tracking.update(context, requests),
        );
        self.lend_to(|features| &mut features.camera_views, |views, context, _| views.update(context));
        self.lend_to(|features| &mut features.timeline, |timeline, context, _| timeline.update(context));
        self.update_feature(
            |features| &mut features.laboratory,
            |laboratory, context, requests| laboratory.update(context, requests),
        );
        self.update_feature(
            |features| &mut features.observability,
            |observability, context, requests| observability.update(context, requests),
        );
        self.state.observability = self.features.observability.marks();
        self.update_feature(
            |features| &mut features.motions,
            |motions, context, requests| motions.update(context, requests),
        );
        self.state.motions = self.features.motions.marks();
        self.update_feature(
            |features| &mut features.beginnings,
            |beginnings, context, requests| beginnings.update(context, requests),
        );
        self.state.ghosts = self.features.beginnings.ghosts();
        self.update_feature(
            |features| &mut features.scene,
            |scene, context, requests| scene.update(context, requests),
        );
        self.update_feature(
            |features| &mut features.tour,
            |tour, context, requests| tour.update(context, requests),
        );
    }

    /// Half of the memory for frames is for what is on the screen or was, half for decoded videos.
    fn keep_to_memory(&mut self) {
        let half = self.state.preferences.frames_mb / 2;
        let session = &mut self.state.session;
        session.frames.set_limit_mb(half);
        if let Some(cache) = session.take.as_ref().map(|take| take.take().frame_cache())
            && cache.limit_mb() != half
        {
            cache.set_limit_mb(half);
        }
    }

    /// Ends a fit that is going on, because its pose is about to change: what it has done stays as a run.
    pub(crate) fn interrupt_fit(&mut self) {
        self.with(|features| &mut features.fit, |fit, _, requests| fit.interrupt(requests));
    }

    /// The copy of unsaved work follows what was done in this frame, and work is not left that can be kept nowhere.
    pub(crate) fn keep_work(&mut self) {
        self.with(
            |features| &mut features.recovery,
            |recovery, context, requests| {
                recovery.update(context, requests);
                recovery.guard_close(context, requests);
            },
        );
    }

    /// Writes every step of all runs as CSV.
    pub fn export_curves_to(&mut self, path: &Path) {
        self.write_curves(CurvesFile::Table, path);
    }

    /// Writes the convergence plot, as it is shown, as a PNG.
    pub fn export_plot_to(&mut self, path: &Path) {
        self.write_curves(CurvesFile::Plot, path);
    }

    fn write_curves(&mut self, file: CurvesFile, path: &Path) {
        self.with(
            |features| &mut features.convergence,
            |convergence, context, requests| convergence.write(file, path, context, requests),
        );
    }

    /// Something is dragged in a camera's view. What runs or plays stops for it.
    pub(crate) fn drag(&mut self, camera: usize, event: DragEvent) {
        if matches!(event, DragEvent::Begin(_)) {
            self.interrupt_fit();
            self.pause();
        }
        self.with(
            |features| &mut features.pose,
            |posing, context, requests| posing.drag(camera, event, context, requests),
        );
    }

    /// Other settings of the basin.
    pub fn set_basin(&mut self, settings: BasinSettings) {
        self.features.basin.set(settings);
    }

    /// Writes the laboratory's plot to a file.
    pub fn save_laboratory_plot(&mut self, path: &Path) {
        self.with(
            |all| &mut all.laboratory,
            |laboratory, context, requests| {
                laboratory.save_plot(path, context, requests);
            },
        );
    }

    /// Writes what the basin's pane shows to a file.
    pub fn export_basin_to(&mut self, kind: FileKind, path: &Path) {
        self.with(
            |features| &mut features.basin,
            |basin, context, requests| {
                basin.write(kind, path, context.preferences.theme, requests);
            },
        );
    }
}
