//! Who is in view of a take, so that one of several people can be followed.

use std::collections::BTreeMap;
use std::sync::Arc;

use backlit_formats::FootageError;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::people::{self, PersonTrack};

use crate::track::{FrameReader, ReadAhead};

/// The people in view in these frames, those who are seen longest first. Nobody is hidden from the reader's silhouettes. `tell`
/// hears how many frames of how many were looked at.
pub fn find<R: FrameReader>(
    reader: &Arc<R>,
    frames: &[usize],
    cancel: &CancelToken,
    mut tell: impl FnMut(usize, usize),
) -> Result<Vec<PersonTrack>, FootageError> {
    let mut ahead = ReadAhead::new(reader.clone(), frames.iter().copied().collect(), cancel.clone());
    let mut found = BTreeMap::new();
    for (done, &frame) in frames.iter().enumerate() {
        if cancel.is_cancelled() {
            break;
        }
        tell(done, frames.len());
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
    use backlit_tracking::fit::{FitOptions, Preset};
    use backlit_tracking::people::FollowedPerson;
    use backlit_tracking::track::Tracker;

    use super::*;
    use crate::track::{TakeReader, survey};

    /// Mean distance of the limbs' ends of two poses, metres.
    fn off(found: &Pose, truth: &Pose) -> f64 {
        let body = builtin::full_body();
        let [found, truth] = [found, truth].map(|pose| Kinematics::new(&body, pose).ends().to_vec());
        found.iter().zip(&truth).map(|(a, b)| a.distance(*b)).sum::<f64>() / truth.len() as f64
    }

    /// Mean error of a track through all frames of the silhouettes of one of two people, metres.
    fn error(footage: Footage, who: usize) -> f64 {
        let body = builtin::full_body();
        let reader = TakeReader::of_silhouettes(Arc::new(footage), (0..4).collect());
        let start = two_people::poses(&body, 0)[who].clone();
        let options = FitOptions::preset(Preset::Robust);
        let mut tracker = Tracker::new(Arc::new(body.clone()), options, start).unwrap();
        let of_frame = |frame: usize| {
            let views = reader.views(&reader.read(frame).unwrap());
            let found = tracker.track_frame(frame, views, &CancelToken::new()).unwrap();
            off(&found.pose, &two_people::poses(&body, frame)[who])
        };
        (0..two_people::FRAMES).map(of_frame).sum::<f64>() / two_people::FRAMES as f64
    }

    #[test]
    fn each_of_two_people_is_tracked_nearly_as_if_alone() {
        let (body, size) = (builtin::full_body(), [288, 288]);
        let open = |who: &[usize]| {
            let folder = tempfile::tempdir().unwrap();
            two_people::write(folder.path(), &body, size, who).unwrap();
            let take = Take::open(folder.path()).unwrap();
            (Footage::new(take), folder)
        };
        let (footage, _folder) = open(&[0, 1]);
        let frames: Vec<usize> = (0..two_people::FRAMES).collect();
        let reader = Arc::new(TakeReader::of_silhouettes(Arc::new(footage.clone()), (0..4).collect()));
        assert_eq!(survey(&*reader, &frames, 5, &CancelToken::new()).people, 2);
        let found = find(&reader, &frames, &CancelToken::new(), |_, _| {}).unwrap();
        assert_eq!(found.len(), 2);
        let off = |person: &PersonTrack, frame: usize, who: usize| {
            let root = two_people::poses(&body, frame)[who].root;
            (root - person.at(frame).unwrap().bounds.centre()).truncate().length()
        };
        for (number, person) in found.iter().enumerate() {
            let who = usize::from(off(person, 0, 1) < off(person, 0, 0));
            assert!(frames.iter().all(|&frame| off(person, frame, who) < off(person, frame, 1 - who)));
            let person = FollowedPerson::of(&found, number).map(Arc::new);
            let followed = error(footage.with_person(person), who);
            let (alone, _folder) = open(&[who]);
            let (alone, both) = (error(alone, who), error(footage.clone(), who));
            assert!(followed < 0.1 && alone < followed, "{followed} m, alone {alone}");
            assert!(both > 2.0 * followed, "{both} m without a choice");
        }
    }
}
