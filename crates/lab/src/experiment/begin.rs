//! Ways to begin ([`initialisation`](backlit_tracking::initialisation)): where a fit is to start when the pose is hardly known or
//! not at all (the report's 6.4), one beside another, from drawn starts or on the frames of a take ([`footage`]).

pub mod footage;

use std::collections::BTreeMap;
use std::time::Instant;

use backlit_formats::starts_file::Start;
use backlit_tracking::body::Pose;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::initialisation::{InitialisationInputs, InitialisationMethod, InitialisationOptions};
use backlit_tracking::metrics::leaf_error_mm;
use backlit_tracking::statistics::{Statistics, Z_95, wilson};
use serde::Serialize;

use super::{ExperimentError, Progress};

/// Below this mean distance a fit has found its truth, millimetres.
const SUCCESS_MM: f64 = 20.0;

/// What to try.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Ways to begin.
    pub methods: Vec<InitialisationMethod>,
    /// Numbers of cameras.
    pub cameras: Vec<usize>,
    /// Whether the starts are ignored.
    pub no_start: bool,
    /// The methods' own choices.
    #[serde(flatten)]
    pub choices: InitialisationOptions,
}

impl Default for Options {
    fn default() -> Self {
        let methods = InitialisationMethod::COMPARED.to_vec();
        Self { methods, cameras: vec![2], no_start: false, choices: InitialisationOptions::default() }
    }
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// By number of cameras, then by how far the starts were off, then by method.
    pub rows: Vec<MethodRow>,
}

/// One method from all starts of one kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodRow {
    /// The method.
    pub method: InitialisationMethod,
    /// Cameras.
    pub cameras: usize,
    /// Degrees that every joint of the starts was off; `None` without starts.
    pub degrees: Option<u32>,
    /// Starts that were tried.
    pub tried: usize,
    /// Those that found their truth.
    pub found: usize,
    /// Ends of the interval that holds the true share 95 times of 100.
    pub interval: [f64; 2],
    /// Median of the mean distances from the truth, millimetres.
    pub median_mm: f64,
    /// The same before the last fit; `None` for methods that are one.
    pub median_before_mm: Option<f64>,
    /// Mean evaluations of Λ of a start.
    pub evaluations: f64,
    /// Median wall time of a start, milliseconds.
    pub ms: f64,
}

/// One start by one method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BeginTrial {
    error_mm: f64,
    before_mm: Option<f64>,
    evaluations: usize,
    seconds: f64,
    found: bool,
}

impl BeginTrial {
    /// Tries a method; a pose with an error of at most `found_mm` is found.
    fn run(
        options: &Options,
        method: InitialisationMethod,
        inputs: &InitialisationInputs<'_>,
        error_mm: impl Fn(&Pose) -> f64,
        is_found: impl Fn(f64) -> bool,
    ) -> Result<Self, ExperimentError> {
        let began = Instant::now();
        let result = options.choices.run(method, inputs, &mut |_| {})?;
        let seconds = began.elapsed().as_secs_f64();
        let before_mm = result.before.as_ref().map(&error_mm);
        let error_mm = result.pose().map_or(f64::INFINITY, error_mm);
        let (evaluations, found) = (result.evaluations.unwrap_or(0), is_found(error_mm));
        Ok(Self { error_mm, before_mm, evaluations, seconds, found })
    }
}

/// Tries all methods from all starts.
///
/// # Errors
/// Returns an error if a fit cannot begin, if the starts lack a number of cameras, or if it is cancelled.
pub fn run(
    options: &Options,
    starts: &[Start],
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    let (mut done, total) = (0, options.cameras.len() * starts.len() * options.methods.len());
    let mut trials: BTreeMap<(usize, Option<u32>, usize), Vec<BeginTrial>> = BTreeMap::new();
    for &cameras in &options.cameras {
        for start in starts {
            let Some(views) = start.views.get(&cameras) else {
                let value = cameras as f64;
                let expected = "a number of cameras that the starts have";
                return Err(ExperimentError::Option { option: "cameras", value, expected });
            };
            let given = (!options.no_start).then_some(&start.start);
            let inputs = InitialisationInputs { model: &start.model, views, start: given, cancel };
            let error = |pose: &Pose| leaf_error_mm(&start.model, pose, &start.truth);
            for (index, &method) in options.methods.iter().enumerate() {
                on_progress(Progress { done, total });
                done += 1;
                let trial = BeginTrial::run(options, method, &inputs, error, |error| error < SUCCESS_MM)?;
                let degrees = given.map(|_| start.degrees);
                trials.entry((cameras, degrees, index)).or_default().push(trial);
            }
        }
    }
    on_progress(Progress { done, total });
    let row = |((cameras, degrees, method), trials): (&(usize, Option<u32>, usize), &Vec<BeginTrial>)| {
        MethodRow::of(options.methods[*method], *cameras, *degrees, trials)
    };
    Ok(Report { rows: trials.iter().map(row).collect() })
}

