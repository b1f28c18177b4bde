//! What the benches fit: the report's upper body of ten limbs, 43 raw coefficients, seen by cameras around it.

use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, ModelSpec, Pose};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::fit::{Evidence, FitOptions, FitView, Objective, Stage};
use backlit_tracking::render::{Ramp, RendererKind, predict};
use backlit_tracking::search::start;
use backlit_tracking::silhouette::Measurement;
use glam::DVec3;

/// Ten limbs with a rotation each: the torso, its two sides, the head and two arms of three limbs.
const UPPER_BODY: &str = r#"
format = "backlit-body 1"
name = "upper body of ten limbs"
limb = [
    { name = "torso", direction = [0, 1, 0], length = 0.50, radius = 0.11 },
    { name = "right shoulder", parent = "torso", direction = [-1, -0.1, 0], length = 0.19, radius = 0.06 },
    { name = "right upper arm", parent = "right shoulder", direction = [-0.25, -1, 0], length = 0.28, radius = 0.05 },
    { name = "right forearm", parent = "right upper arm", direction = [-0.1, -1, 0.25], length = 0.36, radius = 0.04 },
    { name = "left shoulder", parent = "torso", direction = [1, -0.1, 0], length = 0.19, radius = 0.06 },
    { name = "left upper arm", parent = "left shoulder", direction = [0.25, -1, 0], length = 0.28, radius = 0.05 },
    { name = "left forearm", parent = "left upper arm", direction = [0.1, -1, 0.25], length = 0.36, radius = 0.04 },
    { name = "head", parent = "torso", direction = [0, 1, 0.05], length = 0.22, radius = 0.085 },
    { name = "right side", direction = [-0.3, 1, 0], length = 0.40, radius = 0.07 },
    { name = "left side", direction = [0.3, 1, 0], length = 0.40, radius = 0.07 },
]
"#;

/// A body, its cameras and data of another pose.
pub(crate) struct Scene {
    pub(crate) model: Arc<Model>,
    pub(crate) pose: Pose,
    pub(crate) cameras: Vec<(Camera, Measurement)>,
}

impl Scene {
    /// `count` cameras of `width` × `height` pixels, 2.7 m away, a quarter turn apart where there are two. The
    /// body fills the height of their pictures.
    pub(crate) fn new(width: u64, height: u64, count: usize) -> Self {
        let spec: ModelSpec = toml::from_str(UPPER_BODY).expect("a body");
        let model = Model::new(&spec).expect("a valid body");
        let truth = start::perturb(&model, &Pose::rest(&model), 0.2, 0.05, 3);
        let pose = start::perturb(&model, &truth, 0.1, 0.03, 5);
        let kinematics = Kinematics::new(&model, &truth);
        let cameras = (0..count).map(|index| {
            let camera = camera(index, count, width, height);
            let prediction = predict(&model, &kinematics, &camera, RendererKind::Capsule, Ramp::Thesis);
            let weights = vec![1.0; prediction.lambda.len()];
            let data = Measurement::new(width as usize, height as usize, prediction.lambda, weights);
            (camera, data.expect("a picture of its size"))
        });
        Self { cameras: cameras.collect(), model: Arc::new(model), pose }
    }

    /// The library's problem, of one stage at full resolution.
    pub(crate) fn objective(&self, options: &FitOptions, stage: Stage) -> Objective {
        let views: Vec<FitView> = self
            .cameras
            .iter()
            .map(|(camera, data)| FitView {
                camera: Arc::new(camera.clone()),
                evidence: Evidence::Measurement(Arc::new(data.clone())),
                weight: 1.0,
            })
            .collect();
        let distances = vec![None; views.len()];
        Objective::new(Arc::clone(&self.model), &views, &distances, options, stage, self.pose.clone())
    }
}

fn camera(index: usize, count: usize, width: u64, height: u64) -> Camera {
    let azimuth = 0.4 + std::f64::consts::PI * index as f64 / count.max(2) as f64;
    let centre = DVec3::new(2.6 * azimuth.sin(), 0.8, 2.6 * azimuth.cos());
    let place = CameraFromWorld::looking_at(centre, DVec3::new(0.0, 0.35, 0.0), DVec3::Y);
    let f = 2.08 * height as f64;
    let (cx, cy) = (width as f64 / 2.0 - 0.5, height as f64 / 2.0 - 0.5);
    let pinhole = Intrinsics { fx: f, fy: f, cx, cy };
    Camera::new(&format!("camera {index}"), [width, height], pinhole, Distortion::None, place)
        .expect("a valid camera")
}
