//! Later frames mend earlier ones, and a run that was stopped in between goes on as if it had not been.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;

use backlit_lab::synthetic::capsules;
use backlit_lab::synthetic::masks::widened;
use backlit_lab::synthetic::occlusions::Occlusion;
use backlit_tracking::belief::Verdict;
use backlit_tracking::body::{Model, builtin};
use backlit_tracking::fit::FitOptions;
use backlit_tracking::metrics::mean_joint_error_mm;
use backlit_tracking::search::start;

use super::*;

const EVERY: usize = 4;
const RATE: f64 = 30.0;
const FRAMES: usize = 40;

/// A walk before two telephones that see it from the side: legs hide one another.
struct Walk {
    frames: Vec<Vec<FitView>>,
    /// Frames that were read, and how often one was read again: a rewind does so.
    read: Mutex<(BTreeSet<usize>, usize)>,
    /// When so many were read again, this is cancelled.
    stops_at: usize,
    stop: CancelToken,
}

impl Walk {
    fn new(model: &Model) -> Self {
        let cameras = Occlusion::WalkFromTheSide.cameras([180, 320]).unwrap();
        let frame = |frame: usize| {
            let pose = truth(model, frame * EVERY);
            let view = |camera: &Arc<backlit_tracking::camera::Camera>| {
                let mask = widened(capsules::hard_mask(model, &pose, camera).unwrap(), 2.0).unwrap();
                FitView::of_mask(camera.clone(), mask)
            };
            cameras.iter().map(view).collect()
        };
        Self::of((0..FRAMES).map(frame).collect(), usize::MAX)
    }

    fn of(frames: Vec<Vec<FitView>>, stops_at: usize) -> Self {
        Self { frames, read: Mutex::default(), stops_at, stop: CancelToken::new() }
    }
}

impl FrameReader for Walk {
    type Data = usize;

    fn read(&self, frame: usize) -> Result<usize, FootageError> {
        let mut read = self.read.lock().unwrap();
        if !read.0.insert(frame) {
            read.1 += 1;
            if read.1 == self.stops_at {
                self.stop.cancel();
            }
        }
        Ok(frame)
    }

    fn views(&self, frame: &usize) -> Vec<FitView> {
        self.frames[frame / EVERY].clone()
    }

    fn cues(&self, _: &usize) -> Result<FrameCues, FootageError> {
        Ok(FrameCues::default())
    }
}

fn truth(model: &Model, frame: usize) -> Pose {
    Occlusion::WalkFromTheSide.pose(model, frame as f64 / RATE)
}

fn plan(model: &Arc<Model>, from: usize, to: usize) -> TrackPlan {
    let start = start::perturb(model, &truth(model, 0), 0.05, 0.02, 1);
    let frames = (from..to).map(|frame| frame * EVERY).collect();
    let prior = Some(backlit_document::likely_poses::people());
    let fit = Arc::new(FitOptions { prior, ..FitOptions::default() });
    TrackPlan { fit, ..TrackPlan::new(model.clone(), RATE, start, frames) }
}

/// The track as it is told, and the frames that were mended.
#[derive(Debug, Default)]
struct Followed {
    track: BTreeMap<usize, FrameEstimate>,
    mended: Vec<Mended>,
    /// How many frames were read again until the first were mended.
    read_again: usize,
}

/// A frame that was mended, by which later one, and its poses.
#[derive(Debug, PartialEq)]
struct Mended {
    frame: usize,
    by: usize,
    before: Pose,
    after: Pose,
}

fn follow(run: &mut TrackRun<Walk>, cancel: &CancelToken, told: &mut Followed) {
    let (mut is_done, mut newest, reader) = (false, 0, run.reader.clone());
    while !is_done {
        run.step(cancel, &mut |message| match message {
            TrackMessage::Frame { estimate, .. } => {
                newest = estimate.frame;
                told.track.insert(estimate.frame, *estimate);
            }
            TrackMessage::Rewound(better) => {
                if told.mended.is_empty() {
                    told.read_again = reader.read.lock().unwrap().1;
                }
                for one in better {
                    let (frame, after) = (one.frame, one.pose.clone());
                    let before = told.track.insert(frame, one).expect("it was tracked before").pose;
                    told.mended.push(Mended { frame, by: newest, before, after });
                }
            }
            TrackMessage::Done(how) => {
                assert!(!matches!(how, TrackEnding::Failed { .. }), "{how:?}");
                is_done = true;
            }
            _ => {}
        });
    }
}

