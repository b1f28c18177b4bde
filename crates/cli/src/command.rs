//! The commands and their help.

use clap::Subcommand;

use crate::{
    background, cameras, experiment, export, fit, fit_body, import, observability, prior, recognise, render,
    silhouettes, sphere_tree, sync, track,
};

/// One thing to do without a window.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Make a take from footage and a calibration, or from a project of another tool
    Import(import::ImportArguments),
    /// Draw the silhouettes that a pose predicts, one picture a camera
    Render(render::RenderArguments),
    /// Fit a pose to the silhouettes of one moment
    Fit(fit::FitArguments),
    /// Find a person's own lengths and radii from several frames of a take
    FitBody(fit_body::FitBodyArguments),
    /// Fit frame after frame of a take; report joint errors, overlap and times
    Track(track::TrackArguments),
    /// Write a track or the poses of a project as motion files for other programs: BVH, TRC, MOT, C3D, glTF, NumPy, CSV
    Export(export::ExportArguments),
    /// Learn the background of a take again, without the tracked body
    Background(background::BackgroundArguments),
    /// Show what the cameras see of a frame's pose and what they do not, and compare sets of cameras
    Observability(observability::ObservabilityArguments),
    /// Write the silhouettes of a take as pictures
    Silhouettes(silhouettes::SilhouetteArguments),
    /// Find how far apart in time the cameras of a take were started, from the motion of the silhouettes
    Sync(sync::SyncArguments),
    /// Learn from motion files how people move, for track --prior
    Prior(prior::PriorArguments),
    /// Show the cameras of a calibration of another tool, and write them in other formats
    Cameras(cameras::CameraArguments),
    /// Build nested spheres of a closed triangle mesh
    SphereTree(sphere_tree::SphereTreeArguments),
    /// Name motions: walking, running, boxing …; learn names from named motions, and test them
    Recognise(recognise::RecogniseArguments),
    /// Run an experiment of the report again: numbers, a table and plots
    Experiment(experiment::ExperimentArguments),
}

impl Command {
    /// Does it.
    ///
    /// # Errors
    /// What it was told makes no sense, cannot be read or cannot be written; a [`clap::Error`] where the command line
    /// itself is wrong.
    pub fn run(&self) -> anyhow::Result<()> {
        match self {
            Self::Import(arguments) => import::run(arguments),
            Self::Render(arguments) => render::run(arguments),
            Self::Fit(arguments) => fit::run(arguments),
            Self::FitBody(arguments) => fit_body::run(arguments),
            Self::Track(arguments) => track::run(arguments),
            Self::Export(arguments) => export::run(arguments),
            Self::Background(arguments) => background::run(arguments),
            Self::Observability(arguments) => observability::run(arguments),
            Self::Silhouettes(arguments) => silhouettes::run(arguments),
            Self::Sync(arguments) => sync::run(arguments),
            Self::Prior(arguments) => prior::run(arguments),
            Self::Cameras(arguments) => cameras::run(arguments),
            Self::SphereTree(arguments) => sphere_tree::run(arguments),
            Self::Recognise(arguments) => recognise::run(arguments),
            Self::Experiment(arguments) => experiment::run(arguments),
        }
    }
}
