//! Projects that are cut, changed and garbled, by the engine of the formats' fuzzing: the same work back or an error in plain words,
//! within 1 s and 500 MB. `BACKLIT_FUZZ_CASES=N` runs N cases.

#![expect(clippy::unwrap_used, reason = "tests, where a panic is the answer")]

#[path = "../../formats/fuzz/engine.rs"]
mod engine;
#[path = "../../formats/fuzz/mutate.rs"]
#[expect(dead_code, reason = "projects are text; other readers are of bytes")]
mod mutate;

use std::path::{Path, PathBuf};

use backlit_document::bookmark::Bookmark;
use backlit_document::edit::Edit;
use backlit_document::project::{Project, parse_project, to_text};
use backlit_document::{CameraUse, Document};
use backlit_take::source::TakeSource;
use backlit_tracking::body::{Parameters, builtin};
use backlit_words::joint::JointId;

use engine::{Outcome, Target};

const CASES: u64 = 400;

/// A project, and the same with work in it.
fn seeds() -> Vec<Vec<u8>> {
    let mut document = Document::new(builtin::single_limb());
    document.take = Some(TakeSource::Path(PathBuf::from("/takes/wave")));
    let camera = CameraUse { name: "cam01".to_owned(), used: true, weight: 0.5 };
    document.cameras = vec![camera].into();
    let plain = to_text(&document, &[]).unwrap();
    let columns = Parameters::Tangent.columns(document.model.rotation_count());
    let pose = document.start.retract(Parameters::Tangent, &vec![0.1; columns]);
    let joint = Some(JointId::End(0));
    for edit in [
        Edit::SetPose { frame: 3, pose, what: "Move".to_owned() },
        Edit::AddBookmark(Bookmark { frame: 3, camera: Some(0), joint, text: "here".to_owned() }),
        Edit::SetMasks { frame: 4, masks: [(0, PathBuf::from("/masks/cam01.png"))].into() },
    ] {
        document.apply(edit).unwrap();
    }
    [plain, to_text(&document, &[]).unwrap()].map(String::into_bytes).into()
}

fn read(bytes: &[u8]) -> Outcome {
    let path = Path::new("work.backlit");
    let read = parse_project(path, bytes);
    if let Ok(Project { document, runs }) = &read {
        let again = parse_project(path, to_text(document, runs).unwrap().as_bytes());
        assert_eq!(again.unwrap().document, *document, "its own file says something else");
    }
    read.into()
}

#[test]
fn projects_are_read_or_refused_in_plain_words() {
    let target = Target {
        name: "project",
        syntax: mutate::Syntax::Text,
        seeds: seeds(),
        words: "backlit-project 1¦take¦built-in¦demonstration¦path¦cameras¦keys¦start¦estimates¦fit¦tracking¦masks¦bookmarks¦runs",
        read,
        short: CASES,
    };
    let cases = std::env::var("BACKLIT_FUZZ_CASES").map_or(target.short, |cases| cases.parse().unwrap());
    if let Err(fault) = engine::run(&target, cases, f64::INFINITY, &|_| ()) {
        let kept = std::env::temp_dir().join("backlit-fuzz-project");
        std::fs::write(&kept, &fault.bytes).unwrap();
        panic!("{}; the case is {}", fault.what, kept.display());
    }
    for seed in &target.seeds {
        for place in (0..seed.len()).step_by(1 + seed.len() / 100) {
            let cut = engine::one(&target, &seed[..place], &mut engine::Figures::default());
            assert!(matches!(cut, Ok(Outcome::Refused(_))), "cut at {place}");
        }
    }
}
