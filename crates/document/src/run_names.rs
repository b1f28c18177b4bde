//! Names of runs: what differs between those that are shown, and nothing else.

use backlit_tracking::body::{Parameters, Pose};
use backlit_tracking::fit::FitOptions;
use backlit_tracking::optimize::Method;
use backlit_tracking::render::RendererKind;
use backlit_words::format;

use crate::run::Run;
use crate::runs::{StepRef, is_same};
use crate::{fit_words as words, likely_poses};

/// Names every run that was not named by hand by its differences from the runs whose curves are shown. A run
/// that is hidden is named as if it were shown.
pub fn name_runs(runs: &mut [Run]) {
    let names = count_twins(plain_names(runs), |index| runs[index].is_named);
    runs.iter_mut().zip(names).for_each(|(run, name)| run.name = name);
}

/// The same names before runs that differ in nothing are counted.
pub fn plain_names(runs: &[Run]) -> Vec<String> {
    let facets: Vec<Facets> = runs.iter().zip(start_numbers(runs)).map(Facets::of).collect();
    let name = |index: usize| {
        if runs[index].is_named {
            return runs[index].name.clone();
        }
        let compared = (0..runs.len()).filter(|&other| runs[other].is_shown || other == index);
        let others: Vec<&Facets> = compared.map(|other| &facets[other]).collect();
        facets[index].name_among(&others)
    };
    (0..runs.len()).map(name).collect()
}

/// The names with those counted that stand there before, unless they were given: "Robust", "Robust (2)".
pub fn count_twins(plain: Vec<String>, is_given: impl Fn(usize) -> bool) -> Vec<String> {
    let mut names: Vec<String> = Vec::with_capacity(plain.len());
    for (index, name) in plain.into_iter().enumerate() {
        names.push(if is_given(index) { name } else { counted(name, &names) });
    }
    names
}

fn counted(plain: String, before: &[String]) -> String {
    let is_same = |name: &&String| {
        name.strip_prefix(&plain).is_some_and(|rest| rest.is_empty() || rest.starts_with(" ("))
    };
    match before.iter().filter(is_same).count() {
        0 => plain,
        again => format!("{plain} ({})", again + 1),
    }
}

/// Which of the different starts of its frame each run has, counted from 1.
fn start_numbers(runs: &[Run]) -> Vec<usize> {
    let mut known: Vec<(usize, &Pose)> = Vec::new();
    let mut numbers = Vec::with_capacity(runs.len());
    for run in runs {
        let Some(first) = run.steps.first() else {
            numbers.push(1);
            continue;
        };
        let of_frame = known.iter().filter(|(frame, _)| *frame == run.frame);
        let place = of_frame.clone().position(|(_, pose)| is_same(pose, &first.iteration.point));
        numbers.push(place.unwrap_or(of_frame.count()) + 1);
        if place.is_none() {
            known.push((run.frame, &first.iteration.point));
        }
    }
    numbers
}

/// Which other runs a part of a name is compared with.
#[derive(Clone, Copy)]
enum Compared {
    All,
    /// Choices that a preset makes: said only where two runs of one preset or method differ in them.
    OfFit,
    OfFrame,
}

/// What a name may be made of.
struct Facets {
    /// The part that was fitted again alone.
    refit: Option<String>,
    /// Preset or method.
    fit: String,
    frame: usize,
    /// In the order of the name, always as many.
    texts: Vec<(Compared, String)>,
}

impl Facets {
    fn of((run, start): (&Run, usize)) -> Self {
        let choices = &run.choices;
        let fit = words::fit_name(&choices.fit);
        let refit = choices.part.as_ref().map(|part| format!("refit {part}"));
        let part = refit.clone().unwrap_or_else(|| "whole body".to_owned());
        let start = match choices.branched_from {
            Some(StepRef { run, step }) => format!("from step {step} of run {run}"),
            None => format!("start {start}"),
        };
        let first = [part, fit.clone(), renderer_text(choices.fit.renderer)];
        let mut texts = first.map(|text| (Compared::All, text)).to_vec();
        texts.extend(refinements(&choices.fit).into_iter().map(|text| (Compared::OfFit, text)));
        texts.push((Compared::All, cameras_text(run)));
        texts.push((Compared::All, format!("frame {}", run.frame)));
        texts.push((Compared::OfFrame, start));
        Self { refit, fit, frame: run.frame, texts }
    }

    fn name_among(&self, others: &[&Self]) -> String {
        let is_compared = |other: &Self, compared| match compared {
            Compared::All => true,
            Compared::OfFit => other.fit == self.fit,
            Compared::OfFrame => other.frame == self.frame,
        };
        let differs = |(index, (compared, text)): (usize, &(Compared, String))| {
            let differs = |other: &&Self| is_compared(other, *compared) && other.texts[index].1 != *text;
            others.iter().any(differs).then(|| text.clone())
        };
        let parts: Vec<String> = self.texts.iter().enumerate().filter_map(differs).collect();
        match parts.as_slice() {
            [] => self.refit.as_deref().map_or_else(|| self.fit.clone(), format::capitalised),
            parts => format::capitalised(&parts.join(", ")),
        }
    }
}

fn renderer_text(renderer: RendererKind) -> String {
    let name = renderer.label().to_lowercase();
    match renderer {
        RendererKind::SphereTree { spheres: Some(count) } => format!("{name}, {count} spheres"),
        _ => name,
    }
}

