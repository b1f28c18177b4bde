//! Exceptions: the message is what the command line says, and every cause below it is a `__cause__`.

use anyhow::Error;
use backlit_formats::{FileError as FormatsFileError, TakeError};
use pyo3::exceptions::PyTypeError;
use pyo3::import_exception;
use pyo3::prelude::*;

import_exception!(backlit._errors, BacklitError);
import_exception!(backlit._errors, InputError);
import_exception!(backlit._errors, FileError);

/// Which class of exception it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Class {
    General,
    Input,
    File,
}

/// The exception for an error, whose class its causes tell.
pub(crate) fn raised(error: impl Into<Error>) -> PyErr {
    let error = error.into();
    let is_of_file = error.chain().any(|cause| cause.is::<FormatsFileError>() || cause.is::<TakeError>());
    exception(&error, if is_of_file { Class::File } else { Class::General })
}

/// The exception for what was passed in.
pub(crate) fn refused(error: impl Into<Error>) -> PyErr {
    exception(&error.into(), Class::Input)
}

/// An argument that is not as expected.
pub(crate) fn wrong(argument: &str, expected: &str, found: &str) -> PyErr {
    InputError::new_err(format!("{argument}: expected {expected}; got {found}"))
}

/// An argument of a type that is not expected.
pub(crate) fn wrong_type(argument: &str, expected: &str, found: &Bound<'_, PyAny>) -> PyErr {
    let name =
        found.get_type().name().map_or_else(|_error| "something else".to_owned(), |name| name.to_string());
    PyTypeError::new_err(format!("{argument}: expected {expected}; got {name}"))
}

fn exception(error: &Error, class: Class) -> PyErr {
    let words: Vec<String> = error.chain().map(ToString::to_string).collect();
    let made = |from: usize| {
        let message = words[from..].join(": ");
        match class {
            Class::General => BacklitError::new_err(message),
            Class::Input => InputError::new_err(message),
            Class::File => FileError::new_err(message),
        }
    };
    let mut below: Option<PyErr> = None;
    for from in (0..words.len()).rev() {
        let this = made(from);
        Python::attach(|py| this.set_cause(py, below.take()));
        below = Some(this);
    }
    below.unwrap_or_else(|| BacklitError::new_err("an error without words"))
}
