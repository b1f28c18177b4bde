//! The laboratory's choices, and the comparison that they make.

use backlit_tracking::body::{Model, Pose};

use super::{Comparison, Lineup, PushAxis, StartChoice};
use crate::context::command::{Command, FitCommand, LaboratoryCommand, TimelineCommand};
use crate::document::run::RunStep;

/// All that belongs to the laboratory. Not saved and not undone.
#[derive(Debug, Clone, Default)]
pub struct Laboratory {
    /// What is compared.
    pub lineup: Lineup,
    /// Where all begin.
    pub start: StartChoice,
    /// Along which motion pushes are shown; what suits the body until it is chosen.
    pub axis: Option<PushAxis>,
    /// The camera whose pictures are shown.
    pub camera: usize,
    /// Whether the plot's heights are logarithmic.
    pub is_log: bool,
    /// The fit whose worst pixel is marked.
    pub marked: Option<usize>,
    /// The comparison, once it has begun.
    pub comparison: Option<Comparison>,
    /// How many comparisons there have been.
    pub comparisons: u64,
    /// Whether fits are being stepped.
    pub is_running: bool,
    /// Whether gradients are being checked.
    pub is_checking: bool,
    /// The check that was asked for last: the pose of each fit.
    pub check_wanted: Option<Vec<(usize, Pose)>>,
    /// Whether that check broke down.
    pub check_broke: bool,
    /// Whether the comparison is to run as soon as it has begun.
    pub wants_run: bool,
    /// Steps that were asked for while one was being made.
    pub pending_steps: usize,
    /// Time of the last step of every fit, in seconds.
    pub step_seconds: Option<f64>,
    /// Whether something that the screen lacks is still to be asked for.
    pub is_waiting: bool,
}

/// What is asked of the laboratory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LaboratoryRequest {
    /// Compare something else.
    Lineup(Lineup),
    /// Begin somewhere else.
    Start(StartChoice),
    /// Show another camera.
    Camera(usize),
    /// Show what pushes along another motion.
    Axis(PushAxis),
    /// Hold another limb.
    Limb(usize),
    /// Look at a step.
    Step(usize),
    /// Logarithmic heights, or percent.
    Log(bool),
    /// Mark the worst pixel of a fit, or of none.
    Mark(Option<usize>),
    /// Copy the curves as text.
    CopyTable,
    /// Save the plot as a picture.
    SavePlot,
}

impl Laboratory {
    /// The same without any work that is going on.
    #[must_use]
    pub fn at_rest(&self) -> Self {
        Self {
            is_running: false,
            is_checking: false,
            check_wanted: None,
            wants_run: false,
            pending_steps: 0,
            ..self.clone()
        }
    }

    /// The motion along which pushes are shown.
    #[must_use]
    pub fn axis_for(&self, model: &Model) -> PushAxis {
        self.axis.unwrap_or_else(|| PushAxis::of(model))
    }

    /// Why a command cannot be used in the laboratory's layout; the outer `None` is for commands that it leaves to
    /// others.
    #[must_use]
    pub fn unavailable(&self, command: Command) -> Option<Option<&'static str>> {
        let because = |is_so: bool, why: &'static str| is_so.then_some(why);
        let Some(comparison) = self.comparison.as_ref().filter(|comparison| comparison.has_begun()) else {
            return is_own(command).then_some(Some("The laboratory has not begun yet"));
        };
        let at_end = comparison.cursor == comparison.last();
        let is_over = comparison.is_over() && at_end;
        Some(match command {
            Command::Fit(FitCommand::Step | FitCommand::LaterStep)
            | Command::Timeline(TimelineCommand::NextFrame) => because(is_over, "All fits have ended"),
            Command::Fit(FitCommand::Run) => {
                because(is_over, "All fits have ended").or(because(self.is_running, "They are running"))
            }
            Command::Fit(FitCommand::StepBack | FitCommand::EarlierStep)
            | Command::Timeline(
                TimelineCommand::PreviousFrame | TimelineCommand::TenFramesBack | TimelineCommand::FirstFrame,
            ) => because(comparison.cursor == 0, "This is the start"),
            Command::Timeline(TimelineCommand::LastFrame | TimelineCommand::TenFramesOn) => {
                because(at_end, "This is the newest step")
            }
            Command::Fit(FitCommand::Stop) if self.is_running => None,
            Command::Laboratory(LaboratoryCommand::Restart) => {
                let is_new = comparison.last() == 0 && comparison.problem().is_none();
                because(is_new, "No step has been made yet")
            }
            _ => return None,
        })
    }

    /// The time of one step of all fits together, from their newest ones.
    pub fn measure_steps(&mut self) {
        let newest = |steps: &Vec<RunStep>| steps.iter().skip(1).next_back().map(|step| step.seconds);
        let seconds = self.comparison.iter().flat_map(|comparison| &comparison.contestants);
        let seconds: Vec<f64> = seconds.filter_map(|fit| newest(&fit.steps)).collect();
        self.step_seconds = (!seconds.is_empty()).then(|| seconds.iter().sum());
    }
}

/// Whether a command means something of its own in the laboratory's layout.
fn is_own(command: Command) -> bool {
    use {FitCommand as F, TimelineCommand as T};
    matches!(
        command,
        Command::Fit(F::Step | F::StepBack | F::Run | F::Stop | F::EarlierStep | F::LaterStep)
            | Command::Timeline(T::PreviousFrame | T::NextFrame | T::TenFramesBack | T::TenFramesOn)
            | Command::Timeline(T::FirstFrame | T::LastFrame)
            | Command::Laboratory(LaboratoryCommand::Restart)
    )
}
