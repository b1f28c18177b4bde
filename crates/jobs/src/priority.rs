//! What is done first, and on which thread.

/// The threads: each does the most urgent of its jobs. A search that takes seconds must not hold up a drag, neither may
/// hold up the copy of unsaved work, and the scene is drawn while silhouettes are predicted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Crew {
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
    /// All of them, with the names of their threads.
    pub(super) const ALL: [(Self, &'static str); 4] = [
        (Self::Screen, "backlit worker"),
        (Self::Drawing, "backlit scene"),
        (Self::Saving, "backlit files"),
        (Self::Long, "backlit long work"),
    ];

    pub(super) const fn of(priority: u8) -> Self {
        Self::ALL[(priority >> LEVEL_BITS) as usize].0
    }
}

const LEVEL_BITS: u8 = 6;

/// How urgent a kind of work is, and which thread does it, as the parameter of its task's type. Of one thread's the smallest
/// level, 0 to 63, goes first.
pub const fn priority(crew: Crew, level: u8) -> u8 {
    assert!(level < 1 << LEVEL_BITS, "there is no such level");
    ((crew as u8) << LEVEL_BITS) + level
}
