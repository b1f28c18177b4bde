//! Exact silhouettes of the figure, for measurements against known truth; and masks with known faults.

use backlit_tracking::camera::Camera;
use backlit_tracking::silhouette::{Label, Mask, MaskError, SignedDistance};
use glam::{DVec2, DVec3};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use super::figure::{BundleHit, Figure};

/// Whether the ray through each pixel's centre meets the figure: no noise, no edge smoothing, no unknown.
///
/// Give [`Camera::without_distortion`] for the mask of the rectified picture.
///
/// # Errors
/// The camera's pictures are larger than a mask may be.
pub fn silhouette(figure: &Figure, camera: &Camera) -> Result<Mask, MaskError> {
    let (width, height) = (camera.width(), camera.height());
    let rays = Rays { figure, camera };
    let rows = height.div_ceil(BLOCK);
    let bands = (0..rows).into_par_iter().map(|row| {
        let mut band = Band { width, top: row * BLOCK, labels: Vec::new() };
        band.labels = vec![Label::Background; width * BLOCK.min(height - band.top)];
        (0..width).step_by(BLOCK).for_each(|x| rays.draw([x, band.top], BLOCK, 0.0, &mut band));
        band.labels
    });
    Mask::new(width, height, bands.collect::<Vec<_>>().concat())
}

/// Pixels along each side of the blocks that are looked at as a whole first.
const BLOCK: usize = 16;

/// Some whole rows of a mask.
struct Band {
    width: usize,
    top: usize,
    labels: Vec<Label>,
}

impl Band {
    /// Makes a square block the subject's.
    fn fill(&mut self, [x, y]: [usize; 2], side: usize) {
        let (width, past) = (self.width, (x + side).min(self.width));
        let rows = self.labels.chunks_mut(width).skip(y - self.top).take(side);
        rows.for_each(|row| row[x..past].fill(Label::Subject));
    }
}

/// The rays of a camera's pixels, and what they may meet.
struct Rays<'a> {
    figure: &'a Figure,
    camera: &'a Camera,
}

impl Rays<'_> {
    fn ray(&self, x: f64, y: f64) -> Option<DVec3> {
        self.camera.ray_in_world(DVec2::new(x, y))
    }

    /// Draws a square block whose rays meet nothing before `from`: a block that misses the figure as a whole is done, else its quarters
    /// are drawn.
    fn draw(&self, [x, y]: [usize; 2], side: usize, from: f64, band: &mut Band) {
        if x >= band.width || (y - band.top) * band.width >= band.labels.len() {
            return;
        }
        if side == 1 {
            let ray = self.ray(x as f64, y as f64);
            let origin = self.camera.centre();
            if ray.and_then(|ray| self.figure.intersect_from(origin, ray, from)).is_some() {
                band.labels[(y - band.top) * band.width + x] = Label::Subject;
            }
            return;
        }
        let clear = match self.meet([x, y], side, from) {
            BundleHit::None => return,
            BundleHit::All => return band.fill([x, y], side),
            BundleHit::Some(clear) => clear,
        };
        let half = side / 2;
        for (right, down) in [(0, 0), (half, 0), (0, half), (half, half)] {
            self.draw([x + right, y + down], half, clear, band);
        }
    }

    /// What the rays of a block meet.
    fn meet(&self, [x, y]: [usize; 2], side: usize, from: f64) -> BundleHit {
        // A lens bends the block's sides by less than this share of it.
        const BENT: f64 = 1.1;
        let [left, top, reach] = [x, y, side - 1].map(|pixels| pixels as f64);
        let corners = [(0.0, 0.0), (reach, 0.0), (0.0, reach), (reach, reach)];
        let Some(middle) = self.ray(left + reach / 2.0, top + reach / 2.0) else {
            return BundleHit::Some(from);
        };
        let mut spread: f64 = 0.0;
        for (right, down) in corners {
            let Some(corner) = self.ray(left + right, top + down) else { return BundleHit::Some(from) };
            spread = spread.max(corner.distance(middle));
        }
        self.figure.intersect_all(self.camera.centre(), middle, BENT * spread, from)
    }
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

    /// Blocks that are left out as a whole would have been empty ray by ray.
    #[test]
    fn blocks_change_no_pixel() {
        let model = builtin::full_body();
        for (frame, camera) in [0.0, 17.0, 41.0].into_iter().zip(studio::cameras().cameras()) {
            let figure = Figure::new(&model, &motion::pose(&model, frame), Build::default()).unwrap();
            let mask = silhouette(&figure, camera).unwrap();
            for (pixel, label) in mask.labels().iter().enumerate() {
                let at = DVec2::new((pixel % mask.width()) as f64, (pixel / mask.width()) as f64);
                let ray = camera.ray_in_world(at);
                let hit = ray.and_then(|ray| figure.intersect(camera.centre(), ray)).is_some();
                assert_eq!(*label == Label::Subject, hit, "{} {frame} {at}", camera.name());
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
