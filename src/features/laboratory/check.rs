//! The analytic Jacobian of every camera against central differences, one column of the state in one camera at a time,
//! so that it can be watched and stopped.

use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, Parameters, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::optimize::gradient_check::{DifferenceOptions, GradientCheck, check_column};
use backlit_tracking::render::{Ramp, RendererKind, View, jacobian_along, prediction};

/// One fit's Jacobian in one camera at one pose.
#[derive(Debug, Clone)]
pub(crate) struct ColumnCheck {
    /// The body.
    pub(crate) model: Arc<Model>,
    pub(crate) pose: Pose,
    pub(crate) camera: Arc<Camera>,
    /// The solid of a limb.
    pub(crate) renderer: RendererKind,
    /// How distance becomes grey.
    pub(crate) ramp: Ramp,
    /// The columns of the state.
    pub(crate) parameters: Parameters,
}

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

    /// Adds what was found in one column in one camera.
    pub(crate) fn add(
        &mut self,
        found: &GradientCheck,
        check: &ColumnCheck,
        (camera, column): (usize, usize),
    ) {
        self.done += 1;
        self.compared += found.compared;
        self.skipped += found.skipped;
        self.mismatches += found.mismatches.len();
        let Some(worst) = found.worst else { return };
        if self.worst.is_none() || worst.relative_error > self.largest_error {
            self.largest_error = worst.relative_error;
            let width = check.camera.width().max(1);
            self.worst = Some(Worst {
                camera,
                pixel: [worst.row % width, worst.row / width],
                column: column_name(&check.model, check.parameters, column),
                analytic: worst.analytic,
                numeric: worst.numeric,
            });
        }
    }
}

impl ColumnCheck {
    /// Columns of the state.
    pub(crate) fn columns(&self) -> usize {
        self.parameters.columns(self.model.rotation_count())
    }

    /// What the program says of one column: ∂λ/∂x of every pixel.
    pub(crate) fn analytic(&self, column: usize) -> Vec<f64> {
        let kinematics = Kinematics::new(&self.model, &self.pose);
        let view = View::new(&self.model, &kinematics, &self.camera, self.renderer, self.ramp);
        let mut direction = vec![0.0; self.columns()];
        if let Some(slot) = direction.get_mut(column) {
            *slot = 1.0;
        }
        jacobian_along(&view, &kinematics, &self.camera, self.parameters, &direction)
    }

    /// Compares one column: `analytic` is what [`analytic`](Self::analytic) gives.
    pub(crate) fn compare(&self, column: usize, analytic: &[f64]) -> GradientCheck {
        let mut kinematics = Kinematics::new(&self.model, &self.pose);
        let mut view = View::new(&self.model, &kinematics, &self.camera, self.renderer, self.ramp);
        let levels = |offset: f64| {
            kinematics.update(&self.model, &self.pose.nudged(self.parameters, column, offset));
            view.prepare(&self.model, &kinematics, &self.camera, self.renderer, self.ramp);
            prediction::levels(&view)
        };
        check_column(analytic, levels, |row| row.to_string(), &DifferenceOptions::default())
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

    use super::*;

    fn check(renderer: RendererKind) -> ColumnCheck {
        ColumnCheck {
            model: Arc::new(backlit_tracking::body::builtin::single_limb()),
            pose: single_limb::start(0.1),
            camera: single_limb::camera(0.8, [96, 72]).unwrap(),
            renderer,
            ramp: Ramp::Thesis,
            parameters: Parameters::Raw,
        }
    }

    /// All columns, with what the program says spoilt on the way.
    fn run(check: &ColumnCheck, mut fault: impl FnMut(usize, &mut [f64])) -> CheckProgress {
        let mut progress = CheckProgress { total: check.columns(), ..CheckProgress::default() };
        for column in 0..check.columns() {
            let mut analytic = check.analytic(column);
            fault(column, &mut analytic);
            progress.add(&check.compare(column, &analytic), check, (2, column));
        }
        progress
    }

    #[test]
    fn the_three_renderers_pass() {
        for renderer in single_limb::RENDERERS {
            let found = run(&check(renderer), |_, _| {});
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
        let spoilt = strongest(&check.analytic(1));
        let found = run(&check, |column, analytic| {
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
        let found = run(&check(RendererKind::SphereTree { spheres: None }), |_, analytic| {
            analytic.iter_mut().for_each(|value| *value = -*value);
        });
        assert!(found.mismatches > 500, "{found:?}");
    }

    #[test]
    fn columns_are_named_in_the_order_of_the_state() {
        let model = backlit_tracking::body::builtin::upper_body();
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
