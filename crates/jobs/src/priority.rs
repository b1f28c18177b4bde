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

/// How urgent a kind of work is, and which thread does it. Of one thread's the smallest level, 0 to 63, goes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Priority(u8);

impl Priority {
    /// What the screen waits for.
    pub const fn screen(level: u8) -> Self {
        Self::of(Crew::Screen, level)
    }

    /// Large pictures.
    pub const fn drawing(level: u8) -> Self {
        Self::of(Crew::Drawing, level)
    }

    /// What is written, also if its task or the pool is dropped.
    pub const fn saving(level: u8) -> Self {
        Self::of(Crew::Saving, level)
    }

    /// What takes its time.
    pub const fn long(level: u8) -> Self {
        Self::of(Crew::Long, level)
    }

    /// As the parameter of a task's type.
    pub const fn code(self) -> u8 {
        self.0
    }

    pub(super) const fn of_code(code: u8) -> Self {
        Self(code)
    }

    pub(super) const fn crew(self) -> Crew {
        Crew::ALL[(self.0 >> LEVEL_BITS) as usize]
    }

    const fn of(crew: Crew, level: u8) -> Self {
        assert!(level < 1 << LEVEL_BITS, "there is no such level");
        Self(((crew as u8) << LEVEL_BITS) + level)
    }
}

const LEVEL_BITS: u8 = 6;
