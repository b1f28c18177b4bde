//! Vicon's `.xcp`: XML.
//!
//! `ORIENTATION` is a quaternion x y z w, camera from world with OpenCV's axes; `POSITION` is the camera's place in
//! millimetres; `FOCAL_LENGTH` and `PRINCIPAL_POINT` are pixels with centres at integers, and fy = fx /
//! `PIXEL_ASPECT_RATIO`. Names are `DEVICEID`. Only cameras that film (`SYSTEM` "DV") are read.
//!
//! Vicon's lens leads from the measured pixel to the ideal one, ideal = c + (measured − c) (1 + k1 r² + k2 r⁴ + k3 r⁶)
//! with r in pixels: the other way round than OpenCV's. OpenCV's k1 k2 k3 k4 are fitted to it over the whole picture;
//! what that leaves is below half a pixel in the corners of wide lenses.

use std::path::Path;

use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};
use glam::{DMat3, DMat4, DQuat, DVec2, DVec3, DVec4};

use super::partial::{PartialCamera, PartialCameras, Pinhole};
use super::xml::{Element, document};
use crate::Result;

/// Radii at which the lens is fitted.
const SAMPLES: u32 = 400;
/// A fit that is off by more anywhere in the picture is refused.
const WORST_FIT_PX: f64 = 2.0;

pub(super) fn parts(path: &Path, text: &str) -> Result<PartialCameras> {
    let document = document(path, text)?;
    let mut parts = PartialCameras::new(Some(0.001));
    for node in document.descendants().filter(|node| node.has_tag_name("Camera")) {
        let name = node.attribute("DEVICEID").unwrap_or_default();
        let frame = node.descendants().find(|child| child.has_tag_name("KeyFrame"));
        if node.attribute("SYSTEM").is_some_and(|system| system != "DV") {
            parts.leave_out(name, "it only sees markers");
        } else if let Some(frame) = frame {
            let [camera, frame] = [node, frame].map(|node| Element { path, node });
            parts.push(path, partial(camera, name, frame)?)?;
        } else {
            parts.leave_out(name, "it is not calibrated");
        }
    }
    Ok(parts)
}

fn partial(camera: Element<'_, '_>, name: &str, frame: Element<'_, '_>) -> Result<PartialCamera> {
    let mut part = PartialCamera::new(name, camera.line());
    let size: [f64; 2] = camera.numbers("SENSOR_SIZE")?;
    if let Some(side) = size.iter().find(|side| !(**side >= 0.0 && side.fract() == 0.0 && **side < 1e6)) {
        return Err(camera.error("SENSOR_SIZE", &side.to_string(), "whole numbers of pixels"));
    }
    part.size = Some(size.map(|side| side as u64));
    let [fx] = frame.numbers("FOCAL_LENGTH")?;
    let [cx, cy] = frame.numbers("PRINCIPAL_POINT")?;
    let ratio = match camera.attribute("PIXEL_ASPECT_RATIO") {
        Some(_) => camera.numbers::<1>("PIXEL_ASPECT_RATIO")?[0],
        None => 1.0,
    };
    let pinhole = Intrinsics { fx, fy: fx / ratio, cx, cy };
    part.lens = Some((Pinhole::Pixels(pinhole), lens(frame, pinhole, DVec2::from_array(size))?));
    let [x, y, z, w] = frame.numbers("ORIENTATION")?;
    let quaternion = DQuat::from_xyzw(x, y, z, w);
    if (quaternion.length() - 1.0).abs() > 1e-3 {
        let found = format!("of length {}", quaternion.length());
        return Err(frame.error("ORIENTATION", &found, "a unit quaternion x y z w"));
    }
    let rotation = DMat3::from_quat(quaternion.normalize());
    let centre = DVec3::from_array(frame.numbers("POSITION")?);
    part.place = Some(CameraFromWorld { rotation, translation: -(rotation * centre) });
    Ok(part)
}

