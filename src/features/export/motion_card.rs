//! What a motion's file is to be, and where it goes: a card over the window. The choices are kept from start to start. Poses
//! are as the document has them, those set by hand included.

use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

use anyhow::anyhow;
use backlit_formats::motion::{self, Axes, EulerOrder, Motion, MotionFormat, MotionOptions, Names, Unit};
use backlit_tracking::camera::up_of;
use backlit_ui::style::format;
use backlit_ui::style::theme::space;
use backlit_ui::widgets::{card, checkbox, choice, segmented};
use egui::Ui;

use super::choices::{ExportChoices, MotionChoices};
use super::dialog::{CardAnswer, ending, frames_row, heading, home_folder, path_problem, path_row, row};
use crate::context::file_dialog::DialogKind;
use crate::context::{Context, Requests};

/// Width of the boxes.
const BOX: f32 = 190.0;

/// The endings that a file dialog offers.
static ENDINGS: LazyLock<[&str; 7]> = LazyLock::new(|| MotionFormat::ALL.map(MotionFormat::extension));

#[derive(Debug)]
pub(crate) struct MotionCard {
    choices: MotionChoices,
    motion: Arc<Motion>,
    /// First and last frame that are written.
    frames: [usize; 2],
    path: String,
}

impl MotionCard {
    pub(super) fn new(choices: &ExportChoices, context: &Context<'_>) -> Self {
        let motion = Arc::new(motion_of(context));
        let end = |frame: Option<(&usize, _)>| frame.map_or(0, |(frame, _)| *frame);
        let frames = [end(motion.poses.first_key_value()), end(motion.poses.last_key_value())];
        let folder = choices.folder.clone().or_else(home_folder).unwrap_or_default();
        let name = format!("{}.{}", motion.name, choices.motion.format.extension());
        Self {
            choices: choices.motion.clone(),
            motion,
            frames,
            path: folder.join(name).display().to_string(),
        }
    }

    /// The file was chosen in a dialog of the desktop's; its ending says the format.
    pub(super) fn set_path(&mut self, path: &Path) {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        self.path = path.display().to_string();
        match MotionFormat::of_extension(ending) {
            Some(format) => self.choices.format = format,
            None => self.match_ending(),
        }
    }

    /// The file gets the ending of the format.
    fn match_ending(&mut self) {
        let ending = self.choices.format.extension();
        let path = Path::new(&self.path);
        let is_format =
            |ending: &std::ffi::OsStr| MotionFormat::of_extension(&ending.to_string_lossy()).is_some();
        self.path = match path.extension() {
            Some(old) if is_format(old) => path.with_extension(ending).display().to_string(),
            _ => format!("{}.{ending}", self.path),
        };
    }

    pub(super) fn ui(&mut self, ui: &Ui, context: &Context<'_>, requests: &mut Requests) -> CardAnswer {
        let mut answer = CardAnswer::default();
        let modal = card(ui.ctx(), "export motion").show(ui.ctx(), |ui| {
            heading(ui, "Export motion");
            let before = self.choices.format;
            let formats = MotionFormat::ALL.map(|format| (format, format.label()));
            segmented(ui, &mut self.choices.format, &formats);
            if self.choices.format != before {
                self.match_ending();
            }
            ui.add_space(space::ROW);
            self.others(ui);
            self.contents(ui);
            if path_row(ui, "File", "Motion file", &mut self.path) {
                let name = format::file_name(Path::new(&self.path));
                answer.asks = Some(("Export motion", DialogKind::NewFile(name, &*ENDINGS)));
            }
            let (exports, cancels) = ending(ui, self.problem(), || self.summary());
            if exports {
                answer.written = Some((self.choices.clone(), PathBuf::from(self.path.trim())));
                self.write(context, requests);
            }
            answer.closes = exports || cancels;
        });
        answer.closes |= modal.should_close();
        answer
    }

    /// The kinds that are written beside the first.
    fn others(&mut self, ui: &mut Ui) {
        row(ui, "Also as", |ui| {
            ui.horizontal(|ui| {
                for format in MotionFormat::ALL.into_iter().filter(|format| *format != self.choices.format) {
                    let mut is_wanted = self.choices.also.contains(&format);
                    let hover = "A second file beside the first, of the same name and with its own ending";
                    if checkbox(ui, &mut is_wanted, format.label()).on_hover_text(hover).changed() {
                        self.choices.also.retain(|other| *other != format);
                        self.choices.also.extend(is_wanted.then_some(format));
                    }
                }
            });
        });
    }

    /// Every file that is written.
    fn files(&self) -> Vec<(MotionFormat, PathBuf)> {
        let (first, path) = (self.choices.format, PathBuf::from(self.path.trim()));
        let others = self.choices.also.iter().filter(|format| **format != first);
        let others = others.map(|format| (*format, path.with_extension(format.extension())));
        others.chain([(first, path.clone())]).collect()
    }

