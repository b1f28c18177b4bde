//! A page as a recording of the [Rerun](https://rerun.io) viewer, version 0.36 or newer.
//!
//! | entity | holds | timelines |
//! |---|---|---|
//! | `world` | which axis is up; metres | |
//! | `world/cameras/NAME` | place and pinhole; below it `picture`, `subject`, `unknown` | frame, time |
//! | `world/body/limbs`, `…/axes`, `…/joints` | capsules, lines, points | frame, time |
//! | `world/fits/FRAME/…` | the same after each step of a fit, and `costs/FRAME` | steps of frame FRAME |
//! | `curves/GROUP/NAME` | numbers over frames | frame, time |
//! | `trust`, `bookmarks` | limbs that are not believed, frames that are lost, marked places: lines of text | frame, time |
//! | `about` | settings, commands, notes and tables | |
//!
//! Picture coordinates of Rerun begin at a pixel's corner, ours at its centre: the principal point moves by half a pixel.
//! Recordings name themselves and their rows by random numbers, so no two files are the same.

mod about;
mod layout;
mod silhouette;

use std::collections::BTreeSet;

use glam::{DMat3, DVec3};
use re_sdk::external::re_log_encoding::EncodeError;
use re_sdk::{
    AsComponents, EntityPath, EntityPathPart, RecordingStream, RecordingStreamBuilder, RecordingStreamError,
    TimelineName,
};
use re_sdk_types::archetypes::{
    Capsules3D, Clear, EncodedImage, LineStrips2D, LineStrips3D, Pinhole, Points3D, Scalars, SeriesLines,
    TextDocument, TextLog, Transform3D, ViewCoordinates,
};
use re_sdk_types::components::{Color, Radius};
use thiserror::Error;

use crate::{Curve, DoubtedLimb, FitSteps, Frame, Page, PageCamera, PageLimb, Picture};

const BELIEVED: [u8; 3] = [242, 193, 78];
const DOUBTFUL: [u8; 3] = [220, 106, 18];
const WRONG: [u8; 3] = [255, 107, 94];
const SUBJECT: [u8; 3] = [127, 178, 240];
const UNKNOWN: [u8; 3] = [149, 157, 167];

/// Radius of a joint's point, metres.
const JOINT_RADIUS_M: f32 = 0.012;

/// Half the widths of lines, points of the screen: a limb's axis, the outlines of subject and unknown.
const AXIS_RADIUS: f32 = 1.5;
const SUBJECT_RADIUS: f32 = 1.0;
const UNKNOWN_RADIUS: f32 = 0.4;

/// A picture so much smaller is not seen.
const HIDDEN_SCALE: f32 = 1e-4;

/// How far from a camera its picture stands in the scene, metres.
const PICTURE_DISTANCE_M: f32 = 0.4;

/// Why a recording cannot be made.
#[derive(Debug, Error)]
pub enum RrdError {
    /// A part of it cannot be logged.
    #[error("the Rerun recording cannot be made: {0}")]
    Logging(#[from] RecordingStreamError),
    /// What was logged cannot be written.
    #[error("the Rerun recording cannot be written: {0}")]
    Encoding(#[from] EncodeError),
}

type Written = Result<(), RrdError>;

/// Writes a page as an RRD file.
///
/// # Errors
/// Rerun's library refuses a part of it.
pub fn to_rrd(page: &Page) -> Result<Vec<u8>, RrdError> {
    let builder = RecordingStreamBuilder::new("backlit").enabled(true).recording_name(page.title.clone());
    let (stream, memory) = builder.with_default_blueprint(layout::of(page)).memory()?;
    stream.set_log_time_enabled(false);
    stream.set_log_tick_enabled(false);
    let pictured = page.pictures.iter().map(|picture| (picture.camera, picture.frame)).collect();
    RrdWriter { page, pictured, stream }.write()?;
    Ok(memory.drain_as_bytes()?)
}

struct RrdWriter<'a> {
    page: &'a Page,
    /// Cameras and frames of its pictures.
    pictured: BTreeSet<(usize, usize)>,
    stream: RecordingStream,
}

impl RrdWriter<'_> {
    fn write(&self) -> Written {
        self.log_static("world", &upright(self.page.up))?;
        self.log_static("about", &TextDocument::from_markdown(about::markdown(self.page)))?;
        self.page.cameras.iter().try_for_each(|camera| self.camera(camera))?;
        self.page.pictures.iter().try_for_each(|picture| self.picture(picture))?;
        self.page.frames.iter().try_for_each(|frame| self.frame(frame))?;
        self.page.curves.iter().try_for_each(|curve| self.curve(curve))?;
        self.page.fits.iter().try_for_each(|fit| self.fit(fit))?;
        for mark in &self.page.bookmarks {
            self.at_frame(mark.frame);
            self.log("bookmarks", &TextLog::new(mark.text.clone()).with_level("INFO"))?;
        }
        Ok(())
    }

