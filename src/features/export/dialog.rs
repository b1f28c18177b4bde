//! What to export, how large, and where to: a card over the window. The choices are kept from start to start.

use std::path::{Path, PathBuf};

use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{
    button_row, card, checkbox, number_field, primary_button, row_name, segmented, text_button, text_field,
};
use egui::{Align, Layout as Direction, RichText, Ui};

use super::choices::{DELAYS_MS, MAX_SIDE, SCALES};
use super::{ExportArea, ExportChoices, ExportOrder, MotionChoices, SeriesFormat, Subject};
use crate::context::Context;
use crate::context::file_dialog::DialogKind;

/// Width of the card, and of the names in it.
const WIDTH: f32 = 460.0;
const NAMES: f32 = 92.0;
/// Scales that are offered.
const VIEW_SCALES: [(f32, &str); 4] = [(1.0, "1×"), (2.0, "2×"), (3.0, "3×"), (4.0, "4×")];

#[derive(Debug)]
pub(crate) struct ExportDialog {
    order: ExportOrder,
    path: String,
    /// The name that was made up; another one is the user's and stays.
    proposed: String,
}

/// What becomes of a card of exports.
#[derive(Debug, Default)]
pub(super) struct CardAnswer {
    pub(super) closes: bool,
    /// The file or the folder is to be chosen in this dialog of the desktop's.
    pub(super) asks: Option<(&'static str, DialogKind)>,
    pub(super) order: Option<ExportOrder>,
    /// A motion is written: with these choices, to this file.
    pub(super) written: Option<(MotionChoices, PathBuf)>,
}

/// Pixels of the active camera's pictures.
fn footage(context: &Context<'_>) -> [usize; 2] {
    context.session.camera_size(context.selection.camera).unwrap_or([1, 1])
}

impl ExportDialog {
    pub(super) fn new(subject: Subject, choices: ExportChoices, context: &Context<'_>) -> Self {
        let document = context.document();
        let first = document.estimates.keys().next().copied().unwrap_or(0);
        let last = document.estimates.keys().next_back().copied();
        let last =
            last.filter(|last| *last > first).unwrap_or(context.session.frame_count().saturating_sub(1));
        let order = ExportOrder { subject, choices, frames: [first, last], path: PathBuf::new() };
        let mut dialog = Self { order, path: String::new(), proposed: String::new() };
        dialog.propose(context);
        dialog
    }

    /// The file or folder was chosen in a dialog of the desktop's.
    pub(crate) fn set_path(&mut self, path: &Path) {
        self.path = path.display().to_string();
        self.proposed.clear();
    }

    fn wants_folder(&self) -> bool {
        self.order.subject.is_series() && self.order.choices.format == SeriesFormat::Pngs
    }

    /// Makes up a name that says what the picture shows, unless the user has given one.
    fn propose(&mut self, context: &Context<'_>) {
        if self.path != self.proposed {
            return self.match_ending();
        }
        let take = context.session.take.as_ref().map_or("backlit", |take| take.take().name());
        let take: String =
            take.chars().map(|c| if c.is_alphanumeric() || "-_".contains(c) { c } else { ' ' }).collect();
        let (frame, camera) = (context.selection.frame, context.selection.camera + 1);
        let view = if self.order.choices.part == ExportArea::View {
            format!(" camera {camera}")
        } else {
            String::new()
        };
        let name = match self.order.subject {
            Subject::View => format!("{take} frame {frame} camera {camera}.png"),
            Subject::Window => format!("{take} frame {frame} window.png"),
            Subject::Steps => {
                format!("{take} frame {frame}{view} steps{}", self.order.choices.format.ending())
            }
            Subject::Frames => {
                let [first, last] = self.order.frames;
                format!("{take}{view} frames {first} to {last}{}", self.order.choices.format.ending())
            }
        };
        let folder = self.order.choices.folder.clone().or_else(pictures_folder).unwrap_or_default();
        self.path = folder.join(name).display().to_string();
        self.proposed.clone_from(&self.path);
    }

    /// A name that the user gave keeps its stem and gets the ending of the format.
    fn match_ending(&mut self) {
        let ending = if self.order.subject.is_series() { self.order.choices.format.ending() } else { ".png" };
        for old in [".png", ".gif"] {
            if let Some(stem) = self.path.strip_suffix(old).filter(|_| old != ending) {
                self.path = format!("{stem}{ending}");
            }
        }
        if !ending.is_empty() && !self.path.is_empty() && !self.path.ends_with(ending) {
            self.path.push_str(ending);
        }
    }

