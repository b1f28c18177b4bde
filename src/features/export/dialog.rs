//! What to export, how large, and where to: a card over the window. The choices are kept from start to start.

use std::path::{Path, PathBuf};

use backlit_ui::style::format;
use backlit_ui::style::theme;
use backlit_ui::style::theme::{size, space};
use backlit_ui::widgets::{
    button_row, card, checkbox, number_field, primary_button, row_name, segmented, text_field,
};
use egui::{Align, Button, Layout as Direction, RichText, Ui, vec2};

use super::choices::{DELAYS_MS, MAX_SIDE, SCALES};
use super::{ExportArea, ExportChoices, ExportOrder, SeriesFormat, Subject};
use crate::context::Context;

/// Width of the card, and of the names in it.
const WIDTH: f32 = 460.0;
const NAMES: f32 = 92.0;
/// Scales that are offered.
const VIEW_SCALES: [(f32, &str); 4] = [(1.0, "1×"), (2.0, "2×"), (3.0, "3×"), (4.0, "4×")];

/// The card's state.
#[derive(Debug)]
pub(crate) struct ExportDialog {
    subject: Subject,
    choices: ExportChoices,
    frames: [usize; 2],
    path: String,
    /// The name that was made up; another one is the user's and stays.
    proposed: String,
}

/// What becomes of the card.
#[derive(Debug, Default)]
pub(crate) struct CardAnswer {
    /// It is closed.
    pub(crate) closes: bool,
    /// The file or the folder is to be chosen in a dialog of the desktop's.
    pub(crate) asks_for_path: bool,
    /// What is to be exported.
    pub(crate) order: Option<ExportOrder>,
}

/// What the dialog knows of the inspector.
struct Facts {
    footage: [usize; 2],
    camera: usize,
    window: egui::Vec2,
    frame_count: usize,
    /// All steps of the shown run and the accepted ones, its start among both.
    steps: Option<[usize; 2]>,
}

impl Facts {
    fn new(ui: &egui::Context, context: &Context<'_>) -> Self {
        let (session, camera) = (context.session, context.selection.camera);
        let run = context.run();
        Self {
            footage: session.camera_size(camera).unwrap_or([1, 1]),
            camera,
            window: ui.viewport_rect().size(),
            frame_count: session.frame_count(),
            steps: run.map(|run| [run.steps.len(), 1 + run.accepted_until(run.steps.len())]),
        }
    }
}

impl ExportDialog {
    /// The card as it opens.
    pub(crate) fn new(subject: Subject, choices: ExportChoices, context: &Context<'_>) -> Self {
        let document = context.document();
        let first = document.estimates.keys().next().copied().unwrap_or(0);
        let last = document.estimates.keys().next_back().copied();
        let last =
            last.filter(|last| *last > first).unwrap_or(context.session.frame_count().saturating_sub(1));
        let mut dialog =
            Self { subject, choices, frames: [first, last], path: String::new(), proposed: String::new() };
        dialog.propose(context);
        dialog
    }

    /// The file or folder was chosen in a dialog of the desktop's.
    pub(crate) fn set_path(&mut self, path: &Path) {
        self.path = path.display().to_string();
        self.proposed.clear();
    }

    /// Whether a folder is asked for, and what it or the file is to be called.
    pub(crate) fn wanted_name(&self) -> (bool, String) {
        let name = Path::new(&self.path).file_name();
        (self.wants_folder(), name.map_or_else(String::new, |name| name.to_string_lossy().into_owned()))
    }

    fn wants_folder(&self) -> bool {
        self.subject.is_series() && self.choices.format == SeriesFormat::Pngs
    }

