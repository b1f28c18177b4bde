//! Which ways to begin there are.

use backlit_lab::experiment::begin::Method;

/// A way to begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Way {
    Particles,
    Ramp,
    Templates,
    Search,
    Report,
    /// A body acquired from nothing: pose and sizes.
    Body,
}

impl Way {
    /// Those that are compared with one another.
    pub(super) const COMPARED: [Self; 5] =
        [Self::Particles, Self::Ramp, Self::Templates, Self::Search, Self::Report];

    /// What the lab calls it; the body is no method of the lab's comparison.
    pub(super) const fn method(self) -> Option<Method> {
        Some(match self {
            Self::Particles => Method::Particles,
            Self::Ramp => Method::Ramp,
            Self::Templates => Method::Templates,
            Self::Search => Method::Search,
            Self::Report => Method::Report,
            Self::Body => return None,
        })
    }

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Particles => "Particle filter",
            Self::Ramp => "Softened ramp",
            Self::Templates => "Templates",
            Self::Search => "Search",
            Self::Report => "Report 2004",
            Self::Body => "Acquired body",
        }
    }

    /// In the middle of a sentence.
    pub(super) const fn lower_case(self) -> &'static str {
        match self {
            Self::Particles => "the particle filter",
            Self::Ramp => "the softened ramp",
            Self::Templates => "templates",
            Self::Search => "the search",
            Self::Report => "the way of 2004",
            Self::Body => "a body from nothing",
        }
    }

    /// One sentence about what it does, without its full stop.
    pub(super) const fn explanation(self) -> &'static str {
        match self {
            Self::Particles => {
                "Hundreds of bodies are moved at random and weighed by how well they explain the silhouettes; the heaviest \
                 have children. First the trunk, then every arm, leg and the head"
            }
            Self::Ramp => "The fit goes downhill on wide, soft outlines, which become sharp step by step",
            Self::Templates => {
                "A ball finds the head, a capsule hangs from it and turns to the middle of its pixels, then limb after limb. \
                 The start plays no part"
            }
            Self::Search => "The program's own: fits from many places, with arms, legs and head found again",
            Self::Report => "The fit of the 2004 report goes downhill, as it was",
            Self::Body => {
                "Nothing is known, the person's size neither: the search finds the pose of a scaled body, then every limb \
                 shrinks until it holds no background and grows until background enters"
            }
        }
    }
}
