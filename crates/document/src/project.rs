//! The project file `*.backlit`: a document as versioned JSON (see `docs/formats.md`).
//!
//! Poses are written by limb name, so that a person can read them; numbers are written so that they are read
//! back to the bit.

mod bookmark_record;
mod frame_trust_record;
mod record;
mod run_record;

use std::path::{Path, PathBuf};

use backlit_formats::{
    DiskFiles, FileError, FileProblem, TakeFiles, atomic, json_text,
    text::{cut, shown},
};
use backlit_tracking::body::{ModelError, PoseError};
use backlit_tracking::fit::OptionsError;
use backlit_tracking::segment::SegmentError;
use backlit_tracking::silhouette::StrokeError;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::Document;
use crate::run::Run;
use record::ProjectFile;

/// Name and version of the project file's format.
pub const FORMAT: &str = "backlit-project 1";

/// Files larger than this are not projects.
const MAX_BYTES: u64 = 1 << 30;

/// What a project's file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Project {
    /// What is saved and undone.
    pub document: Document,
    /// The runs of the fit, by number.
    pub runs: Vec<Run>,
}

/// Why a project cannot be read or written.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum ProjectError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}: {error}", path.display())]
    Json { path: PathBuf, error: serde_json::Error },
    #[error("{}, line {line}: the file ends too early: it was cut off", path.display())]
    Cut { path: PathBuf, line: usize },
    #[error("{}: {}", path.display(), shown(&problem.to_string()))]
    Content { path: PathBuf, problem: ProjectProblem },
}

