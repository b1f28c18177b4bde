//! Figs. 5.2 and 5.3: the upper body from many starts, before one camera and before two.
//!
//! Data are the renderer's own grey levels of the true pose, so that the cost of the truth is zero. What one
//! camera cannot see costs nothing: there the cost falls while joints stay off. The same seed gives the same
//! starts for any number of cameras.

use std::sync::Arc;

use backlit_tracking::body::{Parameters, builtin};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::optimize::Method;
use backlit_tracking::render::RendererKind;
use backlit_tracking::search::start::perturb;
use backlit_tracking::statistics::median;
use serde::Serialize;

use super::curve::Curve;
use super::{ExperimentError, Progress, Simulation, scene};
use crate::synthetic::upper_body;

/// A fit ends well when its mean joint error is below this, millimetres.
pub const GOOD_MM: f64 = 20.0;

/// Damping at the start of Levenberg-Marquardt, as the fit's options count it.
pub const LM_DAMPING: f64 = 0.01;

/// A way to fit: a name and every choice.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Way {
    /// What it is called in tables and plots.
    pub name: String,
    /// Its choices.
    pub fit: FitOptions,
}

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Cameras: one in Fig. 5.2, two in Fig. 5.3.
    pub cameras: usize,
    /// Pixels across and down.
    pub size_px: [u64; 2],
    /// Number of starts.
    pub starts: usize,
    /// Seed of the starts.
    pub seed: u64,
    /// How far every joint of a start is turned from the truth, radians.
    pub angle_rad: f64,
    /// How far the root of a start is from the truth, metres.
    pub distance_m: f64,
    /// How the data are made.
    pub simulation: Simulation,
    /// The ways that are compared.
    pub ways: Vec<Way>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            cameras: 2,
            size_px: [192, 144],
            starts: 100,
            seed: 1,
            angle_rad: 10f64.to_radians(),
            distance_m: 0.05,
            simulation: Simulation::Prediction,
            ways: ways(),
        }
    }
}

/// The report's fit with each renderer, and the same cost lowered by Levenberg-Marquardt on tangent steps.
#[must_use]
pub fn ways() -> Vec<Way> {
    let report = FitOptions { run_all: true, ..FitOptions::preset(Preset::Report) };
    let with =
        |name: &str, renderer| Way { name: name.to_owned(), fit: FitOptions { renderer, ..report.clone() } };
    let mended = FitOptions {
        parameters: Parameters::Tangent,
        method: Method::LevenbergMarquardt,
        damping: LM_DAMPING,
        ..report.clone()
    };
    vec![
        with("cylinder", RendererKind::Cylinder),
        with("capsule", RendererKind::Capsule),
        with("sphere tree", RendererKind::SphereTree { spheres: None }),
        Way { name: "capsule, tangent LM".to_owned(), fit: mended },
    ]
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// One entry a way.
    pub ways: Vec<WayReport>,
}

/// What came of one way.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WayReport {
    /// Its name.
    pub name: String,
    /// Median over the starts of the cost in percent of the start's, at the start and after every iteration.
    pub median_percent: Vec<f64>,
    /// Median over the starts of the mean joint error, millimetres.
    pub median_joint_error_mm: Vec<f64>,
    /// Starts that ended with a mean joint error below [`GOOD_MM`].
    pub good: usize,
    /// One curve a start.
    pub curves: Vec<Curve>,
}