    fn contents(&mut self, ui: &mut Ui) {
        let (axes, unit, names) = self.choices.format.defaults();
        row(ui, "Axes", |ui| {
            let mut rows = vec![expected(axes_text(axes))];
            let others = [
                (Axes::YUp, "Blender, Maya and OpenSim turn it as they need"),
                (Axes::ZUp, "As in most laboratories"),
                (Axes::World, "Nothing is turned"),
            ];
            rows.extend(others.map(|(axes, tooltip)| (Some(axes), axes_text(axes).to_owned(), tooltip)));
            pick(ui, "Axes", &mut self.choices.axes, &rows);
        });
        row(ui, "Unit", |ui| {
            let mut rows = vec![expected(unit_text(unit))];
            rows.extend(
                UNITS.map(|unit| (Some(unit), unit_text(unit).to_owned(), "Lengths and places in the file")),
            );
            pick(ui, "Unit", &mut self.choices.unit, &rows);
        });
        row(ui, "Joint names", |ui| {
            let all = [
                (Names::Anatomical, "Elbow, wrist, knee: joints by anatomy; bones by the limbs’ names"),
                (Names::Limbs, "The names of the limbs; a joint’s is that of the limb that ends there"),
                (Names::OpenSim, "As models of OpenSim and OpenCap call them"),
                (Names::Mixamo, "As Mixamo’s characters call them: mixamorig:Hips"),
            ];
            let mut rows = vec![expected(names_text(names))];
            rows.extend(all.map(|(names, tooltip)| (Some(names), names_text(names).to_owned(), tooltip)));
            pick(ui, "Joint names", &mut self.choices.names, &rows);
        });
        if self.choices.format == MotionFormat::Bvh {
            row(ui, "Angles", |ui| {
                let rows = EulerOrder::ALL.map(|order| {
                    let [first, second, third] = order.letters();
                    (order, format!("{first} {second} {third}"), "The order in which the three angles turn")
                });
                pick(ui, "Angles", &mut self.choices.euler, &rows);
            });
        }
        let most = self.motion.poses.last_key_value().map_or(0, |(frame, _)| *frame);
        frames_row(ui, &mut self.frames, most);
    }

    /// "70 frames; y up, in centimetres. The file that is there is replaced."
    fn summary(&self) -> String {
        let (axes, unit, _) = self.choices.format.defaults();
        let (axes, unit) = (self.choices.axes.unwrap_or(axes), self.choices.unit.unwrap_or(unit));
        let [first, last] = self.frames;
        let (count, of) = (self.motion.poses.range(first..=last).count(), last - first + 1);
        let gaps = if count < of {
            format!(" of {of}: the others have no pose of their own")
        } else {
            String::new()
        };
        let axes = if axes == Axes::World { "axes of the take" } else { axes_text(axes) };
        let frames = format::counted(count, "frame");
        let files = self.files();
        let there = match files.iter().filter(|(_, path)| path.exists()).count() {
            0 => "",
            1 => " The file that is there is replaced.",
            _ => " The files that are there are replaced.",
        };
        let count = if files.len() > 1 { format!(", {} files", files.len()) } else { String::new() };
        let (axes, unit) = (axes.to_lowercase(), unit_text(unit).to_lowercase());
        format!("{frames}{gaps}{count}; {axes}, {unit}.{there}")
    }

    fn problem(&self) -> Option<String> {
        let [first, last] = self.frames;
        if self.motion.poses.range(first..=last).next().is_none() {
            return Some("None of these frames has a pose of its own.".to_owned());
        }
        let path = Path::new(self.path.trim());
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        let format = self.choices.format;
        if MotionFormat::of_extension(ending) != Some(format) && !path.as_os_str().is_empty() {
            return Some(format!("The name must end in .{}.", format.extension()));
        }
        path_problem(path, false)
    }

    fn write(&self, context: &Context<'_>, requests: &mut Requests) {
        for (format, path) in self.files() {
            let (motion, options) = (self.motion.clone(), options(&self.choices, self.frames, context));
            requests.write(&path, move || {
                motion::to_bytes(format, &motion, &options).map_err(|problem| anyhow!("{problem}"))
            });
        }
    }
}

const UNITS: [Unit; 3] = [Unit::Metres, Unit::Centimetres, Unit::Millimetres];

fn axes_text(axes: Axes) -> &'static str {
    match axes {
        Axes::YUp => "Y up",
        Axes::ZUp => "Z up",
        Axes::World => "As in the take",
    }
}

fn unit_text(unit: Unit) -> &'static str {
    match unit {
        Unit::Metres => "Metres",
        Unit::Centimetres => "Centimetres",
        Unit::Millimetres => "Millimetres",
    }
}

fn names_text(names: Names) -> &'static str {
    match names {
        Names::Anatomical => "Anatomical",
        Names::Limbs => "The limbs’",
        Names::OpenSim => "OpenSim’s",
        Names::Mixamo => "Mixamo’s",
    }
}

/// The choice of what suits the format.
fn expected<T>(what: &str) -> (Option<T>, String, &'static str) {
    (None, format!("{what}, as expected"), "What programs expect of such a file")
}

/// A box of choices.
fn pick<T: PartialEq + Copy>(ui: &mut Ui, name: &str, chosen: &mut T, rows: &[(T, String, &str)]) {
    let text = rows.iter().find(|(value, ..)| value == chosen).map_or("", |(_, text, _)| text);
    let shown: Vec<(T, &str, String)> =
        rows.iter().map(|(value, text, tooltip)| (*value, text.as_str(), (*tooltip).to_owned())).collect();
    if let Some(value) = choice(ui, name, BOX, text, &shown) {
        *chosen = value;
    }
}

/// The poses of a document: of each frame that has one of its own, fitted or set by hand.
fn motion_of(context: &Context<'_>) -> Motion {
    let take = context.session.take.as_ref();
    let (name, rate) = take.map_or(("backlit", 30.0), |take| (take.take().name(), take.take().frame_rate()));
    context.document().motion(name, rate)
}

/// How these frames of it are written. Which way is up is told by the cameras.
fn options(choices: &MotionChoices, [first, last]: [usize; 2], context: &Context<'_>) -> MotionOptions {
    let cameras = context.session.take.as_ref().map(|take| take.cameras.clone()).unwrap_or_default();
    let up = up_of(cameras.iter().map(|camera| &**camera)).unwrap_or(MotionOptions::default().up);
    let MotionChoices { axes, unit, names, euler, .. } = *choices;
    MotionOptions { axes, up, unit, range: Some(first..=last), names, euler }
}
