//! Pictures for other people: what of the window is painted, how large, and the files it goes to. Who paints is the app's
//! business.

use std::path::{Path, PathBuf};

use backlit_jobs::{Pool, Task, TaskEvent};
use backlit_ui::style::format;
pub use choices::{ExportArea, ExportChoices, MotionChoices, SeriesFormat};
pub(crate) use choices::{ExportOrder, Painter, Shot, Subject};
use egui::Ui;
pub(crate) use job::ExportJob;
pub(crate) use series::{ExportError, SeriesWriter};

use self::dialog::ExportDialog;
use self::job::Exported;
use self::motion_card::MotionCard;
use self::report::ReportWriter;
use crate::context::command::{Command, ExportCommand};
use crate::context::feature::Feature;
use crate::context::file_dialog::FileDialogs;
use crate::context::unavailable::{Why, because, no_take};
use crate::context::write_advice::write_advice;
use crate::context::{Context, DesktopRequest, FeatureCard, Requests, ShellRequest, priority};

pub(crate) mod choices;
mod dialog;
mod job;
mod motion_card;
mod report;
pub(crate) mod series;

#[derive(Debug, Default)]
pub(crate) struct Export {
    /// What was chosen last, kept from start to start.
    pub(crate) preferences: ExportChoices,
    /// The card, while it lies over the window.
    card: Option<ExportCard>,
    /// What was put together on the card and is to be begun.
    pub(crate) order: Option<ExportOrder>,
    running: Option<ExportProgress>,
    /// Folder of the last export.
    folder: Option<PathBuf>,
    task: Task<(), Exported, { priority::EXPORT }>,
    report: ReportWriter,
    dialogs: FileDialogs<AskedFor>,
}

/// What a file is asked for.
#[derive(Debug, Clone, Copy)]
enum AskedFor {
    /// The card over the window.
    Card,
    Report,
}

#[derive(Debug)]
enum ExportCard {
    Pictures(Box<ExportDialog>),
    Motion(Box<MotionCard>),
}

#[derive(Debug)]
struct ExportProgress {
    path: PathBuf,
    done: usize,
    total: usize,
    /// How it ends, once that is known.
    outcome: Exported,
}

impl Export {
    /// How far an export is: pictures done, and in all.
    pub(crate) fn progress(&self) -> Option<(usize, usize)> {
        self.running.as_ref().map(|running| (running.done, running.total))
    }
}

impl Feature for Export {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for (asked, path) in self.dialogs.answers() {
            match (asked, &mut self.card) {
                (AskedFor::Report, _) => self.report.begin(path, context),
                (AskedFor::Card, Some(ExportCard::Pictures(dialog))) => dialog.set_path(&path),
                (AskedFor::Card, Some(ExportCard::Motion(card))) => card.set_path(&path),
                (AskedFor::Card, None) => {}
            }
        }
        if let Some(path) = self.report.update(requests) {
            self.folder = path.parent().map(Path::to_owned);
        }
        for event in self.task.poll() {
            match event {
                TaskEvent::Output(said) => {
                    let Some(running) = &mut self.running else { continue };
                    match said {
                        Exported::Pictures(count) => running.done = count,
                        outcome => running.outcome = outcome,
                    }
                }
                TaskEvent::Ended => self.ended(requests),
                TaskEvent::Failed(failure) => {
                    requests.failed("The export", &failure);
                    self.running = None;
                }
            }
        }
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let Command::Export(command) = command else { return false };
        let subject = match command {
            ExportCommand::View => Some(Subject::View),
            ExportCommand::Window => Some(Subject::Window),
            ExportCommand::Steps => Some(Subject::Steps),
            ExportCommand::Frames => Some(Subject::Frames),
            ExportCommand::Motion => None,
            ExportCommand::Report => {
                let asks = report::dialog(context);
                self.dialogs.ask(context.egui, AskedFor::Report, asks, |why| requests.complain(why));
                return true;
            }
            ExportCommand::Stop => {
                self.stop();
                return true;
            }
            ExportCommand::ShowExported => {
                if let Some(folder) = &self.folder {
                    requests.request(DesktopRequest::OpenOutside(folder.display().to_string()));
                }
                return true;
            }
        };
        self.card = Some(match subject {
            Some(subject) => {
                let dialog = ExportDialog::new(subject, self.preferences.clone(), context);
                ExportCard::Pictures(Box::new(dialog))
            }
            None => ExportCard::Motion(Box::new(MotionCard::new(&self.preferences, context))),
        });
        requests.request(ShellRequest::OpenCard(FeatureCard::Export));
        true
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        let Command::Export(command) = command else { return None };
        let is_exporting = because(self.running.is_some(), "An export is under way");
        match command {
            ExportCommand::ShowExported => {
                because(self.folder.is_none(), "Nothing was exported since the start")
            }
            ExportCommand::Motion | ExportCommand::Report => {
                let document = context.document();
                let is_still = document.estimates.is_empty() && document.keys.is_empty();
                let is_busy = command == ExportCommand::Report && self.report.is_busy();
                no_take(context)
                    .or(because(is_still, "No frame has a pose yet: track, or pose by hand"))
                    .or(because(is_busy, "A report is being written"))
            }
            ExportCommand::Stop => because(self.running.is_none(), "Nothing is being exported"),
            ExportCommand::Window => is_exporting,
            ExportCommand::View | ExportCommand::Frames => is_exporting.or(no_take(context)),
            ExportCommand::Steps => {
                let has_run = context.run().is_some();
                let no_run = because(!has_run, "This frame has no run yet: press Space to step");
                is_exporting.or(no_take(context)).or(no_run)
            }
        }
    }

    fn sentence(&self, _: &Context<'_>) -> Option<String> {
        self.report.is_busy().then(|| "Writing a report.".to_owned())
    }

    fn card(&mut self, ui: &Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        let answer = match &mut self.card {
            Some(ExportCard::Pictures(dialog)) => dialog.ui(ui, context),
            Some(ExportCard::Motion(card)) => card.ui(ui, context, requests),
            None => return false,
        };
        if let Some(order) = answer.order {
            self.preferences = order.choices.clone();
            self.order = Some(order);
            requests.request(DesktopRequest::Export);
        }
        if let Some((choices, path)) = answer.written {
            self.folder = path.parent().map(Path::to_owned);
            self.preferences.motion = choices;
            self.preferences.folder.clone_from(&self.folder);
        }
        if let Some(dialog) = answer.asks {
            self.dialogs.ask(context.egui, AskedFor::Card, dialog, |why| requests.complain(why));
        }
        if answer.closes {
            self.card = None;
        }
        !answer.closes
    }
}