/// Runs every way from every start.
///
/// # Errors
/// Options that make no sense, or `cancel`.
pub fn run(
    options: &Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    for (option, value) in [("angle_rad", options.angle_rad), ("distance_m", options.distance_m)] {
        if !value.is_finite() {
            return Err(ExperimentError::Option { option, value, expected: "a finite number" });
        }
    }
    if options.starts == 0 {
        return Err(ExperimentError::Option { option: "starts", value: 0.0, expected: "1 or more" });
    }
    let model = Arc::new(builtin::upper_body());
    let cameras = upper_body::cameras(options.cameras, options.size_px)?;
    let truth = upper_body::motion(&model, 0);
    let total = options.ways.len() * options.starts;
    let mut ways = Vec::new();
    for Way { name, fit } in &options.ways {
        let see =
            |camera| scene::view(&model, &truth, camera, options.simulation, fit.renderer, fit.final_ramp());
        let views = cameras.iter().map(see).collect::<Result<Vec<_>, _>>()?;
        let mut curves = Vec::new();
        for start in 0..options.starts {
            on_progress(Progress { done: ways.len() * options.starts + start, total });
            let seed = options.seed.wrapping_add(start as u64);
            let from = perturb(&model, &truth, options.angle_rad, options.distance_m, seed);
            let curve = Curve::of(
                &format!("start {start}"),
                &model,
                &truth,
                views.clone(),
                &from,
                fit.clone(),
                cancel,
            )?;
            curves.push(curve);
        }
        ways.push(WayReport::of(name, curves));
    }
    on_progress(Progress { done: total, total });
    Ok(Report { ways })
}

impl WayReport {
    fn of(name: &str, curves: Vec<Curve>) -> Self {
        Self {
            name: name.to_owned(),
            median_percent: medians(curves.iter().map(Curve::percent_of_start)),
            median_joint_error_mm: medians(curves.iter().map(|curve| curve.joint_errors_mm.clone())),
            good: curves.iter().filter(|curve| curve.final_joint_error_mm() < GOOD_MM).count(),
            curves,
        }
    }
}

/// Medians of lists, entry by entry; a list that is shorter than others goes on with its last entry.
pub(super) fn medians(lists: impl Iterator<Item = Vec<f64>>) -> Vec<f64> {
    let lists: Vec<Vec<f64>> = lists.filter(|list| !list.is_empty()).collect();
    let length = lists.iter().map(Vec::len).max().unwrap_or(0);
    let entry = |at: usize| {
        let mut values: Vec<f64> = lists.iter().map(|list| list[at.min(list.len() - 1)]).collect();
        median(&mut values)
    };
    (0..length).filter_map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run_small(cameras: usize) -> Report {
        let options = Options { cameras, size_px: [96, 72], starts: 4, ..Options::default() };
        run(&options, &CancelToken::new(), |_| {}).unwrap()
    }

    #[test]
    fn one_camera_lowers_the_cost_but_only_two_bring_the_joints_home() {
        let [one, two] = [1, 2].map(run_small);
        let last = |list: &[f64]| *list.last().unwrap();
        for (one, two) in one.ways.iter().zip(&two.ways) {
            // The same starts.
            assert_eq!(one.curves[0].joint_errors_mm[0], two.curves[0].joint_errors_mm[0]);
            assert!(last(&one.median_percent) < 20.0 && last(&two.median_percent) < 20.0, "{}", one.name);
            let [one_mm, two_mm] = [one, two].map(|way| last(&way.median_joint_error_mm));
            assert!(one_mm > 1.5 * two_mm, "{}: {one_mm} mm with one camera, {two_mm} mm with two", one.name);
        }
        assert!(last(&two.ways[3].median_joint_error_mm) < GOOD_MM);
    }

    #[test]
    fn medians_go_on_where_a_list_ends() {
        let lists = [vec![1.0, 2.0, 3.0], vec![5.0], vec![0.0, 9.0]];
        assert_eq!(medians(lists.into_iter()), [1.0, 5.0, 5.0]);
    }

    #[test]
    fn senseless_options_are_named_and_a_cancelled_run_says_so() {
        let wrong = Options { starts: 0, ..Options::default() };
        let error = run(&wrong, &CancelToken::new(), |_| {}).unwrap_err().to_string();
        assert!(error.contains("`starts` is 0"), "{error}");
        let cancel = CancelToken::new();
        cancel.cancel();
        assert_eq!(run(&Options::default(), &cancel, |_| {}), Err(ExperimentError::Cancelled));
    }
}
