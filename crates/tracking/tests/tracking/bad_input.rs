//! Numbers that are not finite, sizes that are absurd, shapes that are degenerate: an error with the field's name where
//! something is made, and never a panic or a NaN after that.

use backlit_tracking::body::{
    JointLimits, Kinematics, LimbSpec, LimbSphere, Model, ModelError, Pose, PoseError, Range, builtin,
};
use backlit_tracking::camera::{
    Camera, CameraError, CameraFromWorld, Distortion, Intrinsics, Rectification, Rig,
};
use backlit_tracking::render::wrench::WrenchBlock;
use backlit_tracking::render::{Ramp, View, dense_jacobian, prediction};
use backlit_tracking::residual::silhouette::{KernelMemory, SampledData};
use backlit_tracking::segment::{Background, SegmentOptions, segment};
use backlit_tracking::silhouette::{
    Label, MAX_PIXELS, Mask, MaskError, Measurement, MeasurementError, SignedDistance, contours,
};
use glam::{DMat3, DQuat, DVec3};
use image::{GrayImage, RgbImage};

use crate::fixtures::{BOTH, renderers};

const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
/// Finite, and squares of it are not.
const HUGE: f64 = 1e200;

const RAMPS: [Ramp; 4] =
    [Ramp::Thesis, Ramp::Half, Ramp::Width { px: 2.0 }, Ramp::Distance { inner_px: 2.0, outer_px: 6.0 }];

fn pinhole() -> Intrinsics {
    Intrinsics { fx: 40.0, fy: 41.0, cx: 11.5, cy: 8.5 }
}

fn place() -> CameraFromWorld {
    CameraFromWorld::looking_at(DVec3::new(0.3, 0.2, 2.0), DVec3::new(0.0, 0.2, 0.0), DVec3::Y)
}

fn camera(size: [u64; 2], intrinsics: Intrinsics, place: CameraFromWorld) -> Result<Camera, CameraError> {
    Camera::new("camera", size, intrinsics, Distortion::None, place)
}

fn good_camera() -> Camera {
    camera([24, 18], pinhole(), place()).unwrap()
}

#[test]
fn poses_with_numbers_that_are_none_are_errors() {
    let model = builtin::upper_body();
    let rest = Pose::rest(&model);
    for bad in BAD.into_iter().chain([HUGE]) {
        for axis in 0..3 {
            let mut pose = rest.clone();
            pose.root[axis] = bad;
            assert!(matches!(pose.check(&model), Err(PoseError::Root { .. })), "{pose:?}");
            assert!(matches!(Pose::from_state(&model, &pose.to_state()), Err(PoseError::Root { .. })));
        }
        let mut pose = rest.clone();
        pose.rotations[2].y = bad;
        assert!(matches!(pose.check(&model), Err(PoseError::Rotation { .. })), "{pose:?}");
    }
    let mut pose = rest.clone();
    pose.rotations[1] = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
    let name = &model.limbs()[1].name;
    assert!(matches!(pose.check(&model), Err(PoseError::Rotation { limb, .. }) if limb == *name));
    pose.rotations.pop();
    assert!(matches!(pose.check(&model), Err(PoseError::Count { .. })));
    for length in [0, 1, 2, 3, 5, 1000] {
        let found = Pose::from_state(&model, &vec![0.5; length]);
        assert!(matches!(found, Err(PoseError::Count { .. })), "{length}");
    }
}

#[test]
fn limbs_without_extent_are_errors() {
    let good = builtin::upper_body().to_spec();
    let changed = |change: &dyn Fn(&mut LimbSpec)| {
        let mut spec = good.clone();
        change(&mut spec.limbs[3]);
        Model::new(&spec)
    };
    for bad in BAD.into_iter().chain([0.0, -0.1, 1e-300, HUGE]) {
        let length = changed(&|limb| limb.length = bad);
        assert!(matches!(length, Err(ModelError::Size { field: "length", .. })), "{bad}: {length:?}");
        let radius = changed(&|limb| limb.radius = bad);
        assert!(matches!(radius, Err(ModelError::Size { field: "radius", .. })), "{bad}: {radius:?}");
        let sphere = LimbSphere { at: 0.5, radius: bad, offset: DVec3::ZERO, parent: None };
        let sphere = changed(&|limb| limb.spheres = vec![sphere]);
        assert!(matches!(sphere, Err(ModelError::Sphere { index: 0, .. })), "{bad}: {sphere:?}");
    }
    for bad in BAD.into_iter().chain([HUGE]) {
        let direction = changed(&|limb| limb.direction = DVec3::new(0.0, bad, 0.0));
        assert!(matches!(direction, Err(ModelError::Direction { .. })), "{bad}: {direction:?}");
        for sphere in [
            LimbSphere { at: bad, radius: 0.1, offset: DVec3::ZERO, parent: None },
            LimbSphere { at: 0.5, radius: 0.1, offset: DVec3::X * bad, parent: None },
        ] {
            let found = changed(&|limb| limb.spheres = vec![sphere]);
            assert!(matches!(found, Err(ModelError::Sphere { index: 0, .. })), "{sphere:?}: {found:?}");
        }
    }
    assert!(matches!(changed(&|limb| limb.direction = DVec3::ZERO), Err(ModelError::Direction { .. })));
}

