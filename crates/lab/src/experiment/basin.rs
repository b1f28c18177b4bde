//! The basin of attraction: how far off a start may be, and still end at the truth.
//!
//! Success is a mean distance of the leaf joints and the root from the truth's below 20 mm.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, FitView, Preset};
use backlit_tracking::render::RendererKind;
use backlit_tracking::search::{SearchOptions, WithoutStart, WithoutStartError, without_start};
use backlit_tracking::statistics::Statistics;
use serde::Serialize;

use super::{ExperimentError, FitChoice, Progress};
use backlit_formats::starts_file::Start;

/// Below this mean distance a fit has found its truth, millimetres.
pub const SUCCESS_MM: f64 = 20.0;

/// How every start is fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Numbers of cameras.
    pub cameras: Vec<usize>,
    /// The preset that the fit begins with.
    pub preset: Preset,
    /// The solid that stands for a limb.
    pub renderer: RendererKind,
    /// Whether annealing and priors follow the scale of what is seen.
    pub scaled: bool,
    /// Looking for other hypotheses; `None` goes downhill from the start alone.
    pub hypotheses: Option<SearchOptions>,
    /// Whether the starts are ignored, and the search begins in the visual hull.
    pub no_start: bool,
}

impl Options {
    /// What a preset does at its best: the robust one scaled and with hypotheses, the report's as it is.
    #[must_use]
    pub fn of(preset: Preset) -> Self {
        let is_robust = preset == Preset::Robust;
        Self {
            cameras: vec![1, 2, 4],
            preset,
            renderer: RendererKind::Capsule,
            scaled: is_robust,
            hypotheses: is_robust.then(SearchOptions::default),
            no_start: false,
        }
    }

    /// How every start is fitted.
    #[must_use]
    pub fn choice(&self) -> FitChoice {
        let mut fit = FitOptions { renderer: self.renderer, ..FitOptions::preset(self.preset) };
        fit.to_scale &= self.scaled;
        FitChoice { name: self.preset.label().to_owned(), fit, hypotheses: self.hypotheses.clone() }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self::of(Preset::Robust)
    }
}

/// What came of it: one entry a number of cameras.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// In the order of the options.
    pub basins: Vec<Basin>,
}

/// The basin with one number of cameras.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Basin {
    /// Cameras.
    pub cameras: usize,
    /// Fraction of starts that found their truth, by degrees off.
    pub success: BTreeMap<u32, f64>,
    /// Median of the mean distances, by degrees off.
    pub median_mm: BTreeMap<u32, f64>,
    /// Mean wall time of a start, milliseconds.
    pub ms_per_start: f64,
}

/// Fits all starts, one after the other on one core; without starts on as many as there are.
///
/// # Errors
/// A fit that cannot begin, a number of cameras that the starts do not have, or `cancel`.
pub fn run(
    options: &Options,
    starts: &[Start],
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    let choice = options.choice();
    let (mut done, total) = (0, options.cameras.len() * starts.len());
    let mut basins = Vec::new();
    for &cameras in &options.cameras {
        let mut errors: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
        let mut seconds = 0.0;
        for start in starts {
            on_progress(Progress { done, total });
            done += 1;
            let Some(views) = start.views.get(&cameras) else {
                let value = cameras as f64;
                let expected = "a number of cameras that the starts have";
                return Err(ExperimentError::Option { option: "cameras", value, expected });
            };
            let began = Instant::now();
            let pose = if options.no_start {
                end_without_start(&choice, &start.model, views, cancel)?
            } else {
                Some(choice.end(&start.model, views.clone(), &start.start, cancel)?)
            };
            seconds += began.elapsed().as_secs_f64();
            let error = pose.map_or(f64::INFINITY, |pose| leaf_error_mm(&start.model, &pose, &start.truth));
            errors.entry(start.degrees).or_default().push(error);
        }
        let success = |list: &Vec<f64>| {
            list.iter().filter(|&&error| error < SUCCESS_MM).count() as f64 / list.len() as f64
        };
        let median = |list: &Vec<f64>| Statistics::of(list).map_or(0.0, |all| all.median);
        basins.push(Basin {
            cameras,
            success: errors.iter().map(|(&degrees, list)| (degrees, success(list))).collect(),
            median_mm: errors.iter().map(|(&degrees, list)| (degrees, median(list))).collect(),
            ms_per_start: 1e3 * seconds / starts.len().max(1) as f64,
        });
    }
    on_progress(Progress { done, total });
    Ok(Report { basins })
}

