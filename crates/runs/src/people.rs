//! Who is in view of a take, so that one of several people can be followed.

use std::collections::BTreeMap;
use std::sync::Arc;

use backlit_formats::FootageError;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::people::{self, PersonTrack};

use crate::track::{FrameReader, ReadAhead};

/// So many frames a second are looked at.
const LOOKED_AT_HZ: f64 = 10.0;

/// The people in view in these frames, those who are seen longest first. Nobody is hidden from the reader's silhouettes. `tell`
/// hears how many frames of how many were looked at.
pub fn find<R: FrameReader>(
    reader: &Arc<R>,
    frames: &[usize],
    frame_rate: f64,
    cancel: &CancelToken,
    mut tell: impl FnMut(usize, usize),
) -> Result<Vec<PersonTrack>, FootageError> {
    let step = (frame_rate / LOOKED_AT_HZ) as usize;
    let looked_at: Vec<usize> = frames.iter().copied().step_by(step.max(1)).collect();
    let mut ahead = ReadAhead::new(reader.clone(), looked_at.iter().copied().collect(), cancel.clone());
    let mut found = BTreeMap::new();
    for (done, &frame) in looked_at.iter().enumerate() {
        if cancel.is_cancelled() {
            break;
        }
        tell(done, looked_at.len());
        let views = reader.views(&*ahead.get(frame)?);
        found.insert(frame, people::people_in_frame(&views, cancel));
    }
    Ok(people::link(&found))
}

#[cfg(test)]
mod tests {
    use backlit_formats::{Footage, Take};
    use backlit_lab::synthetic::two_people;
    use backlit_tracking::body::{Kinematics, Pose, builtin};
    use backlit_tracking::people::FollowedPerson;

    use super::*;
    use crate::track::TakeReader;

    fn take(folder: &tempfile::TempDir) -> Arc<Footage> {
        two_people::write(folder.path(), &builtin::full_body(), [192, 192]).unwrap();
        Arc::new(Footage::new(Take::open(folder.path()).unwrap()))
    }

    /// Mean distance of the limbs' ends of two poses, metres.
    fn off(found: &Pose, truth: &Pose) -> f64 {
        let body = builtin::full_body();
        let [found, truth] = [found, truth].map(|pose| Kinematics::new(&body, pose).ends().to_vec());
        found.iter().zip(&truth).map(|(a, b)| a.distance(*b)).sum::<f64>() / truth.len() as f64
    }

    #[test]
    fn each_of_two_people_is_tracked_as_if_alone() {
        let folder = tempfile::tempdir().unwrap();
        let footage = take(&folder);
        let frames: Vec<usize> = (0..two_people::FRAMES).collect();
        let reader = Arc::new(TakeReader::of_silhouettes(footage.clone(), (0..4).collect()));
        let looked = crate::track::survey(&*reader, &frames, 5, &CancelToken::new());
        assert_eq!(looked.people, 2);
        let found = find(&reader, &frames, two_people::FRAME_RATE, &CancelToken::new(), |_, _| {}).unwrap();
        assert_eq!(found.len(), 2);
        let body = builtin::full_body();
        for number in 0..2 {
            let person = Arc::new(FollowedPerson::of(&found, number).unwrap());
            let followed = footage.with_replacements(None, Arc::default(), Some(person.clone()));
            let reader = TakeReader::of_silhouettes(Arc::new(followed), (0..4).collect());
            let (mut all, mut worst) = (0.0, 0.0_f64);
            let at = |frame: usize| person.own.at(frame).unwrap().centre();
            let who = |frame: usize| {
                let off = |pose: &Pose| (pose.root - at(frame)).truncate().length();
                let [walks, stands] = two_people::poses(&body, frame);
                usize::from(off(&stands) < off(&walks))
            };
            assert!(frames.iter().all(|&frame| who(frame) == who(0)), "nobody is taken for the other");
            let options = backlit_tracking::fit::FitOptions::preset(backlit_tracking::fit::Preset::Robust);
            let start = two_people::poses(&body, 0)[who(0)].clone();
            let mut tracker =
                backlit_tracking::track::Tracker::new(Arc::new(body.clone()), options, start).unwrap();
            for &frame in &frames {
                let views = reader.views(&reader.read(frame).unwrap());
                let found = tracker.track_frame(frame, views, &CancelToken::new()).unwrap();
                let off = off(&found.pose, &two_people::poses(&body, frame)[who(0)]);
                all += off / frames.len() as f64;
                worst = worst.max(off);
            }
            println!("person {number}: mean {:.1} mm, worst frame {:.1} mm", 1e3 * all, 1e3 * worst);
            assert!(all < 0.06, "{all}");
        }
    }
}
