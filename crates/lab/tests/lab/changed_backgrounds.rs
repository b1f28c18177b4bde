//! The built-in take with one camera's pictures disturbed: what changes in its background is learnt again, and told with its frame.

use std::path::Path;

use backlit_formats::footage::changes::ChangeSurvey;
use backlit_formats::{Footage, FootageError, Take};
use backlit_lab::experiment::disturbed_pictures::PictureDisturbance;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::segment::changes::{BackgroundChange, ChangeKind};
use backlit_tracking::silhouette::{Label, Mask};
use image::RgbImage;

const CAMERAS: [usize; 4] = [0, 1, 2, 3];
const FROM: usize = 20;

fn footage() -> Footage {
    Footage::new(Take::open(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/take")).unwrap())
}

fn picture(
    footage: &Footage,
    what: Option<(PictureDisturbance, usize)>,
    (camera, frame): (usize, usize),
) -> Result<RgbImage, FootageError> {
    let mut picture = footage.picture(camera, frame)?;
    if let Some((what, disturbed)) = what
        && camera == disturbed
        && frame >= FROM
    {
        what.apply(&mut picture, frame - FROM);
    }
    Ok(picture)
}

fn changes(footage: &Footage, what: Option<(PictureDisturbance, usize)>) -> Vec<BackgroundChange> {
    let frames: Vec<usize> = (0..footage.frame_count()).collect();
    let picture = |camera, frame| picture(footage, what, (camera, frame));
    let measurement = footage.take().measurement();
    let survey = ChangeSurvey { footage, cameras: &CAMERAS, frames: &frames, measurement, picture };
    survey.changes(&CancelToken::new(), |_| {}).unwrap().unwrap()
}

#[test]
fn of_clean_pictures_nothing_is_learnt_again() {
    assert_eq!(changes(&footage(), None), []);
}

/// Pixels that are subject in one mask and background in the other.
fn wrong(mask: &Mask, clean: &Mask) -> usize {
    let pairs = mask.labels().iter().zip(clean.labels());
    pairs.filter(|pair| *pair == (&Label::Subject, &Label::Background)).count()
}

#[test]
fn what_changes_is_learnt_again_from_its_first_frame() {
    let footage = footage();
    let frame = footage.frame_count() - 8;
    // The take's own settings bear the lamp well.
    for (what, kind, better) in [
        (PictureDisturbance::StandingBody, ChangeKind::Thing, 5),
        (PictureDisturbance::SuddenLight, ChangeKind::Light, 1),
    ] {
        for camera in CAMERAS {
            let found = changes(&footage, Some((what, camera)));
            let told: Vec<_> =
                found.iter().map(|found| (found.camera, found.from, found.until, found.kind)).collect();
            assert_eq!(told, [(camera, FROM, None, kind)], "{what:?}");
            let options = &footage.take().measurement()[camera];
            let clean =
                footage.mask(camera, frame, &footage.picture(camera, frame).unwrap(), options).unwrap();
            let disturbed = picture(&footage, Some((what, camera)), (camera, frame)).unwrap();
            let learnt = footage.with_changes(found.into());
            let [before, after] =
                [&footage, &learnt].map(|footage| footage.mask(camera, frame, &disturbed, options).unwrap());
            let (wrong, left) = (wrong(&before, &clean), wrong(&after, &clean));
            assert!(
                better * left < wrong,
                "{what:?}, camera {camera}: {left} of {wrong} wrong pixels are left"
            );
            let body = clean.count(Label::Subject);
            let lost = after
                .labels()
                .iter()
                .zip(clean.labels())
                .filter(|pair| *pair == (&Label::Background, &Label::Subject));
            assert!(20 * lost.count() < body, "{what:?}, camera {camera}: the body is lost");
            // Before it came the picture is as it was.
            let first = footage.picture(camera, FROM - 1).unwrap();
            let [before, after] =
                [&footage, &learnt].map(|footage| footage.mask(camera, FROM - 1, &first, options).unwrap());
            assert_eq!(before, after, "{what:?}, camera {camera}");
        }
    }
}
