//! A motion filmed: the clothed figure in the furnished room before cameras in a ring, as a take with pictures or masks, and the truth.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

use backlit_formats::export::{TrackExport, track_json};
use backlit_formats::{FileError, atomic, calibration, images, model_file, pose_file};
use backlit_tracking::body::{Kinematics, Model, Pose, builtin, joint_at_end};
use backlit_tracking::camera::{Camera, CameraError, Rig, RigError};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::silhouette::{Label, Mask, MaskError};
use backlit_tracking::track::{FrameEstimate, Track};
use glam::DVec3;
use image::{DynamicImage, RgbImage};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use thiserror::Error;

use super::masks::{noisy, silhouette, widened};
use super::{Build, Figure, Plate, Room, Sensor, studio};

/// Pictures of the empty room, of which the background is learnt.
const PLATES: usize = 8;
/// Height of the cameras, and of what they look at, metres.
const CAMERA_M: f64 = 1.7;
const TARGET_M: f64 = 0.95;
/// Half of the height that the pictures show, and the room beside the joints, metres.
const TALL_M: f64 = 1.15;
const BESIDE_M: f64 = 0.3;
/// Nearest that a camera stands, metres.
const NEAREST_M: f64 = 3.0;
/// Focal length over the picture's shorter side.
const FOCAL: f64 = 1.1;

/// What a camera films.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Filmed {
    /// Pictures of the room, of which masks are still to be made.
    Pictures,
    /// Masks.
    Masks,
}

/// How a motion is filmed.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmOptions {
    /// The take's name.
    pub name: String,
    /// Cameras in the ring, at least 1.
    pub cameras: usize,
    /// Size of the pictures.
    pub size_px: [u64; 2],
    /// Frames a second.
    pub frame_rate: f64,
    /// Pictures or masks.
    pub filmed: Filmed,
    /// The clothes.
    pub build: Build,
    /// The sensor; its noise is in the pictures.
    pub sensor: Sensor,
    /// Shadows on the floor and the figure, which take most of the time.
    pub shadows: bool,
    /// Pixels by which masks are too wide all round.
    pub wide_px: f64,
    /// Share of the pixels at the masks' edges that are wrong, 0 to 1.
    pub mask_noise: f64,
    /// Columns in each picture that hide what is behind them, as a share of its width, 0 to 0.9: masks are unknown there.
    pub occluder: f64,
    /// Seed of all noise.
    pub seed: u64,
}

