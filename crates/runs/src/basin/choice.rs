//! How a start is fitted: what basins are compared for.

use std::str::FromStr;

use backlit_document::run::{Run, RunChoices};
use backlit_document::run_names::{count_twins, plain_names};
use backlit_tracking::body::Pose;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Fit, FitOptions, Preset};
use backlit_tracking::metrics::leaf_error_mm;
use backlit_tracking::render::RendererKind;
use backlit_tracking::search::{
    SearchOptions, WithoutStartError, WithoutStartOptions, fit_best, without_start,
};
use serde::{Deserialize, Serialize};

use super::{BasinError, Subject};

/// How every start is fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitChoice {
    /// What distinguishes it from the others beside it.
    pub name: String,
    /// The choices of the fit.
    pub fit: FitOptions,
    /// Looking for other hypotheses; `None` goes downhill from the start alone.
    pub hypotheses: Option<SearchOptions>,
    /// Whether starts are ignored, and the search begins in the visual hull.
    #[serde(skip)]
    pub ignores_start: bool,
}

impl FitChoice {
    /// A fit that goes downhill from the start, with the choices as they are.
    #[must_use]
    pub fn downhill(name: &str, fit: FitOptions) -> Self {
        Self { name: name.to_owned(), fit, hypotheses: None, ignores_start: false }
    }

    /// A preset at its best: the robust one with a search for hypotheses, the report's as it is.
    #[must_use]
    pub fn best_of(preset: Preset) -> Self {
        let hypotheses = (preset == Preset::Robust).then(SearchOptions::default);
        Self { hypotheses, ..Self::downhill(preset.label(), FitOptions::preset(preset)) }
    }

    /// Fits from a start to the end. `None` where the start is ignored and silhouettes of a few pixels do not meet.
    ///
    /// # Errors
    /// Returns an error if the fit cannot begin, or if `cancel` was given.
    pub fn end(
        &self,
        subject: &Subject,
        start: &Pose,
        cancel: &CancelToken,
    ) -> Result<Option<Pose>, BasinError> {
        let Subject { model, views, .. } = subject;
        if self.ignores_start {
            return match without_start(model, views, &WithoutStartOptions::for_fit(&self.fit), cancel) {
                Ok(found) => Ok(Some(found.pose().clone())),
                Err(WithoutStartError::Apart { .. }) => Ok(None),
                Err(WithoutStartError::Cancelled) => Err(BasinError::Cancelled),
                Err(error) => Err(error.into()),
            };
        }
        let (model, views, options) = (model.clone(), views.clone(), self.fit.clone());
        let mut fit = match &self.hypotheses {
            Some(effort) => fit_best(model, views, start, options, effort, cancel)?.0,
            None => Fit::new(model, views, start.clone(), options)?,
        };
        let pose = fit.run(cancel, |_| {}).pose;
        if cancel.is_cancelled() { Err(BasinError::Cancelled) } else { Ok(Some(pose)) }
    }

    /// How far from a target a fit ends, millimetres; infinitely far where no pose was found.
    ///
    /// # Errors
    /// As [`end`](Self::end).
    pub fn error_mm(
        &self,
        subject: &Subject,
        start: &Pose,
        target: &Pose,
        cancel: &CancelToken,
    ) -> Result<f64, BasinError> {
        let end = self.end(subject, start, cancel)?;
        Ok(end.map_or(f64::INFINITY, |end| leaf_error_mm(&subject.model, &end, target)))
    }
}

/// Most fits that the current choices are compared with.
pub const MOST_COMPARED: usize = 3;

/// A method of fitting to compare with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ComparedMethod {
    /// A preset, downhill from the start.
    Preset(Preset),
    /// The robust preset, with annealing by scale and a search for other hypotheses.
    Search,
}

impl ComparedMethod {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Preset(Preset::Robust), Self::Preset(Preset::Report), Self::Search];

    /// In the order in which they are offered for a comparison.
    const OFFERED: [Self; 3] = [Self::Preset(Preset::Report), Self::Search, Self::Preset(Preset::Robust)];

    /// Its name.
    #[must_use]
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
pub struct ComparedFit {
    /// How it fits.
    #[serde(rename = "way")]
    pub method: ComparedMethod,
    /// The solid that stands for a limb.
    pub renderer: RendererKind,
}

impl ComparedFit {
    /// The choice of fit, without a name yet.
    #[must_use]
    pub fn choice(self) -> FitChoice {
        let mut choice = match self.method {
            ComparedMethod::Preset(preset) => FitChoice::downhill("", FitOptions::preset(preset)),
            ComparedMethod::Search => FitChoice::best_of(Preset::Robust),
        };
        choice.fit.renderer = self.renderer;
        choice
    }

    /// What to compare with next: the first method that is neither the current choices nor compared already.
    #[must_use]
    pub fn next(current: &FitOptions, compared: &[Self]) -> Self {
        let renderer = current.renderer;
        let is_new = |method: &ComparedMethod| {
            let is_current = matches!(method, ComparedMethod::Preset(preset)
                if FitOptions { renderer, ..FitOptions::preset(*preset) } == *current);
            !is_current && !compared.contains(&Self { method: *method, renderer })
        };
        let method = ComparedMethod::OFFERED.into_iter().find(is_new).unwrap_or(ComparedMethod::Search);
        Self { method, renderer }
    }
}

/// Why a word names no fit to compare with.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0:?}: expected robust, report or search, and a solid behind a colon if wanted: search:cylinder")]
pub struct ParseComparedError(String);

impl FromStr for ComparedFit {
    type Err = ParseComparedError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong = || ParseComparedError(text.to_owned());
        let (method, solid) = text.split_once(':').unwrap_or((text, RendererKind::default().name()));
        let method = match method {
            "search" => ComparedMethod::Search,
            preset => ComparedMethod::Preset(preset.parse().ok().ok_or_else(wrong)?),
        };
        Ok(Self { method, renderer: solid.parse().ok().ok_or_else(wrong)? })
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
    for (choice, name) in choices.iter_mut().zip(count_twins(plain, |_| false)) {
        choice.name = name;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_to_compare_with_is_read() {
        let compared = |text: &str| text.parse::<ComparedFit>();
        let search = ComparedFit { method: ComparedMethod::Search, renderer: RendererKind::Cylinder };
        assert_eq!(compared("search:cylinder"), Ok(search));
        let method = ComparedMethod::Preset(Preset::Report);
        assert_eq!(compared("report"), Ok(ComparedFit { method, renderer: RendererKind::Capsule }));
        for wrong in ["", "best", "report:ball", "search:"] {
            assert!(compared(wrong).unwrap_err().to_string().contains("search:cylinder"), "{wrong}");
        }
    }

    #[test]
    fn what_is_compared_next_is_new() {
        let robust = FitOptions::preset(Preset::Robust);
        let mut compared: Vec<ComparedFit> = Vec::new();
        let methods =
            [ComparedMethod::Preset(Preset::Report), ComparedMethod::Search, ComparedMethod::Search];
        for method in methods {
            let next = ComparedFit::next(&robust, &compared);
            assert_eq!(next.method, method);
            compared.push(next);
        }
        let next = ComparedFit::next(&FitOptions::preset(Preset::Report), &[]);
        assert_eq!(next.method, ComparedMethod::Search);
    }
}
