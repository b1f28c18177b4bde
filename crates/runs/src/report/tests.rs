use backlit_report::to_html;
use backlit_take::builtin;
use backlit_tracking::body::Pose;

use super::*;
use crate::track::{TakeReader, TrackEnding, TrackMessage, TrackPlan, TrackRun};

/// A track that has no take.
pub(super) fn source(model: Arc<Model>, track: Track) -> ReportSource {
    ReportSource {
        name: "a take".to_owned(),
        frame_rate: 60.0,
        model,
        cameras: Vec::new(),
        track,
        ious: BTreeMap::new(),
        fit: FitOptions::default(),
        footage: None,
        measurement: None,
        weights: Vec::new(),
        making: TrackMaking::default(),
        comparisons: Vec::new(),
        bookmarks: Vec::new(),
    }
}

/// Four frames of the built-in take, tracked by two cameras.
fn tracked() -> ReportSource {
    let footage = Arc::new(Footage::new(builtin::open().unwrap()));
    let take = footage.take();
    let plan = TrackPlan::of_frames(take, take.start().unwrap().clone(), (0..4).collect());
    let making = TrackMaking { settings: plan.settings(), ..TrackMaking::default() };
    let mut run = TrackRun::new(Arc::new(TakeReader::of_silhouettes(footage.clone(), vec![0, 2])), plan);
    let (mut track, mut ending) = (Track::default(), None);
    while ending.is_none() {
        run.step(&CancelToken::new(), &mut |message| match message {
            TrackMessage::Frame { estimate, .. } => {
                track.frames.insert(estimate.frame, *estimate);
            }
            TrackMessage::Done(how) => ending = Some(how),
            _ => {}
        });
    }
    assert!(matches!(ending, Some(TrackEnding::Whole)));
    let names = [0, 2].map(|camera| footage.cameras[camera].name().to_owned());
    ReportSource {
        cameras: names.into(),
        weights: vec![1.0; 2],
        footage: Some(footage.clone()),
        fit: fit_of_settings(&making.settings),
        making,
        ..source(footage.take().model().clone(), track)
    }
}

#[test]
fn a_tracked_take_has_pictures_steps_curves_and_errors() {
    let source = tracked();
    let options = ReportOptions { command: Some("backlit report".to_owned()), ..ReportOptions::default() };
    let page = source.page(&options, &CancelToken::new()).unwrap();
    assert_eq!(page.notes, [""; 0]);
    assert_eq!((page.frames.len(), page.cameras.len(), page.pictures.len()), (4, 2, 8));
    assert!(page.pictures.iter().all(|one| one.bytes.len() > 1000 && one.subject.starts_with('M')));
    // Its steps end where the track has the frame, as near as its own start lets it.
    let last = &page.fits[0].steps.last().unwrap();
    let away = |joint: usize| last.joints[joint].distance(page.frames[0].joints[joint]);
    assert!((0..last.joints.len()).all(|joint| away(joint) < 0.25));
    assert!(page.fits[0].steps.len() > 3 && page.fits[0].steps[0].cost > 0.0);
    let groups: Vec<&str> = page.curves.iter().map(|curve| curve.group.as_str()).collect();
    assert_eq!(groups.iter().filter(|group| **group == "Overlap (IoU)").count(), 3, "{groups:?}");
    assert!(["Joint error", "Residual", "Cost"].iter().all(|group| groups.contains(group)), "{groups:?}");
    assert!(page.tables.iter().any(|table| table.title == "Joint errors"));
    assert!(page.settings.iter().any(|[name, value]| name == "Preset" && value == "Robust"));
    // Asked for in the same way it is the same page.
    let again = source.page(&options, &CancelToken::new()).unwrap();
    assert_eq!(to_html(&page), to_html(&again));

    let options = ReportOptions { steps_of: Some(vec![9]), ..options };
    let error = source.page(&options, &CancelToken::new()).unwrap_err().to_string();
    assert!(error.contains("frame 9 is not in the track, which has frames 0 to 3"), "{error}");
    let cancel = CancelToken::new();
    cancel.cancel();
    assert!(matches!(source.page(&ReportOptions::default(), &cancel), Err(ReportError::Stopped)));
}

#[test]
fn without_a_take_the_page_says_what_it_lacks() {
    let model = Arc::new(backlit_tracking::body::builtin::single_limb());
    let track = Track { frames: [(3, FrameEstimate::of_pose(3, Pose::rest(&model)))].into() };
    let page = source(model.clone(), track).page(&ReportOptions::default(), &CancelToken::new()).unwrap();
    assert!(page.notes[0].contains("not at hand"), "{:?}", page.notes);
    assert!(page.pictures.is_empty() && page.cameras.is_empty() && page.fits.is_empty());
    let empty = source(model, Track::default()).page(&ReportOptions::default(), &CancelToken::new());
    assert!(matches!(empty, Err(ReportError::Empty)));
}
