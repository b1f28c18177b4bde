//! A take is open.

use std::sync::Arc;

use backlit_document::history::History;
use backlit_document::tracking_choices::{CueChoice, TrackPrior, TrackingChoices};
use backlit_document::{CameraUse, Document};
use backlit_formats::Footage;
use backlit_take::demonstration::Demonstration;
use backlit_take::source::TakeSource;
use backlit_tracking::track::WhenToSearch;
use backlit_ui::style::format::capitalised;

use super::Inspector;
use crate::app::open_job::OpenedProject;
use crate::app::refresh::Refresh;
use crate::app::state::State;
use crate::context::command::{Command, RecoveryCommand};
use crate::context::notices::Notices;
use crate::session::selection::Selection;

/// Notes of a take that are shown; a broken recording may have one for every camera.
const MOST_NOTES: usize = 3;

impl Inspector {
    pub(crate) fn take_opened(
        &mut self,
        footage: &Arc<Footage>,
        source: Option<TakeSource>,
        project: Option<OpenedProject>,
    ) {
        self.refresh = Refresh::default();
        self.features.all_mut().for_each(|feature| feature.reset(footage));
        self.state.session.reset(Some(footage.clone()), source.clone());
        self.features.laboratory.begin_with(self.state.session.demonstration());
        self.state.keep_own_tiles();
        self.state.status = None;
        let path = self.state.session.source.as_ref().and_then(TakeSource::path).cloned();
        if let Some(path) = &path {
            self.state.preferences.remember(path.clone());
        }
        let left = self.features.recovery.begin(project.as_ref().map(|project| project.path.as_path()));
        self.state.lost_take = None;
        if let Some(kept) = self.features.recovery.notice(&self.state.clock) {
            self.state.notices.remind(kept, Command::Recovery(RecoveryCommand::Show));
        }
        if let Some(note) = project.as_ref().and_then(|project| project.note.clone()) {
            self.state.notices.info(note, None);
        }
        if path.is_some() {
            remark_on(footage, &mut self.state.notices);
        }
        let (history, path) = match project {
            Some(project) => {
                // What was left unsaved is in no file as it is.
                let is_unsaved = left.is_some() || project.is_changed;
                let begin = if is_unsaved { History::unsaved } else { History::new };
                let left_of = left.as_ref().map(|left| left.project.clone());
                let path = left_of.unwrap_or(Some(project.path));
                (begin(*project.document).with_runs(project.runs), path)
            }
            None => (History::new(document_of(footage, source)), None),
        };
        if let Some(project) = &path {
            self.state.preferences.remember(project.clone());
        }
        let is_new = path.is_none() && !history.is_dirty();
        let document = history.document();
        self.state.selection = Selection::default();
        self.state.selection.frame =
            left.map_or(0, |left| left.frame).min(footage.frame_count().saturating_sub(1));
        let first = document.model.rotation_owners()[0];
        self.state.selection.joint = Selection::joint_of(&document.model, first);
        if let Some(place) = self.state.place.take() {
            let (frames, selection) = (footage.frame_count(), &mut self.state.selection);
            if let Err(problem) = place.select(document, frames, selection) {
                self.state.notices.error(problem);
            }
        }
        self.state.history = history;
        self.state.project = path;
        self.shell.docking.alone = None;
        self.shell.docking.pair = [0, 1.min(footage.cameras.len() - 1)];
        if let Some(which) = self.state.session.demonstration()
            && is_new
        {
            self.ask(|features, _, requests| features.demonstrations.begin(which, requests));
        }
    }
}

impl State {
    /// What a demonstration does to layout and tiles is its own: the user's come back with the user's take.
    fn keep_own_tiles(&mut self) {
        let arranged = (self.preferences.layout, self.preferences.kept.clone());
        match (self.session.demonstration(), self.own_tiles.take()) {
            (Some(_), own) => self.own_tiles = own.or(Some(arranged)),
            (None, Some((layout, kept))) => {
                (self.preferences.layout, self.preferences.kept) = (layout, kept);
            }
            (None, None) => {}
        }
    }
}

/// Says what a take of the disk reads outside its own folder, and what is missing in its footage.
fn remark_on(footage: &Footage, notices: &mut Notices) {
    let take = footage.take();
    let notes = take.notes();
    let left_out = notes.len().saturating_sub(MOST_NOTES);
    let shown = notes.into_iter().take(MOST_NOTES);
    for remark in take.outside().map(ToString::to_string).into_iter().chain(shown) {
        notices.info(format!("{}.", capitalised(&remark)), None);
    }
    if left_out > 0 {
        notices.info(format!("The take has {left_out} more such notes: backlit track says them all."), None);
    }
}

/// A new document about a take.
fn document_of(footage: &Footage, source: Option<TakeSource>) -> Document {
    let mut document = Document::new((**footage.take().model()).clone());
    document.take = source;
    document.start = Arc::new(footage.start());
    document.keys = footage.take().poses().clone();
    document.measurement = Arc::new(footage.take().measurement().to_vec());
    let camera = |camera: &Arc<backlit_tracking::camera::Camera>| CameraUse {
        name: camera.name().to_owned(),
        used: true,
        weight: 1.0,
    };
    let mut cameras: Vec<CameraUse> = footage.cameras.iter().map(camera).collect();
    if let Some(which) = document.take.as_ref().and_then(TakeSource::demonstration) {
        document.fit = Arc::new(which.fit());
        // As in the report: downhill, and nowhere else.
        let tracking = TrackingChoices::of_preset(document.fit.as_preset());
        let cues = if which == Demonstration::Cues { CueChoice::Keypoints } else { CueChoice::None };
        document.tracking =
            TrackingChoices { search: WhenToSearch::Never, prior: TrackPrior::None, cues, ..tracking };
        cameras.iter_mut().skip(which.used_cameras()).for_each(|camera| camera.used = false);
    }
    document.cameras = Arc::new(cameras);
    document
}
