//! A motion as a take without footage: cameras in a ring see the body's silhouette, which is drawn when it is asked for.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use backlit_formats::recording::RecordingOptions;
use backlit_formats::{
    FileError, FileProblem, MemoryFiles, Take, TakeFiles, calibration, model_file, pose_file,
};
use backlit_lab::synthetic::capsules;
use backlit_lab::synthetic::take::{Extent, ring};
use backlit_tracking::body::{Model, Pose, builtin};
use backlit_tracking::camera::{Camera, Rig};
use image::{GrayImage, ImageFormat, Luma};

use super::{FollowOptions, follow_recording};
use crate::demonstration::joints_of;

/// How many cameras see it, and the size of what they see.
const CAMERAS: usize = 4;
const SIZE_PX: [u64; 2] = [480, 480];

/// Opens a recording as a take without footage, whose poses are the motion on the built-in body.
///
/// # Errors
/// As [`follow_recording`].
pub fn open(path: &Path, tell: &mut dyn FnMut(usize, usize)) -> anyhow::Result<Take> {
    let (model, reading) = (builtin::full_body(), RecordingOptions::default());
    let motion = follow_recording(path, &reading, &model, FollowOptions::default(), tell)?;
    let poses = Arc::new(motion.poses);
    let (Some((_, start)), Some((last, _))) = (poses.first_key_value(), poses.last_key_value()) else {
        anyhow::bail!("{}: expected a frame", path.display());
    };
    let cameras = ring(CAMERAS, SIZE_PX, Extent::of(&model, &poses))?;
    let rig = Rig::new(cameras.iter().map(|camera| (**camera).clone()).collect())?;
    let mut toml = format!(
        "format = \"backlit-take 1\"\nname = \"{}\"\nframe_rate = {:?}\nmodel = \"body.toml\"\nstart = \"start.json\"\n\
         [cameras]\ncalibration = \"cameras.json\"\n[reference]\nkeypoints = \"joints.csv\"\n",
        plain(&motion.name),
        motion.frame_rate
    );
    for camera in &cameras {
        let name = camera.name();
        toml += &format!("[[camera]]\nname = \"{name}\"\nmasks = \"{name}/%d.png\"\n");
    }
    let texts = [
        ("take.toml", toml),
        ("body.toml", model_file::to_text(&model)),
        ("start.json", pose_file::to_text(&model, start)),
        ("cameras.json", calibration::backlit::to_text(&rig)),
        ("joints.csv", joints_of(&model, poses.iter().map(|(frame, pose)| (*frame, pose)))),
    ];
    let texts = MemoryFiles::new(texts.map(|(name, text)| (name, text.into_bytes())));
    let count = last + 1;
    let files = DrawnFiles { texts, model, poses: poses.clone(), count, cameras };
    Ok(Take::from_files(Arc::new(files), Path::new("take.toml"))?.with_poses(poses))
}

/// A name that a take may have.
fn plain(name: &str) -> String {
    let plain = |letter: char| if letter.is_alphanumeric() || " -_.".contains(letter) { letter } else { '_' };
    let name: String = name.chars().map(plain).collect();
    if name.trim().is_empty() { "motion".to_owned() } else { name }
}

/// The files of a take whose masks are drawn when they are read.
#[derive(Debug)]
struct DrawnFiles {
    texts: MemoryFiles,
    model: Model,
    poses: Arc<BTreeMap<usize, Pose>>,
    count: usize,
    cameras: Vec<Arc<Camera>>,
}

impl DrawnFiles {
    /// Camera and frame of a mask.
    fn mask(&self, path: &Path) -> Option<(&Camera, usize)> {
        let camera = self.cameras.iter().find(|camera| path.parent() == Some(Path::new(camera.name())))?;
        let frame = path.file_stem()?.to_str()?.parse().ok()?;
        (frame < self.count).then_some((camera, frame))
    }

