//! Exports: a thread paints and writes, the window hears how far it is.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use backlit_formats::images;
use backlit_tracking::cancel::CancelToken;
use image::DynamicImage;

use super::off_screen::{PictureOf, Shot, Snapshot, Twin};
use crate::app::App;
use crate::context::command::{Command, ExportCommand};
use crate::context::picture_alone::PictureAlone;
use crate::context::write_advice::remedy;
use crate::features::export::dialog::{ExportDialog, ExportOrder, Subject};
use crate::features::export::{ExportError, Part, SeriesFormat, SeriesOptions, write_series};
use crate::session::selection::StepRef;
use crate::shell::Overlay;

/// An export that is under way.
#[derive(Debug)]
pub(crate) struct Exporting {
    path: PathBuf,
    done: usize,
    total: usize,
    cancel: CancelToken,
    news: Receiver<News>,
}

impl Drop for Exporting {
    fn drop(&mut self) {
        self.cancel.cancel();
    }
}

#[derive(Debug)]
enum News {
    Done(usize),
    Ended(Result<(), String>),
    Stopped,
}

/// All that a thread needs to paint and write.
#[derive(Debug)]
pub(crate) struct Export {
    /// What there is to be seen.
    pub(crate) snapshot: Snapshot,
    /// What is painted of it.
    pub(crate) what: PictureOf,
    /// The pictures, each with the number in its name.
    pub(crate) shots: Vec<(usize, Shot)>,
    /// How a series is written; one picture has none.
    pub(crate) series: Option<SeriesOptions>,
    /// What the pictures of a folder are called.
    pub(crate) name: &'static str,
    /// The file or the folder.
    pub(crate) path: PathBuf,
}

impl Export {
    /// Paints and writes; `done` hears how many pictures there are.
    ///
    /// # Errors
    /// What cannot be written, with the file's name; or it was stopped.
    pub(crate) fn run(self, cancel: &CancelToken, done: &dyn Fn(usize)) -> anyhow::Result<()> {
        let mut twin = Twin::new(self.snapshot, self.what)?;
        let shots = self.shots;
        let mut paint =
            |index: usize| twin.paint(shots.get(index).map_or(Shot::AsShown, |shot| shot.1), cancel);
        match self.series {
            None => {
                let picture = DynamicImage::ImageRgb8(paint(0));
                anyhow::ensure!(!cancel.is_cancelled(), ExportError::Stopped);
                images::write_png(&self.path, &picture)?;
                done(1);
            }
            Some(options) => {
                let numbers: Vec<usize> = shots.iter().map(|shot| shot.0).collect();
                write_series(&self.path, self.name, options, &numbers, cancel, &mut paint, done)?;
            }
        }
        Ok(())
    }
}

impl App {
    /// Asks what is to be exported, and where to.
    pub(crate) fn ask_for_export(&mut self, subject: Subject) {
        let choices = self.state.preferences.export.clone();
        self.shell.overlay =
            Some(Overlay::Export(Box::new(ExportDialog::new(subject, choices, &self.context()))));
    }

    /// Begins an export that the dialog has put together.
    pub(crate) fn begin_export(&mut self, order: ExportOrder) {
        self.state.preferences.export = order.choices.clone();
        let export = self.export_of(&order);
        let (sender, news) = channel();
        let cancel = CancelToken::default();
        let exporting =
            Exporting { path: order.path, done: 0, total: export.shots.len(), cancel: cancel.clone(), news };
        let context = self.state.egui.clone();
        let thread = std::thread::Builder::new().name("backlit export".to_owned()).spawn(move || {
            let tell = |news| {
                // The window may be gone by now.
                let _ = sender.send(news);
                context.request_repaint();
            };
            let result = export.run(&cancel, &|count| tell(News::Done(count)));
            tell(match result {
                Err(_) if cancel.is_cancelled() => News::Stopped,
                result => {
                    News::Ended(result.map_err(|error| format!("{error:#}. {}", remedy(error.as_ref()))))
                }
            });
        });
        match thread {
            Ok(_) => self.features.export.exporting = Some(exporting),
            Err(error) => self.state.notices.error(format!("Nothing was exported: {error}.")),
        }
    }

