//! A project and its take as it is now, which may be another than the one that the project was made about.

use std::collections::BTreeMap;
use std::sync::Arc;

use backlit_tracking::segment::SegmentOptions;
use thiserror::Error;

use crate::{CameraUse, Document};

/// Why a project is not about a take.
#[derive(Debug, Error, PartialEq, Eq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum MatchError {
    #[error(
        "the project is for the cameras {}; the take has {}. Open the take that the project was made from, or give \
         take.toml those cameras",
        project.join(", "),
        take.join(", ")
    )]
    Cameras { project: Vec<String>, take: Vec<String> },
}

/// Brings the cameras of a document into the order of the take's, and says what else there is to know: a sentence where
/// poses lie beyond the last frame. A document that names no cameras uses all of the take's.
pub fn match_take(
    document: &mut Document,
    names: &[&str],
    measurement: &[SegmentOptions],
    frames: usize,
) -> Result<Option<String>, MatchError> {
    if document.cameras.is_empty() {
        let camera = |name: &&str| CameraUse { name: (*name).to_owned(), used: true, weight: 1.0 };
        document.cameras = Arc::new(names.iter().map(camera).collect());
    }
    let places: Option<Vec<usize>> =
        names.iter().map(|name| document.cameras.iter().position(|camera| camera.name == *name)).collect();
    let Some(places) = places.filter(|places| places.len() == document.cameras.len()) else {
        return Err(MatchError::Cameras {
            project: document.cameras.iter().map(|camera| camera.name.clone()).collect(),
            take: names.iter().map(|name| (*name).to_owned()).collect(),
        });
    };
    let settings = |(camera, &place): (usize, &usize)| {
        let own = document.measurement.get(place).or_else(|| measurement.get(camera));
        own.cloned().unwrap_or_default()
    };
    document.measurement = Arc::new(places.iter().enumerate().map(settings).collect());
    if !places.is_sorted() {
        let moved = |files: &BTreeMap<usize, std::path::PathBuf>| {
            let at = |(camera, place)| Some((camera, files.get(place)?.clone()));
            places.iter().enumerate().filter_map(at).collect()
        };
        document.plates = Arc::new(moved(&document.plates));
        document.masks =
            Arc::new(document.masks.iter().map(|(frame, masks)| (*frame, moved(masks))).collect());
        let now = |before: usize| places.iter().position(|place| *place == before).unwrap_or(before);
        Arc::make_mut(&mut document.brush).iter_mut().for_each(|one| one.camera = now(one.camera));
        let marks = Arc::make_mut(&mut document.bookmarks).iter_mut();
        marks.for_each(|mark| mark.camera = mark.camera.map(now));
        Arc::make_mut(&mut document.changes).iter_mut().for_each(|one| one.camera = now(one.camera));
        document.cameras = Arc::new(places.iter().map(|&place| document.cameras[place].clone()).collect());
    }
    let last = document.keys.keys().chain(document.estimates.keys()).max();
    Ok(last.filter(|&&last| last >= frames).map(|last| {
        format!(
            "The take has only {frames} frames now. The project's poses up to frame {last} are kept; those beyond the \
             last frame are not shown."
        )
    }))
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use backlit_tracking::body::{Pose, builtin};

    use super::*;

    fn document(names: &[&str]) -> Document {
        let mut document = Document::new(builtin::single_limb());
        let weight = |index: usize| 1.0 + index as f64;
        let camera = |(index, name): (usize, &&str)| CameraUse {
            name: (*name).to_owned(),
            used: index > 0,
            weight: weight(index),
        };
        document.cameras = Arc::new(names.iter().enumerate().map(camera).collect());
        let settings = |index| SegmentOptions { opening_px: index, ..SegmentOptions::default() };
        document.measurement = Arc::new((0..names.len()).map(settings).collect());
        document.masks = Arc::new(BTreeMap::from([(3, BTreeMap::from([(0, PathBuf::from("a.png"))]))]));
        document.plates = Arc::new(BTreeMap::from([(2, PathBuf::from("empty.png"))]));
        document
    }

    #[test]
    fn cameras_in_another_order_keep_what_is_theirs() {
        let mut shuffled = document(&["a", "b", "c"]);
        assert_eq!(match_take(&mut shuffled, &["c", "a", "b"], &[], 9), Ok(None));
        let names: Vec<(&str, f64)> =
            shuffled.cameras.iter().map(|camera| (camera.name.as_str(), camera.weight)).collect();
        assert_eq!(names, [("c", 3.0), ("a", 1.0), ("b", 2.0)]);
        let settings: Vec<usize> = shuffled.measurement.iter().map(|options| options.opening_px).collect();
        assert_eq!(settings, [2, 0, 1]);
        assert_eq!(shuffled.masks[&3], BTreeMap::from([(1, PathBuf::from("a.png"))]));
        assert_eq!(*shuffled.plates, BTreeMap::from([(0, PathBuf::from("empty.png"))]));
        let mut same = document(&["a", "b", "c"]);
        match_take(&mut same, &["a", "b", "c"], &[], 9).unwrap();
        assert_eq!(same, document(&["a", "b", "c"]));
    }

    #[test]
    fn other_cameras_are_named() {
        for names in [&["a", "b"][..], &["a", "b", "c", "d"], &["a", "b", "x"]] {
            let message = match_take(&mut document(&["a", "b", "c"]), names, &[], 9).unwrap_err().to_string();
            assert!(message.contains("a, b, c") && message.contains(&names.join(", ")), "{message}");
        }
    }

    #[test]
    fn a_project_without_cameras_takes_all_as_the_take_says() {
        let mut document = document(&[]);
        document.masks = Arc::default();
        let measurement = [SegmentOptions { closing_px: 7, ..SegmentOptions::default() }];
        match_take(&mut document, &["a"], &measurement, 9).unwrap();
        assert!(document.cameras[0].used && document.measurement[0].closing_px == 7);
    }

    #[test]
    fn poses_beyond_the_last_frame_are_said() {
        let mut document = document(&["a"]);
        let pose = Pose::rest(&document.model);
        document.keys = Arc::new(BTreeMap::from([(40, pose)]));
        assert_eq!(match_take(&mut document, &["a"], &[], 41), Ok(None));
        let said = match_take(&mut document, &["a"], &[], 40).unwrap().unwrap();
        assert!(said.contains("only 40 frames") && said.contains("up to frame 40"), "{said}");
        assert!(document.keys.contains_key(&40));
    }
}