impl MethodRow {
    fn of(method: InitialisationMethod, cameras: usize, degrees: Option<u32>, trials: &[BeginTrial]) -> Self {
        let median = |list: Vec<f64>| Statistics::of(&list).map(|all| all.median);
        let (tried, found) = (trials.len(), trials.iter().filter(|trial| trial.found).count());
        let mean =
            |value: fn(&BeginTrial) -> f64| trials.iter().map(value).sum::<f64>() / tried.max(1) as f64;
        Self {
            method,
            cameras,
            degrees,
            tried,
            found,
            interval: wilson(found, tried, Z_95),
            median_mm: median(trials.iter().map(|trial| trial.error_mm).collect()).unwrap_or(f64::INFINITY),
            median_before_mm: median(trials.iter().filter_map(|trial| trial.before_mm).collect()),
            evaluations: mean(|trial| trial.evaluations as f64),
            ms: 1e3 * median(trials.iter().map(|trial| trial.seconds).collect()).unwrap_or(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::starts::Draw;
    use backlit_tracking::search::start::Level;

    fn starts(degrees: u32, count: usize) -> Vec<Start> {
        let levels = vec![Level { degrees, metres: 0.1 }];
        Draw { starts: count, levels, cameras: vec![2], ..Draw::default() }.draw().unwrap()
    }

    #[test]
    fn every_method_is_tried_and_counted_and_twice_the_same() {
        let starts = starts(10, 2);
        let options = Options::default();
        let all = || run(&options, &starts, &CancelToken::new(), |_| {}).unwrap();
        let report = all();
        assert_eq!(report.rows.len(), InitialisationMethod::COMPARED.len());
        for row in &report.rows {
            assert!(row.tried == 2 && row.evaluations > 10.0 && row.median_mm.is_finite(), "{row:?}");
            assert_eq!(row.degrees, Some(10));
        }
        let errors =
            |report: &Report| -> Vec<u64> { report.rows.iter().map(|row| row.median_mm.to_bits()).collect() };
        assert_eq!(errors(&report), errors(&all()));
        let of = |method| report.rows.iter().find(|row| row.method == method).unwrap();
        let ramp = of(InitialisationMethod::Ramp);
        assert_eq!(ramp.found, 2, "{report:?}");
        assert!(of(InitialisationMethod::Particles).evaluations > 10.0 * ramp.evaluations);
    }

    #[test]
    fn without_a_start_none_is_looked_at() {
        let starts = starts(45, 1);
        let mut moved = starts.clone();
        moved[0].start = moved[0].start.retract(
            backlit_tracking::body::Parameters::Tangent,
            &vec![0.7; 3 + 3 * starts[0].model.rotation_count()],
        );
        let options = Options { no_start: true, ..Options::default() };
        let medians = |starts: &[Start]| -> Vec<f64> {
            let report = run(&options, starts, &CancelToken::new(), |_| {}).unwrap();
            report.rows.iter().map(|row| row.median_mm).collect()
        };
        assert_eq!(medians(&starts), medians(&moved));
    }

    #[test]
    fn cameras_that_the_starts_do_not_have_are_named() {
        let options = Options { cameras: vec![3], ..Options::default() };
        let error = run(&options, &starts(5, 1), &CancelToken::new(), |_| {}).unwrap_err();
        assert!(error.to_string().contains("cameras"), "{error}");
    }
}