    pub(super) fn ui(&mut self, ui: &Ui, context: &Context<'_>) -> CardAnswer {
        let mut answer = CardAnswer::default();
        let modal = card(ui.ctx(), "export").show(ui.ctx(), |ui| {
            heading(ui, "Export");
            let chosen =
                |order: &ExportOrder| (order.subject, order.choices.format, order.choices.part, order.frames);
            let before = chosen(&self.order);
            segmented(ui, &mut self.order.subject, &Subject::ALL);
            ui.add_space(space::ROW);
            self.series(ui, context);
            if self.order.part() == ExportArea::View {
                self.view(ui, context);
            } else {
                self.window(ui);
            }
            if before != chosen(&self.order) {
                self.propose(context);
            }
            ui.add_space(space::ROW);
            let name = if self.wants_folder() { "Folder" } else { "File" };
            if path_row(ui, name, name, &mut self.path) {
                answer.asks = Some(self.path_dialog());
            }
            let problem = self.problem(context);
            let (exports, cancels) = ending(ui, problem, || self.summary(context));
            if exports {
                let path = PathBuf::from(&self.path);
                let mut order = ExportOrder { path, ..self.order.clone() };
                order.choices.folder = order.path.parent().map(Path::to_owned);
                answer.order = Some(order);
            }
            answer.closes = exports || cancels;
        });
        answer.closes |= modal.should_close();
        answer
    }

    fn path_dialog(&self) -> (&'static str, DialogKind) {
        if self.wants_folder() {
            return ("Export to folder", DialogKind::Folder);
        }
        let name = Path::new(&self.path).file_name().unwrap_or_default();
        ("Export", DialogKind::NewFile(name.to_string_lossy().into_owned(), &[]))
    }

    fn series(&mut self, ui: &mut Ui, context: &Context<'_>) {
        let ExportOrder { subject, choices, frames, .. } = &mut self.order;
        if !subject.is_series() {
            return;
        }
        row(ui, "Pictures of", |ui| {
            segmented(ui, &mut choices.part, &[(ExportArea::View, "View"), (ExportArea::Window, "Window")]);
        });
        row(ui, "Saved as", |ui| {
            segmented(ui, &mut choices.format, &SeriesFormat::ALL);
        });
        if choices.format != SeriesFormat::Pngs {
            row(ui, "Each stays", |ui| {
                let mut delay = f64::from(choices.delay_ms);
                number_field(ui, "Each picture stays", &mut delay, 0, " ms", 2.0, 76.0);
                choices.delay_ms = (delay as u32).clamp(*DELAYS_MS.start(), *DELAYS_MS.end());
                ui.add_space(space::WIDGET);
                checkbox(ui, &mut choices.repeats, "Begins again at the end");
            });
        }
        if *subject == Subject::Frames {
            frames_row(ui, frames, context.session.frame_count().saturating_sub(1));
        } else {
            row(ui, "", |ui| {
                checkbox(ui, &mut choices.accepted_only, "Leave out steps that were rejected");
            });
        }
    }

    fn view(&mut self, ui: &mut Ui, context: &Context<'_>) {
        let (choices, footage) = (&mut self.order.choices, footage(context));
        row(ui, "Size", |ui| {
            let mut chosen = if choices.view_width.is_some() { f32::NAN } else { choices.view_scale };
            let before = chosen;
            segmented(ui, &mut chosen, &VIEW_SCALES);
            if chosen.to_bits() != before.to_bits() {
                (choices.view_scale, choices.view_width) = (chosen, None);
            }
            ui.label(RichText::new("or").color(theme::palette(ui).text2));
            let width = footage[0] as f32 * choices.view_pixels_per_px(footage);
            let mut wide = f64::from(width.round());
            if number_field(ui, "Width", &mut wide, 0, " px wide", 4.0, 96.0).changed() {
                choices.view_width = Some((wide.max(16.0) as u32).min(MAX_SIDE));
            }
        });
        row(ui, "Shows", |ui| {
            segmented(ui, &mut choices.whole_frame, &[(true, "Whole frame"), (false, "As framed")]);
        });
        row(ui, "With", |ui| {
            checkbox(ui, &mut choices.marks, "Joints and limbs");
            ui.add_space(space::WIDGET);
            checkbox(ui, &mut choices.legend, "Legend");
        });
    }

    fn window(&mut self, ui: &mut Ui) {
        row(ui, "Scale", |ui| {
            let choices = &mut self.order.choices;
            segmented(ui, &mut choices.window_scale, &VIEW_SCALES);
            ui.label(RichText::new("or").color(theme::palette(ui).text2));
            let mut scale = f64::from(choices.window_scale);
            number_field(ui, "Scale", &mut scale, 2, "×", 0.01, 64.0);
            choices.window_scale = (scale as f32).clamp(*SCALES.start(), *SCALES.end());
        });
    }

    /// How many pictures there will be, and how large.
    fn summary(&self, context: &Context<'_>) -> String {
        let [width, height] = self.pixels(context).map(format::count);
        let size = format!("{width} × {height} pixels");
        let what = match (self.order.subject, self.count(context)) {
            (Subject::View, _) => format!("Camera {}, {size}", context.selection.camera + 1),
            (Subject::Window, _) => size,
            (Subject::Steps | Subject::Frames, count) => {
                format!("{}, {size}", format::counted(count, "picture"))
            }
        };
        let replaced = match (self.wants_folder(), Path::new(&self.path).exists()) {
            (false, true) => "; the file that is there is replaced",
            (true, true) => "; pictures of these names are replaced",
            _ => "",
        };
        format!("{what}{replaced}.")
    }

