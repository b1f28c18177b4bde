//! The analytic Jacobian of every camera against central differences, a few columns of the state at a time, so that it can
//! be watched and stopped.

use backlit_jobs::{Job, Outbox, Turn};
use backlit_tracking::body::{Kinematics, Model, Parameters, Pose};
use backlit_tracking::optimize::gradient_check::{DifferenceOptions, GradientCheck, check_column};
use backlit_tracking::render::{View, jacobian_along, prediction};
use rayon::prelude::*;

use crate::session::prediction::FitInputs;

/// Columns of a gradient that are checked at once.
const COLUMNS_A_STEP: usize = 8;

/// The pixel in which analytic and numeric derivative differ most.
#[derive(Debug, Clone, PartialEq)]
pub struct Worst {
    /// Index of the camera.
    pub camera: usize,
    /// x and y.
    pub pixel: [usize; 2],
    /// The column of the state, in words.
    pub column: String,
    /// What the program says, grey levels a metre, radian or coefficient.
    pub(crate) analytic: f64,
    /// What differences say.
    pub(crate) numeric: f64,
}

/// How far a check has come, and what it has found, over all cameras.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CheckProgress {
    /// Columns that were compared, those of every camera counted.
    pub(crate) done: usize,
    /// Columns of the state by cameras.
    pub total: usize,
    /// Derivatives that were compared, and those at a kink, where differences cannot tell.
    pub compared: usize,
    /// See there.
    pub(crate) skipped: usize,
    /// Derivatives that differ by more than the tolerance.
    pub(crate) mismatches: usize,
    /// Largest difference over the largest derivative of its column.
    pub(crate) largest_error: f64,
    /// Where that is.
    pub worst: Option<Worst>,
}

impl CheckProgress {
    /// Whether all columns were compared.
    pub fn is_whole(&self) -> bool {
        self.total > 0 && self.done == self.total
    }

    /// Whether nothing differs so far.
    pub fn passes(&self) -> bool {
        self.mismatches == 0
    }
}

/// A check of the gradient at one pose in all cameras.
#[derive(Debug, Clone, PartialEq)]
pub struct Checked {
    /// The pose.
    pub pose: Pose,
    /// What was found so far.
    pub progress: CheckProgress,
}

/// The check of one fit's Jacobian at one pose.
#[derive(Debug)]
pub(super) struct FitCheck {
    /// The fit.
    index: usize,
    scene: FitInputs,
    /// The cameras in the order in which they are checked; all see the same state.
    cameras: Vec<usize>,
    checked: Checked,
}

impl FitCheck {
    pub(super) fn new(index: usize, scene: FitInputs, pose: Pose, cameras: Vec<usize>) -> Self {
        let checked = Checked { pose, progress: CheckProgress::default() };
        let mut check = Self { index, scene, cameras, checked };
        check.checked.progress.total = check.columns() * check.cameras.len();
        check
    }

    fn columns(&self) -> usize {
        self.scene.fit.parameters.columns(self.scene.model.rotation_count())
    }

    /// What the program says of one column: ∂λ/∂x of every pixel.
    fn analytic(&self, camera: usize, column: usize) -> Vec<f64> {
        let FitInputs { model, fit, cameras, .. } = &self.scene;
        let kinematics = Kinematics::new(model, &self.checked.pose);
        let view = View::new(model, &kinematics, &cameras[camera], fit.renderer, fit.final_ramp());
        let mut direction = vec![0.0; self.columns()];
        if let Some(slot) = direction.get_mut(column) {
            *slot = 1.0;
        }
        jacobian_along(&view, &kinematics, &cameras[camera], fit.parameters, &direction)
    }

    /// Compares one column: `analytic` is what [`analytic`](Self::analytic) gives.
    fn compare(&self, camera: usize, column: usize, analytic: &[f64]) -> GradientCheck {
        let FitInputs { model, fit, cameras, .. } = &self.scene;
        let (camera, ramp, pose) = (&cameras[camera], fit.final_ramp(), &self.checked.pose);
        let mut kinematics = Kinematics::new(model, pose);
        let mut view = View::new(model, &kinematics, camera, fit.renderer, ramp);
        let levels = |offset: f64| {
            kinematics.update(model, &pose.nudged(fit.parameters, column, offset));
            view.prepare(model, &kinematics, camera, fit.renderer, ramp);
            prediction::levels(&view)
        };
        check_column(analytic, levels, |row| row.to_string(), &DifferenceOptions::default())
    }

    /// Adds what was found in one column in one camera.
    fn add(&mut self, camera: usize, column: usize, found: &GradientCheck) {
        let progress = &mut self.checked.progress;
        progress.done += 1;
        progress.compared += found.compared;
        progress.skipped += found.skipped;
        progress.mismatches += found.mismatches.len();
        let Some(worst) = found.worst else { return };
        if progress.worst.is_none() || worst.relative_error > progress.largest_error {
            progress.largest_error = worst.relative_error;
            let width = self.scene.cameras[camera].width().max(1);
            progress.worst = Some(Worst {
                camera,
                pixel: [worst.row % width, worst.row / width],
                column: column_name(&self.scene.model, self.scene.fit.parameters, column),
                analytic: worst.analytic,
                numeric: worst.numeric,
            });
        }
    }

