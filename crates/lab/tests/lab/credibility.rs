//! Whether the Kalman filter errs as it says on pictures of known poses.

use std::sync::Arc;

use backlit_formats::prior_file;
use backlit_lab::experiment::credibility::Credibility;
use backlit_lab::synthetic::masks::noisy;
use backlit_lab::synthetic::{capsules, exercise, motion, studio, upper_body};
use backlit_tracking::body::{Model, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, FitView};
use backlit_tracking::residual::learnt_prior::LearntPrior;
use backlit_tracking::search::start::perturb;
use backlit_tracking::track::{KalmanOptions, Motion, Tracker};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

/// Frames of each track.
const FRAMES: usize = 24;

/// A body that moves before cameras.
struct Scene<'a> {
    model: Model,
    cameras: Vec<Arc<Camera>>,
    frame_rate: f64,
    pose: &'a dyn Fn(&Model, usize) -> Pose,
}

impl Scene<'_> {
    /// Followed through noisy masks as a track is by default, but for the filter.
    fn credibility(&self, options: KalmanOptions, seed: u64) -> Credibility {
        let (model, mut random) = (Arc::new(self.model.clone()), Pcg64Mcg::seed_from_u64(seed));
        let start = perturb(&model, &(self.pose)(&model, 0), 0.05, 0.02, seed);
        let prior = Some(LearntPrior::new(prior_file::people()));
        let tracker =
            Tracker::new(model.clone(), FitOptions { prior, ..FitOptions::default() }, start).unwrap();
        let mut tracker = tracker.with_motion(Motion::Kalman(options), self.frame_rate).unwrap();
        let mut sum = Credibility::default();
        for frame in 0..FRAMES {
            let truth = (self.pose)(&model, frame);
            let view = |camera: &Arc<Camera>| {
                let mask = capsules::hard_mask(&model, &truth, camera).unwrap();
                FitView::of_mask(camera.clone(), noisy(&mask, 0.1, 1e-4, &mut random))
            };
            let views = self.cameras.iter().map(view).collect();
            let found = tracker.track_frame(frame, views, &CancelToken::new()).unwrap();
            sum += Credibility::of_frame(&model, &found, &truth);
        }
        sum
    }
}

/// NIS and NEES are between a half and two, movement by movement, which they are not with an R that
/// does not heed the residuals.
#[test]
fn the_filter_errs_as_it_says_on_pictures() {
    let scenes = [
        (
            "upper body",
            Scene {
                model: builtin::upper_body(),
                cameras: upper_body::cameras(4, [128, 96]).unwrap(),
                frame_rate: upper_body::FRAME_RATE,
                pose: &|model, frame| upper_body::motion(model, 2 * frame),
            },
        ),
        (
            "walk",
            Scene {
                model: builtin::full_body(),
                cameras: exercise::cameras(3, [120, 160]).unwrap(),
                frame_rate: exercise::FRAME_RATE,
                pose: &|model, frame| exercise::pose(model, frame as f64 / exercise::FRAME_RATE),
            },
        ),
        (
            "step and reach",
            Scene {
                model: builtin::full_body(),
                cameras: studio::pinholes([96, 128]).unwrap(),
                frame_rate: motion::FRAME_RATE,
                pose: &|model, frame| motion::pose(model, 2.0 * frame as f64),
            },
        ),
    ];
    let wrong = |scenes: &[(&str, Scene)], options: KalmanOptions| -> Vec<String> {
        let one = |(name, scene): &(&str, Scene)| {
            let mut sum = Credibility::default();
            (1..=2).for_each(|seed| sum += scene.credibility(options, seed));
            let found = [sum.nis(), sum.nees()].map(Option::unwrap_or_default);
            let is_honest = found.iter().all(|ratio| (0.5..2.0).contains(ratio));
            (!is_honest).then(|| format!("{name}: NIS and NEES {found:.2?}"))
        };
        scenes.iter().filter_map(one).collect()
    };
    for steers in [false, true] {
        let options = KalmanOptions { steers, ..KalmanOptions::default() };
        assert_eq!(wrong(&scenes, options), Vec::<String>::new(), "steers: {steers}");
    }
    let unsure = KalmanOptions { measurement_deviation: Some(200.0), ..KalmanOptions::default() };
    assert_eq!(wrong(&scenes[..1], unsure).len(), 1);
}
