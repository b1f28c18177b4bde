//! `backlit track --people N`: several people, one after the other, each by what the others' bodies do not explain.
//!
//! At first nobody's body is known: others are hidden by their parts of the hull, which are larger than they are. Then each is
//! tracked again, and of the others what their tracked bodies cover is hidden.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::Footage;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::people::{FollowedPerson, FoundBodies, KnownBody, PersonTrack};

use crate::output::{self, number, object};
use crate::person::{self, Begun};
use crate::table::Table;
use crate::track::{self, TrackArguments};
use crate::track_report::TrackReport;

/// Who is tracked, and where to.
pub(crate) struct Whom<'a> {
    /// What shows nobody else.
    pub(crate) footage: Arc<Footage>,
    /// At least one.
    pub(crate) frames: Vec<usize>,
    /// Where to begin, if that is known.
    pub(crate) start: Option<Pose>,
    /// What was found before an earlier track of the same person: the take's body has the sizes then.
    pub(crate) found: Option<Begun>,
    /// The folder of the results.
    pub(crate) out: &'a Path,
}

/// A person who was tracked.
struct TrackedPerson {
    report: TrackReport,
    model: Arc<Model>,
    out: PathBuf,
}

impl TrackedPerson {
    /// The body in all frames in which it was not lost.
    fn body(&self) -> KnownBody {
        let frames = self.report.track.frames.iter().filter(|(_, estimate)| !estimate.is_lost());
        let poses = frames.map(|(frame, estimate)| (*frame, estimate.pose.clone())).collect();
        KnownBody { model: Arc::clone(&self.model), poses }
    }
}

/// Tracks this number of people, writes the files of each, and prints a row a person.
pub(crate) fn run(arguments: &TrackArguments, count: usize, cancel: &CancelToken) -> anyhow::Result<()> {
    let footage = track::open(arguments, None)?;
    let frames = arguments.part.frames(footage.take())?;
    let cameras = arguments.part.cameras(footage.take())?;
    let found = person::in_view("--people", &footage, (&cameras, &frames), cancel)?;
    if found.len() < count {
        return Err(person::nobody(&format!("--people {count}"), &found));
    }
    let footage = arguments.relearn.learn(footage, (&cameras, &frames), cancel)?;
    let start = arguments.start.known_pose(footage.take(), frames[0])?;
    let of_start = start.as_ref().and_then(|start| nearest(&found, frames[0], start));
    let mut all = Vec::new();
    for (index, own) in found.iter().enumerate().take(count) {
        output::complain(&person::place_text(index + 1, own));
        let followed = FollowedPerson::of(&found, index).map(Arc::new);
        let whom = Whom {
            footage: Arc::new(footage.with_person(followed)),
            frames: while_in_view(own, &frames),
            start: start.clone().filter(|_| of_start == Some(index)),
            found: None,
            out: &arguments.out.join(format!("person-{}", index + 1)),
        };
        let out = whom.out.to_owned();
        let (report, model) = track::track(arguments, whom, None, cancel)?;
        all.push(TrackedPerson { report, model, out });
    }
    let bodies: Vec<KnownBody> = all.iter().map(TrackedPerson::body).collect();
    for (index, tracked) in all.iter_mut().enumerate() {
        output::complain(&format!("person {} again, without what the others' bodies cover", index + 1));
        if let Some(followed) = with_bodies(&found, index, &bodies) {
            again(arguments, tracked, (&footage, followed), cancel)?;
        }
    }
    output::print_result(arguments.json, &answer(&all), || text(&all))
}

/// Tracks a person once more from the pose and by the body that were found.
fn again(
    arguments: &TrackArguments,
    tracked: &mut TrackedPerson,
    (footage, followed): (&Footage, FollowedPerson),
    cancel: &CancelToken,
) -> anyhow::Result<()> {
    let first = tracked.report.track.frames.first_key_value();
    let Some(start) = first.map(|(_, estimate)| estimate.pose.clone()) else { return Ok(()) };
    let footage = footage.with_body(tracked.model.clone()).unwrap_or_else(|| footage.clone());
    let whom = Whom {
        footage: Arc::new(footage.with_person(Some(Arc::new(followed)))),
        frames: tracked.report.track.frames.keys().copied().collect(),
        start: Some(start),
        found: Some(tracked.report.begun.take().unwrap_or_default()),
        out: &tracked.out,
    };
    (tracked.report, _) = track::track(arguments, whom, None, cancel)?;
    Ok(())
}

/// The person with all bodies that were found; of whoever was not tracked none is.
fn with_bodies(found: &[PersonTrack], index: usize, bodies: &[KnownBody]) -> Option<FollowedPerson> {
    let others = (0..found.len()).filter(|other| *other != index);
    let bodies = FoundBodies {
        own: bodies.get(index).cloned(),
        others: others.map(|other| bodies.get(other).cloned()).collect(),
    };
    Some(FollowedPerson { bodies, ..FollowedPerson::of(found, index)? })
}

/// Who a start is of: whose place is nearest to its root.
fn nearest(found: &[PersonTrack], frame: usize, start: &Pose) -> Option<usize> {
    let away = |(index, track): (usize, &PersonTrack)| {
        Some((index, track.at(frame)?.bounds.centre().distance(start.root)))
    };
    let all = found.iter().enumerate().filter_map(away);
    all.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _)| index)
}

/// The frames from the first in which a person was seen to the last.
fn while_in_view(track: &PersonTrack, frames: &[usize]) -> Vec<usize> {
    let ends = track.places.first_key_value().zip(track.places.last_key_value());
    let is_in = |frame: &&usize| ends.is_none_or(|((first, _), (last, _))| (first..=last).contains(frame));
    frames.iter().filter(is_in).copied().collect()
}

fn text(all: &[TrackedPerson]) -> String {
    let mut table = Table::new(["person", "frames", "lost", "IoU", "unknown, %", "folder"]);
    for (tracked, number_of) in all.iter().zip(1..) {
        let summary = tracked.report.summary();
        let frames = tracked.report.track.frames.len().to_string();
        table.row([
            number_of.to_string(),
            frames,
            summary.lost.to_string(),
            number(summary.iou.mean, 3),
            number(summary.iou.left_out.map(|share| 100.0 * share), 1),
            folder(&tracked.out),
        ]);
    }
    table.to_text()
}

fn folder(path: &Path) -> String {
    path.display().to_string()
}

fn answer(all: &[TrackedPerson]) -> impl serde::Serialize {
    let person = |(tracked, number): (&TrackedPerson, usize)| {
        object! { person: number, folder: folder(&tracked.out), summary: tracked.report.summary() }
    };
    object! { people: all.iter().zip(1..).map(person).collect::<Vec<_>>() }
}