    /// Compares the next columns, shared out among threads. What is found does not depend on how they are shared out.
    fn go_on(&mut self) {
        let (columns, &CheckProgress { done, total, .. }) = (self.columns().max(1), &self.checked.progress);
        let compare = |at: usize| {
            let (camera, column) = (*self.cameras.get(at / columns)?, at % columns);
            Some((camera, column, self.compare(camera, column, &self.analytic(camera, column))))
        };
        let next = done..(done + COLUMNS_A_STEP).min(total);
        let found: Vec<_> = next.into_par_iter().filter_map(compare).collect();
        for (camera, column, found) in found {
            self.add(camera, column, &found);
        }
    }
}

/// Checks the gradients of several fits, a few columns of one of them a step: all of them come on together.
pub(super) fn check_all(mut fits: Vec<FitCheck>) -> impl Job<(usize, Checked)> {
    move |out: &Outbox<(usize, Checked)>| {
        let going = fits.iter_mut().filter(|fit| !fit.checked.progress.is_whole());
        let next = going.min_by_key(|fit| (fit.checked.progress.done, fit.index));
        let Some(fit) = next.filter(|fit| !fit.cameras.is_empty()) else { return Turn::Done };
        fit.go_on();
        out.send((fit.index, fit.checked.clone()));
        Turn::Again
    }
}

/// "root x", "right forearm ω y": what a column of the state moves.
pub(crate) fn column_name(model: &Model, parameters: Parameters, column: usize) -> String {
    let Some(in_rotations) = column.checked_sub(3) else {
        return format!("root {}", ["x", "y", "z"][column]);
    };
    let (rotation, part) =
        (in_rotations / parameters.per_rotation(), in_rotations % parameters.per_rotation());
    let part = match parameters {
        Parameters::Raw => ["w", "x", "y", "z"][part],
        Parameters::Tangent => ["ω x", "ω y", "ω z"][part],
    };
    let limb =
        model.rotation_owners().get(rotation).map_or("none", |owner| model.limbs()[*owner].name.as_str());
    format!("{limb} {part}")
}

#[cfg(test)]
mod tests {
    use backlit_lab::synthetic::single_limb;
    use backlit_tracking::body::builtin;
    use backlit_tracking::fit::{FitOptions, Preset};
    use backlit_tracking::render::RendererKind;

    use super::*;
    use crate::features::laboratory::comparison::tests::scene;

    fn check(renderer: RendererKind) -> FitCheck {
        let camera = single_limb::camera(0.8, [96, 72]).unwrap();
        let fit = FitOptions { renderer, parameters: Parameters::Raw, ..FitOptions::preset(Preset::Report) };
        let scene = scene(builtin::single_limb(), fit, vec![camera; 3]);
        FitCheck::new(0, scene, single_limb::start(0.1), vec![2])
    }

    /// All columns, with what the program says spoilt on the way.
    fn run(mut check: FitCheck, mut fault: impl FnMut(usize, &mut [f64])) -> CheckProgress {
        for column in 0..check.columns() {
            let mut analytic = check.analytic(2, column);
            fault(column, &mut analytic);
            check.add(2, column, &check.compare(2, column, &analytic));
        }
        check.checked.progress
    }

    #[test]
    fn the_three_renderers_pass() {
        for renderer in RendererKind::in_report_order() {
            let found = run(check(renderer), |_, _| {});
            assert!(found.is_whole() && found.passes() && found.compared > 1000, "{renderer}: {found:?}");
            assert!(found.largest_error < 1e-5 && found.worst.is_some(), "{renderer}: {found:?}");
        }
    }

    #[test]
    fn a_broken_jacobian_is_caught_and_its_pixel_named() {
        let check = check(RendererKind::Capsule);
        let strongest = |column: &[f64]| {
            (0..column.len()).max_by(|a, b| column[*a].abs().total_cmp(&column[*b].abs())).unwrap()
        };
        let spoilt = strongest(&check.analytic(2, 1));
        let found = run(check, |column, analytic| {
            if column == 1 {
                analytic[spoilt] *= 1.02;
            }
        });
        assert!(!found.passes() && found.is_whole());
        assert_eq!(found.mismatches, 1);
        let worst = found.worst.unwrap();
        assert_eq!((worst.pixel, worst.column.as_str()), ([spoilt % 96, spoilt / 96], "root y"));
        assert_eq!(worst.camera, 2);
        assert!((worst.analytic / worst.numeric - 1.02).abs() < 1e-4, "{worst:?}");
    }

    #[test]
    fn a_wrong_sign_is_caught_everywhere() {
        let found = run(check(RendererKind::SphereTree { spheres: None }), |_, analytic| {
            analytic.iter_mut().for_each(|value| *value = -*value);
        });
        assert!(found.mismatches > 500, "{found:?}");
    }

    #[test]
    fn columns_are_named_in_the_order_of_the_state() {
        let model = builtin::upper_body();
        let names = |parameters: Parameters| -> Vec<String> {
            (0..8).map(|column| column_name(&model, parameters, column)).collect()
        };
        assert_eq!(names(Parameters::Tangent)[..5], ["root x", "root y", "root z", "torso ω x", "torso ω y"]);
        assert_eq!(
            names(Parameters::Raw)[3..8],
            ["torso w", "torso x", "torso y", "torso z", "right shoulder w"]
        );
    }
}
