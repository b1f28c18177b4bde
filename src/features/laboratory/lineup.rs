//! Which ways to fit are compared.

use backlit_lab::experiment::fig52;
use backlit_tracking::body::{Model, Parameters};
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::optimize::Method;
use backlit_tracking::render::{Ramp, RendererKind};

use crate::context::command::Variants;

/// Width of the ramp that is given by its width, pixels.
const WIDTH_PX: f64 = 2.0;
/// Widths of the ramp for distance data, pixels.
const DISTANCE_PX: [f64; 2] = [1.5, 3.0];

/// What distinguishes the fits that are compared.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Lineup {
    /// Cylinder, capsule, sphere tree.
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
    /// The same within a sentence, with its article.
    pub(crate) subject: &'static str,
    /// What it is, in two words.
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

impl Lineup {
    /// All of them, with their names.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::Renderers, "Renderers"),
        (Self::Ramps, "Ramps"),
        (Self::Presets, "Presets"),
        (Self::Updates, "Updates"),
    ];

    /// What the laboratory is called.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Renderers => "Renderer laboratory",
            Self::Ramps => "Ramp laboratory",
            Self::Presets => "Preset laboratory",
            Self::Updates => "Update laboratory",
        }
    }

    /// What is the same in all of them and what is not, in a sentence.
    pub(crate) const fn sentence(self) -> &'static str {
        match self {
            Self::Renderers => "Three renderers, same start, same solver.",
            Self::Ramps => "Four ramps, same start, same renderer, same solver.",
            Self::Presets => "Two presets, same start, same renderer.",
            Self::Updates => "Three updates, same start, same renderer, same ramp.",
        }
    }

    /// What a choice of it compares, for its tooltip.
    pub(crate) const fn tooltip(self) -> &'static str {
        match self {
            Self::Renderers => "Cylinder, capsule and sphere tree with the chosen solver",
            Self::Ramps => "How distance becomes grey: thesis, half, width and distance, each in one stage",
            Self::Presets => "The report’s fit beside the robust one, with the chosen renderer",
            Self::Updates => "Raw quaternions, tangent steps with fixed damping, Levenberg-Marquardt",
        }
    }

    /// How many there are, as a word of a button.
    pub const fn all_text(self) -> &'static str {
        match self {
            Self::Renderers | Self::Updates => "all three",
            Self::Ramps => "all four",
            Self::Presets => "both",
        }
    }

    /// The fits, made from the document's choices.
    pub(crate) fn entrants(self, base: &FitOptions, model: &Model) -> Vec<Entrant> {
        match self {
            Self::Renderers => renderers(base, model),
            Self::Ramps => ramps(base),
            Self::Presets => presets(base),
            Self::Updates => updates(base),
        }
    }
}

fn renderers(base: &FitOptions, model: &Model) -> Vec<Entrant> {
    let spheres = match base.renderer {
        RendererKind::SphereTree { spheres } => spheres,
        _ => None,
    };
    let of = |limb| RendererKind::equal_spheres(limb, spheres).unwrap_or(limb.spheres.len());
    let count: usize = model.limbs().iter().map(of).sum();
    let parts = [
        ("Cylinder", "the cylinder", "flat ends".to_owned(), RendererKind::Cylinder),
        ("Capsule", "the capsule", "round ends".to_owned(), RendererKind::Capsule),
        ("Sphere tree", "the sphere tree", format!("{count} spheres"), RendererKind::SphereTree { spheres }),
    ];
    let one = |(name, subject, note, renderer)| {
        let fit = FitOptions { renderer, ..base.clone() };
        Entrant { name, subject, note, fit }
    };
    parts.map(one).into()
}

fn ramps(base: &FitOptions) -> Vec<Entrant> {
    let [inner_px, outer_px] = DISTANCE_PX;
    let parts = [
        ("Thesis", "the thesis ramp", "half grey outside".to_owned(), Ramp::Thesis),
        ("Half", "the half ramp", "half grey on the limb".to_owned(), Ramp::Half),
        ("Width", "the narrow ramp", format!("{WIDTH_PX} px wide"), Ramp::Width { px: WIDTH_PX }),
        (
            "Distance",
            "the distance ramp",
            format!("{inner_px} px in, {outer_px} px out"),
            Ramp::Distance { inner_px, outer_px },
        ),
    ];
    let one =
        |(name, subject, note, ramp)| Entrant { name, subject, note, fit: base.clone().with_ramp(ramp) };
    parts.map(one).into()
}

fn presets(base: &FitOptions) -> Vec<Entrant> {
    let one = |preset: Preset, subject, note: &str| Entrant {
        name: preset.label(),
        subject,
        note: note.to_owned(),
        fit: FitOptions { renderer: base.renderer, ..FitOptions::preset(preset) },
    };
    vec![
        one(Preset::Report, "the report’s fit", "thesis ramp, fixed damping"),
        one(Preset::Robust, "the robust fit", "annealed, priors, limits"),
    ]
}

fn updates(base: &FitOptions) -> Vec<Entrant> {
    let parts = [
        ("Raw", "the raw update", "four numbers a joint", Parameters::Raw, Method::GaussNewton),
        ("Tangent", "the tangent update", "three numbers a joint", Parameters::Tangent, Method::GaussNewton),
        (
            "Tangent LM",
            "Levenberg-Marquardt",
            "takes bad steps back",
            Parameters::Tangent,
            Method::LevenbergMarquardt,
        ),
    ];
    let one = |(name, subject, note, parameters, method): (_, _, &str, _, _)| {
        // Each with the damping that it is used with.
        let damping = match method {
            Method::GaussNewton => FitOptions::preset(Preset::Report).damping,
            Method::LevenbergMarquardt => fig52::LM_DAMPING,
        };
        let fit = FitOptions { parameters, method, damping, ..base.clone() };
        Entrant { name, subject, note: note.to_owned(), fit }
    };
    parts.map(one).into()
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    #[test]
    fn every_fit_is_valid_and_has_a_name_of_its_own() {
        let model = builtin::full_body();
        for preset in Preset::ALL {
            for (lineup, _) in Lineup::ALL {
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
