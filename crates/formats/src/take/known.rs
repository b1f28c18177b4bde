//! What a plate knows of its pixels.

/// What a plate knows of a pixel, by its alpha channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Known {
    /// Nothing: alpha below 32.
    Nothing,
    /// The subject covers it in every frame: alpha from 32 to 127.
    AlwaysSubject,
    /// What is there without the subject: alpha from 128 on.
    Scene,
}

impl Known {
    /// From this alpha on the scene is known.
    pub(super) const OPAQUE: u8 = 128;
    /// From this alpha on the subject covers the pixel.
    const COVERED: u8 = 32;

    /// The alpha that says so in a file.
    #[must_use]
    pub fn alpha(self) -> u8 {
        match self {
            Self::Nothing => 0,
            Self::AlwaysSubject => 64,
            Self::Scene => 255,
        }
    }

    pub(super) fn of_alpha(alpha: u8) -> Self {
        match alpha {
            0..Self::COVERED => Self::Nothing,
            Self::COVERED..Self::OPAQUE => Self::AlwaysSubject,
            Self::OPAQUE.. => Self::Scene,
        }
    }
}