    fn pixels(&self, context: &Context<'_>) -> [i64; 2] {
        let size = if self.order.part() == ExportArea::View {
            let footage = footage(context);
            let scale = self.order.choices.view_pixels_per_px(footage);
            footage.map(|side| side as f32 * scale)
        } else {
            let window = context.egui.viewport_rect().size();
            <[f32; 2]>::from(window).map(|side| side * self.order.choices.window_scale)
        };
        size.map(|side| side.round() as i64)
    }

    fn count(&self, context: &Context<'_>) -> usize {
        let ExportOrder { subject, frames, choices, .. } = &self.order;
        match (subject, context.run()) {
            (Subject::View | Subject::Window, _) => 1,
            (Subject::Steps, Some(run)) if choices.accepted_only => 1 + run.accepted_until(run.steps.len()),
            (Subject::Steps, run) => run.map_or(0, |run| run.steps.len()),
            (Subject::Frames, _) => frames[1] - frames[0] + 1,
        }
    }

    /// Why nothing can be exported as it is, in a sentence.
    fn problem(&self, context: &Context<'_>) -> Option<String> {
        if self.order.subject == Subject::Steps && context.run().is_none() {
            return Some("This frame has no run yet: press Space to step.".to_owned());
        }
        if context.session.frame_count() == 0 && self.order.part() == ExportArea::View {
            return Some("Open a take first.".to_owned());
        }
        if self.pixels(context).into_iter().any(|side| side > i64::from(MAX_SIDE)) {
            return Some(format!("That is more than {MAX_SIDE} pixels a side."));
        }
        path_problem(Path::new(self.path.trim()), self.wants_folder())
    }
}

/// The top of a card of exports.
pub(super) fn heading(ui: &mut Ui, title: &str) {
    ui.set_width(WIDTH);
    ui.spacing_mut().item_spacing.y = 6.0;
    ui.label(RichText::new(title).text_style(theme::title()));
    ui.add_space(space::ROW);
}

/// First and last frame.
pub(super) fn frames_row(ui: &mut Ui, frames: &mut [usize; 2], most: usize) {
    row(ui, "Frames", |ui| {
        let [mut from, mut to] = frames.map(|frame| frame as f64);
        number_field(ui, "First frame", &mut from, 0, "", 0.2, 64.0);
        ui.label("to");
        number_field(ui, "Last frame", &mut to, 0, "", 0.2, 64.0);
        let frame = |value: f64| (value.max(0.0) as usize).min(most);
        *frames = [frame(from), frame(to).max(frame(from))];
    });
}

/// The row of the path. Returns whether the user asks for the desktop's dialog.
pub(super) fn path_row(ui: &mut Ui, name: &str, field: &str, path: &mut String) -> bool {
    let mut asks = false;
    row(ui, name, |ui| {
        ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
            asks = text_button(ui, "Choose…").clicked();
            text_field(ui, field, "", path);
        });
    });
    asks
}

/// The end of a card: why nothing can be exported, or what will be, and two buttons. Returns which of them was clicked.
pub(super) fn ending(ui: &mut Ui, problem: Option<String>, summary: impl FnOnce() -> String) -> (bool, bool) {
    let palette = theme::palette(ui);
    match &problem {
        Some(problem) => ui.label(RichText::new(problem).small().color(palette.warn)),
        None => ui.label(RichText::new(summary()).small().color(palette.text3)),
    };
    ui.add_space(space::WIDGET);
    let mut clicked = (false, false);
    button_row(ui, |ui| {
        let export = ui.add_enabled_ui(problem.is_none(), |ui| primary_button(ui, "Export")).inner;
        clicked.0 = export.on_disabled_hover_text(problem.unwrap_or_default()).clicked();
        clicked.1 = text_button(ui, "Cancel").clicked();
    });
    clicked
}

/// Why a file, or a folder of pictures, cannot be written there, in a sentence.
pub(super) fn path_problem(path: &Path, is_folder: bool) -> Option<String> {
    if path.as_os_str().is_empty() {
        return Some("Say where to.".to_owned());
    }
    if !is_folder && path.is_dir() {
        return Some("That is a folder; a file needs a name.".to_owned());
    }
    if is_folder && path.is_file() {
        return Some("That is a file; the pictures need a folder.".to_owned());
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty())?;
    (!folder.is_dir()).then(|| format!("There is no folder {}.", folder.display()))
}

/// A name and what is chosen for it.
pub(super) fn row(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        ui.set_height(size::BUTTON);
        row_name(ui, name, NAMES);
        add(ui);
    });
}

/// Where pictures go that nobody has said where.
fn pictures_folder() -> Option<PathBuf> {
    let home = home_folder()?;
    let pictures = home.join("Pictures");
    if pictures.is_dir() { Some(pictures) } else { Some(home) }
}

pub(super) fn home_folder() -> Option<PathBuf> {
    let home = std::env::var_os("HOME").or_else(|| std::env::var_os("USERPROFILE")).map(PathBuf::from)?;
    home.is_dir().then_some(home)
}