    fn log(&self, path: impl Into<EntityPath>, what: &dyn AsComponents) -> Written {
        Ok(self.stream.log(path, what)?)
    }

    /// What holds at all times.
    fn log_static(&self, path: impl Into<EntityPath>, what: &dyn AsComponents) -> Written {
        Ok(self.stream.log_static(path, what)?)
    }

    /// What is logged from here on is of this frame.
    fn at_frame(&self, number: usize) {
        self.stream.reset_time();
        self.stream.set_time_sequence("frame", number as i64);
        if self.page.frame_rate > 0.0 {
            self.stream.set_duration_secs("time", number as f64 / self.page.frame_rate);
        }
    }

    /// What is logged from here on is of this step of a fit.
    fn at_step(&self, frame: usize, step: usize) {
        self.stream.reset_time();
        if let Ok(timeline) = TimelineName::try_new(format!("steps of frame {frame}")) {
            self.stream.set_time_sequence(timeline, step as i64);
        }
    }

    fn camera(&self, camera: &PageCamera) -> Written {
        let [fx, fy, cx, cy] = camera.intrinsics.map(|number| number as f32);
        let size = camera.size.map(|pixels| pixels as f32);
        let pinhole = Pinhole::new([[fx, 0.0, 0.0], [0.0, fy, 0.0], [cx + 0.5, cy + 0.5, 1.0]])
            .with_resolution(size)
            .with_camera_xyz(re_sdk_types::components::ViewCoordinates::RDF)
            .with_image_plane_distance(PICTURE_DISTANCE_M);
        let (at, axes) = place_in_world(camera);
        let axes = axes.to_cols_array_2d().map(|column| column.map(|number| number as f32));
        let path = camera_path(camera);
        self.log_static(path.clone(), &Transform3D::from_translation_mat3x3(point(at), axes))?;
        self.log_static(path, &pinhole)
    }

    /// A picture and its outlines are shown in their own frame only: other frames have none.
    fn picture(&self, picture: &Picture) -> Written {
        let Some(camera) = self.page.cameras.get(picture.camera) else { return Ok(()) };
        let is_last = !self.pictured.contains(&(picture.camera, picture.frame + 1));
        let of_fits: Vec<&FitSteps> =
            self.page.fits.iter().filter(|fit| fit.frame == picture.frame).collect();
        for PicturePart { name, shown, hidden } in picture_parts(picture, camera) {
            let path = camera_path(camera).join(&EntityPath::from(name));
            self.at_frame(picture.frame);
            self.log(path.clone(), &*shown)?;
            if let Some(hidden) = hidden.filter(|_| is_last) {
                self.at_frame(picture.frame + 1);
                self.log(path.clone(), &*hidden)?;
            }
            for fit in &of_fits {
                self.at_step(fit.frame, 0);
                self.log(path.clone(), &*shown)?;
            }
        }
        Ok(())
    }

