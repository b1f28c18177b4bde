//! Backlit for Python: the native half of the package `backlit`. What a function computes is the core's and the runs'; here numbers
//! become arrays, and errors exceptions. `python/backlit/_backlit.pyi` documents what Python sees.
//!
//! | file | holds |
//! |---|---|
//! | `arrays` | NumPy in and out |
//! | `array_files` | arrays as the files of a take, so that they go the way that files go |
//! | `work` | long work beside the interpreter: Ctrl+C, progress, threads |
//! | `errors` | exceptions with their causes |
//! | `options` | words that choose how a pose is fitted |
//! | `camera_group`, `body`, `pose`, `take` | the nouns |
//! | `fit`, `track` | frame after frame, and what was found |
//! | `iterate` | one frame, iteration by iteration |
//! | `render`, `check`, `refine` | predictions; cameras checked and refined |
//! | `program` | the command line |

mod array_files;
mod arrays;
mod body;
mod camera_group;
mod check;
mod errors;
mod fit;
mod iterate;
mod options;
mod pose;
mod program;
mod refine;
mod render;
mod take;
mod track;
mod work;

#[pyo3::pymodule]
mod _backlit {
    use backlit_cli::program::obey_environment;
    use pyo3::prelude::*;

    use super::errors::InputError;

    #[pymodule_export]
    use super::body::PyBody;
    #[pymodule_export]
    use super::camera_group::PyCameraGroup;
    #[pymodule_export]
    use super::check::{PyFinding, check};
    #[pymodule_export]
    use super::fit::fit;
    #[pymodule_export]
    use super::iterate::{PyIterations, PyStep, iterate};
    #[pymodule_export]
    use super::pose::PyPose;
    #[pymodule_export]
    use super::program::run_program;
    #[pymodule_export]
    use super::refine::{PyRefinement, refine};
    #[pymodule_export]
    use super::render::{jacobian, render};
    #[pymodule_export]
    use super::take::PyTake;
    #[pymodule_export]
    use super::track::PyTrack;

    #[pymodule_init]
    fn begin(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        obey_environment().map_err(InputError::new_err)
    }
}
