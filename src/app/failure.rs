//! When a job breaks down: what it was busy with ends, and what began it by itself does not begin it again for the
//! same, over and over. The thread lives on, and the user's next change tries again.

use std::collections::BTreeMap;

use super::Inspector;
use crate::context::preferences::Layout;
use crate::document::run::RunEnding;
use crate::features::fit::job::LiveFit;
use crate::session::selection::Selection;
use crate::worker::Lane;

/// Lanes whose last job broke down, and how things were then.
#[derive(Debug, Default)]
pub(crate) struct Broken(BTreeMap<Lane, Circumstances>);

/// What the jobs that begin by themselves depend on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Circumstances {
    revision: u64,
    selection: Selection,
    layout: Layout,
}

impl Inspector {
    fn circumstances(&self) -> Circumstances {
        Circumstances {
            revision: self.state.history.revision(),
            selection: self.state.selection,
            layout: self.state.preferences.layout,
        }
    }

    /// Whether a job of this lane may begin by itself: not where the last one broke down and nothing has changed.
    pub(crate) fn may_ask(&self, lane: Lane) -> bool {
        self.broken.0.get(&lane).is_none_or(|then| *then != self.circumstances())
    }

    /// Another take: it may be better.
    pub(crate) fn forget_broken(&mut self) {
        self.broken = Broken::default();
    }

    /// A job broke down: says so, and ends what waits for it.
    pub(crate) fn broke(&mut self, lane: Lane, why: &str) {
        let circumstances = self.circumstances();
        self.broken.0.insert(lane, circumstances);
        self.state.notices.error(format!("{} broke down: {why}. Your work is unharmed.", work_of(lane)));
        match lane {
            Lane::Fit => self.fit_broke(),
            _ => {}
        }
    }

    /// The steps that were made stay; the fit that made them is lost.
    fn fit_broke(&mut self) {
        self.features.fit.pending_steps = 0;
        self.features.demonstrations.stop();
        self.finish_run(Some(RunEnding::Solver("a step broke down".to_owned())));
        self.state.session.live = None;
        self.features.fit.live = LiveFit::default();
    }
}

/// What a lane does, at the beginning of a sentence.
const fn work_of(lane: Lane) -> &'static str {
    match lane {
        Lane::Save => "Writing a file",
        Lane::Fit => "The fit",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::testing::{Breaks, errors, open, settle};
    use crate::app::{AppOptions, Opening};
    use crate::context::command::{Command, FitCommand};
    use crate::context::notices::Severity;
    use crate::document::edit::Edit;

    const ALL: [Lane; 2] = [Lane::Save, Lane::Fit];

    #[test]
    fn whatever_breaks_down_is_said_once_and_nothing_waits_for_it() {
        for layout in [Layout::Pose, Layout::Demonstrate] {
            let (mut window, mut app) = open(layout);
            for lane in ALL {
                let before = errors(&app).len();
                app.worker.request(lane, Breaks);
                settle(&mut window, &mut app);
                let said = errors(&app);
                assert_eq!(said.len(), before + 1, "{lane:?}: {said:?}");
                assert!(
                    said[before].starts_with(work_of(lane)) && said[before].contains("thirteen"),
                    "{said:?}"
                );
                let context = app.context();
                assert!(!context.busy.is_long() && !context.busy.basin, "{lane:?}");
            }
        }
    }

    #[test]
    fn a_fit_that_breaks_down_leaves_what_it_has_done() {
        let (mut window, mut app) = open(Layout::Pose);
        let context = window.ctx.clone();
        app.run(Command::Fit(FitCommand::Step), &context);
        settle(&mut window, &mut app);
        let steps = app.state.session.runs[0].steps.len();
        app.run(Command::Fit(FitCommand::Run), &context);
        app.worker.request(Lane::Fit, Breaks);
        settle(&mut window, &mut app);
        let run = &app.state.session.runs[0];
        assert_eq!((run.steps.len(), run.ending_text().as_str()), (steps, "Stopped: a step broke down"));
        assert!(app.state.session.live.is_none());
        app.run(Command::Fit(FitCommand::Step), &context);
        settle(&mut window, &mut app);
        assert!(app.state.session.runs.last().unwrap().steps.len() > 1, "the next run is a new one");
    }
}
