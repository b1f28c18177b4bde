//! What is done first, and on which thread.

/// The threads: each does the most urgent of its jobs. A search that takes seconds must not hold up a drag, neither may
/// hold up the copy of unsaved work, and the scene is drawn while silhouettes are predicted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Crew {
    /// What the screen waits for.
    Screen,
    /// Large pictures.
    Drawing,
    /// What is written. It is done even if its task or the pool is dropped.
    Saving,
    /// What takes its time.
    Long,
}

impl Crew {
    pub(super) const ALL: [Self; 4] = [Self::Screen, Self::Drawing, Self::Saving, Self::Long];

    pub(super) const fn thread_name(self) -> &'static str {
        match self {
            Self::Screen => "backlit worker",
            Self::Drawing => "backlit scene",
            Self::Saving => "backlit files",
            Self::Long => "backlit long work",
        }
    }
}

/// How urgent a kind of work is, and which thread does it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Priority {
    pub(super) crew: Crew,
    /// The smallest goes first.
    level: u8,
}

impl Priority {
    /// What the screen waits for; the smallest level goes first.
    pub const fn screen(level: u8) -> Self {
        Self { crew: Crew::Screen, level }
    }

    /// Large pictures.
    pub const fn drawing(level: u8) -> Self {
        Self { crew: Crew::Drawing, level }
    }

    /// What is written, also if its task or the pool is dropped.
    pub const fn saving(level: u8) -> Self {
        Self { crew: Crew::Saving, level }
    }

    /// What takes its time.
    pub const fn long(level: u8) -> Self {
        Self { crew: Crew::Long, level }
    }
}
