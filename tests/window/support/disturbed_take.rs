//! The built-in take as a folder, with something as large as a body before one camera from some frame on.

use std::fs;
use std::path::Path;

use backlit_formats::Take;
use backlit_lab::experiment::disturbed_pictures::PictureDisturbance;

/// Writes it. The camera is counted from 1.
pub(crate) fn write(folder: &Path, camera: usize, from: usize) {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/take");
    copy(&source, folder);
    let take = Take::open(&source).unwrap();
    for frame in 0..take.frame_count() {
        let mut picture = take.frame(camera - 1, frame).unwrap();
        if let Some(since) = frame.checked_sub(from) {
            PictureDisturbance::StandingBody.apply(&mut picture, since);
        }
        picture.save(folder.join(format!("cam{camera}/frame_{frame:03}.png"))).unwrap();
    }
    let text = fs::read_to_string(folder.join("take.toml")).unwrap();
    let name = format!("cam{camera}/frame_%03d");
    let text = text.replace(&format!("{name}.jpg"), &format!("{name}.png"));
    fs::write(folder.join("take.toml"), text).unwrap();
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let to = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &to);
        } else {
            fs::copy(entry.path(), to).unwrap();
        }
    }
}