    /// Nobody is in the picture of a frame without a pose.
    fn draw(&self, camera: &Camera, frame: usize) -> anyhow::Result<Vec<u8>> {
        let picture = match self.poses.get(&frame) {
            Some(pose) => capsules::hard_mask(&self.model, pose, camera)?.to_gray(),
            None => GrayImage::from_pixel(camera.width() as u32, camera.height() as u32, Luma([0])),
        };
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, ImageFormat::Png)?;
        Ok(bytes.into_inner())
    }
}

impl TakeFiles for DrawnFiles {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
        let Some((camera, frame)) = self.mask(path) else { return self.texts.read(path, limit) };
        self.draw(camera, frame)
            .map_err(|why| FileError::new(path, FileProblem::Read { error: std::io::Error::other(why) }))
    }

    fn exists(&self, path: &Path) -> bool {
        self.mask(path).is_some() || self.texts.exists(path)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use backlit_tracking::body::{Kinematics, joint_names};
    use backlit_tracking::silhouette::Label;

    use super::*;
    use crate::motion::is_motion;

    /// A man who bends, in millimetres and y up, with a frame in which nobody was there.
    fn bends() -> tempfile::NamedTempFile {
        let model = builtin::full_body();
        let mut file = tempfile::Builder::new().suffix(".csv").tempfile().unwrap();
        writeln!(file, "frame,time,joint,x,y,z").unwrap();
        for frame in (0..12).filter(|frame| *frame != 5) {
            let mut pose = Pose::rest(&model);
            pose.rotations[0] = glam::DQuat::from_rotation_x(0.05 * f64::from(frame)) * pose.rotations[0];
            let ends = Kinematics::new(&model, &pose).ends().to_vec();
            for (name, end) in joint_names(&model).iter().zip(ends) {
                writeln!(file, "{frame},{},{name},{},{},{}", f64::from(frame) / 25.0, end.x, end.z, -end.y)
                    .unwrap();
            }
        }
        file
    }

    #[test]
    fn a_motion_is_a_take_whose_cameras_see_the_body() {
        let file = bends();
        let mut told = Vec::new();
        let take = open(file.path(), &mut |done, count| told.push((done, count))).unwrap();
        assert_eq!((take.rig().count(), take.frame_count(), take.frame_rate()), (4, 12, 25.0));
        assert_eq!((told.first(), told.last()), (Some(&(0, 12)), Some(&(11, 12))));
        assert!(take.footage()[0].is_masks_alone() && take.reference().is_some());
        for (frame, pose) in take.poses().iter() {
            let expected = capsules::hard_mask(take.model(), pose, &take.rig().cameras()[1]).unwrap();
            let picture = take.frame(1, *frame).unwrap();
            let white = picture.pixels().filter(|pixel| pixel.0 == [255; 3]).count();
            assert_eq!(white, expected.count(Label::Subject), "frame {frame}");
            assert!(white > 5000, "frame {frame}: {white} pixels");
        }
    }

    #[test]
    fn what_is_no_motion_is_told_with_its_file() {
        let mut file = tempfile::Builder::new().suffix(".bvh").tempfile().unwrap();
        writeln!(file, "HIERARCHY?").unwrap();
        let error = open(file.path(), &mut |_, _| {}).unwrap_err();
        assert!(format!("{error:#}").contains(&file.path().display().to_string()), "{error:#}");
        let far = std::fs::read_to_string(bends().path()).unwrap().replace("11,0.44,", "11,4e12,");
        let mut long = tempfile::Builder::new().suffix(".csv").tempfile().unwrap();
        write!(long, "{far}").unwrap();
        let error = format!("{:#}", open(long.path(), &mut |_, _| {}).unwrap_err());
        assert!(error.contains("expected at most 1000000"), "{error}");
        assert_eq!(plain("a \"b\"/c\n"), "a _b__c_");
        let folder = tempfile::Builder::new().suffix(".trc").tempdir().unwrap();
        assert!(is_motion(file.path()) && !is_motion(folder.path()));
    }
}
