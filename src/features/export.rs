//! Pictures for other people: what of the window is painted, how large, and the files it goes to. Who paints is the app's
//! business.
//!
//! | file | holds |
//! |---|---|
//! | this | asked for, begun, stopped, told |
//! | `choices` | [`ExportChoices`]: what the card and the command line choose, kept from start to start; `ExportOrder` |
//! | `dialog` | the card on which an export is put together |
//! | `job` | painting and writing, one picture a step |
//! | `motion_card` | poses for other programs, BVH, TRC, C3D, glTF and others, and the card on which that is chosen |
//! | `series` | numbered PNGs, an animated PNG or a GIF from one picture after another |

use std::path::{Path, PathBuf};

use backlit_jobs::{News, Pool, Task};
pub use choices::{ExportArea, ExportChoices, MotionChoices, SeriesFormat};
pub(crate) use choices::{ExportOrder, Painter, PictureOf, Shot, Subject};
use egui::Ui;
pub(crate) use job::ExportJob;
pub(crate) use series::{ExportError, SeriesOptions, SeriesWriter};

use self::dialog::{CardAnswer, ExportDialog};
use self::job::Exported;
use self::motion_card::{MotionAnswer, MotionCard};
use crate::context::command::{Command, ExportCommand};
use crate::context::feature::Feature;
use crate::context::file_dialog::{DialogKind, FileDialogs};
use crate::context::unavailable::{Why, because, no_take};
use crate::context::write_advice::write_advice;
use crate::context::{Context, DesktopRequest, FeatureCard, Requests, ShellRequest, priority};

pub(crate) mod choices;
mod dialog;
mod job;
mod motion_card;
pub(crate) mod series;
#[cfg(test)]
mod tests;

/// The feature.
#[derive(Debug, Default)]
pub(crate) struct Export {
    /// What was chosen last, kept from start to start.
    pub(crate) preferences: ExportChoices,
    /// The card, while it lies over the window.
    card: Option<ExportCard>,
    order: Option<ExportOrder>,
    running: Option<ExportProgress>,
    /// Folder of the last export.
    folder: Option<PathBuf>,
    task: Task<(), Exported, { priority::EXPORT }>,
    dialogs: FileDialogs<()>,
}

/// A card over the window.
#[derive(Debug)]
enum ExportCard {
    Pictures(Box<ExportDialog>),
    Motion(Box<MotionCard>),
}

/// An export that is under way.
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
    fn update(&mut self, _: &Context<'_>, requests: &mut Requests) {
        for ((), path) in self.dialogs.answers() {
            match &mut self.card {
                Some(ExportCard::Pictures(dialog)) => dialog.set_path(&path),
                Some(ExportCard::Motion(card)) => card.set_path(&path),
                None => {}
            }
        }
        for news in self.task.poll() {
            match news {
                News::Output(said) => {
                    let Some(running) = &mut self.running else { continue };
                    match said {
                        Exported::Pictures(count) => running.done = count,
                        outcome => running.outcome = outcome,
                    }
                }
                News::Ended => self.ended(requests),
                News::Failed(failure) => {
                    requests.failed("The export", &failure);
                    self.running = None;
                }
            }
        }
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let Command::Export(command) = command else { return false };
        match command {
            ExportCommand::View => self.open_card(Subject::View, context, requests),
            ExportCommand::Window => self.open_card(Subject::Window, context, requests),
            ExportCommand::Steps => self.open_card(Subject::Steps, context, requests),
            ExportCommand::Frames => self.open_card(Subject::Frames, context, requests),
            ExportCommand::Motion => self.open_motion_card(context, requests),
            ExportCommand::Stop => self.stop(),
            ExportCommand::ShowExported => {
                if let Some(folder) = &self.folder {
                    requests.request(DesktopRequest::OpenOutside(folder.display().to_string()));
                }
            }
        }
        true
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        let Command::Export(command) = command else { return None };
        let is_exporting = because(self.running.is_some(), "An export is under way");
        match command {
            ExportCommand::ShowExported => {
                because(self.folder.is_none(), "Nothing was exported since the start")
            }
            ExportCommand::Motion => {
                let document = context.document();
                let is_still = document.estimates.is_empty() && document.keys.is_empty();
                no_take(context).or(because(is_still, "No frame has a pose yet: track, or pose by hand"))
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

    fn card(&mut self, ui: &Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        let (closes, asked) = match &mut self.card {
            Some(ExportCard::Pictures(dialog)) => {
                let CardAnswer { closes, asks_for_path, order } = dialog.ui(ui, context);
                if let Some(order) = order {
                    self.preferences = order.choices.clone();
                    self.order = Some(order);
                    requests.request(DesktopRequest::Export);
                }
                let (is_folder, name) = dialog.wanted_name();
                let wanted = match is_folder {
                    true => ("Export to folder", DialogKind::Folder),
                    false => ("Export", DialogKind::NewFile(name, &[])),
                };
                (closes, asks_for_path.then_some(wanted))
            }
            Some(ExportCard::Motion(card)) => {
                let MotionAnswer { closes, asks_for_path, written } = card.ui(ui, context, requests);
                if let Some((choices, path)) = written {
                    self.folder = path.parent().map(Path::to_owned);
                    self.preferences.motion = choices;
                    self.preferences.folder.clone_from(&self.folder);
                }
                let wanted = asks_for_path.map(|path| {
                    ("Export motion", DialogKind::NewFile(name_of(Path::new(&path)), &*motion_card::ENDINGS))
                });
                (closes, wanted)
            }
            None => return false,
        };
        if let Some((title, wanted)) = asked
            && let Err(why) = self.dialogs.ask(context.egui, (), title, wanted)
        {
            requests.complain(why.to_string());
        }
        if closes {
            self.card = None;
        }
        !closes
    }
}

impl Export {
    /// Asks what is to be exported, and where to.
    fn open_card(&mut self, subject: Subject, context: &Context<'_>, requests: &mut Requests) {
        let dialog = ExportDialog::new(subject, self.preferences.clone(), context);
        self.card = Some(ExportCard::Pictures(Box::new(dialog)));
        requests.request(ShellRequest::OpenCard(FeatureCard::Export));
    }

    fn open_motion_card(&mut self, context: &Context<'_>, requests: &mut Requests) {
        self.card = Some(ExportCard::Motion(Box::new(MotionCard::new(&self.preferences, context))));
        requests.request(ShellRequest::OpenCard(FeatureCard::Export));
    }

    /// What was put together on the card and is to be begun.
    pub(crate) const fn take_order(&mut self) -> Option<ExportOrder> {
        self.order.take()
    }

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
        let (name, is_folder) = (name_of(&path), path.is_dir());
        self.folder = if is_folder { Some(path) } else { path.parent().map(Path::to_owned) };
        let pictures =
            |count: usize| if count == 1 { "1 picture".to_owned() } else { format!("{count} pictures") };
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

/// The last part of a path.
fn name_of(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}