/// What is wrong with the content of a project's file.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum ProjectProblem {
    #[error("`format` is \"{}\"; expected \"{FORMAT}\"", cut(.found))]
    Format { found: String },
    #[error(
        "a newer Backlit wrote this project (\"{}\"; this one reads \"{FORMAT}\"): open it with that one", cut(.found)
    )]
    Newer { found: String },
    #[error("`model`: {0}")]
    Model(ModelError),
    #[error("`{field}`: {error}")]
    Pose { field: String, error: PoseError },
    #[error("`{field}` names the limb \"{}\", which the model does not have", cut(.limb))]
    Limb { field: String, limb: String },
    #[error(
        "`{field}` names the limb \"{}\", which has no rotation of its own: it turns with the limb before it", cut(.limb)
    )]
    Rigid { field: String, limb: String },
    #[error("`{field}` is {value}; expected {expected}")]
    Number { field: String, value: f64, expected: &'static str },
    #[error("`measurement` has {count} entries; expected one for each of the {cameras} cameras")]
    Measurements { count: usize, cameras: usize },
    #[error("`{field}` names the camera \"{}\", which the take does not have", cut(.camera))]
    Camera { field: String, camera: String },
    #[error("`{field}`: {error}")]
    Fit { field: String, error: OptionsError },
    #[error("`measurement`, camera {index} counted from 0: {error}")]
    Measurement { index: usize, error: SegmentError },
    #[error("`cameras`: the weight of {} is {weight}; expected a number, 0 or above", cut(.camera))]
    Weight { camera: String, weight: f64 },
    #[error("`{field}`: {error}")]
    Stroke { field: String, error: StrokeError },
    #[error("`{field}` is no text of a bookmark; expected {expected}")]
    Text { field: String, expected: &'static str },
    #[error("`{field}` is missing; only a frame with an estimate may leave it out")]
    NoPose { field: String },
    #[error(transparent)]
    Trust(FileProblem),
    #[error(transparent)]
    Calibration(FileError),
}

/// Writes a document and the runs of the fit. The file appears whole or not at all.
pub fn write_project(path: &Path, document: &Document, runs: &[Run]) -> Result<(), ProjectError> {
    let text = to_text(document, runs);
    let text = text.map_err(|error| ProjectError::Json { path: path.to_owned(), error })?;
    Ok(atomic::write(path, text.as_bytes())?)
}

/// The text of a project's file: a run and what was told of a frame take one line.
pub fn to_text(document: &Document, runs: &[Run]) -> serde_json::Result<String> {
    let file = ProjectFile::of(document, runs);
    let mut text = serde_json::to_string_pretty(&file)?;
    let last_brace = "\n}";
    text.truncate(text.len() - last_brace.len());
    if !file.brush.is_empty() {
        text += &lines("brush", &file.brush)?;
    }
    if !file.bookmarks.is_empty() {
        text += &lines("bookmarks", &file.bookmarks)?;
    }
    if let Some(person) = &file.person {
        text += &format!(",\n  \"person\": {}", serde_json::to_string(person)?);
    }
    if !file.trust.is_empty() {
        let line = |(frame, told)| Ok(format!("\"{frame}\": {}", serde_json::to_string(told)?));
        let lines: serde_json::Result<Vec<String>> = file.trust.iter().map(line).collect();
        text += &format!(",\n  \"told\": {{\n    {}\n  }}", lines?.join(",\n    "));
    }
    if !file.background_changes.is_empty() {
        text += &lines("background_changes", &file.background_changes)?;
    }
    if !file.runs.is_empty() {
        text += &lines("runs", &file.runs)?;
    }
    text += last_brace;
    Ok(text)
}

/// A list whose elements take a line each.
fn lines(key: &str, elements: &[impl Serialize]) -> Result<String, serde_json::Error> {
    let lines: Result<Vec<String>, _> = elements.iter().map(serde_json::to_string).collect();
    Ok(format!(",\n  \"{key}\": [\n    {}\n  ]", lines?.join(",\n    ")))
}

/// Reads a project; it is equal to the one that was written.
pub fn read_project(path: &Path) -> Result<Project, ProjectError> {
    parse_project(path, &DiskFiles.read(path, MAX_BYTES)?)
}

/// The same from the bytes of a file, which errors name.
pub fn parse_project(path: &Path, text: &[u8]) -> Result<Project, ProjectError> {
    let wrong = |problem| ProjectError::Content { path: path.to_owned(), problem };
    // The version first: another version's fields would only confuse.
    let header: Header = match serde_json::from_slice(text) {
        Ok(header) => header,
        Err(error) if error.is_eof() => {
            return Err(ProjectError::Cut { path: path.to_owned(), line: error.line() });
        }
        Err(_) => json_text::parse_bytes(path, text)?,
    };
    if header.format != FORMAT {
        let found = header.format;
        let is_newer = version(&found) > version(FORMAT);
        return Err(wrong(if is_newer {
            ProjectProblem::Newer { found }
        } else {
            ProjectProblem::Format { found }
        }));
    }
    let file: ProjectFile = json_text::parse_bytes(path, text)?;
    file.into_project(path).map_err(|problem| match problem {
        ProjectProblem::Calibration(error) => ProjectError::File(error),
        problem => wrong(problem),
    })
}

/// The version of a project's format; none of another format's.
fn version(format: &str) -> Option<u64> {
    let (name, version) = format.split_once(' ')?;
    version.parse().ok().filter(|_| FORMAT.split_once(' ').is_some_and(|(ours, _)| ours == name))
}

#[derive(Debug, Deserialize)]
struct Header {
    format: String,
}

#[cfg(test)]
mod tests {
    use backlit_tracking::optimize::Iteration;
    use std::collections::BTreeMap;
    use std::sync::Arc;

    use backlit_tracking::belief::{LimbTrust, Reason};
    use backlit_tracking::body::{Parameters, Pose, builtin};
    use backlit_tracking::cues::{Cue, LimbHold};
    use backlit_tracking::segment::SegmentOptions;
    use backlit_tracking::silhouette::{Label, Stroke};
    use backlit_tracking::track::{Mode, WhenToSearch};
    use glam::{DMat3, DVec3};

    use super::*;
    use crate::bookmark::Bookmark;
    use crate::edit::Edit;
    use crate::frame_trust::FrameTrust;
    use crate::run::{RunChoices, RunEnding, RunStep};
    use crate::runs::StepRef;
    use crate::tracking_choices::{AtKeys, CueChoice, Following, TrackPrior, TrackedBody, TrackingChoices};
    use crate::{CameraUse, Estimate, Origin, likely_poses};
    use backlit_formats::footage::BrushStroke;
    use backlit_formats::footage::replacement::Calibration;
    use backlit_take::source::TakeSource;
    use backlit_words::joint::JointId;

    fn example() -> Document {
        let mut document = Document::new(builtin::upper_body());
        document.take = Some(TakeSource::Path(PathBuf::from("/takes/balancing")));
        document.cameras =
            Arc::new(vec![CameraUse { name: "cam01".to_owned(), used: true, weight: 1.0 / 3.0 }]);
        let step: Vec<f64> = (0..27).map(|i| 0.3 * (f64::from(i) * 1.7).sin()).collect();
        let pose = document.start.retract(Parameters::Tangent, &step);
        let estimate = Estimate {
            pose: pose.clone(),
            origin: Origin::Track,
            cost: Some(1.25e8),
            rms: Some(20.5),
            iou: Some(0.83),
            steps: 21,
            lost: false,
            is_stale: false,
        };
        document.measurement = Arc::new(vec![SegmentOptions::default()]);
        let model = document.model.clone();
        let trust = |pose: &Pose| {
            let trust = (0..model.limbs().len()).map(|limb| {
                let wrong = 0.1 * limb as f64 / 3.0;
                LimbTrust::new(limb, wrong, [wrong / 3.0, 0.3], Reason::Rival)
            });
            let holds = model.rotation_owners().iter().map(|&limb| {
                let cues = if limb > 2 { vec![Cue::Flow, Cue::Stereo] } else { Vec::new() };
                LimbHold { limb, cameras: limb, by_silhouettes: limb == 2, cues }
            });
            let covariance = DMat3::from_diagonal(DVec3::new(1e-4, 2e-4, 9e-4));
            let covariances = vec![covariance; document.model.limbs().len()];
            let rival = document.start.as_ref().clone();
            let rivals = vec![Mode { pose: rival, weight: 1.0 / 3.0, covariances }];
            Some(Arc::new(FrameTrust::new(&model, pose.clone(), trust.collect(), holds.collect(), rivals)))
        };
        let found = Arc::new(estimate);
        let track = [4, 5].map(|frame| (frame, found.clone(), trust(&found.pose))).into();
        let mut likely = (*document.fit).clone();
        likely_poses::set_weight(&mut likely, 4.5);
        for edit in [
            Edit::AddTrack(track),
            Edit::SetPose { frame: 3, pose, what: "Move".to_owned() },
            Edit::SetPose { frame: 5, pose: (*document.start).clone(), what: "Take rival pose".to_owned() },
            Edit::UseCamera { camera: 0, used: false },
            Edit::AddBookmark(Bookmark {
                frame: 9,
                camera: None,
                joint: Some(JointId::End(2)),
                text: "here".to_owned(),
            }),
            Edit::SetTracking(TrackingChoices {
                motion: Following::Smoothed { lag: Some(3) },
                search: WhenToSearch::Never,
                at_keys: AtKeys::Stop,
                body: TrackedBody::AsItIs,
                cues: CueChoice::All,
                prior: TrackPrior::People,
            }),
            Edit::SetFit { options: Box::new(likely), what: "Change solver".to_owned() },
            Edit::Pin { limb: 5, pinned: true },
            Edit::SetSize { limb: 2, length: 0.2, radius: 0.05, both_sides: true },
            Edit::SetCalibration(Some(calibration())),
            Edit::SetReferences(vec![PathBuf::from("/motions/squat.trc")]),
            Edit::SetPlates(BTreeMap::from([(0, PathBuf::from("/plates/cam01.png"))])),
            Edit::SetMasks { frame: 4, masks: BTreeMap::from([(0, PathBuf::from("/masks/cam01.png"))]) },
            Edit::Paint(vec![BrushStroke {
                camera: 0,
                frames: [4, 9],
                stroke: Stroke {
                    label: Label::Unknown,
                    radius_px: 2.5,
                    points: vec![[1.0 / 3.0, -2.0], [7.0, 9.5]],
                },
            }]),
        ] {
            document.apply(edit).unwrap();
        }
        document
    }

    /// A run with a step that was taken, and one whose numbers ran out of range.
    fn run(document: &Document, number: usize) -> Run {
        let iteration = Iteration {
            predicted_decrease: 1.25,
            actual_decrease: 1.0,
            damping: 0.5,
            step_norm: 0.1,
            ..Iteration::start(document.pose_at(3).clone(), 9.0)
        };
        let wild = Iteration { trial_cost: f64::INFINITY, stage: 1, accepted: false, ..iteration.clone() };
        let step = |iteration| RunStep {
            iteration,
            mismatch: 8.0,
            rms: 2.5,
            iou: Some(0.75),
            joint_error_mm: None,
            seconds: 0.002,
        };
        Run {
            number,
            name: "by hand".to_owned(),
            is_named: true,
            choices: RunChoices {
                fit: document.fit.clone(),
                cameras: document.cameras.clone(),
                part: Some("right forearm".to_owned()),
                branched_from: Some(StepRef { run: 1, step: 4 }),
            },
            detail: "capsule".to_owned(),
            frame: 3,
            measured_by: document.fit.stages.first().copied(),
            colour: 1,
            steps: vec![step(iteration), step(wild)],
            stages: vec!["wide".to_owned(), "narrow".to_owned()],
            ending: Some(RunEnding::Solver("no step lowered the cost".to_owned())),
            is_shown: true,
        }
    }

    fn calibration() -> Arc<Calibration> {
        use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, Rig};
        let intrinsics = Intrinsics { fx: 410.123_456_789, fy: 1e3 / 3.0, cx: 135.5, cy: 0.1 + 0.2 };
        let place = CameraFromWorld::looking_at(DVec3::new(0.1, -2.7, 1.3), DVec3::ZERO, DVec3::Z);
        let lens = Distortion::OpenCv { k1: -0.1, k2: 1e-9, p1: 0.0, p2: 0.7, k3: 0.0 };
        let camera = Camera::new("cam01", [272, 480], intrinsics, lens, place).unwrap();
        Arc::new(Calibration { path: PathBuf::from("/c.qca.txt"), rig: Rig::new(vec![camera]).unwrap() })
    }

    #[test]
    fn a_project_is_read_back_equal() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.backlit");
        let document = example();
        let runs = vec![run(&document, 2), run(&document, 5)];
        write_project(&path, &document, &runs).unwrap();
        assert_eq!(read_project(&path).unwrap(), Project { document: document.clone(), runs });
        write_project(&path, &document, &[]).unwrap();
        assert_eq!(read_project(&path).unwrap(), Project { document, runs: Vec::new() });
        let names: Vec<_> =
            std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(names, ["a.backlit"], "nothing else is left in the folder");
    }

    #[test]
    fn a_project_from_before_there_was_more_to_save_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("old.backlit");
        write_project(&path, &example(), &[]).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
        for field in ["tracking", "told"] {
            assert!(json.as_object_mut().unwrap().remove(field).is_some());
        }
        std::fs::write(&path, json.to_string()).unwrap();
        let Document { tracking, trust, .. } = read_project(&path).unwrap().document;
        assert_eq!(tracking, TrackingChoices::of_preset(None));
        assert!(trust.is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_no_projects() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe.backlit");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for path in [pipe.as_path(), Path::new("/dev/zero")] {
            let said = read_project(path).unwrap_err().to_string();
            assert!(said.contains("expected a file"), "{said}");
        }
    }

    #[test]
    fn errors_name_file_and_field() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("b.backlit");
        let document = example();
        write_project(&path, &document, &[run(&document, 2), run(&document, 5)]).unwrap();
        let good = std::fs::read_to_string(&path).unwrap();
        for (from, to, expected) in [
            ("backlit-project 1", "backlit-project 9", "a newer Backlit wrote this project"),
            ("backlit-project 1", "backlit-pose 9", "`format` is \"backlit-pose 9\""),
            ("backlit-project 1", &"backlit ".repeat(200), "backlit back…\"; expected"),
            ("backlit-body 1", "backlit-body\u{7f} 1", "`format` is \"backlit-body\\u{7f} 1\""),
            ("\"format\": \"backlit-project 1\"", "\"format\": 3", "line 2: `format` is 3; expected a text"),
            ("\"weight\": 0.3333333333333333", "\"weight\": -1", "weight of cam01 is -1"),
            ("\"pins\": [", "\"pins\": [\"tail\",", "`pins` names the limb \"tail\""),
            ("\"z_threshold\": ", "\"z_threshold\": -", "`measurement`, camera 0 counted from 0: "),
            ("\"lost\": false", "\"lost\": false, \"colour\": 1", "unknown field `colour`"),
            ("\"lost\": false", "\"lost\": 0", "`estimates.4.lost`"),
            ("\"iou\": ", "\"iou\": -", "`estimates.4.iou` is -"),
            ("\"cost\": ", "\"cost\": -", "`estimates.4.cost` is -"),
            ("\"keys\": {", "\"keys\": {\"3\": {\"root\": [0, 0, 0]},", "\"3\" is given twice"),
            ("\"plates\": {", "\"plates\": {\"cam9\": \"a.png\",", "`plates` names the camera \"cam9\""),
            ("\"measurement\": [", "\"measurement\": [{},", "`measurement` has 2 entries"),
            ("\"camera\":\"cam01\"", "\"camera\":\"cam9\"", "`brush[0].camera` names the camera \"cam9\""),
            ("\"frames\":[4,9]", "\"frames\":[4,3]", "`brush[0].frames[1]` is 3; expected the last frame"),
            ("\"radius_px\":2.5", "\"radius_px\":-2.5", "`brush[0]`: `radius_px` is -2.5; expected"),
            ("\"label\":\"unknown\"", "\"label\":\"maybe\"", "`brush[0].label`"),
            ("\"text\":\"here\"", "\"text\":\"a\\nb\"", "`bookmarks[0].text` is no text of a bookmark"),
            ("\"frame\":9,\"joint\":\"", "\"frame\":9,\"joint\":\"x", "`bookmarks[0].joint` names the limb"),
            ("\"wrong\":0.0,", "\"wrong\":-1,", "`told.4.trust."),
            (
                "\"held\":{",
                "\"held\":{\"tail\":{\"cameras\":1,\"by_silhouettes\":true,\"cues\":[]},",
                "`told.4.held`",
            ),
            ("\"weight\":0.3333", "\"weight\":1.3333", "`told.4.rivals[0].weight` is 1.3333"),
            ("\"5\": {\"pose\":", "\"6\": {\"trust\":{}}, \"5\": {\"pose\":", "`told.6.pose` is missing"),
            ("\"number\":5", "\"number\":2", "`runs[1].number` is 2"),
            ("\"mismatch\":8.0", "\"mismatch\":-8.0", "`runs[0].steps[0].mismatch` is -8"),
            ("\"stage\":1", "\"stage\":2", "`runs[0].steps[1].stage` is 2"),
            ("\"damping\":0.5,\"step", "\"dumping\":0.5,\"step", "unknown field `dumping`"),
            ("\"stride\": ", "\"stride\": 429496729600", "`fit`: `stages[0].stride` is 4294967"),
            ("\"length\": ", "\"length\": -", "`model`: limb "),
        ] {
            assert!(good.contains(from), "{from}");
            std::fs::write(&path, good.replacen(from, to, 1)).unwrap();
            let error = read_project(&path).unwrap_err();
            let message = error.to_string();
            assert!(message.contains(expected) && message.contains("b.backlit"), "{message}");
            // Who prints causes too, as the command line does, would say it twice.
            let cause = std::error::Error::source(&error).map(ToString::to_string);
            assert!(cause.as_ref().is_none_or(|cause| !message.contains(cause)), "{message}: {cause:?}");
        }
        for cut in [0, 1, good.len() / 2, good.trim_end().len() - 1] {
            std::fs::write(&path, &good[..cut]).unwrap();
            let message = read_project(&path).unwrap_err().to_string();
            assert!(message.contains("b.backlit, line") && message.contains("was cut off"), "{message}");
        }
        let message = read_project(&folder.path().join("none.backlit")).unwrap_err().to_string();
        assert!(message.contains("none.backlit: there is no such file"), "{message}");
    }
}
