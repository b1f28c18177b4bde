use std::sync::Arc;
use backlit_tracking::body::{Kinematics, Model, Pose, builtin, SizeKind};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::render::{Ramp, RendererKind, predict};
use backlit_tracking::silhouette::{Label, Mask};
use backlit_tracking::synthetic::{motion, people::PEOPLE, studio};
use backlit_tracking::track::fit_body::*;
use backlit_tracking::track::{Evidence, FitView, start};

fn mask(model: &Model, pose: &Pose, camera: &backlit_tracking::camera::Camera) -> Mask {
    let p = predict(model, &Kinematics::new(model, pose), camera, RendererKind::Capsule, Ramp::Half);
    let labels = p.lambda.iter().map(|&l| if l < 127.5 { Label::Subject } else { Label::Background }).collect();
    Mask::new(p.width, p.height, labels).unwrap()
}

#[test]
fn builds() {
    let adult = Arc::new(builtin::full_body());
    let scale: u64 = std::env::var("SCALE").ok().and_then(|s| s.parse().ok()).unwrap_or(2);
    let cameras: Vec<_> = studio::cameras().cameras().iter().map(|c| Arc::new(c.without_distortion().resized(96 * scale, 128 * scale).unwrap())).collect();
    let only: Option<usize> = std::env::var("ONLY").ok().and_then(|s| s.parse().ok());
    let frames: Vec<f64> = std::env::var("FRAMES").map(|s| s.split(',').map(|x| x.parse().unwrap()).collect()).unwrap_or(vec![0., 8., 16., 24., 31., 41., 50., 59.]);
    for (i, person) in PEOPLE.iter().enumerate() {
        if only.is_some_and(|o| o != i) { continue; }
        let truth = person.of(&adult).unwrap();
        let body_frames: Vec<BodyFrame> = frames.iter().enumerate().map(|(k, &f)| {
            let pose = motion::pose(&truth, f);
            let mut pose = pose; pose.root.z -= 0.9 * (1.0 - person.stature);
            let views = cameras.iter().map(|c| FitView { camera: c.clone(), evidence: Evidence::Mask(Arc::new(mask(&truth, &pose, c))), weight: 1.0 }).collect();
            BodyFrame { frame: k, views, start: start::perturb(&adult, &pose, 0.087, 0.03, 3 + k as u64) }
        }).collect();
        let t = std::time::Instant::now();
        let options = BodyFitOptions::default();
        let fit = fit_body(adult.clone(), body_frames.clone(), None, &options, &CancelToken::new(), |_| {}).unwrap();
        println!("{}: size {:.3} (true {:.3}) girth {:.3} rms {:?} iou {:?} it {} {:?}", person.name, fit.size, person.stature, fit.girth, fit.rms, fit.iou, fit.iterations, t.elapsed());
        let mut worst = [0.0f64; 2];
        for s in &fit.sizes {
            let limb = truth.limbs().iter().find(|l| l.name == s.name || l.name == format!("right {}", s.name)).unwrap();
            let t = if s.kind == SizeKind::Length { limb.length } else { limb.radius };
            let e = 1000.0 * (s.found - t);
            worst[usize::from(s.kind == SizeKind::Radius)] = worst[usize::from(s.kind == SizeKind::Radius)].max(e.abs());
            println!("   {:14} {}  true {:6.1} found {:6.1} err {:5.1} dev {:5.1} prior {:5.1} unc {:.2}", s.name, s.kind, 1000.0 * t, 1000.0 * s.found, e, 1000.0 * s.deviation, 1000.0 * s.prior_deviation, s.uncertainty());
        }
        println!("  worst {:?}", worst);
        let je: Vec<f64> = body_frames.iter().zip(&fit.poses).enumerate().flat_map(|(k, (_, pose))| {
            let mut tp = motion::pose(&truth, frames[k]); tp.root.z -= 0.9 * (1.0 - person.stature);
            let a = Kinematics::new(&truth, &tp); let b = Kinematics::new(&fit.model, pose);
            a.ends().iter().zip(b.ends()).map(|(a, b)| 1000.0 * a.distance(*b)).collect::<Vec<_>>()
        }).collect();
        println!("  joints mean {:.1} mm", je.iter().sum::<f64>() / je.len() as f64);
    }
}
