//! Exact silhouettes of the figure, for measurements against known truth.

use backlit_tracking::camera::Camera;
use backlit_tracking::silhouette::{Label, Mask, MaskError};
use glam::DVec2;
use rayon::prelude::*;

use super::figure::Figure;

/// Whether the ray through each pixel's centre meets the figure: no noise, no edge smoothing, no unknown.
///
/// Give [`Camera::without_distortion`] for the mask of the rectified picture.
///
/// # Errors
/// The camera's pictures are larger than a mask may be.
pub fn silhouette(figure: &Figure, camera: &Camera) -> Result<Mask, MaskError> {
    let (width, height) = (camera.width(), camera.height());
    let origin = camera.centre();
    let rows: Vec<Vec<Label>> = (0..height)
        .into_par_iter()
        .map(|y| {
            let label = |x| {
                let ray = camera.ray_in_world(DVec2::new(x as f64, y as f64));
                let hit = ray.and_then(|ray| figure.intersect(origin, ray));
                if hit.is_some() { Label::Subject } else { Label::Background }
            };
            (0..width).map(label).collect()
        })
        .collect();
    Mask::new(width, height, rows.concat())
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::{Kinematics, builtin};

    use super::*;
    use crate::synthetic::{Build, motion, studio};

    #[test]
    fn the_silhouette_covers_the_projected_joints_and_keeps_off_the_border() {
        let model = builtin::full_body();
        let rig = studio::cameras();
        for frame in [0, 10, 25, 31, 41, 59] {
            let pose = motion::pose(&model, f64::from(frame));
            let kinematics = Kinematics::new(&model, &pose);
            let figure = Figure::new(&model, &pose, Build::default()).unwrap();
            for camera in rig.cameras() {
                let mask = silhouette(&figure, camera).unwrap();
                for (limb, end) in model.limbs().iter().zip(kinematics.ends()) {
                    let pixel = camera.project(*end).unwrap().round();
                    let label = mask.get(pixel.x as usize, pixel.y as usize);
                    assert_eq!(label, Some(Label::Subject), "{} {frame} {}", camera.name(), limb.name);
                }
                let on_border = mask.labels().iter().enumerate().any(|(at, &label)| {
                    let (x, y) = (at % mask.width(), at / mask.width());
                    let border = x < 3 || y < 3 || x + 3 >= mask.width() || y + 3 >= mask.height();
                    border && label == Label::Subject
                });
                assert!(!on_border, "{} frame {frame}: cut off", camera.name());
            }
        }
    }

    #[test]
    fn a_stouter_build_has_a_larger_silhouette() {
        let model = builtin::full_body();
        let pose = motion::pose(&model, 0.0);
        let rig = studio::cameras();
        let camera = rig.cameras()[0].resized(48, 64).unwrap();
        let area = |build| {
            let figure = Figure::new(&model, &pose, build).unwrap();
            silhouette(&figure, &camera).unwrap().count(Label::Subject)
        };
        let stout = Build { trunk: 1.25, arms: 1.2, legs: 1.2, ..Build::default() };
        let (more, usual) = (area(stout), area(Build::default()));
        assert!(more as f64 > 1.05 * usual as f64, "{more} {usual}");
    }
}
