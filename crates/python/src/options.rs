//! Words that choose how a pose is fitted: those of the command line.

use std::fmt::Display;
use std::str::FromStr;

use backlit_tracking::body::Parameters;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::optimize::Method;
use backlit_tracking::render::{MAX_SPHERES, Ramp, RendererKind};
use pyo3::prelude::*;

use crate::errors::{InputError, wrong};

/// A word that has a meaning; the argument is named where it has none.
fn word<T: FromStr<Err: Display>>(argument: &str, text: &str) -> PyResult<T> {
    text.parse().map_err(|error| InputError::new_err(format!("{argument}: {error}")))
}

/// What a rotation's numbers are.
pub(crate) fn parameters_of(text: &str) -> PyResult<Parameters> {
    match text {
        "raw" => Ok(Parameters::Raw),
        "tangent" => Ok(Parameters::Tangent),
        _ => Err(wrong("parameters", "\"raw\" or \"tangent\"", &format!("{text:?}"))),
    }
}

/// The solid that stands for a limb. Words of Python's kind count too: `sphere_tree`.
pub(crate) fn renderer_of(text: &str, spheres: Option<usize>) -> PyResult<RendererKind> {
    let renderer = word("renderer", &text.replace('_', "-"))?;
    match (renderer, spheres) {
        (_, None) => Ok(renderer),
        (RendererKind::SphereTree { .. }, Some(1..=MAX_SPHERES)) => Ok(RendererKind::SphereTree { spheres }),
        (RendererKind::SphereTree { .. }, Some(count)) => {
            Err(wrong("spheres", &format!("1 to {MAX_SPHERES}"), &count.to_string()))
        }
        _ => Err(wrong("spheres", "none beside another renderer than \"sphere_tree\"", "a number")),
    }
}

/// How distance becomes grey.
pub(crate) fn ramp_of(text: &str) -> PyResult<Ramp> {
    word("ramp", text)
}

/// A named set of choices.
pub(crate) fn preset_of(text: &str) -> PyResult<Preset> {
    word("preset", text)
}

/// What is chosen besides a preset.
#[derive(Debug, Default)]
pub(crate) struct Choices<'a> {
    pub(crate) renderer: Option<&'a str>,
    pub(crate) spheres: Option<usize>,
    pub(crate) ramp: Option<&'a str>,
    pub(crate) method: Option<&'a str>,
    pub(crate) parameters: Option<&'a str>,
    pub(crate) damping: Option<f64>,
    pub(crate) iterations: Option<usize>,
    pub(crate) run_all: bool,
}

impl Choices<'_> {
    /// The choices of a preset with these in the place of its own, in the command line's order.
    pub(crate) fn options(&self, preset: Preset) -> PyResult<FitOptions> {
        let mut options = FitOptions::preset(preset);
        if let Some(renderer) = self.renderer {
            options.renderer = renderer_of(renderer, self.spheres)?;
        } else if self.spheres.is_some() {
            return Err(wrong("spheres", "none without renderer = \"sphere_tree\"", "a number"));
        }
        if let Some(ramp) = self.ramp {
            options = options.with_ramp(ramp_of(ramp)?);
        }
        if let Some(method) = self.method {
            options.method = word::<Method>("method", method)?;
        }
        if let Some(parameters) = self.parameters {
            options.parameters = parameters_of(parameters)?;
        }
        if let Some(damping) = self.damping {
            options.damping = damping;
        }
        if let Some(iterations) = self.iterations {
            options = options.with_iterations(iterations);
        }
        options.run_all = self.run_all;
        options.check().map_err(crate::errors::refused)?;
        Ok(options)
    }
}
