//! Ways to begin: where a fit is to start when the pose is hardly known or not at all (the report's 6.4), one beside another.
//!
//! | [`Method`] | from a given start | without one |
//! |---|---|---|
//! | `report` | the 2004 method downhill: its ramp as it is | the same from a body standing in the hull, facing eight ways; the best by cost |
//! | `ramp` | the softened ramp, annealed, downhill | likewise |
//! | `particles` | the partitioned, annealed particle filter | from those eight bodies |
//! | `templates` | head, trunk, limb after limb, whatever the start | the same |
//! | `search` | the program's own search for other hypotheses | its search from the hull |
//!
//! What particles and templates end with is refined by the same fit downhill (`method`); how good it was before that is told too.
//! Evaluations are predictions Λ of a body in all cameras, with or without derivatives, in whatever coarseness; looks at single limbs
//! in the search's sketch and at single templates are not counted, their time is.
//!
//! | file | holds |
//! |---|---|
//! | `method` | how each of them begins and ends |
//! | [`footage`] | a take's frames with keypoints |

pub mod footage;
mod method;

use std::collections::BTreeMap;
use std::time::Instant;

use backlit_formats::starts_file::Start;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::metrics::leaf_error_mm;
use backlit_tracking::particles::ParticleOptions;
use backlit_tracking::statistics::{Statistics, Z_95, wilson};
use serde::Serialize;

pub use method::{Beginning, End, Method, Step, Watch, begin, begin_watched};

use super::{ExperimentError, Progress};

/// Below this mean distance a fit has found its truth, millimetres.
const SUCCESS_MM: f64 = 20.0;

/// What to try.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Ways to begin.
    pub methods: Vec<Method>,
    /// Numbers of cameras.
    pub cameras: Vec<usize>,
    /// Whether the starts are ignored.
    pub no_start: bool,
    /// Particles from a given start.
    pub particles: ParticleOptions,
    /// Particles without one.
    pub particles_no_start: ParticleOptions,
    /// Places of the head that templates go on with; 1 as Mikić et al. do it.
    pub heads: usize,
}

impl Default for Options {
    fn default() -> Self {
        let particles = ParticleOptions::default();
        let particles_no_start = ParticleOptions {
            particles: 2 * particles.particles,
            trunk_turn_rad: 0.3,
            chain_turn_rad: 0.9,
            ..particles.clone()
        };
        Self {
            methods: Method::ALL.to_vec(),
            cameras: vec![2],
            no_start: false,
            particles,
            particles_no_start,
            heads: 3,
        }
    }
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// By number of cameras, then by how far the starts were off, then by method.
    pub rows: Vec<Row>,
}

/// One method from all starts of one kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The method.
    pub method: Method,
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

/// One trial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Trial {
    error_mm: f64,
    before_mm: Option<f64>,
    evaluations: usize,
    seconds: f64,
    found: bool,
}

/// Tries all methods from all starts.
///
/// # Errors
/// A fit that cannot begin, a number of cameras that the starts do not have, or `cancel`.
pub fn run(
    options: &Options,
    starts: &[Start],
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    let (mut done, total) = (0, options.cameras.len() * starts.len() * options.methods.len());
    let mut trials: BTreeMap<(usize, Option<u32>, usize), Vec<Trial>> = BTreeMap::new();
    for &cameras in &options.cameras {
        for start in starts {
            let Some(views) = start.views.get(&cameras) else {
                let value = cameras as f64;
                let expected = "a number of cameras that the starts have";
                return Err(ExperimentError::Option { option: "cameras", value, expected });
            };
            let given = (!options.no_start).then_some(&start.start);
            let beginning = Beginning { model: &start.model, views, start: given };
            for (index, &method) in options.methods.iter().enumerate() {
                on_progress(Progress { done, total });
                done += 1;
                let began = Instant::now();
                let end = begin(method, &beginning, options, cancel)?;
                let seconds = began.elapsed().as_secs_f64();
                let error = |pose| leaf_error_mm(&start.model, pose, &start.truth);
                let error_mm = end.pose.as_ref().map_or(f64::INFINITY, error);
                let trial = Trial {
                    error_mm,
                    before_mm: end.before.as_ref().map(error),
                    evaluations: end.evaluations,
                    seconds,
                    found: error_mm < SUCCESS_MM,
                };
                let degrees = given.map(|_| start.degrees);
                trials.entry((cameras, degrees, index)).or_default().push(trial);
            }
        }
    }
    on_progress(Progress { done, total });
    let row = |((cameras, degrees, method), trials): (&(usize, Option<u32>, usize), &Vec<Trial>)| {
        Row::of(options.methods[*method], *cameras, *degrees, trials)
    };
    Ok(Report { rows: trials.iter().map(row).collect() })
}

