//! The fits that a demonstration shows.

use backlit_lab::experiment::{bias, fig51, fig52};
use backlit_tracking::body::Parameters;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::optimize::Method;
use backlit_tracking::render::{Ramp, RendererKind};

use super::Demonstration;

/// A fit from the start of the take, and the name of its curve.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PreparedRun {
    /// What distinguishes it.
    pub(crate) name: String,
    /// Its choices.
    pub(crate) fit: FitOptions,
}

impl Demonstration {
    /// The runs that begin by themselves. The last one's end is what stays on the screen.
    pub(crate) fn runs(self) -> Vec<PreparedRun> {
        match self {
            Self::SingleLimb => {
                // The cylinder last.
                let run = |renderer: RendererKind| PreparedRun {
                    name: renderer_name(renderer).to_owned(),
                    fit: FitOptions { renderer, ..FitOptions::preset(Preset::Report) },
                };
                fig51::RENDERERS.into_iter().rev().map(run).collect()
            }
            Self::OneCamera => vec![report()],
            Self::TwoCameras => vec![report(), tangent()],
            Self::Sequence | Self::TinySequence | Self::RealFootage => Vec::new(),
            Self::Bias => {
                let looks =
                    bias::Options::default().looks.into_iter().filter(|look| look.data != bias::Data::Area);
                let mut runs: Vec<PreparedRun> =
                    looks.map(|look| PreparedRun { name: ramp_name(look.ramp), fit: look.fit() }).collect();
                // The thesis ramp last.
                runs.rotate_left(1);
                runs
            }
        }
    }

    /// The choices that the take begins with.
    pub(crate) fn fit(self) -> FitOptions {
        match self {
            Self::Sequence | Self::TinySequence => FitOptions::preset(Preset::Robust),
            Self::RealFootage => FitOptions::preset(Preset::Report),
            _ => self.runs().pop().map(|run| run.fit).unwrap_or_default(),
        }
    }

    /// How many of the take's cameras count, from the first on.
    pub(crate) const fn used_cameras(self) -> usize {
        match self {
            Self::SingleLimb | Self::OneCamera | Self::Bias => 1,
            _ => 2,
        }
    }
}

/// The report's fit with capsules.
fn report() -> PreparedRun {
    PreparedRun { name: Preset::Report.label().to_owned(), fit: FitOptions::preset(Preset::Report) }
}

/// The same cost lowered by Levenberg-Marquardt on tangent steps.
fn tangent() -> PreparedRun {
    let fit = FitOptions {
        parameters: Parameters::Tangent,
        method: Method::LevenbergMarquardt,
        damping: fig52::LM_DAMPING,
        ..FitOptions::preset(Preset::Report)
    };
    PreparedRun { name: "Tangent LM".to_owned(), fit }
}

fn renderer_name(renderer: RendererKind) -> &'static str {
    match renderer {
        RendererKind::Capsule => "Capsule",
        RendererKind::Cylinder => "Cylinder",
        RendererKind::SphereTree { .. } => "Sphere tree",
    }
}

fn ramp_name(ramp: Ramp) -> String {
    match ramp {
        Ramp::Thesis => "Thesis".to_owned(),
        Ramp::Half => "Half".to_owned(),
        Ramp::Width { px } => format!("Width {px} px"),
        Ramp::Distance { outer_px, .. } => format!("Distance {outer_px} px"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_valid_and_told_apart() {
        for demonstration in Demonstration::ALL {
            demonstration.fit().check().unwrap();
            let runs = demonstration.runs();
            for (index, run) in runs.iter().enumerate() {
                run.fit.check().unwrap();
                assert!(runs[..index].iter().all(|other| other.name != run.name), "{}", run.name);
            }
        }
        let last = |demonstration: Demonstration| demonstration.runs().pop().unwrap().name;
        assert_eq!(last(Demonstration::SingleLimb), "Cylinder");
        assert_eq!(last(Demonstration::Bias), "Thesis");
    }
}
