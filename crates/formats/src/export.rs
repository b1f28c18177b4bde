//! Tracks for other programs (see `docs/formats.md`).

use std::path::Path;

use backlit_tracking::body::Model;
use backlit_tracking::optimize::Termination;
use backlit_tracking::track::Track;

use super::Result;
use super::atomic::{self, Fill};

pub mod resume_file;
pub mod tables;
pub mod track_json;
pub mod track_read;
pub mod trust_record;

/// A track and what its numbers belong to. The poses must be of the model.
#[derive(Debug, Clone, Copy)]
pub struct TrackExport<'a> {
    /// What the recording is called.
    pub name: &'a str,
    /// Frames per second.
    pub frame_rate: f64,
    /// The body.
    pub model: &'a Model,
    /// The cameras' names, in the order of the estimates' overlaps.
    pub cameras: &'a [&'a str],
    /// The estimates.
    pub track: &'a Track,
}

/// Why the fit of a frame ended, in words for people: tables, the window and the command line say the same.
#[must_use]
pub fn ending_text(why: Termination) -> String {
    match why {
        Termination::NoGradient => "no pixel pulls the model".to_owned(),
        Termination::Cancelled => "stopped by you".to_owned(),
        why => why.to_string(),
    }
}

/// The ending that these are the words of.
fn ending_of_text(text: &str) -> Option<Termination> {
    use Termination as E;
    let number = text.split_whitespace().find_map(|word| word.parse::<f64>().ok());
    let with_number = number.map(|tolerance| {
        let steps = tolerance as usize;
        let gradient = E::ConvergedByGradient { tolerance };
        [E::ConvergedByGain { tolerance }, E::ConvergedByStep { tolerance }, gradient, E::StepLimit { steps }]
    });
    let plain = [E::NoDecrease, E::NoGradient, E::Cancelled, E::NotFinite];
    plain.into_iter().chain(with_number.into_iter().flatten()).find(|&why| ending_text(why) == text)
}

/// Writes `track.json`, `poses.csv`, `joints.csv` and `frames.csv` and these other files into a folder: all of them, or none.
pub fn write(folder: &Path, export: &TrackExport<'_>, others: &[(&str, &[u8])]) -> Result<()> {
    let track = track_json::to_text(export);
    let mut files: Vec<(&str, Fill<'_>)> = vec![
        ("track.json", Box::new(|out| out.write_all(track.as_bytes()))),
        ("poses.csv", Box::new(|out| tables::write_poses(out, export))),
        ("joints.csv", Box::new(|out| tables::write_joints(out, export))),
        ("frames.csv", Box::new(|out| tables::write_frames(out, export))),
    ];
    for &(name, bytes) in others {
        files.push((name, Box::new(move |out| out.write_all(bytes))));
    }
    atomic::write_all(folder, files)
}

/// The word for the root where a limb's name stands for its second joint.
pub(super) const ROOT: &str = "root";

#[cfg(test)]
pub(super) mod tests {
    use backlit_tracking::belief::{LimbTrust, Reason};
    use backlit_tracking::body::{Parameters, Pose, builtin};
    use backlit_tracking::optimize::Termination;
    use backlit_tracking::silhouette::Overlap;
    use backlit_tracking::track::{FrameEstimate, Track};

    /// Two frames of one limb; the second is lost and has no numbers.
    pub(crate) fn sample() -> Track {
        let model = builtin::single_limb();
        let rest = Pose::rest(&model);
        let moved = rest.retract(Parameters::Tangent, &[0.1, -2.0, 3.0, 0.0, 0.0, 0.5]);
        let overlap = Overlap { agreement: 3, missing: 1, ..Overlap::default() };
        let first = FrameEstimate {
            cost: Some(1234.5),
            rms: Some(2.25),
            overlap: vec![Some(overlap), None],
            iterations: 7,
            termination: Some(Termination::NoDecrease),
            trust: vec![LimbTrust::new(0, 0.3, [0.08, 0.4], Reason::Spurious)],
            ..FrameEstimate::of_pose(4, moved)
        };
        let second = FrameEstimate {
            overlap: vec![None, None],
            lost_because: Some(backlit_tracking::track::Lost::Nobody),
            ..FrameEstimate::of_pose(6, rest)
        };
        Track { frames: [(4, first), (6, second)].into() }
    }

    #[test]
    fn every_ending_is_known_by_its_words() {
        use Termination as E;
        let tolerance = 2.5e-7;
        for why in [
            E::ConvergedByGain { tolerance },
            E::ConvergedByStep { tolerance },
            E::ConvergedByGradient { tolerance },
            E::StepLimit { steps: 1 },
            E::StepLimit { steps: 40 },
            E::NoDecrease,
            E::NoGradient,
            E::Cancelled,
            E::NotFinite,
        ] {
            assert_eq!(super::ending_of_text(&super::ending_text(why)), Some(why));
        }
        assert_eq!(super::ending_of_text("no idea"), None);
    }
}
