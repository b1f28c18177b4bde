//! A person's own sizes in one go: masks that are too wide, tracks that are wrong, takes that cannot be right.

use std::sync::Arc;

use backlit_lab::experiment::{Simulation, scene};
use backlit_lab::synthetic::masks::widened;
use backlit_lab::synthetic::{capsules, motion, people::PEOPLE, studio};
use backlit_tracking::body::{Model, Pose, SizeKind, builtin};
use backlit_tracking::body_fit::survey::{LeftOut, Unusable};
use backlit_tracking::body_fit::{
    BodyFitError, BodyFitOptions, BodyFrame, Doubt, FirstSizes, OwnSizes, OwnSizesError, OwnSizesOptions,
    PosedFrame, WELL_SEEN, fit_body, own_sizes,
};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Evidence, FitView};
use backlit_tracking::metrics::ReferenceJoints;
use backlit_tracking::render::{Ramp, RendererKind};
use backlit_tracking::search::start::perturb;
use backlit_tracking::silhouette::Label;

/// Moments of the built-in movement.
const MOMENTS: [usize; 6] = [0, 10, 20, 31, 41, 50];

/// What the cameras see of a body, masks too wide by this many pixels.
fn views(body: &Model, pose: &Pose, by_px: f64) -> Vec<FitView> {
    let see = |camera: Arc<Camera>| {
        let exact = capsules::hard_mask(body, pose, &camera).unwrap();
        FitView::of_mask(camera, widened(exact, by_px).unwrap())
    };
    studio::pinholes([96, 128]).unwrap().into_iter().map(see).collect()
}

/// The average adult's poses near the true ones, as a track has them.
fn track(body: &Model, off_rad: f64) -> Vec<PosedFrame> {
    let adult = builtin::full_body();
    let posed = |frame: usize| PosedFrame {
        frame,
        pose: perturb(&adult, &motion::pose(body, frame as f64), off_rad, 0.02, frame as u64),
        iou: None,
        is_lost: false,
    };
    MOMENTS.map(posed).to_vec()
}

fn options() -> OwnSizesOptions {
    OwnSizesOptions { fitted: 4, held_out: 2, ..OwnSizesOptions::default() }
}

fn sizes_of(track: &[PosedFrame], views: impl Fn(usize) -> Vec<FitView>) -> Result<OwnSizes, OwnSizesError> {
    sizes_with(&options(), track, views)
}

fn sizes_with(
    options: &OwnSizesOptions,
    track: &[PosedFrame],
    views: impl Fn(usize) -> Vec<FitView>,
) -> Result<OwnSizes, OwnSizesError> {
    let adult = Arc::new(builtin::full_body());
    let (cancel, no_joints) = (CancelToken::new(), |_| ReferenceJoints::new());
    own_sizes(&adult, track, options, &cancel, |frame| Ok(views(frame)), no_joints, |_| {})
}

/// The mean logarithm of the radii over the true ones.
fn girth(model: &Model, truth: &Model) -> f64 {
    let ratio = model.limbs().iter().zip(truth.limbs()).map(|(a, b)| (a.radius / b.radius).ln());
    ratio.sum::<f64>() / model.limbs().len() as f64
}

#[test]
fn masks_that_are_too_wide_are_not_taken_for_a_stout_person() {
    let adult = PEOPLE.iter().find(|person| person.name == "tall adult, broad").unwrap();
    let body = adult.of(&builtin::full_body()).unwrap();
    let by_px = 1.0;
    let found =
        sizes_of(&track(&body, 0.05), |frame| views(&body, &motion::pose(&body, frame as f64), by_px))
            .unwrap();
    assert_eq!(found.doubts, []);
    let widening = found.fit.widening.unwrap();
    assert!(widening.is_believed && (widening.px - by_px).abs() < 0.4, "{widening:?}");
    assert!(girth(found.model(), &body).abs() < 0.1, "girth {:.3}", girth(found.model(), &body));
    // As the masks show it: as much stouter as a pixel is.
    assert!(girth(&found.as_seen(), &body) > 0.2, "seen {:.3}", girth(&found.as_seen(), &body));
    let leg = body.limb_index("left thigh").unwrap();
    let long = found.model().limbs()[leg].length / body.limbs()[leg].length;
    assert!((long - 1.0).abs() < 0.06, "{long:.3}");
    let [scaled, own] = found.judged.iou.map(Option::unwrap);
    assert!(own > scaled + 0.02 && found.judged.frames.len() == 2, "{:?}", found.judged);
}

/// Nobody's trunk is twice as thick beside the arms, and frames held out that gain too little are a reason too. What there was
/// stays.
#[test]
fn what_is_not_plausible_is_said_and_not_taken() {
    let adult = builtin::full_body();
    let limbs = adult.limbs();
    let barrel = adult.with_sizes(|limb| {
        let limb = &limbs[limb];
        let is_trunk =
            ["spine", "chest", "rib", "side", "flank"].iter().any(|part| limb.name.ends_with(part));
        [limb.length, limb.radius * if is_trunk { 2.2 } else { 1.0 }]
    });
    let barrel = barrel.unwrap();
    let seen = |body: &Model, frame: usize| views(body, &motion::pose(body, frame as f64), 0.0);
    let found = sizes_of(&track(&adult, 0.05), |frame| seen(&barrel, frame)).unwrap();
    let is_size = |doubt: &Doubt| !matches!(doubt, Doubt::NotBetter { .. });
    assert!(found.doubts.iter().any(is_size), "{:?} {:?}", found.doubts, found.fit.widening);
    assert_eq!((found.model(), found.as_seen(), found.widening_px()), (&adult, adult.clone(), 0.0));
    let demanding = OwnSizesOptions { least_gain: 0.2, ..options() };
    let found = sizes_with(&demanding, &track(&adult, 0.05), |frame| seen(&adult, frame)).unwrap();
    assert!(matches!(found.doubts[..], [Doubt::NotBetter { iou: [a, b] }] if a > 0.9 && b > 0.9));
}

