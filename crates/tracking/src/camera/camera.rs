//! One calibrated camera: its pinhole, its place, and both with a lens.

use glam::{DMat3, DVec2, DVec3};
use thiserror::Error;

use super::Distortion;
use crate::names;
use crate::numbers::Brief;

/// Most pixels across or down a picture.
pub const MAX_SIDE: u32 = 16_384;
/// Most pixels of a picture, as of a mask: of larger ones not even one could be decoded within 500 MB.
pub const MAX_PIXELS: u64 = 64 << 20;
/// Larger numbers in a calibration (pixels, coefficients of a lens) are a mistake, and would not stay finite when squared.
pub const LARGEST_NUMBER: f64 = 1e9;
/// A focal length below this projects everything to one point.
const SMALLEST_FOCAL_PX: f64 = 1e-9;
/// A camera farther away than this, metres, is a mistake of units.
pub const FARTHEST: f64 = 1e6;
/// Rotations that are this far from orthonormal are refused; closer ones are mended.
const ROTATION_TOLERANCE: f64 = 1e-3;

/// `x_px = fx X/Z + cx`, `y_px = fy Y/Z + cy`, with pixel centres at integers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intrinsics {
    /// Focal length across, pixels.
    pub fx: f64,
    /// Focal length down, pixels.
    pub fy: f64,
    /// Principal point across, pixels.
    pub cx: f64,
    /// Principal point down, pixels.
    pub cy: f64,
}

impl Intrinsics {
    /// Pixel of a point on the plane Z = 1.
    pub fn pixel_from_plane(&self, plane: DVec2) -> DVec2 {
        DVec2::new(self.fx * plane.x + self.cx, self.fy * plane.y + self.cy)
    }

    /// Point on the plane Z = 1 of a pixel.
    pub fn plane_from_pixel(&self, pixel: DVec2) -> DVec2 {
        DVec2::new((pixel.x - self.cx) / self.fx, (pixel.y - self.cy) / self.fy)
    }

    /// Unit ray of a pixel in camera axes.
    pub fn ray(&self, pixel: DVec2) -> DVec3 {
        self.plane_from_pixel(pixel).extend(1.0).normalize()
    }

    /// One focal length for sizes: the geometric mean.
    pub fn mean_focal_px(&self) -> f64 {
        (self.fx * self.fy).sqrt()
    }
}

/// The rigid transform from world to camera: `x_camera = rotation · x_world + translation`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraFromWorld {
    /// Rows are the camera's axes in the world.
    pub rotation: DMat3,
    /// Metres.
    pub translation: DVec3,
}

impl CameraFromWorld {
    /// A point's camera coordinates.
    pub fn transform(&self, point_in_world: DVec3) -> DVec3 {
        self.rotation * point_in_world + self.translation
    }

    /// Where the camera stands in the world.
    pub fn centre(&self) -> DVec3 {
        -(self.rotation.transpose() * self.translation)
    }

    /// A camera at `centre` that looks at `target`, with `up` upwards in the picture.
    pub fn looking_at(centre: DVec3, target: DVec3, up: DVec3) -> Self {
        let z = (target - centre).normalize();
        let x = z.cross(up).normalize_or(z.any_orthonormal_vector());
        let y = z.cross(x);
        let rotation = DMat3::from_cols(x, y, z).transpose();
        Self { rotation, translation: -(rotation * centre) }
    }
}

/// Why numbers are not a camera. Every message names the field.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum CameraError {
    #[error("`name` is \"{}\"; expected {}", names::excerpt(.name), names::EXPECTED)]
    Name { name: String },
    #[error("`{field}` is {value}; expected 1 to {MAX_SIDE} pixels")]
    Size { field: &'static str, value: u64 },
    #[error("`width` × `height` is {} × {}; expected at most {MAX_PIXELS} pixels", size[0], size[1])]
    Pixels { size: [u64; 2] },
    #[error("`{field}` is {}; expected a number of pixels above 0 and at most {LARGEST_NUMBER:e}", Brief(*.value))]
    Focal { field: &'static str, value: f64 },
    #[error("`{field}` is {}; expected a number of at most {LARGEST_NUMBER:e}", Brief(*.value))]
    NotFinite { field: &'static str, value: f64 },
    #[error("`rotation` is not a rotation: its rows are {error:.1e} away from orthonormal, or it mirrors")]
    Rotation { error: f64 },
    #[error(
        "`translation` is [{:?}, {:?}, {:?}]; expected three numbers in metres, none beyond {FARTHEST:e}",
        value.x, value.y, value.z
    )]
    Translation { value: DVec3 },
}

/// A calibrated camera: picture size, pinhole, lens and place. Checked at construction.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    name: String,
    width: usize,
    height: usize,
    intrinsics: Intrinsics,
    distortion: Distortion,
    camera_from_world: CameraFromWorld,
}