impl Export {
    pub(crate) fn begin(&mut self, job: ExportJob, order: ExportOrder, pool: &Pool) {
        self.running =
            Some(ExportProgress { path: order.path, done: 0, total: job.len(), outcome: Exported::Stopped });
        self.task.begin(pool, (), |()| job);
    }

    /// Ends the export; what is written of a folder of pictures stays.
    pub(crate) fn stop(&self) {
        self.task.stop();
    }

    fn ended(&mut self, requests: &mut Requests) {
        let Some(ExportProgress { path, done, total, outcome }) = self.running.take() else { return };
        let (name, is_folder) = (format::file_name(&path), path.is_dir());
        self.folder = if is_folder { Some(path) } else { path.parent().map(Path::to_owned) };
        let pictures = |count| format::counted(count, "picture");
        match outcome {
            Exported::Whole | Exported::Pictures(_) => {
                let text = match total {
                    1 if !is_folder => format!("Exported {name}."),
                    _ => format!("Exported {} to {name}.", pictures(total)),
                };
                requests.inform(text, Some(Command::Export(ExportCommand::ShowExported)));
            }
            Exported::Stopped => {
                let kept =
                    if is_folder { format!("; {} stay in {name}", pictures(done)) } else { String::new() };
                requests.inform(format!("Stopped the export{kept}."), None);
            }
            Exported::Failed(error) => {
                let advice = write_advice(error.cause());
                requests.complain(format!("Not exported: {:#}. {advice}", anyhow::Error::from(error)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use backlit_document::edit::Edit;

    use super::*;
    use crate::app::testing::{Breaks, open};
    use crate::context::preferences::Layout;

    #[test]
    fn there_is_no_motion_before_a_frame_has_a_pose() {
        let mut app = open(Layout::Pose);
        let command = Command::Export(ExportCommand::Motion);
        assert!(
            app.features
                .unavailable(command, &app.context())
                .is_some_and(|why| why.contains("No frame has a pose"))
        );
        app.state.edit(Edit::SetKey { frame: 0 }, None);
        assert_eq!(app.features.unavailable(command, &app.context()), None);
    }

    #[test]
    fn a_report_is_written_in_the_background_and_said() {
        let folder = tempfile::tempdir().unwrap();
        let mut app = open(Layout::Pose);
        app.state.edit(Edit::SetKey { frame: 0 }, None);
        let mut export = Export::default();
        export.report.begin(folder.path().join("a take"), &app.context());
        assert!(export.report.is_busy());
        app.state.pool.turn();
        let mut requests = Requests::default();
        export.update(&app.context(), &mut requests);
        let page = std::fs::read_to_string(folder.path().join("a take.html")).unwrap();
        assert!(page.contains("1 frame (0 to 0)") && page.contains("data:image/jpeg"));
        assert_eq!(export.folder.as_deref(), Some(folder.path()));
        export.report.begin(folder.path().join("no folder/a.html"), &app.context());
        app.state.pool.turn();
        assert_eq!(export.report.update(&mut requests), None);
    }

    #[test]
    fn an_export_that_breaks_down_is_said_once_and_is_over() {
        let mut app = open(Layout::Pose);
        let export = &mut app.features.export;
        export.running =
            Some(ExportProgress { path: "a.png".into(), done: 0, total: 1, outcome: Exported::Stopped });
        app.break_down(|all, pool| all.features.export.task.begin(pool, (), |()| Breaks));
        assert_eq!(app.features.export.progress(), None);
        assert_eq!(app.errors(), ["The export broke down: thirteen. Your work is unharmed."]);
    }
}