impl Row {
    pub(super) fn of(method: Method, cameras: usize, degrees: Option<u32>, trials: &[Trial]) -> Self {
        let median = |list: Vec<f64>| Statistics::of(&list).map(|all| all.median);
        let (tried, found) = (trials.len(), trials.iter().filter(|trial| trial.found).count());
        let mean = |value: fn(&Trial) -> f64| trials.iter().map(value).sum::<f64>() / tried.max(1) as f64;
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
        assert_eq!(report.rows.len(), Method::ALL.len());
        for row in &report.rows {
            assert!(row.tried == 2 && row.evaluations > 10.0 && row.median_mm.is_finite(), "{row:?}");
            assert_eq!(row.degrees, Some(10));
        }
        let errors =
            |report: &Report| -> Vec<u64> { report.rows.iter().map(|row| row.median_mm.to_bits()).collect() };
        assert_eq!(errors(&report), errors(&all()));
        let of = |method| report.rows.iter().find(|row| row.method == method).unwrap();
        assert_eq!(of(Method::Ramp).found, 2, "{report:?}");
        assert!(of(Method::Particles).evaluations > 10.0 * of(Method::Ramp).evaluations);
    }

    #[test]
    fn who_watches_sees_every_step_and_changes_nothing() {
        let start = &starts(10, 1)[0];
        for given in [Some(&start.start), None] {
            for method in Method::ALL {
                let (options, cancel) = (Options::default(), CancelToken::new());
                let from = Beginning { model: &start.model, views: &start.views[&2], start: given };
                let (mut kinds, mut lowest) = ([0; 6], f64::INFINITY);
                let mut see = |step: Step<'_>| {
                    let kind = match step {
                        Step::Start { .. } => 0,
                        Step::Downhill { .. } => 1,
                        Step::Particles { generation, .. } => {
                            let all: f64 = generation.particles.iter().map(|particle| particle.weight).sum();
                            assert!((all - 1.0).abs() < 1e-9, "{all}");
                            2
                        }
                        Step::Template(_) => 3,
                        Step::Tried(tried) => {
                            lowest = lowest.min(tried.cost);
                            4
                        }
                        Step::Round(_) => 5,
                    };
                    kinds[kind] += 1;
                };
                let end = begin_watched(method, &from, &options, &cancel, &mut see).unwrap();
                assert_eq!(end, begin(method, &from, &options, &cancel).unwrap());
                let begins = if given.is_some() { 1 } else { 8 };
                let particles =
                    if given.is_some() { &options.particles } else { &options.particles_no_start };
                let expected = match (method, given) {
                    (Method::Report | Method::Ramp, _) => kinds[0] == begins && kinds[1] >= begins * 10,
                    (Method::Particles, _) => kinds[2] == particles.layers * 4 && kinds[0] == 1,
                    (Method::Templates, _) => kinds[3] > 5 && kinds[0] == 1 && kinds[1] > 0,
                    (Method::Search, Some(_)) => kinds[4] > 5 && kinds[..4] == [0; 4] && lowest.is_finite(),
                    (Method::Search, None) => kinds == [0, 0, 0, 0, 0, 4],
                };
                assert!(expected, "{method}: {kinds:?}");
            }
        }
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
