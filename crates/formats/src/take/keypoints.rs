//! One camera's two-dimensional keypoints of another tool, a file a frame.

use std::collections::BTreeMap;
use std::path::PathBuf;

use backlit_tracking::body_fit::survey::spread_numbers;
use backlit_tracking::camera::Camera;
use backlit_tracking::cues::JointKeypoint;
use backlit_tracking::metrics::ReferenceJoints;
use glam::DVec2;
use toml::Spanned;

use super::reader::TakeReader;
use super::spec::ViewSpec;
use super::{CameraFootage, FramePattern, Take, TakeError};
use crate::keypoints::joints::{KeypointOrder, LOWEST_SCORE, body_of, cues_of, joint_pixels, joints_of};
use crate::keypoints::{self, Person, tallest};
use crate::{MAX_TEXT_BYTES, Result};

/// Frames whose keypoints are looked at to tell their order.
const MOST_LOOKED_AT: usize = 12;

/// Where one camera's keypoints are.
#[derive(Debug, Clone)]
pub(super) struct CameraKeypoints {
    folder: PathBuf,
    pattern: FramePattern,
    /// A frame of the camera's own number, and the number of its file.
    first: [u64; 2],
}

impl CameraKeypoints {
    fn path(&self, frame: u64) -> PathBuf {
        let number = frame.saturating_sub(self.first[0]).saturating_add(self.first[1]);
        self.pattern.path(&self.folder, number)
    }
}

impl TakeReader<'_> {
    pub(super) fn keypoints(&self, view: &ViewSpec) -> Result<Option<CameraKeypoints>> {
        let pattern = |keypoints: &Spanned<String>| self.pattern(keypoints, "camera.keypoints");
        let Some(pattern) = view.keypoints.as_ref().map(pattern).transpose()? else { return Ok(None) };
        let first = [view.first, view.keypoints_first.unwrap_or(view.first)];
        Ok(Some(CameraKeypoints { folder: self.footage.clone(), pattern, first }))
    }
}

impl CameraFootage {
    /// The file of a frame's keypoints, counted from 0 at the take's start, if the camera has keypoints.
    #[must_use]
    pub fn keypoint_path(&self, frame: usize) -> Option<PathBuf> {
        self.keypoints.as_ref().map(|keypoints| keypoints.path(self.number(frame)))
    }
}

impl Take {
    /// The people whose keypoints a camera's frame (counted from 0) has, in pixels of the picture on the disk. None where the
    /// camera has no keypoints, or this frame no file.
    pub fn people(&self, camera: usize, frame: usize) -> Result<Vec<Person>, TakeError> {
        let footage = self.footage_of(camera)?;
        let Some(path) = footage.keypoint_path(frame).filter(|path| self.files.exists(path)) else {
            return Ok(Vec::new());
        };
        let people = self.files.read(&path, MAX_TEXT_BYTES);
        let people = people.and_then(|bytes| keypoints::parse(&path, &bytes));
        people.map_err(|error| TakeError::Frame { camera: footage.camera.clone(), frame, error })
    }

    /// In which order the keypoints of this take stand; `None` where they make no body in any of the frames that are looked at.
    pub fn keypoint_order(&self) -> Result<Option<KeypointOrder>, TakeError> {
        if let Some(order) = self.keypoint_order.get() {
            return Ok(*order);
        }
        let mut order = None;
        for frame in spread_numbers(self.frame_count, MOST_LOOKED_AT) {
            order = body_of(&self.subjects(frame)?).map(|body| body.order);
            if order.is_some() {
                break;
            }
        }
        Ok(*self.keypoint_order.get_or_init(|| order))
    }

    /// Whose keypoints count of those of a camera's frame: the one nearest to the person who is followed, else the tallest.
    fn subject<'a>(&self, people: &'a [Person], camera: &Camera, frame: usize) -> Option<&'a Person> {
        let Some(followed) = &self.person else { return tallest(people) };
        let middle = camera.project(followed.own.at(frame)?.bounds.centre())?;
        let off = |person: &&Person| {
            let places = person.iter().flatten().map(|keypoint| keypoint.place);
            let count = places.clone().count().max(1) as f64;
            (places.sum::<DVec2>() / count).distance(middle)
        };
        people
            .iter()
            .filter(|person| tallest(std::slice::from_ref(*person)).is_some())
            .min_by(|a, b| off(a).total_cmp(&off(b)))
    }

    /// The person of each camera in a frame whose keypoints count.
    fn subjects(&self, frame: usize) -> Result<Vec<(&Camera, Person)>, TakeError> {
        let mut people = Vec::new();
        for (index, camera) in self.full_rig.cameras().iter().enumerate() {
            let seen = self.people(index, frame)?;
            people.extend(self.subject(&seen, camera, frame).map(|person| (camera, person.clone())));
        }
        Ok(people)
    }

    /// The keypoints of a camera's frame as [cues](backlit_tracking::cues), in pixels of the `working` camera: of the person who
    /// is followed, else of the tallest.
    pub fn keypoint_cues(
        &self,
        camera: usize,
        frame: usize,
        working: &Camera,
    ) -> Result<Vec<JointKeypoint>, TakeError> {
        let cues = |person: &Person, order, full: &Camera| cues_of(&self.model, person, order, full, working);
        Ok(self.of_subject(camera, frame, cues)?.unwrap_or_default())
    }

    /// Where the `working` camera sees twelve joints of the person (shoulders, elbows, wrists, hips, knees, ankles) in a frame,
    /// pixels, as far as keypoints are sure of them. Empty where there are none.
    pub fn joint_pixels(
        &self,
        camera: usize,
        frame: usize,
        working: &Camera,
    ) -> Result<Vec<Option<DVec2>>, TakeError> {
        let pixels = |person: &Person, order, full: &Camera| {
            let sure = |seen: Option<(DVec2, f64)>| Some(seen.filter(|seen| seen.1 >= LOWEST_SCORE)?.0);
            joint_pixels(person, order, full, working).map(sure).to_vec()
        };
        Ok(self.of_subject(camera, frame, pixels)?.unwrap_or_default())
    }

    /// Calls `tell` with the person's keypoints in a camera's frame, their order and their camera; `None` without keypoints.
    fn of_subject<T>(
        &self,
        camera: usize,
        frame: usize,
        tell: impl FnOnce(&Person, KeypointOrder, &Camera) -> T,
    ) -> Result<Option<T>, TakeError> {
        let Some(order) = self.keypoint_order()? else { return Ok(None) };
        let people = self.people(camera, frame)?;
        let Some(full) = self.full_rig.cameras().get(camera) else { return Ok(None) };
        Ok(self.subject(&people, full, frame).map(|person| tell(person, order, full)))
    }

    /// The joints of the take's body that keypoints show in these frames, world metres; frames without any are left out.
    pub fn keypoint_joints(&self, frames: &[usize]) -> Result<BTreeMap<usize, ReferenceJoints>, TakeError> {
        let mut all = BTreeMap::new();
        let Some(order) = self.keypoint_order()? else { return Ok(all) };
        for &frame in frames {
            let joints = joints_of(&self.model, &self.subjects(frame)?, order);
            if !joints.is_empty() {
                all.insert(frame, joints);
            }
        }
        Ok(all)
    }
}