    /// Makes up a name that says what the picture shows, unless the user has given one.
    fn propose(&mut self, context: &Context<'_>) {
        let take = context.session.take.as_ref().map_or("backlit", |take| take.take().name());
        let take: String =
            take.chars().map(|c| if c.is_alphanumeric() || "-_".contains(c) { c } else { ' ' }).collect();
        let (frame, camera) = (context.selection.frame, context.selection.camera + 1);
        let view =
            if self.choices.part == ExportArea::View { format!(" camera {camera}") } else { String::new() };
        let name = match self.subject {
            Subject::View => format!("{take} frame {frame} camera {camera}.png"),
            Subject::Window => format!("{take} frame {frame} window.png"),
            Subject::Steps => format!("{take} frame {frame}{view} steps{}", self.choices.format.ending()),
            Subject::Frames => {
                let [first, last] = self.frames;
                format!("{take}{view} frames {first} to {last}{}", self.choices.format.ending())
            }
        };
        let is_ours = self.path == self.proposed;
        let folder = if is_ours {
            self.choices.folder.clone().or_else(pictures_folder).unwrap_or_default()
        } else {
            return self.match_ending();
        };
        self.path = folder.join(name).display().to_string();
        self.proposed.clone_from(&self.path);
    }

    /// A name that the user gave keeps its stem and gets the ending of the format.
    fn match_ending(&mut self) {
        let ending = if self.subject.is_series() { self.choices.format.ending() } else { ".png" };
        for old in [".png", ".gif"] {
            if let Some(stem) = self.path.strip_suffix(old).filter(|_| old != ending) {
                self.path = format!("{stem}{ending}");
            }
        }
        if !ending.is_empty() && !self.path.is_empty() && !self.path.ends_with(ending) {
            self.path.push_str(ending);
        }
    }

    /// Shows the card.
    pub(crate) fn ui(&mut self, ui: &Ui, context: &Context<'_>) -> CardAnswer {
        let facts = Facts::new(ui.ctx(), context);
        let mut answer = CardAnswer::default();
        let modal = card(ui.ctx(), "export").show(ui.ctx(), |ui| {
            ui.set_width(WIDTH);
            ui.spacing_mut().item_spacing.y = 6.0;
            ui.label(RichText::new("Export").text_style(theme::title()));
            ui.add_space(space::ROW);
            let before = (self.subject, self.choices.format, self.choices.part, self.frames);
            segmented(ui, &mut self.subject, &Subject::ALL);
            ui.add_space(space::ROW);
            self.series(ui, &facts);
            if self.part() == ExportArea::View {
                self.view(ui, &facts);
            } else {
                self.window(ui, &facts);
            }
            if before != (self.subject, self.choices.format, self.choices.part, self.frames) {
                self.propose(context);
            }
            ui.add_space(space::ROW);
            answer.asks_for_path = self.target(ui);
            let problem = self.problem(&facts);
            self.summary(ui, &facts, problem.as_deref());
            ui.add_space(space::WIDGET);
            button_row(ui, |ui| {
                let export = ui.add_enabled_ui(problem.is_none(), |ui| primary_button(ui, "Export")).inner;
                let export = export.on_disabled_hover_text(problem.as_deref().unwrap_or_default());
                if export.clicked() {
                    let mut choices = self.choices.clone();
                    choices.folder = Path::new(&self.path).parent().map(Path::to_owned);
                    let (subject, path) = (self.subject, PathBuf::from(&self.path));
                    answer.order = Some(ExportOrder { subject, choices, frames: self.frames, path });
                    answer.closes = true;
                }
                answer.closes |= ui.add(Button::new("Cancel").min_size(vec2(0.0, size::BUTTON))).clicked();
            });
        });
        answer.closes |= modal.should_close();
        answer
    }

    fn part(&self) -> ExportArea {
        match self.subject {
            Subject::View => ExportArea::View,
            Subject::Window => ExportArea::Window,
            Subject::Steps | Subject::Frames => self.choices.part,
        }
    }

    fn series(&mut self, ui: &mut Ui, facts: &Facts) {
        if !self.subject.is_series() {
            return;
        }
        let choices = &mut self.choices;
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
        if self.subject == Subject::Frames {
            row(ui, "Frames", |ui| {
                let last = facts.frame_count.saturating_sub(1);
                let [mut from, mut to] = self.frames.map(|frame| frame as f64);
                number_field(ui, "First frame", &mut from, 0, "", 0.2, 64.0);
                ui.label("to");
                number_field(ui, "Last frame", &mut to, 0, "", 0.2, 64.0);
                let frame = |value: f64| (value.max(0.0) as usize).min(last);
                let first = frame(from);
                self.frames = [first, frame(to).max(first)];
            });
        } else {
            row(ui, "", |ui| {
                checkbox(ui, &mut self.choices.accepted_only, "Leave out steps that were rejected");
            });
        }
    }

