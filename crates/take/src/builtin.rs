//! The take that comes with the program: a synthetic figure before four cameras, with known truth.
//!
//! Its files are embedded from `assets/take`, where an example of the core makes them from a seed.

use std::path::Path;
use std::sync::Arc;

use backlit_formats::{MemoryFiles, Take, TakeError};
use backlit_tracking::body::Model;
use include_dir::{Dir, include_dir};

static FILES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../assets/take");

/// The take file.
const TAKE: &str = "take.toml";

/// Opens the built-in take.
pub fn open() -> Result<Take, TakeError> {
    Take::from_files(files(), Path::new(TAKE))
}

/// The same with another body in place of its own.
pub fn open_with_model(model: Model) -> Result<Take, TakeError> {
    Take::from_files_with_model(files(), Path::new(TAKE), model)
}

fn files() -> Arc<MemoryFiles> {
    let mut files = Vec::new();
    collect(&FILES, &mut files);
    Arc::new(MemoryFiles::new(files))
}

fn collect(folder: &'static Dir<'static>, files: &mut Vec<(&'static Path, &'static [u8])>) {
    files.extend(folder.files().map(|file| (file.path(), file.contents())));
    for inner in folder.dirs() {
        collect(inner, files);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_take_opens_whole() {
        let take = open().unwrap();
        assert_eq!((take.rig().count(), take.frame_count()), (4, 60));
        assert!(take.start().is_some() && take.reference().is_some());
        for camera in 0..4 {
            let picture = take.frame(camera, 59).unwrap();
            assert_eq!((picture.width(), picture.height()), (192, 256));
            assert!(take.background(camera).unwrap().len() > 1);
        }
    }

    #[test]
    fn it_is_small_enough_to_carry() {
        let mut files = Vec::new();
        collect(&FILES, &mut files);
        let bytes: usize = files.iter().map(|(_, content)| content.len()).sum();
        assert!(bytes < 6_000_000, "{bytes} bytes");
    }
}