/// Where a search without a start ends; `None` where silhouettes of a few pixels do not meet.
fn end_without_start(
    choice: &FitChoice,
    model: &Arc<Model>,
    views: &[FitView],
    cancel: &CancelToken,
) -> Result<Option<Pose>, ExperimentError> {
    match without_start(model, views, &WithoutStart::for_fit(&choice.fit), cancel) {
        Ok(found) => Ok(Some(found.pose().clone())),
        Err(WithoutStartError::Apart { .. }) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

/// Mean distance of all leaf joints and the root, millimetres.
#[must_use]
pub fn leaf_error_mm(model: &Model, a: &Pose, b: &Pose) -> f64 {
    let is_leaf = |limb: &usize| model.limbs().iter().all(|other| other.parent != Some(*limb));
    let (found, truth) = (Kinematics::new(model, a), Kinematics::new(model, b));
    let mut distances = vec![a.root.distance(b.root)];
    let leaves = (0..model.limbs().len()).filter(is_leaf);
    distances.extend(leaves.map(|limb| found.ends()[limb].distance(truth.ends()[limb])));
    1e3 * distances.iter().sum::<f64>() / distances.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::starts::{Draw, Level};

    #[test]
    fn hypotheses_find_what_going_downhill_does_not() {
        let levels = vec![Level { degrees: 30, metres: 0.15 }];
        let starts = Draw { starts: 8, levels, cameras: vec![4], ..Draw::default() }.draw().unwrap();
        let success = |options: Options| {
            let options = Options { cameras: vec![4], ..options };
            run(&options, &starts, &CancelToken::new(), |_| {}).unwrap().basins[0].success[&30]
        };
        let [report, downhill, search] = [
            Options::of(Preset::Report),
            Options { hypotheses: None, ..Options::default() },
            Options::default(),
        ]
        .map(success);
        assert!(report < downhill && downhill < search, "{report} {downhill} {search}");
        assert!(search > 0.85, "{search}");
    }

    #[test]
    fn without_a_start_four_cameras_find_the_truth() {
        let levels = vec![Level { degrees: 45, metres: 0.2 }];
        let starts = Draw { starts: 4, levels, cameras: vec![4], ..Draw::default() }.draw().unwrap();
        let options = Options { cameras: vec![4], no_start: true, ..Options::default() };
        let report = run(&options, &starts, &CancelToken::new(), |_| {}).unwrap();
        assert!(report.basins[0].success[&45] > 0.99, "{:?}", report.basins[0]);
    }

    #[test]
    fn the_same_starts_give_the_same_numbers() {
        let levels = vec![Level { degrees: 20, metres: 0.1 }];
        let starts = Draw { starts: 2, levels, cameras: vec![2], ..Draw::default() }.draw().unwrap();
        let options = Options { cameras: vec![2], ..Options::default() };
        let median = || {
            let report = run(&options, &starts, &CancelToken::new(), |_| {}).unwrap();
            report.basins[0].median_mm[&20].to_bits()
        };
        assert_eq!(median(), median());
        let missing = Options { cameras: vec![3], ..options.clone() };
        let error = run(&missing, &starts, &CancelToken::new(), |_| {}).unwrap_err();
        assert!(error.to_string().contains("cameras"), "{error}");
    }
}