/// What can go wrong.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum FilmError {
    #[error("the body has no limbs of the built-in full body, of which the clothed figure is made")]
    Figure,
    #[error("there is no pose to film")]
    Empty,
    #[error(transparent)]
    Camera(#[from] CameraError),
    #[error(transparent)]
    Rig(#[from] RigError),
    #[error(transparent)]
    Mask(#[from] MaskError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{path}: {error}")]
    Folder { path: String, error: std::io::Error },
    #[error("stopped")]
    Cancelled,
}

/// Where a motion takes place: a middle, and how far joints come from the upright line through it, metres, z up.
#[derive(Debug, Clone, Copy)]
pub struct Extent {
    middle: DVec3,
    reach: f64,
}

impl Extent {
    /// Of all joints of these poses.
    pub fn of(model: &Model, poses: &BTreeMap<usize, Pose>) -> Self {
        let ends = poses.values().flat_map(|pose| Kinematics::new(model, pose).ends().to_vec());
        let ends: Vec<DVec3> = ends.collect();
        let corners = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [low, high] = ends.iter().fold(corners, |[low, high], end| [low.min(*end), high.max(*end)]);
        let middle = (low + high) / 2.0;
        let reach = ends.iter().map(|end| (end - middle).truncate().length()).fold(0.0, f64::max);
        Self { middle, reach }
    }
}

/// Cameras in a ring that see all of a motion.
///
/// # Errors
/// A size that no camera can have.
pub fn ring(count: usize, size_px: [u64; 2], motion: Extent) -> Result<Vec<Arc<Camera>>, CameraError> {
    let centre = motion.middle.with_z(TARGET_M);
    let half = motion.reach + BESIDE_M;
    let [width, height] = size_px.map(|side| side as f64);
    let focal = FOCAL * width.min(height);
    // All of the ground that is walked on fits into the picture, and at its nearest end the body from head to foot.
    let across = (half.powi(2) + (2.0 * focal * half / width).powi(2)).sqrt();
    let tall = focal * 2.0 * TALL_M / height + motion.reach;
    let away = across.max(tall).max(NEAREST_M);
    let place = |index: usize| {
        let (sine, cosine) = (std::f64::consts::TAU * (index as f64 + 0.25) / count as f64).sin_cos();
        let from = centre + DVec3::new(away * cosine, away * sine, CAMERA_M - TARGET_M);
        studio::pinhole(&format!("cam{:02}", index + 1), size_px, focal, [from, centre], DVec3::Z)
    };
    (0..count).map(place).collect()
}

/// Writes the take of a motion into a folder that is there: `cameras.json`, a picture or mask a camera and frame, `plates` of the empty
/// room, `take.toml` with the true start, `truth.csv` with the true joints as its reference, and `truth/track.json` to compare with.
/// `tell` hears how many frames are written. Returns the share of the person that the occluder hides, over all frames by camera.
///
/// # Errors
/// A body or poses that cannot be filmed, what cannot be written, or `cancel`.
pub fn write(
    folder: &Path,
    model: &Model,
    poses: &BTreeMap<usize, Pose>,
    options: &FilmOptions,
    cancel: &CancelToken,
    mut tell: impl FnMut(usize),
) -> Result<Vec<f64>, FilmError> {
    let first = poses.values().next().ok_or(FilmError::Empty)?;
    let cameras = ring(options.cameras, options.size_px, Extent::of(model, poses))?;
    let rig = Rig::new(cameras.iter().map(|camera| (**camera).clone()).collect())?;
    calibration::backlit::write(&folder.join("cameras.json"), &rig)?;
    let digits = (poses.len().max(2) - 1).to_string().len();
    let film = Film { folder, model, rig: &rig, options, digits };
    let plates = film.empty_rooms()?;
    let mut covered = vec![Covered::default(); cameras.len()];
    for (number, pose) in poses.values().enumerate() {
        if cancel.is_cancelled() {
            return Err(FilmError::Cancelled);
        }
        let figure = Figure::new(model, pose, options.build).ok_or(FilmError::Figure)?;
        for (index, camera) in rig.cameras().iter().enumerate() {
            if options.occluder > 0.0 {
                covered[index].add(&silhouette(&figure, camera)?, film.hidden_columns());
            }
            match plates.get(index) {
                Some(plate) => film.picture(number, index, plate, &figure)?,
                None => film.mask(number, index, camera, &figure)?,
            }
        }
        tell(number + 1);
    }
    film.truth(poses, first)?;
    Ok(covered.into_iter().map(Covered::share).collect())
}

/// How many pixels of the person there are, and how many of them an occluder hides.
#[derive(Debug, Clone, Copy, Default)]
struct Covered {
    all: usize,
    hidden: usize,
}

impl Covered {
    fn add(&mut self, person: &Mask, columns: std::ops::Range<usize>) {
        let is_person = person.labels().iter().enumerate().filter(|(_, label)| **label == Label::Subject);
        for (pixel, _) in is_person {
            self.all += 1;
            self.hidden += usize::from(columns.contains(&(pixel % person.width())));
        }
    }

    fn share(self) -> f64 {
        self.hidden as f64 / self.all.max(1) as f64
    }
}

struct Film<'a> {
    folder: &'a Path,
    model: &'a Model,
    rig: &'a Rig,
    options: &'a FilmOptions,
    digits: usize,
}

impl Film<'_> {
    fn make_folder(&self, name: &str) -> Result<(), FilmError> {
        let path = self.folder.join(name);
        std::fs::create_dir_all(&path)
            .map_err(|error| FilmError::Folder { path: path.display().to_string(), error })
    }

    /// Draws the empty room before every camera, and writes some pictures of it; nothing where masks are filmed.
    fn empty_rooms(&self) -> Result<Vec<Plate>, FilmError> {
        for camera in self.rig.cameras() {
            self.make_folder(camera.name())?;
        }
        if self.options.filmed == Filmed::Masks {
            return Ok(Vec::new());
        }
        let room = Room::default();
        let mut plates = Vec::new();
        for (index, camera) in self.rig.cameras().iter().enumerate() {
            let folder = format!("plates/{}", camera.name());
            self.make_folder(&folder)?;
            let plate = Plate::new(&room, camera, 1);
            let empty = plate.empty();
            for number in 0..PLATES {
                let seed = self.seed(usize::MAX / 2 + number, index);
                let picture = self.hidden(self.options.sensor.expose(&empty, 1.0, seed));
                let path = self.folder.join(&folder).join(format!("{number}.png"));
                images::write_png(&path, &DynamicImage::ImageRgb8(picture))?;
            }
            plates.push(plate);
        }
        Ok(plates)
    }

    fn seed(&self, frame: usize, camera: usize) -> u64 {
        self.options.seed.wrapping_add((frame as u64).wrapping_mul(1 << 16)).wrapping_add(camera as u64)
    }

    fn path(&self, frame: usize, camera: usize) -> std::path::PathBuf {
        let (name, digits) = (self.rig.cameras()[camera].name(), self.digits);
        self.folder.join(name).join(format!("{frame:0digits$}.png"))
    }

    /// The columns that an occluder hides.
    fn hidden_columns(&self) -> std::ops::Range<usize> {
        let width = self.options.size_px[0] as usize;
        let hidden = (self.options.occluder * width as f64) as usize;
        let from = (width - hidden) / 2;
        from..from + hidden
    }

    /// A picture behind the occluder, which is a grey post.
    fn hidden(&self, mut picture: RgbImage) -> RgbImage {
        for x in self.hidden_columns() {
            for y in 0..picture.height() {
                picture.put_pixel(x as u32, y, image::Rgb([96, 92, 88]));
            }
        }
        picture
    }

    fn picture(&self, frame: usize, camera: usize, plate: &Plate, figure: &Figure) -> Result<(), FilmError> {
        let light = if self.options.shadows {
            plate.with_figure(figure, 1)
        } else {
            plate.with_unshaded_figure(figure, |_, _| true)?.0
        };
        let exposed = self.options.sensor.expose(&light, 1.0, self.seed(frame, camera));
        Ok(images::write_png(&self.path(frame, camera), &DynamicImage::ImageRgb8(self.hidden(exposed)))?)
    }

    fn mask(&self, frame: usize, index: usize, camera: &Camera, figure: &Figure) -> Result<(), FilmError> {
        let mut mask: Mask = silhouette(figure, camera)?;
        if self.options.wide_px > 0.0 {
            mask = widened(mask, self.options.wide_px)?;
        }
        if self.options.mask_noise > 0.0 {
            let mut random = Pcg64Mcg::seed_from_u64(self.seed(frame, index));
            mask = noisy(&mask, self.options.mask_noise, 0.0, &mut random);
        }
        let (width, hidden) = (mask.width(), self.hidden_columns());
        if !hidden.is_empty() {
            let labels = mask.labels().iter().enumerate();
            let label = |(pixel, label): (usize, &Label)| {
                if hidden.contains(&(pixel % width)) { Label::Unknown } else { *label }
            };
            mask = Mask::new(width, mask.height(), labels.map(label).collect())?;
        }
        Ok(images::write_png(&self.path(frame, index), &DynamicImage::ImageLuma8(mask.to_gray()))?)
    }

    /// The take's file, and the truth.
    fn truth(&self, poses: &BTreeMap<usize, Pose>, first: &Pose) -> Result<(), FilmError> {
        let Self { folder, model, options, digits, .. } = *self;
        atomic::write(&folder.join("start.json"), pose_file::to_text(model, first).as_bytes())?;
        let body = if builtin::of_name(model.name()).is_some_and(|own| own == *model) {
            // The built-in bodies are named by words; a take names them with `_` between.
            model.name().replace(' ', "_")
        } else {
            atomic::write(&folder.join("body.toml"), model_file::to_text(model).as_bytes())?;
            "body.toml".to_owned()
        };
        let mut table = "frame,joint,x,y,z\n".to_owned();
        let mut frames = BTreeMap::new();
        for (number, pose) in poses.values().enumerate() {
            let ends = Kinematics::new(model, pose);
            for (limb, end) in model.limbs().iter().zip(ends.ends()) {
                if joint_at_end(&limb.name).is_some() {
                    let _ = writeln!(table, "{number},{},{},{},{}", limb.name, end.x, end.y, end.z);
                }
            }
            frames.insert(number, FrameEstimate::of_pose(number, pose.clone()));
        }
        atomic::write(&folder.join("truth.csv"), table.as_bytes())?;
        self.make_folder("truth")?;
        let track = Track { frames };
        let export = TrackExport {
            name: &options.name,
            frame_rate: options.frame_rate,
            model,
            cameras: &[],
            track: &track,
        };
        atomic::write(&folder.join("truth/track.json"), track_json::to_text(&export).as_bytes())?;
        if body == "body.toml" {
            atomic::write(&folder.join("truth/body.toml"), model_file::to_text(model).as_bytes())?;
        }
        let mut text = format!(
            "format = \"backlit-take 1\"\nname = {:?}\nframe_rate = {}\nmodel = \"{body}\"\nstart = \"start.json\"\n\n\
             [reference]\nkeypoints = \"truth.csv\"\n\n[cameras]\ncalibration = \"cameras.json\"\n",
            options.name, options.frame_rate
        );
        for camera in self.rig.cameras() {
            let (name, kind) =
                (camera.name(), if options.filmed == Filmed::Masks { "masks" } else { "frames" });
            let _ = write!(text, "\n[[camera]]\nname = \"{name}\"\n{kind} = \"{name}/%0{digits}d.png\"\n");
            if options.filmed == Filmed::Pictures {
                let _ = writeln!(text, "background = \"plates/{name}/%d.png\"");
            }
        }
        Ok(atomic::write(&folder.join("take.toml"), text.as_bytes())?)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::synthetic::motion;

    /// The person is wholly in every picture, wherever they walk.
    #[test]
    fn cameras_in_a_ring_see_all_of_a_motion() {
        let model = builtin::full_body();
        for (count, size_px, walk) in [(1, [320, 240], 0.0), (4, [240, 320], 2.0), (7, [640, 360], 5.0)] {
            let mut poses = BTreeMap::new();
            for frame in 0..8 {
                let mut pose = motion::pose(&model, 5.0 * frame as f64);
                pose.root.x += walk * frame as f64 / 7.0 + 10.0;
                poses.insert(frame, pose);
            }
            let cameras = ring(count, size_px, Extent::of(&model, &poses)).unwrap();
            assert_eq!(cameras.len(), count);
            for pose in poses.values() {
                for end in Kinematics::new(&model, pose).ends() {
                    for camera in &cameras {
                        let pixel = camera.project(*end).unwrap();
                        let size = DVec2::new(camera.width() as f64, camera.height() as f64);
                        let is_inside = pixel.cmpge(DVec2::ZERO).all() && pixel.cmplt(size).all();
                        assert!(is_inside, "{} {pixel}", camera.name());
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_filmed_is_a_take_with_its_truth() {
        let model = builtin::full_body();
        let poses: BTreeMap<usize, Pose> =
            (0..3).map(|frame| (frame, motion::pose(&model, frame as f64))).collect();
        let mut options = FilmOptions {
            name: "a \"motion\"".to_owned(),
            cameras: 2,
            size_px: [64, 96],
            frame_rate: 30.0,
            filmed: Filmed::Masks,
            build: Build::default(),
            sensor: Sensor::default(),
            shadows: false,
            wide_px: 1.0,
            mask_noise: 0.1,
            occluder: 0.2,
            seed: 1,
        };
        for filmed in [Filmed::Masks, Filmed::Pictures] {
            options.filmed = filmed;
            let folder = tempfile::tempdir().unwrap();
            let mut told = Vec::new();
            let never = CancelToken::default();
            let hidden =
                write(folder.path(), &model, &poses, &options, &never, |count| told.push(count)).unwrap();
            assert_eq!(told, [1, 2, 3]);
            // A fifth of the picture's columns are in the middle, where the person is.
            assert!(hidden.len() == 2 && hidden.iter().all(|share| (0.2..1.0).contains(share)), "{hidden:?}");
            let take = backlit_formats::Take::open(folder.path()).unwrap();
            assert_eq!((take.name(), take.frame_count()), ("a \"motion\"", 3));
            let reference = take.reference().unwrap().joints(2);
            assert!(reference.len() >= 12, "{}", reference.len());
            let truth = Kinematics::new(&model, &poses[&2]);
            for (limb, place) in reference {
                assert!(truth.ends()[limb.unwrap()].distance(place) < 1e-9);
            }
        }
        let never = CancelToken::default();
        let empty = write(Path::new("nowhere"), &model, &BTreeMap::new(), &options, &never, |_| ());
        assert!(matches!(empty, Err(FilmError::Empty)));
    }
}