    fn frame(&self, frame: &Frame) -> Written {
        self.at_frame(frame.number);
        self.body("world/body".into(), &frame.joints, &frame.doubts)?;
        if let Some(why) = &frame.lost {
            self.log("trust", &TextLog::new(format!("lost: {why}")).with_level("ERROR"))?;
        }
        for doubt in &frame.doubts {
            let name = self.page.limbs.get(doubt.limb).map_or("", |limb| &limb.name);
            let [verdict, level] = if doubt.is_wrong { ["wrong", "ERROR"] } else { ["doubtful", "WARN"] };
            let text = format!(
                "{name} {verdict}: {} ({:.0} % that it is more than 250 mm off)",
                doubt.reason,
                100.0 * doubt.wrong
            );
            self.log("trust", &TextLog::new(text).with_level(level))?;
        }
        Ok(())
    }

    /// Joints are the root, then every limb's end.
    fn body(&self, path: EntityPath, joints: &[DVec3], doubts: &[DoubtedLimb]) -> Written {
        let limbs = || self.page.limbs.iter().zip(joints.iter().skip(1)).enumerate();
        let start = |parent: Option<usize>| {
            joints.get(parent.map_or(0, |parent| parent + 1)).copied().unwrap_or_default()
        };
        let colour = |limb: usize| match doubts.iter().find(|doubt| doubt.limb == limb) {
            Some(doubt) if doubt.is_wrong => colour(WRONG),
            Some(_) => colour(DOUBTFUL),
            None => colour(BELIEVED),
        };
        let capsules = Capsules3D::from_endpoints_and_radii(
            limbs().map(|(_, (limb, _))| point(start(limb.parent))),
            limbs().map(|(_, (_, end))| point(*end)),
            limbs().map(|(_, (limb, _))| limb.radius as f32),
        );
        let capsules = capsules
            .with_colors(limbs().map(|(index, _)| colour(index)))
            .with_labels(limbs().map(|(_, (limb, _))| limb.name.clone()))
            .with_show_labels(false);
        let ends = |(_, (limb, end)): (usize, (&PageLimb, &DVec3))| [point(start(limb.parent)), point(*end)];
        let axes = LineStrips3D::new(limbs().map(ends))
            .with_radii([Radius::new_ui_points(AXIS_RADIUS)])
            .with_colors(limbs().map(|(index, _)| colour(index)));
        let names =
            std::iter::once("root".to_owned()).chain(limbs().map(|(_, (limb, _))| limb.joint.clone()));
        let points = Points3D::new(joints.iter().map(|joint| point(*joint)))
            .with_radii([JOINT_RADIUS_M])
            .with_labels(names)
            .with_show_labels(false);
        self.log(path.clone().join(&EntityPath::from("limbs")), &capsules)?;
        // Views of cameras show lines and points, but no capsules.
        self.log(path.clone().join(&EntityPath::from("axes")), &axes)?;
        self.log(path.join(&EntityPath::from("joints")), &points)
    }

    fn curve(&self, curve: &Curve) -> Written {
        let path = curve_path(self.page, curve);
        let unit = if curve.unit.is_empty() { String::new() } else { format!(", {}", curve.unit) };
        let name = format!("{}{unit}", curve_name(self.page, curve));
        self.log_static(path.clone(), &SeriesLines::new().with_names([name]))?;
        for (frame, value) in &curve.values {
            let Some(value) = value.filter(|value| value.is_finite()) else { continue };
            self.at_frame(*frame);
            self.log(path.clone(), &Scalars::single(value))?;
        }
        Ok(())
    }

    fn fit(&self, fit: &FitSteps) -> Written {
        let costs = EntityPath::from("costs").join(&part(&fit.frame.to_string()));
        self.stream
            .log_static(costs.clone(), &SeriesLines::new().with_names([format!("frame {}", fit.frame)]))?;
        for (index, step) in fit.steps.iter().enumerate() {
            self.at_step(fit.frame, index);
            let path = EntityPath::from("world/fits").join(&part(&fit.frame.to_string()));
            self.body(path, &step.joints, &[])?;
            self.log(costs.clone(), &Scalars::single(step.cost))?;
        }
        Ok(())
    }
}

