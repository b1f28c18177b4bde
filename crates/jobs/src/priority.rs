//! What is done first, and on which thread.

/// The threads: each does the most urgent of its jobs. A search that takes seconds must not hold up a drag, neither may
/// hold up the copy of unsaved work, and the scene is drawn while silhouettes are predicted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Crew {
    /// What the screen waits for.
    Screen,
    /// The picture of the 3-D scene.
    Scene,
    /// What is written. It is done even if its task or the pool is dropped.
    Files,
    /// What takes its time.
    Long,
}

impl Crew {
    pub(super) const ALL: [Self; 4] = [Self::Screen, Self::Scene, Self::Files, Self::Long];

    pub(super) const fn thread_name(self) -> &'static str {
        match self {
            Self::Screen => "backlit worker",
            Self::Scene => "backlit scene",
            Self::Files => "backlit files",
            Self::Long => "backlit long work",
        }
    }
}

/// How urgent a kind of work is, and which thread does it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Priority {
    pub(super) crew: Crew,
    /// The smallest goes first.
    rank: u8,
}

impl Priority {
    /// The silhouettes of the pose on the screen.
    pub const PREDICTION: Self = Self::of(Crew::Screen, 0);
    /// The pictures of the laboratory's step.
    pub const LABORATORY_LOOK: Self = Self::of(Crew::Screen, 1);
    /// Opening a take.
    pub const OPEN: Self = Self::of(Crew::Screen, 2);
    /// Reading dropped files.
    pub const TAKE_IN: Self = Self::of(Crew::Screen, 3);
    /// Making the footage again for other cameras.
    pub const CALIBRATION: Self = Self::of(Crew::Screen, 4);
    /// Reading and segmenting the frame on the screen.
    pub const FRAME: Self = Self::of(Crew::Screen, 5);
    /// The fit of one frame.
    pub const FIT: Self = Self::of(Crew::Screen, 6);
    /// The laboratory's fits.
    pub const LABORATORY: Self = Self::of(Crew::Screen, 7);
    /// What the cameras see of the pose on the screen.
    pub const OBSERVABILITY: Self = Self::of(Crew::Screen, 8);

    /// The picture of the 3-D scene.
    pub const SCENE: Self = Self::of(Crew::Scene, 0);

    /// Writing a project or the copy of unsaved work.
    pub const SAVE: Self = Self::of(Crew::Files, 0);
    /// Writing the settings.
    pub const SETTINGS: Self = Self::of(Crew::Files, 1);
    /// Writing a table, a plot or numbers.
    pub const WRITE: Self = Self::of(Crew::Files, 2);

    /// A look at the take as a whole.
    pub const SURVEY: Self = Self::of(Crew::Long, 0);
    /// Painting and writing pictures. Somebody waits for them; trackers and basins go on after it.
    pub const EXPORT: Self = Self::of(Crew::Long, 1);
    /// The fit of frame after frame.
    pub const TRACK: Self = Self::of(Crew::Long, 2);
    /// The visual hull of the frame on the screen.
    pub const HULL: Self = Self::of(Crew::Long, 3);
    /// Names of the tracked motion.
    pub const MOTIONS: Self = Self::of(Crew::Long, 4);
    /// The check of the laboratory's gradients.
    pub const LABORATORY_CHECK: Self = Self::of(Crew::Long, 5);
    /// Fits of many starts of one frame.
    pub const BASIN: Self = Self::of(Crew::Long, 6);

    const fn of(crew: Crew, rank: u8) -> Self {
        Self { crew, rank }
    }
}
