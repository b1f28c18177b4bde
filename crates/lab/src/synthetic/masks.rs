//! Exact silhouettes of the figure, for measurements against known truth; and masks with known faults.

use backlit_tracking::camera::Camera;
use backlit_tracking::silhouette::{Label, Mask, MaskError, SignedDistance};
use glam::DVec2;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::figure::Figure;
use super::render::each_pixel;

/// Whether the ray through each pixel's centre meets the figure: no noise, no edge smoothing, no unknown.
///
/// Give [`Camera::without_distortion`] for the mask of the rectified picture.
///
/// # Errors
/// The camera's pictures are larger than a mask may be.
pub fn silhouette(figure: &Figure, camera: &Camera) -> Result<Mask, MaskError> {
    let (width, height) = (camera.width(), camera.height());
    let origin = camera.centre();
    let labels = each_pixel([width, height], |x, y| {
        let ray = camera.ray_in_world(DVec2::new(x as f64, y as f64));
        let hit = ray.and_then(|ray| figure.intersect(origin, ray));
        if hit.is_some() { Label::Subject } else { Label::Background }
    });
    Mask::new(width, height, labels)
}

/// The mask with all that lies within this many pixels of its subject.
///
/// # Errors
/// None: a mask of that size is there already.
pub fn widened(mask: Mask, by_px: f64) -> Result<Mask, MaskError> {
    if by_px <= 0.0 {
        return Ok(mask);
    }
    let distances = SignedDistance::from_mask(&mask);
    let (width, height) = (mask.width(), mask.height());
    let label = |&distance: &f32| {
        if f64::from(distance) < by_px { Label::Subject } else { Label::Background }
    };
    Mask::new(width, height, distances.values()[..width * height].iter().map(label).collect())
}

/// The mask with wrong pixels: a share of those beside a pixel of the other kind, and a share of all others.
#[must_use]
pub fn noisy(mask: &Mask, border_noise: f64, speckle: f64, random: &mut Pcg64Mcg) -> Mask {
    let (width, height) = (mask.width(), mask.height());
    let at = |x: usize, y: usize| mask.labels()[y * width + x];
    let labels = (0..width * height).map(|pixel| {
        let (x, y) = (pixel % width, pixel / width);
        let own = at(x, y);
        let beside = [
            (x > 0).then(|| at(x - 1, y)),
            (x + 1 < width).then(|| at(x + 1, y)),
            (y > 0).then(|| at(x, y - 1)),
            (y + 1 < height).then(|| at(x, y + 1)),
        ];
        let is_border = beside.into_iter().flatten().any(|label| label != own);
        let is_wrong = random.random_bool(if is_border { border_noise } else { speckle });
        match own {
            Label::Subject if is_wrong => Label::Background,
            Label::Background if is_wrong => Label::Subject,
            label => label,
        }
    });
    let labels: Vec<Label> = labels.collect();
    let mut noisy = mask.clone();
    noisy.labels_mut().copy_from_slice(&labels);
    noisy
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
                let seen = mask.bounds().unwrap();
                let is_whole = seen.x_min.min(seen.y_min) >= 3
                    && seen.x_max + 3 < mask.width()
                    && seen.y_max + 3 < mask.height();
                assert!(is_whole, "{} frame {frame}: cut off", camera.name());
            }
        }
    }

    #[test]
    fn loose_clothes_have_a_larger_silhouette() {
        let model = builtin::full_body();
        let pose = motion::pose(&model, 0.0);
        let rig = studio::cameras();
        let camera = rig.cameras()[0].resized(48, 64).unwrap();
        let area = |build| {
            let figure = Figure::new(&model, &pose, build).unwrap();
            silhouette(&figure, &camera).unwrap().count(Label::Subject)
        };
        let loose = Build { cloth: 4.0, ..Build::default() };
        let (more, usual) = (area(loose), area(Build::default()));
        assert!(more as f64 > 1.05 * usual as f64, "{more} {usual}");
    }
}