#[test]
fn limits_that_contradict_themselves_are_errors() {
    let free = JointLimits {
        axis: DVec3::Z,
        flexion: Range(-1.0, 1.0),
        sideways: Range(-1.0, 1.0),
        twist: Range(-1.0, 1.0),
    };
    let mut spec = builtin::single_limb().to_spec();
    let mut with = |limits: JointLimits| {
        spec.limbs[0].limits = Some(limits);
        Model::new(&spec)
    };
    for bad in [Range(1.0, -1.0), Range(f64::NAN, 1.0), Range(0.0, f64::INFINITY)] {
        for (field, limits) in [
            ("flexion", JointLimits { flexion: bad, ..free }),
            ("sideways", JointLimits { sideways: bad, ..free }),
            ("twist", JointLimits { twist: bad, ..free }),
        ] {
            let found = with(limits);
            let Err(ModelError::Limits { field: named, .. }) = found else { panic!("{found:?}") };
            assert_eq!(named, field);
        }
    }
    let along = builtin::single_limb().limbs()[0].direction;
    for axis in [DVec3::ZERO, along, DVec3::NAN, DVec3::INFINITY] {
        let found = with(JointLimits { axis, ..free });
        assert!(matches!(found, Err(ModelError::Limits { field: "axis", .. })), "{axis}: {found:?}");
    }
}

#[test]
fn cameras_that_project_nothing_are_errors() {
    for bad in BAD.into_iter().chain([0.0, -40.0, 1e-300, HUGE]) {
        for (field, intrinsics) in
            [("fx", Intrinsics { fx: bad, ..pinhole() }), ("fy", Intrinsics { fy: bad, ..pinhole() })]
        {
            let found = camera([24, 18], intrinsics, place());
            assert!(matches!(found, Err(CameraError::Focal { field: named, .. }) if named == field), "{bad}");
        }
    }
    for bad in BAD.into_iter().chain([HUGE]) {
        for intrinsics in [Intrinsics { cx: bad, ..pinhole() }, Intrinsics { cy: bad, ..pinhole() }] {
            let found = camera([24, 18], intrinsics, place());
            assert!(matches!(found, Err(CameraError::NotFinite { .. })), "{bad}: {found:?}");
        }
        let lens = Distortion::OpenCv { k1: 0.1, k2: bad, p1: 0.0, p2: 0.0, k3: 0.0 };
        let found = Camera::new("camera", [24, 18], pinhole(), lens, place());
        assert!(matches!(found, Err(CameraError::NotFinite { field: "k2", .. })), "{bad}: {found:?}");
        let moved = CameraFromWorld { translation: DVec3::Y * bad, ..place() };
        let found = camera([24, 18], pinhole(), moved);
        assert!(matches!(found, Err(CameraError::Translation { .. })), "{bad}: {found:?}");
        let mut rotation = place().rotation;
        rotation.x_axis.y = bad;
        let found = camera([24, 18], pinhole(), CameraFromWorld { rotation, ..place() });
        assert!(matches!(found, Err(CameraError::Rotation { .. })), "{bad}: {found:?}");
    }
    for rotation in [DMat3::ZERO, -DMat3::IDENTITY, DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0))] {
        let found = camera([24, 18], pinhole(), CameraFromWorld { rotation, ..place() });
        assert!(matches!(found, Err(CameraError::Rotation { .. })), "{rotation}: {found:?}");
    }
    for size in [[0, 18], [24, 0], [1 << 31, 18], [24, 1 << 31], [u64::MAX, u64::MAX]] {
        assert!(matches!(camera(size, pinhole(), place()), Err(CameraError::Size { .. })), "{size:?}");
        assert!(matches!(good_camera().resized(size[0], size[1]), Err(CameraError::Size { .. })), "{size:?}");
    }
    assert!(Rig::new(Vec::new()).is_err());
}

