//! Backlit's commands without a window: one file a command, named after it. What a command computes is the core's; here are
//! words and files. Beside the commands:
//!
//! | file | holds |
//! |---|---|
//! | `fit_options`, `take_options`, `follow_options` | options that several commands share |
//! | `evidence` | silhouettes and grey levels from a folder |
//! | `person` | a start and sizes where the take has none |
//! | `track_report`, `track_files`, `fit_body_report` | what a command found, and the files with it |
//! | `program` | from arguments to an exit code |
//! | `output`, `table`, `progress`, `interrupt` | the terminal, folders, Ctrl+C |

mod background;
mod camera_plan;
mod cameras;
mod check;
mod compare;
mod evidence;
mod experiment;
mod export;
mod fit;
mod fit_body;
mod fit_body_report;
mod fit_options;
mod follow_options;
mod import;
pub mod interrupt;
mod join;
mod numbers;
mod observability;
pub mod output;
mod person;
mod prior;
pub mod program;
mod progress;
mod recognise;
mod refine_cameras;
mod relearn;
mod render;
mod report;
mod silhouettes;
mod sphere_tree;
mod sync;
mod synth;
mod table;
mod take_options;
mod track;
mod track_files;
mod track_people;
mod track_report;

pub use track::print_robust_track;

use clap::Subcommand;

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
    Track(Box<track::TrackArguments>),
    /// Write a track or the poses of a project as motion files for other programs: BVH, TRC, MOT, C3D, glTF, NumPy, CSV
    Export(export::ExportArguments),
    /// Join tracks of pieces of a take that overlap
    Join(join::JoinArguments),
    /// Compare a track with recordings of other tools, with truth, or with other tracks: joints and angles
    Compare(compare::CompareArguments),
    /// Write a track or the poses of a project as one HTML page to send: views, scene, curves, errors, steps of a fit
    Report(report::ReportArguments),
    /// Learn the background of a take again, without the tracked body
    Background(background::BackgroundArguments),
    /// Show what the cameras see of a frame's pose and what they do not, and compare sets of cameras
    Observability(observability::ObservabilityArguments),
    /// Write the silhouettes of a take as pictures
    Silhouettes(silhouettes::SilhouetteArguments),
    /// Film a motion of a file: the clothed figure before simulated cameras, as a take with its truth
    Synth(Box<synth::SynthArguments>),
    /// Find how far apart in time the cameras of a take were started, from the motion of the silhouettes
    Sync(sync::SyncArguments),
    /// Check the cameras of a take against one another: which one is wrong, and how
    Check(check::CheckArguments),
    /// Refine the cameras of a take by the silhouettes of a person
    RefineCameras(Box<refine_cameras::RefineCamerasArguments>),
    /// Learn from motion files how people move, for track --prior
    Prior(prior::PriorArguments),
    /// Show the cameras of a calibration of another tool, and write them in other formats
    Cameras(cameras::CameraArguments),
    /// Build nested spheres of a closed triangle mesh
    SphereTree(sphere_tree::SphereTreeArguments),
    /// Name motions: walking, running, boxing …; learn names from named motions, and test them
    Recognise(recognise::RecogniseArguments),
    /// Run an experiment of the report again: numbers, a table and plots
    Experiment(experiment::Arguments),
}

impl Command {
    /// Does it.
    pub fn run(self) -> anyhow::Result<()> {
        match self {
            Self::Import(arguments) => import::run(&arguments),
            Self::Render(arguments) => render::run(&arguments),
            Self::Fit(arguments) => fit::run(&arguments),
            Self::FitBody(arguments) => fit_body::run(&arguments),
            Self::Track(arguments) => track::run(&arguments),
            Self::Export(arguments) => export::run(&arguments),
            Self::Join(arguments) => join::run(&arguments),
            Self::Compare(arguments) => compare::run(&arguments),
            Self::Report(arguments) => report::run(&arguments),
            Self::Background(arguments) => background::run(&arguments),
            Self::Observability(arguments) => observability::run(&arguments),
            Self::Silhouettes(arguments) => silhouettes::run(&arguments),
            Self::Synth(arguments) => synth::run(&arguments),
            Self::Sync(arguments) => sync::run(&arguments),
            Self::Check(arguments) => check::run(&arguments),
            Self::RefineCameras(arguments) => refine_cameras::run(&arguments),
            Self::Prior(arguments) => prior::run(&arguments),
            Self::Cameras(arguments) => cameras::run(&arguments),
            Self::SphereTree(arguments) => sphere_tree::run(&arguments),
            Self::Recognise(arguments) => recognise::run(&arguments),
            Self::Experiment(arguments) => experiment::run(arguments),
        }
    }
}
