//! What the user looks at and holds: frame, camera, limb, step of a run.

/// A step of a run: which of the session's runs, and which of its iterations (0 is the start).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct StepRef {
    /// Index in the session's list of runs.
    pub run: usize,
    /// 0 is the start; n is the state after the n-th iteration.
    pub step: usize,
}

/// What is selected. Nothing here is saved or undone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Selection {
    /// The frame on the screen.
    pub frame: usize,
    /// The camera whose tile is active.
    pub camera: usize,
    /// The limb that is held; its second joint is the selected joint.
    pub limb: usize,
    /// The step on the screen, while the user looks back into a run; otherwise the document's pose is shown.
    pub step: Option<StepRef>,
}

impl Selection {
    /// Goes to a frame and leaves the run that was looked into.
    pub fn go_to_frame(&mut self, frame: usize, frame_count: usize) {
        self.frame = frame.min(frame_count.saturating_sub(1));
        self.step = None;
    }
}