#[test]
fn takes_that_cannot_be_right_are_refused() {
    let body = builtin::full_body();
    let as_seen = |change: fn(usize, Label) -> Label| {
        let body = &body;
        move |frame: usize| {
            let mut views = views(body, &motion::pose(body, frame as f64), 0.0);
            for view in &mut views {
                let Evidence::Mask(mask) = &view.evidence else { continue };
                let mut mask = (**mask).clone();
                mask.labels_mut().iter_mut().enumerate().for_each(|(at, label)| *label = change(at, *label));
                view.evidence = Evidence::Mask(Arc::new(mask));
            }
            views
        }
    };
    let refused = |change| match sizes_of(&track(&body, 0.05), as_seen(change)) {
        Err(OwnSizesError::Unusable { worst, others }) => {
            assert_eq!(others, MOMENTS.len() * 4 - 1);
            worst.because
        }
        other => panic!("{other:?}"),
    };
    // A black plate: all but a few pixels of the subject and its surroundings are unknown.
    let black = |at: usize, label| if at.is_multiple_of(17) { label } else { Label::Unknown };
    assert!(matches!(refused(black), Unusable::Unknown { share } if share > 0.9));
    assert_eq!(refused(|_, _| Label::Background), Unusable::Nobody);
    let near = |at: usize, _| if at % 96 < 80 { Label::Subject } else { Label::Background };
    assert!(matches!(refused(near), Unusable::Fills { .. }));
    // The fit of sizes by itself refuses it too.
    let frame = BodyFrame {
        frame: 3,
        views: as_seen(black)(3),
        start: motion::pose(&body, 3.0),
        joints: ReferenceJoints::new(),
    };
    let options = BodyFitOptions::default();
    let alone = fit_body(
        Arc::new(body.clone()),
        vec![frame],
        FirstSizes::Silhouettes,
        &options,
        &CancelToken::new(),
        |_| {},
    );
    assert!(matches!(alone, Err(BodyFitError::Unusable(LeftOut { frame: 3, .. }))), "{alone:?}");
    // One camera that says nothing is left out, and said.
    let (seen, dark) = (as_seen(|_, label| label), as_seen(black));
    let mixed = |frame: usize| {
        let mut views = seen(frame);
        views[0] = dark(frame)[0].clone();
        views
    };
    let found = sizes_of(&track(&body, 0.05), mixed).unwrap();
    assert_eq!(found.left_out.len(), MOMENTS.len());
    assert!(found.left_out.iter().all(|one| one.camera == "cam1"));
    let few = sizes_of(&track(&body, 0.05)[..2], as_seen(|_, label| label));
    assert!(matches!(few, Err(OwnSizesError::FewFrames { found: 2, .. })), "{few:?}");
}

/// Exact silhouettes of four moments, poses 5° and 3 cm off, the average adult to begin with.
#[test]
fn people_of_all_builds_get_their_sizes() {
    let adult = Arc::new(builtin::full_body());
    let cameras = studio::pinholes([studio::WIDTH, studio::HEIGHT]).unwrap();
    let options = BodyFitOptions::default().with_proportions(WELL_SEEN);
    let mut failures = Vec::new();
    for person in &PEOPLE {
        let body = person.of(&adult).unwrap();
        let frame = |(frame, moment): (usize, f64)| {
            let truth = person.standing(motion::pose(&body, moment));
            let see = |camera| {
                scene::view(&body, &truth, camera, Simulation::Mask, RendererKind::Capsule, Ramp::Half)
                    .unwrap()
            };
            let start = perturb(&adult, &truth, 5.0_f64.to_radians(), 0.03, 1 + frame as u64);
            BodyFrame { frame, views: cameras.iter().map(see).collect(), start, joints: Vec::new() }
        };
        let frames = [0.0, 16.0, 31.0, 50.0].into_iter().enumerate().map(frame).collect();
        let fit =
            fit_body(adult.clone(), frames, FirstSizes::Silhouettes, &options, &CancelToken::new(), |_| {})
                .unwrap();
        for size in fit.sizes.iter().filter(|size| !size.is_held_by_prior()) {
            let is_it = |name: &str| name == size.name || name.strip_prefix("right ") == Some(&size.name);
            let limb = body.limbs().iter().find(|limb| is_it(&limb.name)).unwrap();
            let (truth, most_mm) = match size.kind {
                SizeKind::Length => (limb.length, 10.0),
                SizeKind::Radius => (limb.radius, 5.0),
            };
            if 1000.0 * (size.found - truth).abs() > most_mm {
                failures.push(format!("{}: {size:?}", person.name));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