#[test]
fn pictures_of_no_or_countless_pixels_are_errors() {
    for (width, height) in [(0, 0), (0, 5), (5, 0)] {
        assert!(matches!(Mask::filled(width, height, Label::Subject), Err(MaskError::Empty { .. })));
        assert!(matches!(Mask::new(width, height, Vec::new()), Err(MaskError::Empty { .. })));
        let found = Measurement::new(width, height, Vec::new(), Vec::new());
        assert!(matches!(found, Err(MeasurementError::Empty { .. })), "{found:?}");
    }
    for (width, height) in [(1 << 31, 1), (1, 1 << 31), (usize::MAX, usize::MAX), (MAX_PIXELS + 1, 1)] {
        assert!(matches!(Mask::filled(width, height, Label::Subject), Err(MaskError::TooLarge { .. })));
        assert!(matches!(Mask::new(width, height, Vec::new()), Err(MaskError::TooLarge { .. })));
        let found = Measurement::new(width, height, Vec::new(), Vec::new());
        assert!(matches!(found, Err(MeasurementError::WrongLength { .. })), "{found:?}");
    }
    assert!(Mask::from_gray(&GrayImage::new(0, 3)).is_err());
    for bad in [f32::NAN, f32::INFINITY] {
        let found = Measurement::new(1, 1, vec![bad], vec![1.0]);
        assert!(matches!(found, Err(MeasurementError::NotFinite { .. })), "{found:?}");
        let found = Measurement::new(1, 1, vec![0.0], vec![bad]);
        assert!(matches!(found, Err(MeasurementError::NotFinite { .. })), "{found:?}");
    }
    // Grey pictures become measurements without a check; an empty one has nothing to say and breaks nothing.
    for picture in [GrayImage::new(0, 0), GrayImage::new(0, 7), GrayImage::new(7, 0)] {
        let measurement = Measurement::from_gray(&picture);
        assert_eq!(SampledData::new(&measurement, 1).total_weight, 0.0);
        assert_eq!(measurement.to_gray(), picture);
    }
}

#[test]
fn segmentation_of_nothing_is_an_error() {
    let nothing = RgbImage::new(0, 4);
    let background = Background::from_plate(&nothing);
    for match_exposure in [true, false] {
        let options = SegmentOptions { match_exposure, ..SegmentOptions::default() };
        assert!(segment(&nothing, &background, &options).is_err());
        assert!(segment(&RgbImage::new(3, 3), &background, &options).is_err());
    }
    let options = SegmentOptions { z_threshold: f32::NAN, ..SegmentOptions::default() };
    let wall = RgbImage::new(3, 3);
    assert!(segment(&wall, &Background::from_plate(&wall), &options).is_err());
}

#[test]
fn masks_of_one_label_and_one_pixel_have_distances_and_outlines() {
    for (width, height) in [(1, 1), (1, 9), (9, 1), (70, 3)] {
        for label in [Label::Background, Label::Subject, Label::Unknown] {
            let mask = Mask::filled(width, height, label).unwrap();
            for reach in [0.0, 5.0, f32::INFINITY, f32::NAN, -3.0] {
                let distance = SignedDistance::from_mask_within(&mask, reach);
                assert!(distance.values().iter().all(|value| value.is_finite()), "{label:?} {reach}");
            }
            assert_eq!(contours(&mask).len(), usize::from(label == Label::Subject));
            let averaged = Measurement::from_mask_averaged(&mask, 3);
            assert!(averaged.values().iter().all(|value| (0.0..=255.0).contains(value)));
        }
    }
}

