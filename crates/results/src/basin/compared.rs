//! Ways of fitting that a basin compares, and how they and a map's directions are named.

use std::str::FromStr;

use backlit_document::run::{Run, RunChoices};
use backlit_document::run_names::{count_twins, plain_names};
use backlit_lab::experiment::FitChoice;
use backlit_lab::experiment::basin;
use backlit_lab::experiment::basin_map::{Angle, Direction};
use backlit_tracking::body::Model;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::render::RendererKind;
use serde::{Deserialize, Serialize};

/// Most fits that the current choices are compared with.
pub const MOST_COMPARED: usize = 3;
/// A way of fitting to compare with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ComparedWay {
    /// A preset, downhill from the start.
    Preset(Preset),
    /// The robust preset, with annealing by scale and a search for other hypotheses.
    Search,
}

impl ComparedWay {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Preset(Preset::Robust), Self::Preset(Preset::Report), Self::Search];

    /// In the order in which they are offered for a comparison.
    const OFFERED: [Self; 3] = [Self::Preset(Preset::Report), Self::Search, Self::Preset(Preset::Robust)];

    /// Its name.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Preset(Preset::Robust) => "Robust",
            Self::Preset(Preset::Report) => "Report 2004",
            Self::Search => "Robust, search",
        }
    }
}

/// A fit that the current choices are compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Compared {
    /// How it fits.
    pub way: ComparedWay,
    /// The solid that stands for a limb.
    pub renderer: RendererKind,
}

impl Compared {
    /// The choice of fit, without a name yet.
    pub fn choice(self) -> FitChoice {
        let mut choice = match self.way {
            ComparedWay::Preset(preset) => FitChoice::downhill("", FitOptions::preset(preset)),
            ComparedWay::Search => basin::Options::of(Preset::Robust).choice(),
        };
        choice.fit.renderer = self.renderer;
        choice
    }

    /// What to compare with next: the first way that is neither the current choices nor compared already.
    pub fn next(current: &FitOptions, compared: &[Self]) -> Self {
        let renderer = current.renderer;
        let is_new = |way: &ComparedWay| {
            let is_current = matches!(way, ComparedWay::Preset(preset) if FitOptions { renderer, ..FitOptions::preset(*preset) } == *current);
            !is_current && !compared.contains(&Self { way: *way, renderer })
        };
        let way = ComparedWay::OFFERED.into_iter().find(is_new).unwrap_or(ComparedWay::Search);
        Self { way, renderer }
    }
}

/// What is wrong with the words of a fit to compare with.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0:?}: expected robust, report or search, and a solid behind a colon if wanted: search:cylinder")]
pub struct ParseComparedError(String);

impl FromStr for Compared {
    type Err = ParseComparedError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong = || ParseComparedError(text.to_owned());
        let (way, solid) = text.split_once(':').unwrap_or((text, "capsule"));
        let way = match way {
            "search" => ComparedWay::Search,
            preset => ComparedWay::Preset(preset.parse().ok().ok_or_else(wrong)?),
        };
        Ok(Self { way, renderer: solid.parse().ok().ok_or_else(wrong)? })
    }
}

/// Names choices of fit by what differs, and those that search by that.
pub fn name_choices(choices: &mut [FitChoice]) {
    let run = |choice: &FitChoice| Run {
        choices: RunChoices { fit: choice.fit.clone().into(), ..RunChoices::default() },
        is_shown: true,
        ..Run::default()
    };
    let runs: Vec<Run> = choices.iter().map(run).collect();
    let searches = |(name, choice): (String, &FitChoice)| {
        if choice.hypotheses.is_some() { format!("{name}, search") } else { name }
    };
    let plain = plain_names(&runs).into_iter().zip(choices.iter()).map(searches).collect();
    for (choice, name) in choices.iter_mut().zip(count_twins(plain)) {
        choice.name = name;
    }
}

/// The name of a direction: "right forearm, flexion".
pub fn direction_name(model: &Model, direction: Direction) -> String {
    let owner = model.rotation_owners().get(direction.rotation).and_then(|limb| model.limbs().get(*limb));
    let limb = owner.map_or("", |limb| limb.name.as_str());
    format!("{limb}, {}", angle_name(direction.angle))
}

/// The name of an angle, as the command line and the window say it.
pub const fn angle_name(angle: Angle) -> &'static str {
    match angle {
        Angle::Flexion => "flexion",
        Angle::Sideways => "sideways",
        Angle::Twist => "twist",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_to_compare_with_is_read() {
        let compared = |text: &str| text.parse::<Compared>();
        let search = Compared { way: ComparedWay::Search, renderer: RendererKind::Cylinder };
        assert_eq!(compared("search:cylinder"), Ok(search));
        let report = Compared { way: ComparedWay::Preset(Preset::Report), renderer: RendererKind::Capsule };
        assert_eq!(compared("report"), Ok(report));
        for wrong in ["", "best", "report:ball", "search:"] {
            assert!(compared(wrong).unwrap_err().to_string().contains("search:cylinder"), "{wrong}");
        }
    }

    #[test]
    fn what_is_compared_next_is_new() {
        let robust = FitOptions::preset(Preset::Robust);
        let mut compared: Vec<Compared> = Vec::new();
        for way in [ComparedWay::Preset(Preset::Report), ComparedWay::Search, ComparedWay::Search] {
            let next = Compared::next(&robust, &compared);
            assert_eq!(next.way, way);
            compared.push(next);
        }
        assert_eq!(Compared::next(&FitOptions::preset(Preset::Report), &[]).way, ComparedWay::Search);
    }
}