    fn view(&mut self, ui: &mut Ui, facts: &Facts) {
        let choices = &mut self.choices;
        row(ui, "Size", |ui| {
            let mut chosen = if choices.view_width.is_some() { f32::NAN } else { choices.view_scale };
            let before = chosen;
            segmented(ui, &mut chosen, &VIEW_SCALES);
            if chosen.to_bits() != before.to_bits() {
                (choices.view_scale, choices.view_width) = (chosen, None);
            }
            ui.label(RichText::new("or").color(theme::palette(ui).text2));
            let width = facts.footage[0] as f32 * choices.view_pixels_per_px(facts.footage);
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

    fn window(&mut self, ui: &mut Ui, _facts: &Facts) {
        row(ui, "Scale", |ui| {
            let choices = &mut self.choices;
            segmented(ui, &mut choices.window_scale, &VIEW_SCALES);
            ui.label(RichText::new("or").color(theme::palette(ui).text2));
            let mut scale = f64::from(choices.window_scale);
            number_field(ui, "Scale", &mut scale, 2, "×", 0.01, 64.0);
            choices.window_scale = (scale as f32).clamp(*SCALES.start(), *SCALES.end());
        });
    }

    /// The row of the path. Returns whether the user asks for the desktop's dialog.
    fn target(&mut self, ui: &mut Ui) -> bool {
        let name = if self.wants_folder() { "Folder" } else { "File" };
        let mut asks = false;
        row(ui, name, |ui| {
            ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
                asks = ui.add(Button::new("Choose…").min_size(vec2(0.0, size::BUTTON))).clicked();
                text_field(ui, name, "", &mut self.path);
            });
        });
        asks
    }

    /// How many pictures there will be, and how large.
    fn summary(&self, ui: &mut Ui, facts: &Facts, problem: Option<&str>) {
        let palette = theme::palette(ui);
        if let Some(problem) = problem {
            ui.label(RichText::new(problem).small().color(palette.warn));
            return;
        }
        let [width, height] = self.pixels(facts);
        let count = self.count(facts);
        let size = format!("{} × {} pixels", format::count(width), format::count(height));
        let what = match self.subject {
            Subject::View => format!("Camera {}, {size}", facts.camera + 1),
            Subject::Window => size,
            Subject::Steps | Subject::Frames if count == 1 => format!("1 picture, {size}"),
            Subject::Steps | Subject::Frames => format!("{count} pictures, {size}"),
        };
        let path = Path::new(&self.path);
        let replaced = match (self.wants_folder(), path.exists()) {
            (false, true) => "; the file that is there is replaced",
            (true, true) => "; pictures of these names are replaced",
            _ => "",
        };
        ui.label(RichText::new(format!("{what}{replaced}.")).small().color(palette.text3));
    }

    fn pixels(&self, facts: &Facts) -> [i64; 2] {
        let size = if self.part() == ExportArea::View {
            let scale = self.choices.view_pixels_per_px(facts.footage);
            [facts.footage[0] as f32 * scale, facts.footage[1] as f32 * scale]
        } else {
            [facts.window.x * self.choices.window_scale, facts.window.y * self.choices.window_scale]
        };
        size.map(|side| side.round() as i64)
    }

    fn count(&self, facts: &Facts) -> usize {
        match self.subject {
            Subject::View | Subject::Window => 1,
            Subject::Steps => facts.steps.map_or(0, |steps| steps[usize::from(self.choices.accepted_only)]),
            Subject::Frames => self.frames[1] - self.frames[0] + 1,
        }
    }

    /// Why nothing can be exported as it is, in a sentence.
    fn problem(&self, facts: &Facts) -> Option<String> {
        let path = Path::new(self.path.trim());
        if self.subject == Subject::Steps && facts.steps.is_none() {
            return Some("This frame has no run yet: press Space to step.".to_owned());
        }
        if facts.frame_count == 0 && self.part() == ExportArea::View {
            return Some("Open a take first.".to_owned());
        }
        if self.pixels(facts).into_iter().any(|side| side > i64::from(MAX_SIDE)) {
            return Some(format!("That is more than {MAX_SIDE} pixels a side."));
        }
        path_problem(path, self.wants_folder())
    }
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