/// Choices of the fit, each in words, always as many and in the same order.
fn refinements(fit: &FitOptions) -> Vec<String> {
    let number = |value: f64| format::short(value);
    let iterations: usize = fit.stages.iter().map(|stage| stage.iterations).sum();
    let strides: Vec<String> = fit.stages.iter().map(|stage| stage.stride.to_string()).collect();
    vec![
        words::ramps(fit),
        match fit.parameters {
            Parameters::Tangent => "tangent".to_owned(),
            Parameters::Raw => "raw".to_owned(),
        },
        match fit.method {
            Method::LevenbergMarquardt => "LM".to_owned(),
            Method::GaussNewton => "fixed damping".to_owned(),
        },
        format!("damping {}", number(fit.damping)),
        format!("pull back {}", number(fit.proximal_weight)),
        format!("untwist {}", number(fit.rest_weight)),
        format!("limits {}", number(fit.limit_weight)),
        format!("likely poses {}", number(likely_poses::weight(fit).unwrap_or(0.0))),
        if fit.to_scale { "stages to scale" } else { "stages as they are" }.to_owned(),
        format!("at most {iterations} steps"),
        format!("every {} px", strides.join(" ")),
    ]
}

/// The cameras that counted, with weights other than one.
fn cameras_text(run: &Run) -> String {
    let cameras = &run.choices.cameras;
    let used: Vec<String> = cameras
        .iter()
        .enumerate()
        .filter(|(_, camera)| camera.used)
        .map(|(index, camera)| {
            let weight = if camera.weight == 1.0 {
                String::new()
            } else {
                format!(" × {}", format::short(camera.weight))
            };
            format!("{}{weight}", index + 1)
        })
        .collect();
    match used.as_slice() {
        [] => "no camera".to_owned(),
        [one] => format!("camera {one}"),
        several => format!("cameras {}", several.join(" ")),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use backlit_tracking::fit::Preset;

    use super::*;
    use crate::CameraUse;

    fn run(change: impl FnOnce(&mut FitOptions)) -> Run {
        let mut fit = FitOptions::preset(Preset::Robust);
        change(&mut fit);
        let mut run = Run { is_shown: true, ..Run::default() };
        run.choices.fit = Arc::new(fit);
        let camera = |name: &str| CameraUse { name: name.to_owned(), used: true, weight: 1.0 };
        run.choices.cameras = Arc::new(vec![camera("a"), camera("b")]);
        run
    }

    fn names(mut runs: Vec<Run>) -> Vec<String> {
        name_runs(&mut runs);
        runs.into_iter().map(|run| run.name).collect()
    }

    #[test]
    fn only_what_differs_is_said() {
        let robust = || run(|_| {});
        assert_eq!(names(vec![robust()]), ["Robust"]);
        assert_eq!(names(vec![robust(), robust()]), ["Robust", "Robust (2)"]);
        let cylinder = || run(|fit| fit.renderer = RendererKind::Cylinder);
        assert_eq!(names(vec![robust(), cylinder()]), ["Capsule", "Cylinder"]);
        let report = run(|fit| *fit = FitOptions::preset(Preset::Report));
        assert_eq!(
            names(vec![robust(), cylinder(), report]),
            ["Robust, capsule", "Robust, cylinder", "Report 2004, capsule"]
        );
    }

    #[test]
    fn a_changed_number_is_said_with_its_value() {
        let damped = |value| run(move |fit| fit.damping = value);
        assert_eq!(
            names(vec![damped(0.5), damped(0.02)]),
            ["Damping 0.5", "Damping 0.02"],
            "both are of one method"
        );
        let pulled = run(|fit| (fit.damping, fit.proximal_weight) = (0.5, 3.0));
        assert_eq!(names(vec![damped(0.5), pulled]), ["Pull back 30", "Pull back 3"]);
    }

    #[test]
    fn cameras_frames_parts_and_starts_are_told_apart() {
        let mut one = run(|_| {});
        Arc::make_mut(&mut one.choices.cameras)[1].used = false;
        let mut heavy = run(|_| {});
        Arc::make_mut(&mut heavy.choices.cameras)[1].weight = 0.5;
        assert_eq!(names(vec![run(|_| {}), one, heavy]), ["Cameras 1 2", "Camera 1", "Cameras 1 2 × 0.5"]);
        let later = Run { frame: 7, ..run(|_| {}) };
        assert_eq!(names(vec![run(|_| {}), later]), ["Frame 0", "Frame 7"]);
        let mut arm = run(|_| {});
        arm.choices.part = Some("right forearm".to_owned());
        assert_eq!(names(vec![arm.clone()]), ["Refit right forearm"]);
        assert_eq!(names(vec![run(|_| {}), arm]), ["Whole body", "Refit right forearm"]);
        let mut branch = run(|_| {});
        branch.choices.branched_from = Some(StepRef { run: 1, step: 4 });
        assert_eq!(names(vec![run(|_| {}), branch]), ["Start 1", "From step 4 of run 1"]);
    }

    #[test]
    fn hidden_runs_are_not_compared_with_and_given_names_stay() {
        let hidden = Run { is_shown: false, ..run(|fit| fit.renderer = RendererKind::Cylinder) };
        assert_eq!(names(vec![run(|_| {}), hidden]), ["Robust", "Cylinder"]);
        let mine = Run { name: "Mine".to_owned(), is_named: true, ..run(|_| {}) };
        assert_eq!(names(vec![mine, run(|_| {})]), ["Mine", "Robust"]);
    }
}