/// What is logged of a picture or an outline below its camera, and what hides it.
struct PicturePart {
    name: &'static str,
    shown: Box<dyn AsComponents>,
    hidden: Option<Box<dyn AsComponents>>,
}

fn picture_parts(picture: &Picture, camera: &PageCamera) -> Vec<PicturePart> {
    let mut parts = Vec::new();
    if !picture.bytes.is_empty() {
        let [across, down] = [0, 1].map(|axis| camera.size[axis] as f32 / picture.size[axis].max(1) as f32);
        // The viewer of version 0.36 goes on showing an encoded picture that was cleared, and dies where rows with and
        // without one are of the same entity. So the scale above it hides it.
        parts.push(PicturePart {
            name: "picture",
            shown: Box::new(Transform3D::from_scale([across, down, 1.0])),
            hidden: Some(Box::new(Transform3D::from_scale([HIDDEN_SCALE; 3]))),
        });
        let image = EncodedImage::new(picture.bytes.clone()).with_media_type(picture.media_type);
        parts.push(PicturePart { name: "picture/encoded", shown: Box::new(image), hidden: None });
    }
    let outlines = [
        ("subject", &picture.subject, SUBJECT, SUBJECT_RADIUS),
        ("unknown", &picture.unknown, UNKNOWN, UNKNOWN_RADIUS),
    ];
    for (name, path, rgb, radius) in outlines {
        let lines = LineStrips2D::new(silhouette::outlines(path));
        let lines = lines.with_colors([colour(rgb)]).with_radii([Radius::new_ui_points(radius)]);
        let hidden: Box<dyn AsComponents> = Box::new(Clear::flat());
        parts.push(PicturePart { name, shown: Box::new(lines), hidden: Some(hidden) });
    }
    parts
}

/// Where a camera is and, as columns, where its axes point.
fn place_in_world(camera: &PageCamera) -> (DVec3, DMat3) {
    let world_from_camera = camera.rotation.transpose();
    (-(world_from_camera * camera.translation), world_from_camera)
}

/// World axes by the one that points up most.
fn upright(up: DVec3) -> ViewCoordinates {
    let [x, y, z] = up.abs().to_array();
    if x > y && x > z {
        return if up.x > 0.0 {
            ViewCoordinates::RIGHT_HAND_X_UP()
        } else {
            ViewCoordinates::RIGHT_HAND_X_DOWN()
        };
    }
    if y > z {
        return if up.y > 0.0 {
            ViewCoordinates::RIGHT_HAND_Y_UP()
        } else {
            ViewCoordinates::RIGHT_HAND_Y_DOWN()
        };
    }
    if up.z > 0.0 { ViewCoordinates::RIGHT_HAND_Z_UP() } else { ViewCoordinates::RIGHT_HAND_Z_DOWN() }
}

fn point(at: DVec3) -> [f32; 3] {
    at.as_vec3().to_array()
}

fn colour([red, green, blue]: [u8; 3]) -> Color {
    Color::from_rgb(red, green, blue)
}

/// One part of a path, whatever a user called it.
fn part(name: &str) -> EntityPath {
    EntityPath::from(vec![EntityPathPart::new(name)])
}

fn camera_path(camera: &PageCamera) -> EntityPath {
    EntityPath::from("world/cameras").join(&part(&camera.name))
}

fn curve_path(page: &Page, curve: &Curve) -> EntityPath {
    EntityPath::from("curves").join(&part(&curve.group)).join(&part(&curve_name(page, curve)))
}

fn curve_name(page: &Page, curve: &Curve) -> String {
    match curve.camera.and_then(|camera| page.cameras.get(camera)) {
        Some(camera) if camera.name != curve.label => format!("{} {}", curve.label, camera.name),
        _ => curve.label.clone(),
    }
}

#[cfg(test)]
mod tests;
