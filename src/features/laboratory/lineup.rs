//! Which ways to fit are compared.

use std::borrow::Cow;

use backlit_document::fit_words;
use backlit_tracking::body::{Model, Parameters};
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::optimize::Method;
use backlit_tracking::render::{Ramp, RendererKind};
use backlit_ui::style::format;

use crate::context::command::Variants;

/// Width of the ramp that is given by its width, pixels.
const WIDTH_PX: f64 = 2.0;
/// Where Levenberg-Marquardt begins, as in Figs. 5.2 and 5.3.
const LM_DAMPING: f64 = 0.01;
/// Widths of the ramp for distance data, pixels.
const DISTANCE_PX: [f64; 2] = [1.5, 3.0];

/// What distinguishes the fits that are compared.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Lineup {
    /// All solids, in the order of the report.
    #[default]
    Renderers,
    /// Thesis, half, width, distance.
    Ramps,
    /// Report 2004, robust.
    Presets,
    /// Raw coefficients, tangent steps, Levenberg-Marquardt.
    Updates,
}

/// One of the fits that are compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Entrant {
    /// Its name at the head of a column.
    pub name: &'static str,
    /// What it is, in a few words.
    pub(crate) note: String,
    /// Its choices.
    pub(crate) fit: FitOptions,
}

impl From<Variants> for Lineup {
    fn from(variants: Variants) -> Self {
        match variants {
            Variants::Renderers => Self::Renderers,
            Variants::Presets => Self::Presets,
            Variants::Ramps => Self::Ramps,
        }
    }
}

/// A lineup in words.
#[derive(Debug)]
pub struct LineupWords {
    /// On its choice.
    pub name: &'static str,
    /// What the laboratory is called.
    pub title: &'static str,
    /// What is the same in all of them and what is not.
    pub(crate) sentence: Cow<'static, str>,
    /// What a choice of it compares.
    pub(crate) tooltip: Cow<'static, str>,
    /// How many there are, as a word of a button.
    pub all: Cow<'static, str>,
}

/// How many renderers there are, in words.
const RENDERERS: &str = ["no", "one", "two", "three", "four", "five"][RendererKind::ALL.len()];

impl Lineup {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Renderers, Self::Ramps, Self::Presets, Self::Updates];

    /// What is said of it.
    pub fn words(self) -> LineupWords {
        match self {
            Self::Renderers => LineupWords {
                name: "Renderers",
                title: "Renderer laboratory",
                sentence: format!("{} renderers, same start, same solver.", format::capitalised(RENDERERS))
                    .into(),
                tooltip: format!("{} with the chosen solver", fit_words::renderers()).into(),
                all: format!("all {RENDERERS}").into(),
            },
            Self::Ramps => LineupWords {
                name: "Ramps",
                title: "Ramp laboratory",
                sentence: "Four ramps, same start, same renderer, same solver.".into(),
                tooltip: "How distance becomes grey: thesis, half, width and distance, each in one stage"
                    .into(),
                all: "all four".into(),
            },
            Self::Presets => LineupWords {
                name: "Presets",
                title: "Preset laboratory",
                sentence: "Two presets, same start, same renderer.".into(),
                tooltip: "The report’s fit beside the robust one, with the chosen renderer".into(),
                all: "both".into(),
            },
            Self::Updates => LineupWords {
                name: "Updates",
                title: "Update laboratory",
                sentence: "Three updates, same start, same renderer, same ramp.".into(),
                tooltip: "Raw quaternions, tangent steps with fixed damping, Levenberg-Marquardt".into(),
                all: "all three".into(),
            },
        }
    }

    /// The fits, made from the document's choices.
    pub(crate) fn entrants(self, base: &FitOptions, model: &Model) -> Vec<Entrant> {
        let entrant = |name, note: &str, fit: FitOptions| Entrant { name, note: note.to_owned(), fit };
        match self {
            Self::Renderers => {
                let spheres = match base.renderer {
                    RendererKind::SphereTree { spheres } => spheres,
                    _ => None,
                };
                let of = |limb| RendererKind::equal_spheres(limb, spheres).unwrap_or(limb.spheres.len());
                let count: usize = model.limbs().iter().map(of).sum();
                let with = |kind: RendererKind| {
                    let (renderer, note) = match kind {
                        RendererKind::SphereTree { .. } => {
                            (RendererKind::SphereTree { spheres }, format!("{count} {}", kind.shape()))
                        }
                        other => (other, kind.shape().to_owned()),
                    };
                    entrant(kind.label(), &note, FitOptions { renderer, ..base.clone() })
                };
                RendererKind::in_report_order().map(with).to_vec()
            }
            Self::Ramps => {
                let [inner_px, outer_px] = DISTANCE_PX;
                let ramp = |name, note: &str, ramp| entrant(name, note, base.clone().with_ramp(ramp));
                vec![
                    ramp("Thesis", "half grey outside", Ramp::Thesis),
                    ramp("Half", "half grey on the limb", Ramp::Half),
                    ramp("Width", &format!("{WIDTH_PX} px wide"), Ramp::Width { px: WIDTH_PX }),
                    ramp(
                        "Distance",
                        &format!("{inner_px} px in, {outer_px} px out"),
                        Ramp::Distance { inner_px, outer_px },
                    ),
                ]
            }
            Self::Presets => {
                let preset = |preset: Preset, note| {
                    let fit = FitOptions { renderer: base.renderer, ..FitOptions::preset(preset) };
                    entrant(preset.label(), note, fit)
                };
                vec![
                    preset(Preset::Report, "thesis ramp, fixed damping"),
                    preset(Preset::Robust, "annealed, priors, limits"),
                ]
            }
            Self::Updates => {
                // Each with the damping that it is used with.
                let update = |name, note, parameters, method, damping| {
                    entrant(name, note, FitOptions { parameters, method, damping, ..base.clone() })
                };
                let fixed = FitOptions::preset(Preset::Report).damping;
                let (raw, tangent) = (Parameters::Raw, Parameters::Tangent);
                let (gauss_newton, lm) = (Method::GaussNewton, Method::LevenbergMarquardt);
                vec![
                    update("Raw", "four numbers a joint", raw, gauss_newton, fixed),
                    update("Tangent", "three numbers a joint", tangent, gauss_newton, fixed),
                    update("Tangent LM", "takes bad steps back", tangent, lm, LM_DAMPING),
                ]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    #[test]
    fn every_fit_is_valid_and_has_a_name_of_its_own() {
        let model = builtin::full_body();
        for preset in Preset::ALL {
            for lineup in Lineup::ALL {
                let entrants = lineup.entrants(&FitOptions::preset(preset), &model);
                for (index, entrant) in entrants.iter().enumerate() {
                    entrant.fit.check().unwrap();
                    let others = &entrants[..index];
                    assert!(others.iter().all(|o| o.name != entrant.name && o.fit != entrant.fit));
                }
            }
        }
    }

    #[test]
    fn spheres_are_counted() {
        let model = builtin::single_limb();
        let note = |spheres| {
            let renderer = RendererKind::SphereTree { spheres };
            let base = FitOptions { renderer, ..FitOptions::preset(Preset::Report) };
            Lineup::Renderers.entrants(&base, &model)[2].note.clone()
        };
        assert_eq!(note(Some(7)), "7 spheres");
        assert_ne!(note(None), "0 spheres");
    }
}
