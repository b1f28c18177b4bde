//! Fig. 5.4: the first frame of a sequence, iteration by iteration: D and Λ of each camera.

use std::sync::Arc;

use backlit_tracking::body::Pose;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::Fit;
use backlit_tracking::search::start::perturb;
use serde::Serialize;

use super::ExperimentError;
use super::fig55::Way;
use super::looks::Look;
use super::sequence::Sequence;

/// The iterations that the report shows.
pub const ITERATIONS: [usize; 4] = [0, 6, 10, 25];

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// The iterations that are shown; a fit that has ended before shows its end.
    pub iterations: Vec<usize>,
    /// Seed of the start.
    pub seed: u64,
    /// How far every joint of the start is turned, radians.
    pub angle_rad: f64,
    /// How far its root is moved, metres.
    pub distance_m: f64,
    /// The ways that are shown.
    pub ways: Vec<Way>,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// One entry a way.
    pub ways: Vec<WayReport>,
}

/// One way through the frame.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WayReport {
    /// Its name.
    pub name: String,
    /// What is shown of it.
    pub shown: Vec<Shown>,
}

/// One iteration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Shown {
    /// Iterations done: those asked for, or all that there were.
    pub iteration: usize,
    /// Root of the mean squared residual per pixel by the measure of its stage, grey levels.
    pub rms: f64,
    /// Mean distance of the known joints, millimetres.
    pub joint_error_mm: Option<f64>,
    /// Its pictures, camera by camera.
    #[serde(skip)]
    pub looks: Vec<Look>,
}

/// Fits the first frame in every way.
///
/// # Errors
/// Options that make no sense, or `cancel`.
pub fn run(options: &Options, sequence: &Sequence, cancel: &CancelToken) -> Result<Report, ExperimentError> {
    let Sequence { model, start, moments, .. } = sequence;
    let Some(moment) = moments.first() else { return Ok(Report { ways: Vec::new() }) };
    let from = perturb(model, start, options.angle_rad, options.distance_m, options.seed);
    let mut ways = Vec::new();
    for way in &options.ways {
        let Some(views) = way.views(sequence, 0)? else { continue };
        let mut fit = Fit::new(Arc::clone(model), views.clone(), from.clone(), way.fit.clone())?;
        let rms = fit.initial_rms();
        let summary = fit.run(cancel, |_| {});
        if cancel.is_cancelled() {
            return Err(ExperimentError::Cancelled);
        }
        let show = |&iteration: &usize| {
            let iteration = iteration.min(summary.iterations.len());
            let record = iteration.checked_sub(1).map(|index| &summary.iterations[index]);
            let (pose, stage, rms): (&Pose, usize, f64) =
                record.map_or((&from, 0, rms), |record| (&record.point, record.stage, record.rms));
            let stage = &fit.options().stages[stage];
            let looks = Look::of_views(model, pose, &views, stage, way.fit.renderer);
            Shown { iteration, rms, joint_error_mm: moment.joint_error_mm(model, pose), looks }
        };
        ways.push(WayReport { name: way.name.clone(), shown: options.iterations.iter().map(show).collect() });
    }
    Ok(Report { ways })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::fig55;

    #[test]
    fn iterations_come_nearer_and_are_drawn() {
        let sequence = Sequence::simulated([96, 72], 2, 1).unwrap();
        let fig55::Options { ways, angle_rad, distance_m, .. } = fig55::Options::default();
        let options = Options { iterations: ITERATIONS.to_vec(), seed: 1, angle_rad, distance_m, ways };
        let report = run(&options, &sequence, &CancelToken::new()).unwrap();
        for way in &report.ways {
            let [first, .., last] = &way.shown[..] else { panic!("four columns") };
            assert_eq!((first.iteration, first.looks.len()), (0, 2));
            let [before, after] = [first, last].map(|shown| shown.joint_error_mm.unwrap());
            assert!(after < before, "{}: {before} mm became {after}", way.name);
            let look = &last.looks[1];
            assert_eq!((look.data.dimensions(), look.prediction.dimensions()), ((96, 72), (96, 72)));
            let wrong = look.data.pixels().zip(look.prediction.pixels());
            let wrong = wrong.filter(|(d, l)| d[0].abs_diff(l[0]) > 128).count();
            assert!(wrong < 60, "{}: {wrong} pixels", way.name);
        }
    }
}