#[test]
fn later_frames_mend_earlier_ones_and_a_stopped_run_goes_on_alike() {
    let model = Arc::new(builtin::full_body());
    let walk = Arc::new(Walk::new(&model));
    let (go, mut whole) = (CancelToken::new(), Followed::default());
    follow(&mut TrackRun::new(walk.clone(), plan(&model, 0, FRAMES)), &go, &mut whole);
    let by = whole.mended.first().expect("a leg is lost and found again").by;
    assert!(whole.mended.iter().all(|one| one.frame < one.by), "{:?}", whole.mended);
    let error = |frame: usize, pose: &Pose| mean_joint_error_mm(&model, pose, &truth(&model, frame));
    let before: f64 = whole.mended.iter().map(|one| error(one.frame, &one.before)).sum();
    let after: f64 = whole.mended.iter().map(|one| error(one.frame, &one.after)).sum();
    assert!(after < before, "{before} mm before, {after} mm after");

    // Stopped just before that frame, and while it is followed back.
    let interrupted = Arc::new(Walk::of(walk.frames.clone(), whole.read_again));
    for (walk, cancel, to) in [(&walk, &go, by / EVERY), (&interrupted, &interrupted.stop, FRAMES)] {
        let mut parts = Followed::default();
        let mut run = TrackRun::new(walk.clone(), plan(&model, 0, to)).remembering();
        follow(&mut run, cancel, &mut parts);
        let resume = run.resume_point().expect("frames were tracked");
        let stop = 1 + resume.memory.last.frame / EVERY;
        assert!(parts.mended.is_empty() && parts.track.len() == stop && stop < FRAMES, "{stop}");
        let recent = parts.track.values().map(|one| (one.frame, one.pose.clone())).collect();
        let (memory, rewind) = (resume.memory, resume.rewind);
        let earlier = EarlierFrames { memory, waiting: Vec::new(), recent, rewind };
        let run = TrackRun::new(walk.clone(), plan(&model, stop, FRAMES));
        follow(&mut run.resuming(earlier).unwrap(), &go, &mut parts);
        let poses =
            |told: &Followed| -> Vec<Pose> { told.track.values().map(|one| one.pose.clone()).collect() };
        assert_eq!(poses(&whole), poses(&parts), "stopped after {stop} frames");
        assert_eq!(whole.mended, parts.mended, "stopped after {stop} frames");
    }
}

/// A barrel that stands where a person should be: nearly all limbs are doubted in every frame.
#[test]
fn a_thing_that_is_no_person_is_not_believed() {
    let barrel = builtin::single_limb().with_sizes(|_| [0.5, 0.4]).unwrap();
    let model = Arc::new(builtin::full_body());
    let cameras = Occlusion::Squats.cameras([180, 320]).unwrap();
    let frame = |frame: usize| {
        let mut at = Pose::rest(&barrel);
        at.root = glam::DVec3::new(0.0, 0.02 * frame as f64, 0.8);
        let view = |camera: &Arc<backlit_tracking::camera::Camera>| {
            FitView::of_mask(camera.clone(), capsules::hard_mask(&barrel, &at, camera).unwrap())
        };
        cameras.iter().map(view).collect()
    };
    let mut told = Followed::default();
    let walk = Arc::new(Walk::of((0..4).map(frame).collect(), usize::MAX));
    follow(&mut TrackRun::new(walk, plan(&model, 0, 4)), &CancelToken::new(), &mut told);
    for estimate in told.track.values() {
        let doubted = estimate.trust.iter().filter(|limb| limb.verdict > Verdict::Good).count();
        assert!(10 * doubted > 9 * estimate.trust.len(), "frame {}: {doubted}", estimate.frame);
    }
}