fn lens(frame: Element<'_, '_>, pinhole: Intrinsics, size: DVec2) -> Result<Distortion> {
    const RADIAL2: &str = "VICON_RADIAL2";
    let (centre, k) = if let Some(text) = frame.attribute(RADIAL2) {
        let rest = text.trim().strip_prefix("Vicon3Parameter");
        let rest = rest.ok_or_else(|| frame.error(RADIAL2, text, "Vicon3Parameter and five numbers"))?;
        let [x, y, k1, k2, k3] = frame.numbers_in(RADIAL2, rest)?;
        (DVec2::new(x, y), [k1, k2, k3])
    } else if frame.attribute("VICON_RADIAL").is_some() {
        let [k1, k2] = frame.numbers("VICON_RADIAL")?;
        (DVec2::new(pinhole.cx, pinhole.cy), [k1, k2, 0.0])
    } else {
        return Ok(Distortion::None);
    };
    if k == [0.0; 3] {
        return Ok(Distortion::None);
    }
    let fitted = fitted(pinhole, size, centre, k);
    fitted.ok_or_else(|| {
        frame.error(RADIAL2, "a lens that cannot be inverted", "one that OpenCV's lens can meet")
    })
}

/// The lens of ours that leads from Vicon's ideal pixels to the measured ones, by least squares from the centre to the
/// farthest corner: k1 to k3, or with k4, whichever is nearer. Strong lenses need k4; of weak ones the equations with it
/// are all but singular. More coefficients fit no better, and their denominators have zeros.
fn fitted(pinhole: Intrinsics, size: DVec2, centre: DVec2, k: [f64; 3]) -> Option<Distortion> {
    let corner = (size - 1.0 - centre).abs().max(centre.abs()).length();
    // Radii in the plane Z = 1 of the ideal picture, and how much nearer the measured point is.
    let mut pairs = Vec::with_capacity(SAMPLES as usize);
    let mut farthest = 0.0_f64;
    for index in 1..=SAMPLES {
        let measured = corner * f64::from(index) / f64::from(SAMPLES);
        let r2 = measured * measured;
        let stretch = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[2]));
        let ideal = measured * stretch / pinhole.fx;
        if ideal <= farthest {
            return None;
        }
        farthest = ideal;
        pairs.push((ideal, 1.0 / stretch));
    }
    // Powers of the radius over the farthest one, or the equations would lose their digits.
    let unit = farthest * farthest;
    let (mut normal, mut right) = (DMat4::ZERO, DVec4::ZERO);
    for &(ideal, factor) in &pairs {
        let u = ideal * ideal / unit;
        let row = DVec4::new(u, u * u, u * u * u, -factor * u) * ideal;
        normal += DMat4::from_cols(row * row.x, row * row.y, row * row.z, row * row.w);
        right += row * (factor - 1.0) * ideal;
    }
    let plain = (DMat3::from_mat4(normal).inverse() * right.truncate()).extend(0.0);
    let lenses = [plain, normal.inverse() * right].map(|found| {
        let [k1, k2, k3, k4] =
            [found.x / unit, found.y / unit.powi(2), found.z / unit.powi(3), found.w / unit];
        if k4 == 0.0 {
            return Distortion::OpenCv { k1, k2, p1: 0.0, p2: 0.0, k3 };
        }
        Distortion::Rational { k1, k2, p1: 0.0, p2: 0.0, k3, k4, k5: 0.0, k6: 0.0 }
    });
    let error = |lens: &Distortion| {
        let errors = pairs.iter().map(|&(ideal, factor)| {
            let off = (lens.distort(DVec2::X * ideal).x - ideal * factor).abs() * pinhole.fx;
            if off.is_finite() { off } else { f64::INFINITY }
        });
        errors.fold(0.0, f64::max)
    };
    let best = if error(&lenses[1]) < error(&lenses[0]) { lenses[1] } else { lenses[0] };
    (error(&best) < WORST_FIT_PX).then_some(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fitted_lens_undoes_vicon_s() {
        let pinhole = Intrinsics { fx: 1260.0, fy: 1260.0, cx: 943.0, cy: 564.0 };
        let (size, centre) = (DVec2::new(1920.0, 1080.0), DVec2::new(943.0, 564.0));
        let k = [2.75e-7, 7.6e-14, 7.8e-20];
        let lens = fitted(pinhole, size, centre, k).unwrap();
        for measured in [DVec2::ZERO, DVec2::new(1919.0, 0.0), DVec2::new(400.0, 900.0), centre] {
            let r2 = measured.distance_squared(centre);
            let ideal = centre + (measured - centre) * (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[2])));
            let bent = pinhole.pixel_from_plane(lens.distort(pinhole.plane_from_pixel(ideal)));
            assert!(bent.distance(measured) < 0.2, "{measured}: {bent}");
        }
        // Beyond where Vicon's own lens folds over there is nothing to fit.
        assert!(fitted(pinhole, size, centre, [-2e-6, 0.0, 0.0]).is_none());
    }
}