/// Every level, derivative and sum of a body in a picture is a number, by every renderer; `also` looks at each view by name.
pub(crate) fn assert_finite(
    name: &str,
    model: &Model,
    pose: &Pose,
    camera: &Camera,
    ramps: &[Ramp],
    also: impl Fn(&View, &str),
) {
    let kinematics = Kinematics::new(model, pose);
    let data = Measurement::from_gray(&GrayImage::new(camera.width() as u32, camera.height() as u32));
    for (renderer, &ramp) in renderers().flat_map(|kind| ramps.iter().map(move |ramp| (kind, ramp))) {
        let view = View::new(model, &kinematics, camera, renderer, ramp);
        let name = format!("{name}, {renderer}, {ramp}");
        assert_levels(&name, &view);
        for parameters in BOTH {
            let jacobian = dense_jacobian(&view, &kinematics, camera, parameters);
            assert!(jacobian.iter().all(|x| x.is_finite()), "{name}, {parameters:?}: a derivative is none");
        }
        let mut blocks = vec![WrenchBlock::default(); model.limbs().len()];
        let data = SampledData::new(&data, 1);
        let cost = data.accumulate(&view, &mut KernelMemory::default(), &mut blocks);
        assert!(cost.is_finite(), "{name}: the cost is {cost}");
        also(&view, &name);
    }
}

fn assert_levels(name: &str, view: &View) {
    let levels = prediction::levels(view);
    assert!(levels.iter().all(|level| (0.0..=255.0).contains(level)), "{name}: a level is none");
}

#[test]
fn a_camera_inside_a_limb_sees_numbers() {
    let models = [builtin::single_limb(), builtin::upper_body()];
    for (model, index) in
        models.iter().flat_map(|model| (0..model.limbs().len()).map(move |limb| (model, limb)))
    {
        let limb = &model.limbs()[index];
        let rest = Pose::rest(model);
        let kinematics = Kinematics::new(model, &rest);
        let (from, to) = (kinematics.starts()[index], kinematics.ends()[index]);
        let across = limb.direction.any_orthonormal_vector();
        for along in [0.0, 0.5, 1.0] {
            for out in [0.0, 0.4, 0.999] {
                let centre = from.lerp(to, along) + across * (out * limb.radius);
                for target in [limb.direction, -limb.direction, across, -across] {
                    let place =
                        CameraFromWorld::looking_at(centre, centre + target, DVec3::new(0.3, 0.2, 0.9));
                    let camera = camera([9, 7], Intrinsics { cx: 4.0, cy: 3.0, ..pinhole() }, place).unwrap();
                    let name = format!("in {} at {along}, {out} towards {target}", limb.name);
                    assert_finite(&name, model, &rest, &camera, &RAMPS, |_, _| ());
                }
            }
        }
    }
}

/// Whoever skips the checks still gets a picture of numbers.
#[test]
fn unchecked_poses_and_ramps_draw_numbers() {
    let model = builtin::upper_body();
    let camera = good_camera();
    for bad in BAD.into_iter().chain([HUGE, 1e20, -1e20]) {
        let mut moved = Pose::rest(&model);
        moved.root.z = bad;
        let mut turned = Pose::rest(&model);
        turned.rotations[0].x = bad;
        for pose in [moved, turned] {
            let kinematics = Kinematics::new(&model, &pose);
            for renderer in renderers() {
                for ramp in RAMPS {
                    let view = View::new(&model, &kinematics, &camera, renderer, ramp);
                    assert_levels(&format!("{bad}, {renderer}, {ramp}"), &view);
                }
            }
        }
        let kinematics = Kinematics::new(&model, &Pose::rest(&model));
        for ramp in [
            Ramp::Width { px: bad },
            Ramp::Width { px: 0.0 },
            Ramp::Distance { inner_px: bad, outer_px: 1.0 },
            Ramp::Distance { inner_px: 1.0, outer_px: bad },
            Ramp::Distance { inner_px: 0.0, outer_px: 0.0 },
        ] {
            for renderer in renderers() {
                let view = View::new(&model, &kinematics, &camera, renderer, ramp);
                assert_levels(&format!("{renderer}, {ramp}"), &view);
            }
            assert!(ramp.to_string().parse::<Ramp>().is_err() || ramp.is_valid(), "{ramp}");
        }
    }
}

#[test]
fn lenses_without_an_inverse_draw_numbers() {
    let model = builtin::upper_body();
    for k in [-1e6, -10.0, 10.0, 1e6] {
        let lens = Distortion::OpenCv { k1: k, k2: -k, p1: 0.1 * k, p2: k, k3: k };
        let camera = Camera::new("camera", [24, 18], pinhole(), lens, place()).unwrap();
        assert_finite(&format!("lens {k}"), &model, &Pose::rest(&model), &camera, &[Ramp::Half], |_, _| ());
        assert!(Rectification::new(&camera).rectify(&RgbImage::new(24, 18)).is_some());
    }
}