impl Camera {
    /// Checks the numbers; a rotation with rounding errors is made orthonormal.
    ///
    /// # Errors
    /// The first field that is wrong.
    pub fn new(
        name: &str,
        size: [u64; 2],
        intrinsics: Intrinsics,
        distortion: Distortion,
        camera_from_world: CameraFromWorld,
    ) -> Result<Self, CameraError> {
        if !names::is_name(name) {
            return Err(CameraError::Name { name: name.to_owned() });
        }
        for (field, value) in [("width", size[0]), ("height", size[1])] {
            if value == 0 || value > u64::from(MAX_SIDE) {
                return Err(CameraError::Size { field, value });
            }
        }
        if size[0] * size[1] > MAX_PIXELS {
            return Err(CameraError::Pixels { size });
        }
        for (field, value) in [("fx", intrinsics.fx), ("fy", intrinsics.fy)] {
            if !(SMALLEST_FOCAL_PX..=LARGEST_NUMBER).contains(&value) {
                return Err(CameraError::Focal { field, value });
            }
        }
        let mut numbers = vec![("cx", intrinsics.cx), ("cy", intrinsics.cy)];
        numbers.extend(distortion.coefficients());
        if let Some(&(field, value)) =
            numbers.iter().find(|(_, value)| !(0.0..=LARGEST_NUMBER).contains(&value.abs()))
        {
            return Err(CameraError::NotFinite { field, value });
        }
        // What was computed from a number at the limit may round to beyond it.
        if !camera_from_world.translation.abs().cmple(DVec3::splat(FARTHEST * (1.0 + 1e-9))).all() {
            return Err(CameraError::Translation { value: camera_from_world.translation });
        }
        let rotation = orthonormal(camera_from_world.rotation)?;
        Ok(Self {
            name: name.to_owned(),
            width: size[0] as usize,
            height: size[1] as usize,
            intrinsics,
            distortion,
            camera_from_world: CameraFromWorld { rotation, ..camera_from_world },
        })
    }

    /// Unique name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Pixels across.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The pinhole.
    pub fn intrinsics(&self) -> &Intrinsics {
        &self.intrinsics
    }

    /// The lens.
    pub fn distortion(&self) -> &Distortion {
        &self.distortion
    }

    /// World to camera.
    pub fn camera_from_world(&self) -> &CameraFromWorld {
        &self.camera_from_world
    }

    /// Where the camera stands in the world, metres.
    pub fn centre(&self) -> DVec3 {
        self.camera_from_world.centre()
    }

    /// Its optical axis, a unit vector in world axes.
    pub fn axis_in_world(&self) -> DVec3 {
        self.camera_from_world.rotation.transpose().z_axis
    }

    /// The same camera with an ideal lens: whose pictures [`Rectification`](super::Rectification) makes.
    pub fn without_distortion(&self) -> Self {
        Self { distortion: Distortion::None, ..self.clone() }
    }

    /// Pixel of a world point; `None` for points at or behind the camera plane.
    pub fn project(&self, point_in_world: DVec3) -> Option<DVec2> {
        let point = self.camera_from_world.transform(point_in_world);
        if point.z <= 1e-9 {
            return None;
        }
        let plane = self.distortion.distort(DVec2::new(point.x, point.y) / point.z);
        Some(self.intrinsics.pixel_from_plane(plane))
    }

    /// Depth of a world point along the optical axis, metres; negative behind the camera.
    pub fn depth(&self, point_in_world: DVec3) -> f64 {
        self.camera_from_world.transform(point_in_world).z
    }

    /// Unit ray of a pixel in camera axes; `None` where the lens model has no inverse.
    pub fn ray_in_camera(&self, pixel: DVec2) -> Option<DVec3> {
        let plane = self.distortion.undistort(self.intrinsics.plane_from_pixel(pixel))?;
        Some(plane.extend(1.0).normalize())
    }

    /// Unit ray of a pixel in world axes, from [`centre`](Self::centre).
    pub fn ray_in_world(&self, pixel: DVec2) -> Option<DVec3> {
        self.ray_in_camera(pixel).map(|ray| self.camera_from_world.rotation.transpose() * ray)
    }

    /// The same camera with pictures of another size: all pixel numbers scaled about the picture's corner.
    ///
    /// # Errors
    /// The new size is empty or too large.
    pub fn resized(&self, width: u64, height: u64) -> Result<Self, CameraError> {
        let scale = DVec2::new(width as f64 / self.width as f64, height as f64 / self.height as f64);
        self.remapped([width, height], scale, DVec2::ZERO)
    }

    /// The same camera with pictures whose pixels were made from its own: scaled about the picture's corner, then moved by
    /// `offset` pixels, in a picture of `size`, width first. A pixel centre c goes to (c + ½) · scale − ½ + offset.
    ///
    /// # Errors
    /// The new size is empty or too large, or the numbers make no camera.
    pub fn remapped(&self, size: [u64; 2], scale: DVec2, offset: DVec2) -> Result<Self, CameraError> {
        let k = self.intrinsics;
        // A pixel centre at c covers c − ½ … c + ½.
        let intrinsics = Intrinsics {
            fx: k.fx * scale.x,
            fy: k.fy * scale.y,
            cx: (k.cx + 0.5) * scale.x - 0.5 + offset.x,
            cy: (k.cy + 0.5) * scale.y - 0.5 + offset.y,
        };
        Self::new(&self.name, size, intrinsics, self.distortion, self.camera_from_world)
    }

