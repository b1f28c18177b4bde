//! How well a body in a reference's poses covers the silhouettes of footage, beside the poses that are compared with it.

use std::sync::Arc;

use backlit_formats::Footage;
use backlit_formats::motion::Motion;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::body_fit::survey::spread;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{DataView, FitView};
use backlit_tracking::metrics::comparison::{ComparedFrame, TrackComparison, WorldMap};
use backlit_tracking::posing::Follower;
use backlit_tracking::render::RendererKind;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::track::overlaps;

use super::ComparedReference;

/// Frames that are looked at, spread over those that were compared.
const FRAMES: usize = 30;

/// Mean overlap (IoU) with the silhouettes of one camera.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraOverlap {
    /// The camera's name.
    pub camera: String,
    /// Of the track's poses.
    pub track: f64,
    /// Of the same body in the reference's poses.
    pub reference: f64,
}

/// Mean overlaps of a track and of a reference in the same frames.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedOverlap {
    /// How many frames were looked at.
    pub frames: usize,
    /// By camera with a silhouette.
    pub cameras: Vec<CameraOverlap>,
}

/// Lays both over the silhouettes of footage, in some of the frames that were compared. A track of ours in the same world is laid as it
/// is; else the body follows the reference's joints with its own lengths, as [`Follower`] does. `None` where no frame has hips, shoulders and a silhouette, and where `cancel` says so.
#[must_use]
pub fn compare_overlap(
    motion: &Motion,
    (reference, found): (&ComparedReference, &TrackComparison),
    footage: &Footage,
    measurement: &[SegmentOptions],
    cancel: &CancelToken,
) -> Option<ComparedOverlap> {
    let Motion { model, poses, frame_rate, .. } = motion;
    let own = reference.motion.as_ref().filter(|_| found.world == WorldMap::SAME);
    let cameras: Vec<usize> = (0..footage.cameras.len()).collect();
    let mut sums = vec![([0.0; 2], 0_usize); cameras.len()];
    let in_take = found.frames.iter().enumerate().filter(|(_, frame)| frame.frame < footage.frame_count());
    let places: Vec<usize> = in_take.map(|(place, _)| place).collect();
    let mut looked_at = 0;
    for place in spread(&places, FRAMES) {
        let frame = &found.frames[place];
        if cancel.is_cancelled() {
            return None;
        }
        let seconds = frame.frame as f64 / frame_rate + found.clock.seconds;
        let theirs = match own {
            Some(own) => own_pose(own, seconds),
            None => reference_pose(model, &found.joints, frame).map(|pose| (model, pose)),
        };
        let Some(((their_model, theirs), ours)) = theirs.zip(poses.get(&frame.frame)) else { continue };
        let loaded = footage.load_cameras(&cameras, measurement, frame.frame);
        let views = cameras.iter().zip(loaded).filter_map(|(&camera, seen)| {
            let evidence = seen.evidence(DataView::Hard)?;
            Some((camera, FitView { camera: Arc::clone(&footage.cameras[camera]), evidence, weight: 1.0 }))
        });
        let (places, views): (Vec<usize>, Vec<FitView>) = views.unzip();
        let of = |model: &Model, pose: &Pose| overlaps(model, pose, RendererKind::default(), &views);
        for ((camera, ours), theirs) in places.into_iter().zip(of(model, ours)).zip(of(their_model, &theirs))
        {
            let iou = [ours, theirs].map(|overlap| overlap.and_then(|overlap| overlap.iou()));
            if let [Some(ours), Some(theirs)] = iou {
                let (sum, count) = &mut sums[camera];
                (*sum, *count) = ([sum[0] + ours, sum[1] + theirs], *count + 1);
            }
        }
        looked_at += 1;
    }
    let cameras: Vec<CameraOverlap> = sums
        .into_iter()
        .zip(footage.cameras.iter())
        .filter(|((_, count), _)| *count > 0)
        .map(|((sum, count), camera)| {
            let [track, reference] = sum.map(|sum| sum / count as f64);
            CameraOverlap { camera: camera.name().to_owned(), track, reference }
        })
        .collect();
    (!cameras.is_empty()).then_some(ComparedOverlap { frames: looked_at, cameras })
}

/// The body and the pose of a track of ours at a time.
fn own_pose(motion: &Motion, seconds: f64) -> Option<(&Model, Pose)> {
    let frame = (seconds * motion.frame_rate).round();
    let pose = (frame >= 0.0).then(|| motion.poses.get(&(frame as usize)))??;
    Some((&motion.model, pose.clone()))
}

/// The body's pose for a reference's joints. It begins standing: the frame before may be long ago.
fn reference_pose(model: &Model, joints: &[String], frame: &ComparedFrame) -> Option<Pose> {
    Follower::new(model)?.pose(|joint| frame.reference[joints.iter().position(|name| name == joint)?])
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use backlit_tracking::metrics::Trajectories;

    use super::*;
    use crate::comparison::{AS_IT_IS, ComparedReference, compare_motion};

    /// The joints of the built-in take cover its silhouettes about as well as the poses they are of; a metre beside them, not at all.
    #[test]
    fn a_reference_covers_silhouettes_where_it_is_right() {
        let footage = Footage::new(backlit_take::builtin::open().unwrap());
        let take = footage.take();
        let start = take.start().unwrap().clone();
        let model = (**take.model()).clone();
        let motion = Motion::of_poses("a", model.clone(), take.frame_rate(), BTreeMap::from([(0, start)]));
        let mut reference = ComparedReference {
            name: "b".to_owned(),
            trajectories: Trajectories::of_poses(&model, take.frame_rate(), &motion.poses),
            overlap: BTreeMap::new(),
            motion: None,
        };
        let measure = |reference: &ComparedReference| {
            let found = compare_motion(&motion, reference, &AS_IT_IS);
            compare_overlap(&motion, (reference, &found), &footage, take.measurement(), &CancelToken::new())
        };
        let right = measure(&reference).unwrap();
        assert_eq!((right.frames, right.cameras.len()), (1, take.rig().count()));
        for CameraOverlap { camera, track, reference } in &right.cameras {
            assert!(*track > 0.5 && (track - reference).abs() < 0.05, "{camera}: {track} {reference}");
        }
        // A track of ours is laid as it is.
        reference.motion = Some(motion.clone());
        let same = measure(&reference).unwrap();
        assert!(same.cameras.iter().all(|camera| camera.track == camera.reference), "{same:?}");
        reference.motion = None;
        for points in reference.trajectories.points.iter_mut().flatten().flatten() {
            points.x += 1.0;
        }
        let wrong = measure(&reference).unwrap();
        assert!(wrong.cameras.iter().any(|camera| camera.reference < 0.3), "{wrong:?}");
        reference.trajectories.points[0].fill(None);
        assert_eq!(measure(&reference), None);
    }
}