    /// What a thread needs for an order.
    pub(crate) fn export_of(&self, order: &ExportOrder) -> Export {
        let choices = &order.choices;
        let part = match order.subject {
            Subject::View => Part::View,
            Subject::Window => Part::Window,
            Subject::Steps | Subject::Frames => choices.part,
        };
        let camera = self.state.selection.camera;
        let what = match part {
            Part::Window => PictureOf::Window {
                size: self.state.egui.viewport_rect().size(),
                scale: choices.window_scale,
            },
            Part::View => {
                let camera_size = |take: &std::sync::Arc<crate::take::footage::Footage>| {
                    take.cameras.get(camera).map(|camera| [camera.width(), camera.height()])
                };
                let size = self.state.session.take.as_ref().and_then(camera_size).unwrap_or([1, 1]);
                PictureOf::View {
                    picture: PictureAlone { camera, marks: choices.marks, legend: choices.legend },
                    scale: choices.view_pixels_per_px(size),
                    whole_frame: choices.whole_frame,
                }
            }
        };
        let options =
            SeriesOptions { format: choices.format, delay_ms: choices.delay_ms, repeats: choices.repeats };
        let (shots, series, name) = match order.subject {
            Subject::View | Subject::Window => (vec![(0, Shot::AsShown)], None, ""),
            Subject::Steps => (self.shots_of_steps(choices.accepted_only), Some(options), "step"),
            Subject::Frames => {
                let [first, last] = order.frames;
                let last = last.min(self.state.session.frame_count().saturating_sub(1));
                let shots = (first..=last).map(|frame| (frame, Shot::Frame(frame))).collect();
                (shots, Some(options), "frame")
            }
        };
        Export { snapshot: self.snapshot(), what, shots, series, name, path: order.path.clone() }
    }

    /// The steps of the shown run, from its start on.
    fn shots_of_steps(&self, accepted_only: bool) -> Vec<(usize, Shot)> {
        let Some(run) = self.state.session.run_of(&self.state.selection) else { return Vec::new() };
        let Some(steps) = self.state.session.runs.get(run).map(|run| &run.steps) else { return Vec::new() };
        let is_wanted = |step: usize| step == 0 || steps[step].accepted || !accepted_only;
        let shot = |step| (step, Shot::Step(StepRef { run, step }));
        (0..steps.len()).filter(|step| is_wanted(*step)).map(shot).collect()
    }

    /// How far an export is: pictures done, and in all.
    pub(crate) fn export_progress(&self) -> Option<(usize, usize)> {
        self.features.export.exporting.as_ref().map(|exporting| (exporting.done, exporting.total))
    }

    /// Ends an export; what is written of a folder of pictures stays.
    pub(crate) fn stop_export(&self) {
        if let Some(exporting) = &self.features.export.exporting {
            exporting.cancel.cancel();
        }
    }

    /// Takes in what the export has said since the last frame.
    pub(crate) fn hear_export(&mut self) {
        let Some(exporting) = &mut self.features.export.exporting else { return };
        let ended = loop {
            match exporting.news.try_recv() {
                Ok(News::Done(done)) => exporting.done = done,
                Ok(News::Ended(result)) => break result.map(|()| true),
                Ok(News::Stopped) => break Ok(false),
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => break Err("something broke while painting.".to_owned()),
            }
        };
        let (name, done, total) = (name_of(&exporting.path), exporting.done, exporting.total);
        let is_folder = exporting.path.is_dir();
        let folder = exporting.path.parent().map(std::path::Path::to_owned);
        self.features.export.exported_to = if is_folder { Some(exporting.path.clone()) } else { folder };
        self.features.export.exporting = None;
        let pictures =
            |count: usize| if count == 1 { "1 picture".to_owned() } else { format!("{count} pictures") };
        match ended {
            Ok(true) => {
                let text = match total {
                    1 if !is_folder => format!("Exported {name}."),
                    _ => format!("Exported {} to {name}.", pictures(total)),
                };
                self.state.notices.info(
                    self.state.now,
                    text,
                    Some(Command::Export(ExportCommand::ShowExported)),
                );
            }
            Ok(false) => {
                let kept =
                    if is_folder { format!("; {} stay in {name}", pictures(done)) } else { String::new() };
                self.state.notices.info(self.state.now, format!("Stopped the export{kept}."), None);
            }
            Err(error) => self.state.notices.error(format!("Not exported: {error}")),
        }
    }
}

/// The last part of a path.
fn name_of(path: &std::path::Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

impl SeriesFormat {
    /// The formats with their names.
    pub(crate) const ALL: [(Self, &'static str); 3] =
        [(Self::Pngs, "PNGs"), (Self::AnimatedPng, "Animated PNG"), (Self::Gif, "GIF")];
}