    /// The same camera with pictures reduced by a whole number, as by the mean of blocks of pixels; columns and rows that do
    /// not fill a block are left out.
    ///
    /// # Errors
    /// Nothing is left of the picture.
    pub fn reduced(&self, divisor: u32) -> Result<Self, CameraError> {
        let divisor = u64::from(divisor.max(1));
        let size = [self.width as u64 / divisor, self.height as u64 / divisor];
        self.remapped(size, DVec2::splat(1.0 / divisor as f64), DVec2::ZERO)
    }
}

fn orthonormal(rotation: DMat3) -> Result<DMat3, CameraError> {
    let error = if rotation.is_finite() {
        let off = rotation * rotation.transpose() - DMat3::IDENTITY;
        off.to_cols_array().iter().fold(0.0_f64, |worst, x| worst.max(x.abs()))
    } else {
        f64::INFINITY
    };
    if error > ROTATION_TOLERANCE || rotation.determinant() < 0.0 {
        return Err(CameraError::Rotation { error });
    }
    if error < 1e-12 {
        return Ok(rotation);
    }
    // Gram and Schmidt on the rows, the optical axis first.
    let rows = rotation.transpose();
    let z = rows.z_axis.normalize();
    let x = rows.x_axis.reject_from_normalized(z).normalize();
    Ok(DMat3::from_cols(x, z.cross(x), z).transpose())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures;

    fn camera(distortion: Distortion) -> Camera {
        let intrinsics = [420.0, 421.0, 134.0, 238.5];
        fixtures::lens_camera(distortion, [272, 480], intrinsics, [3.0, -1.0, 1.5], DVec3::Z, DVec3::Z)
    }

    /// A picture of 272 × 480 that is shrunk to 0.75, gets bars of 6 and 9 pixels, and is then reduced by three.
    #[test]
    fn a_remapped_camera_shows_points_where_the_pixels_went() {
        let lens = Distortion::OpenCv { k1: -0.05, k2: 0.14, p1: 6e-4, p2: 7e-4, k3: 0.01 };
        let camera = camera(lens);
        let offset = DVec2::new(6.0, 9.0);
        let small = camera.remapped([216, 378], DVec2::splat(0.75), offset).unwrap();
        let reduced = small.reduced(3).unwrap();
        assert_eq!([reduced.width(), reduced.height()], [72, 126]);
        assert_eq!([small.reduced(5).unwrap().width(), small.reduced(5).unwrap().height()], [43, 75]);
        for point in [DVec3::new(0.2, 0.3, 1.4), DVec3::new(-0.4, 0.1, 0.2)] {
            let pixel = camera.project(point).unwrap();
            let expected = (pixel + 0.5) * 0.75 - 0.5 + offset;
            assert!(small.project(point).unwrap().distance(expected) < 1e-9);
            assert!(reduced.project(point).unwrap().distance((expected - 1.0) / 3.0) < 1e-9);
        }
        assert!(small.reduced(1000).is_err());
    }

    #[test]
    fn rays_and_pixels_agree() {
        for distortion in
            [Distortion::None, Distortion::OpenCv { k1: -0.05, k2: 0.14, p1: 6e-4, p2: 7e-4, k3: 0.01 }]
        {
            let camera = camera(distortion);
            let point = DVec3::new(0.2, 0.3, 1.4);
            let pixel = camera.project(point).unwrap();
            let ray = camera.ray_in_world(pixel).unwrap();
            assert!((point - camera.centre()).normalize().distance(ray) < 1e-10);
        }
    }

    #[test]
    fn up_is_up_in_the_picture() {
        let camera = camera(Distortion::None);
        let (low, high) = (camera.project(DVec3::ZERO).unwrap(), camera.project(DVec3::Z).unwrap());
        assert!(high.y < low.y);
        assert!((camera.depth(DVec3::Z) - DVec3::new(3.0, -1.0, 0.5).length()).abs() < 1e-12);
    }

    #[test]
    fn errors_name_the_field() {
        let good = camera(Distortion::None);
        let intrinsics = *good.intrinsics();
        let place = *good.camera_from_world();
        let new = |size, intrinsics, place| {
            Camera::new("c", size, intrinsics, Distortion::None, place).unwrap_err().to_string()
        };
        assert!(new([0, 480], intrinsics, place).contains("`width` is 0"));
        assert!(new([272, 1 << 31], intrinsics, place).contains("`height`"));
        assert!(new([272, 480], Intrinsics { fx: 0.0, ..intrinsics }, place).contains("`fx`"));
        let scaled = CameraFromWorld { rotation: place.rotation * 1.1, ..place };
        assert!(new([272, 480], intrinsics, scaled).contains("`rotation`"));
    }
}
