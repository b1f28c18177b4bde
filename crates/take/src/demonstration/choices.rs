//! The fits that a demonstration shows.

use backlit_lab::experiment::bias;
use backlit_lab::synthetic::exercise;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::render::Ramp;

use super::Demonstration;

impl Demonstration {
    /// The choices that the take begins with.
    pub fn fit(self) -> FitOptions {
        match self {
            Self::Sequence
            | Self::TinySequence
            | Self::Cues
            | Self::Spheres
            | Self::Begin
            | Self::Motions => FitOptions::preset(Preset::Robust),
            Self::Bias => {
                let mut looks = bias::Options::default().looks.into_iter();
                let thesis = looks.find(|look| look.ramp == Ramp::Thesis && look.data != bias::Data::Area);
                thesis.map(|look| look.fit()).unwrap_or_default()
            }
            _ => FitOptions::preset(Preset::Report),
        }
    }

    /// Whether the document begins with the true poses as key poses.
    pub fn begins_posed(self) -> bool {
        self == Self::Spheres
    }

    /// How many of the take's cameras count, from the first on.
    pub const fn used_cameras(self) -> usize {
        match self {
            Self::SingleLimb | Self::OneCamera | Self::Bias => 1,
            Self::Spheres => 4,
            Self::Motions => exercise::MOST_CAMERAS,
            _ => 2,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_choices_are_valid() {
        for demonstration in Demonstration::ALL {
            demonstration.fit().check().unwrap();
        }
        assert_eq!(Demonstration::Bias.fit().stages[0].ramp, Ramp::Thesis);
    }
}
