//! `backlit-resume 1`: what a tracker knew when a track was last written, so that it can go on as if nothing had stopped it
//! (see `docs/formats.md`).

use std::path::Path;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cues::CueMemory;
use backlit_tracking::filter::Belief;
use backlit_tracking::render::Ramp;
use backlit_tracking::track::{
    Beam, FilterMemory, KalmanOptions, LastFrame, MemoryError, Patience, REWOUND_FRAMES, Rival,
    TrackerMemory, UsualCost, WaitingFrame,
};
use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use crate::{DiskFiles, FileError, FileProblem, Result, TakeFiles, json_text, text};

/// Name and version of the format.
pub const FORMAT: &str = "backlit-resume 1";

/// Largest file that is read, bytes: thousands of frames of a full body that wait to be smoothed.
const MAX_BYTES: u64 = 1 << 30;

/// What goes on.
#[derive(Debug, Clone, PartialEq)]
pub struct Resume {
    /// What the tracker knew after the last frame.
    pub memory: TrackerMemory,
    /// The frames that waited to be smoothed by later ones; `None` where nothing is smoothed.
    pub smoothing: Option<WaitingFrames>,
    /// How many frames a pose that is found elsewhere may still be followed back.
    pub rewind: usize,
}

/// The frames that wait to be smoothed.
#[derive(Debug, Clone, PartialEq)]
pub struct WaitingFrames {
    /// By how many later frames each is smoothed; by all where `None`.
    pub lag: Option<usize>,
    /// In the order of tracking; the last one is the tracker's last frame.
    pub frames: Vec<WaitingFrame>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ResumeSpec {
    format: String,
    frame: usize,
    pose: PoseSpec,
    lost: bool,
    velocity: Option<Vec<f64>>,
    has_start: bool,
    usual_rms: Vec<f64>,
    too_high: usize,
    #[serde(default)]
    usual_ramp: Option<Ramp>,
    last_resort: [usize; 2],
    filter: Option<FilterSpec>,
    cues: Option<CuesSpec>,
    #[serde(default)]
    rivals: Vec<RivalSpec>,
    /// Frames to wait and frames waited: of chains that are seeded again, and of poses that look the same.
    #[serde(default)]
    patience: [[usize; 2]; 2],
    smoothing: Option<SmoothingSpec>,
    #[serde(default)]
    rewind: usize,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RivalSpec {
    pose: PoseSpec,
    velocity: Option<Vec<f64>>,
    behind: f64,
}

/// Rotations are in the order of the state.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PoseSpec {
    root: [f64; 3],
    rotations: Vec<[f64; 4]>,
}

/// The covariance is (δ, v) by (δ, v), column after column.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct BeliefSpec {
    velocity: Vec<f64>,
    covariance: Vec<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FilterSpec {
    noise: KalmanOptions,
    pose: PoseSpec,
    belief: BeliefSpec,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CuesSpec {
    offsets: Vec<[f64; 12]>,
    before: Option<PoseSpec>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SmoothingSpec {
    lag: Option<usize>,
    waiting: Vec<WaitingSpec>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WaitingSpec {
    frame: usize,
    pose: PoseSpec,
    goes_on: bool,
    belief: Option<BeliefSpec>,
}

impl PoseSpec {
    fn of(pose: &Pose) -> Self {
        let rotations = pose.rotations.iter().map(|q| [q.w, q.x, q.y, q.z]).collect();
        Self { root: pose.root.to_array(), rotations }
    }

    fn pose(self) -> Pose {
        let rotations = self.rotations.into_iter().map(|[w, x, y, z]| DQuat::from_xyzw(x, y, z, w)).collect();
        Pose { root: DVec3::from_array(self.root), rotations }
    }
}

impl BeliefSpec {
    fn of(belief: &Belief) -> Self {
        let (velocity, covariance) = belief.numbers();
        Self { velocity: velocity.to_vec(), covariance: covariance.to_vec() }
    }

    fn belief(self, field: &str) -> Result<Belief, MemoryError> {
        let (expected, found) = (4 * self.velocity.len().pow(2), self.covariance.len());
        let field = || format!("{field}.covariance");
        Belief::from_numbers(self.velocity, self.covariance).ok_or_else(|| MemoryError::Count {
            field: field(),
            found,
            expected,
        })
    }
}

/// The content of the file. [`parse`] gives the same again, to the bit.
#[must_use]
pub fn to_text(resume: &Resume) -> String {
    let TrackerMemory { last, usual, last_resort, has_start, filter, cues, beam } = &resume.memory;
    let filter = filter.as_ref().map(|filter| FilterSpec {
        noise: filter.noise,
        pose: PoseSpec::of(&filter.pose),
        belief: BeliefSpec::of(&filter.belief),
    });
    let patience = |patience: &Patience| [patience.wait, patience.waited];
    let waiting = |frame: &WaitingFrame| WaitingSpec {
        frame: frame.frame,
        pose: PoseSpec::of(&frame.pose),
        goes_on: frame.goes_on,
        belief: frame.belief.as_ref().map(BeliefSpec::of),
    };
    let spec = ResumeSpec {
        format: FORMAT.to_owned(),
        frame: last.frame,
        pose: PoseSpec::of(&last.pose),
        lost: last.lost,
        velocity: last.velocity.clone(),
        has_start: *has_start,
        usual_rms: usual.last.iter().copied().collect(),
        too_high: usual.too_high,
        usual_ramp: usual.ramp,
        last_resort: patience(last_resort),
        filter,
        cues: cues.as_ref().map(|cues| CuesSpec {
            offsets: cues.offsets.clone(),
            before: cues.before.as_ref().map(PoseSpec::of),
        }),
        rivals: beam
            .rivals
            .iter()
            .map(|rival| RivalSpec {
                pose: PoseSpec::of(&rival.last.pose),
                velocity: rival.last.velocity.clone(),
                behind: rival.behind,
            })
            .collect(),
        patience: [&beam.reseeds, &beam.confusions].map(patience),
        smoothing: resume.smoothing.as_ref().map(|smoothing| SmoothingSpec {
            lag: smoothing.lag,
            waiting: smoothing.frames.iter().map(waiting).collect(),
        }),
        rewind: resume.rewind,
    };
    // Numbers, words and lists of them: there is nothing that JSON could not hold.
    serde_json::to_string(&spec).unwrap_or_default() + "\n"
}

/// Reads what was left for a track of this body.
pub fn read(path: &Path, model: &Model) -> Result<Resume> {
    parse(path, &DiskFiles.read(path, MAX_BYTES)?, model)
}

/// The same from bytes; `path` is for the error's message.
pub fn parse(path: &Path, bytes: &[u8], model: &Model) -> Result<Resume> {
    let spec: ResumeSpec = json_text::parse_versioned(path, text::decode(path, bytes)?, FORMAT)?;
    resume(spec, model).map_err(|problem| FileError::new(path, problem))
}

fn resume(spec: ResumeSpec, model: &Model) -> Result<Resume, FileProblem> {
    let memory_error = |error| FileProblem::Memory { error };
    let filter = |FilterSpec { noise, pose, belief }: FilterSpec| {
        Ok(FilterMemory { noise, pose: pose.pose(), belief: belief.belief("filter")? })
    };
    let rival = |RivalSpec { pose, velocity, behind }| Rival {
        last: LastFrame { frame: spec.frame, pose: pose.pose(), lost: false, velocity },
        behind,
    };
    let patience = |[wait, waited]: [usize; 2]| Patience { wait, waited };
    let memory = TrackerMemory {
        last: LastFrame {
            frame: spec.frame,
            pose: spec.pose.pose(),
            lost: spec.lost,
            velocity: spec.velocity,
        },
        usual: UsualCost { last: spec.usual_rms.into(), too_high: spec.too_high, ramp: spec.usual_ramp },
        last_resort: patience(spec.last_resort),
        has_start: spec.has_start,
        filter: spec.filter.map(filter).transpose().map_err(memory_error)?,
        cues: spec
            .cues
            .map(|cues| CueMemory { offsets: cues.offsets, before: cues.before.map(PoseSpec::pose) }),
        beam: Beam {
            rivals: spec.rivals.into_iter().map(rival).collect(),
            reseeds: patience(spec.patience[0]),
            confusions: patience(spec.patience[1]),
        },
    };
    memory.check(model).map_err(memory_error)?;
    let waiting = |WaitingSpec { frame, pose, goes_on, belief }: WaitingSpec| {
        let belief = belief.map(|belief| belief.belief(&format!("waiting.{frame}"))).transpose()?;
        let waiting = WaitingFrame { frame, pose: pose.pose(), belief, goes_on };
        waiting.check(model).map(|()| waiting)
    };
    let rewind = spec.rewind.min(REWOUND_FRAMES);
    let Some(SmoothingSpec { lag, waiting: frames }) = spec.smoothing else {
        return Ok(Resume { memory, smoothing: None, rewind });
    };
    let frames: Vec<WaitingFrame> =
        frames.into_iter().map(waiting).collect::<Result<_, _>>().map_err(memory_error)?;
    if let Some(pair) = frames.windows(2).find(|pair| pair[0].frame >= pair[1].frame) {
        return Err(field("smoothing.waiting", pair[1].frame, "frames in their order"));
    }
    match frames.last() {
        Some(last) if last.frame != spec.frame => {
            Err(field("smoothing.waiting", last.frame, "`frame` as the last one"))
        }
        _ => Ok(Resume { memory, smoothing: Some(WaitingFrames { lag, frames }), rewind }),
    }
}

fn field(field: &str, found: usize, expected: &str) -> FileProblem {
    FileProblem::field(field, found.to_string(), expected)
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::{Parameters, builtin};

    use super::*;
    use crate::damaged::assert_refused;

    fn belief(seed: f64) -> Belief {
        let number = |index: usize| (seed + index as f64 * 0.7).sin() / 3.0;
        Belief::from_numbers((0..6).map(number).collect(), (0..144).map(number).collect()).unwrap()
    }

    fn sample() -> Resume {
        let rest = Pose::rest(&builtin::single_limb());
        let pose = rest.retract(Parameters::Tangent, &[0.1, -2.0, 1.0 / 3.0, 0.1, 0.0, 0.5]);
        let waiting = |frame, belief| WaitingFrame { frame, pose: pose.clone(), belief, goes_on: frame > 5 };
        Resume {
            memory: TrackerMemory {
                last: LastFrame { frame: 7, pose: pose.clone(), lost: true, velocity: Some(vec![0.1; 6]) },
                usual: UsualCost { last: [20.25, 1.0 / 3.0].into(), too_high: 2, ramp: Some(Ramp::Half) },
                last_resort: Patience { wait: 1, waited: 4 },
                has_start: true,
                filter: Some(FilterMemory {
                    noise: KalmanOptions {
                        measurement_deviation: Some(312.0 / 7.0),
                        ..KalmanOptions::default()
                    },
                    pose: pose.clone(),
                    belief: belief(1.0),
                }),
                cues: Some(CueMemory { offsets: vec![[0.1; 12]], before: Some(pose.clone()) }),
                beam: Beam {
                    rivals: vec![Rival {
                        last: LastFrame { frame: 7, pose: pose.clone(), lost: false, velocity: None },
                        behind: 1.0 / 7.0,
                    }],
                    reseeds: Patience { wait: 1, waited: 2 },
                    confusions: Patience::default(),
                },
            },
            smoothing: Some(WaitingFrames {
                lag: None,
                frames: vec![waiting(5, Some(belief(2.0))), waiting(7, None)],
            }),
            rewind: 17,
        }
    }

    #[test]
    fn it_survives_its_file_and_a_broken_one_says_where() {
        let model = builtin::single_limb();
        let read = |text: &str| parse(Path::new("resume.json"), text.as_bytes(), &model);
        let resume = sample();
        let text = to_text(&resume);
        assert_eq!(read(&text).unwrap(), resume);
        // What was usual had no ramp once, and filters did not steer.
        let mut before = resume.clone();
        before.memory.usual.ramp = None;
        assert_eq!(read(&text.replace(",\"usual_ramp\":\"half\"", "")).unwrap(), before);
        assert_eq!(read(&text.replace(",\"steers\":false", "")).unwrap(), resume);
        let mut bare = resume;
        bare.smoothing = None;
        bare.memory.filter = None;
        (bare.memory.cues, bare.memory.last.velocity) = (None, None);
        assert_eq!(read(&to_text(&bare)).unwrap(), bare);
        for cut in (0..text.len() - 2).step_by(97) {
            let message = read(&text[..cut]).unwrap_err().to_string();
            assert!(message.starts_with("resume.json"), "{message}");
        }
        assert_refused(
            &text,
            read,
            r#"
            backlit-resume 1 ⇒ backlit-resume 2 ⇒ `format` is "backlit-resume 2"
            "velocity":[0.1, ⇒ "velocity":[ ⇒ `velocity` has 5 numbers; expected 6
            "root":[0.1 ⇒ "root":[9e9 ⇒ `pose`: `root`
            "usual_rms":[20.25 ⇒ "usual_rms":[-1 ⇒ `usual_rms` is -1; expected a finite number
            "too_high":2 ⇒ "too_high":10 ⇒ `usual_rms` is 10
            "last_resort":[1,4] ⇒ "last_resort":[5,4] ⇒ `last_resort` is 5
            "covariance":[ ⇒ "covariance":[1, ⇒ `filter.covariance` has 145 numbers; expected 144
            "offsets":[[ ⇒ "offsets":[[0,0,0,0,0,0,0,0,0,0,0,0],[ ⇒ `cues.offsets` has 2
            "frame":5 ⇒ "frame":7 ⇒ `smoothing.waiting` is 7; expected frames in their order
            "frame":7,"pose" ⇒ "frame":9,"pose" ⇒ expected `frame` as the last one
            "memory":0.3 ⇒ "memory":0 ⇒ `filter.noise`: `kalman.memory` is 0
            "behind":0. ⇒ "behind":99999999999999. ⇒ `rivals` is 9
            "patience":[[1,2] ⇒ "patience":[[1,17] ⇒ `patience` is 17; expected 16 frames at most
            "lag":null ⇒ "lagg":null ⇒ lagg
            "#,
        );
    }
}
