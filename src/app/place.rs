//! A place in a take that is gone to as soon as it is open.

use backlit_document::Document;
use backlit_words::joint::{JointId, joint_name};

use crate::session::selection::Selection;

/// A frame, and if wanted a camera and a joint.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Place {
    /// The frame, counted from 0.
    pub frame: usize,
    /// The camera: its name, or its number from 1 as on its badge.
    pub camera: Option<String>,
    /// The joint: what people call it, or the limb that ends there.
    pub joint: Option<String>,
}

impl Place {
    /// Selects it in a take that has this number of `frames`.
    ///
    /// # Errors
    /// There is no such frame, camera or joint: a sentence that says what there is. What is there of the place is selected.
    pub(crate) fn select(
        &self,
        document: &Document,
        frames: usize,
        selection: &mut Selection,
    ) -> Result<(), String> {
        let mut problems = Vec::new();
        selection.frame = self.frame.min(frames.saturating_sub(1));
        if self.frame >= frames {
            problems.push(format!("There is no frame {}; the take has {frames}.", self.frame));
        }
        if let Some(wanted) = &self.camera {
            let number = wanted.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
            let named = document.cameras.iter().position(|camera| camera.name == *wanted);
            match named.or(number.filter(|&camera| camera < document.cameras.len())) {
                Some(camera) => selection.camera = camera,
                None => {
                    let names: Vec<&str> = document.cameras.iter().map(|one| one.name.as_str()).collect();
                    problems.push(format!("There is no camera {wanted}; there are {}.", names.join(", ")));
                }
            }
        }
        if let Some(wanted) = &self.joint {
            let limbs = document.model.limbs();
            let all = || std::iter::once(JointId::Root).chain((0..limbs.len()).map(JointId::End));
            let name = |joint: JointId| joint_name(&document.model, joint);
            let of_limb = || document.model.limb_index(wanted).map(JointId::End);
            match all().find(|&joint| name(joint) == *wanted).or_else(of_limb) {
                Some(joint) => selection.joint = joint,
                None => {
                    let names: Vec<String> = all().map(name).collect();
                    problems.push(format!("There is no joint {wanted}; there are {}.", names.join(", ")));
                }
            }
        }
        if problems.is_empty() { Ok(()) } else { Err(problems.join(" ")) }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use backlit_document::CameraUse;
    use backlit_tracking::body::builtin;

    use super::*;

    #[test]
    fn a_place_is_selected_by_the_names_that_people_use() {
        let mut document = Document::new(builtin::full_body());
        let camera = |name: &str| CameraUse { name: name.to_owned(), used: true, weight: 1.0 };
        document.cameras = Arc::new(vec![camera("front"), camera("side")]);
        let select = |camera: Option<&str>, joint: Option<&str>, frame: usize| {
            let [camera, joint] = [camera, joint].map(|name| name.map(str::to_owned));
            let mut selection = Selection::default();
            let said = Place { frame, camera, joint }.select(&document, 60, &mut selection);
            ((selection.frame, selection.camera, selection.joint), said)
        };
        let elbow = JointId::End(document.model.limb_index("left upper arm").unwrap());
        assert_eq!(select(Some("side"), Some("left elbow"), 42), ((42, 1, elbow), Ok(())));
        assert_eq!(select(Some("2"), Some("left upper arm"), 0), ((0, 1, elbow), Ok(())));
        let (at, said) = select(Some("back"), Some("tail"), 99);
        assert_eq!((at.0, at.1), (59, 0));
        let said = said.unwrap_err();
        for part in [
            "no frame 99; the take has 60",
            "no camera back; there are front, side",
            "no joint tail",
            "left elbow",
        ] {
            assert!(said.contains(part), "{said}");
        }
    }
}
