//! What can be done where a file cannot be written.

use std::error::Error;
use std::io::{self, ErrorKind};

use backlit_document::project::ProjectError;
use backlit_formats::FileError;

/// A sentence for the user about what to do next; `error` or one of its causes is what the disk said.
pub(crate) fn write_advice(error: &(dyn Error + 'static)) -> &'static str {
    let mut cause = Some(error);
    while let Some(error) = cause {
        if let Some(said) = said_by_disk(error) {
            return match said.kind() {
                ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
                    "Free some space and try again, or choose another disk."
                }
                ErrorKind::InvalidFilename => "Choose a shorter or plainer name.",
                ErrorKind::IsADirectory => "Choose another name.",
                _ => "Choose another folder.",
            };
        }
        cause = error.source();
    }
    "Try again, or choose another place."
}

fn said_by_disk<'a>(error: &'a (dyn Error + 'static)) -> Option<&'a io::Error> {
    if let Some(error) = error.downcast_ref::<io::Error>() {
        return Some(error);
    }
    let file = error.downcast_ref::<FileError>();
    let file = file.or_else(|| match error.downcast_ref::<ProjectError>()? {
        ProjectError::File(file) => Some(file),
        _ => None,
    });
    file?.write_error()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use backlit_formats::FileProblem;

    use super::*;

    #[test]
    fn a_remedy_is_found_through_every_wrapping() {
        let full = || io::Error::from(ErrorKind::StorageFull);
        let file = || FileError::new(Path::new("a.png"), FileProblem::Write { error: full() });
        let wrapped = anyhow::Error::new(file()).context("the plot");
        let all: [&(dyn Error + 'static); 4] =
            [&full(), &file(), &ProjectError::from(file()), wrapped.as_ref()];
        for error in all {
            assert!(write_advice(error).starts_with("Free some space"), "{error}");
        }
        assert!(file().to_string().ends_with("a.png: cannot be written: the disk is full"));
        assert!(write_advice(&io::Error::from(ErrorKind::NotADirectory)).contains("another folder"));
        assert!(write_advice(&std::fmt::Error).contains("another place"));
    }
}
