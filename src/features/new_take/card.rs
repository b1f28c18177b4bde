//! The card: where the footage is, what was found camera by camera, what is missing, where the take goes.

use std::path::{Path, PathBuf};

use backlit_formats::import::{ImportCamera, MatchedBy, PictureSize, Pictures};
use backlit_ui::style::theme::data_colours::PICTURE_GROUND;
use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::image_canvas::cached_texture;
use backlit_ui::widgets::{
    button_row, hint, paint_whole, primary_button, row_name, search_card, text_button, text_field,
};
use egui::{
    Align, CornerRadius, Id, Layout as Direction, Rect, RichText, Role, ScrollArea, Sense, Ui, WidgetInfo,
    vec2,
};

use super::{ImportPath, ImportStage, NewTake, SurveyedFolders};
use crate::context::{Context, Requests};

/// Width of the card, and of the names in it.
const WIDTH: f32 = 620.0;
const NAMES: f32 = 92.0;
/// Side of a camera's picture.
const PICTURE: f32 = 72.0;
/// Height that is left for what stands below the cameras.
const CAMERAS: f32 = 210.0;

/// What was asked for on the card.
#[derive(Debug, Clone, Copy, PartialEq)]
enum CardAction {
    Ask(ImportPath),
    Look,
    Pictures(PictureSize),
    Create,
    Stop,
    Close,
}

impl NewTake {
    /// Shows the card, and says whether it stays.
    pub(super) fn show(&mut self, ui: &Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        let modal = search_card(ui.ctx(), "new take").show(ui.ctx(), |ui| {
            ui.set_width(WIDTH);
            ui.spacing_mut().item_spacing.y = 6.0;
            ui.label(RichText::new("New take").text_style(theme::title()));
            ui.add_space(space::ROW);
            let mut action = None;
            self.contents(ui, &mut action);
            action
        });
        match modal.inner {
            Some(CardAction::Ask(asked)) => self.ask(asked, context, requests),
            Some(CardAction::Look) => self.look_at(self.paths.clone(), context),
            Some(CardAction::Pictures(chosen)) => {
                self.options.picture_size = Some(chosen);
                self.look_at(self.paths.clone(), context);
            }
            Some(CardAction::Create) => self.create(context),
            Some(CardAction::Stop) => self.write.stop(),
            Some(CardAction::Close) => return false,
            None => {}
        }
        // What is being written is not lost at all, and what was chosen not by a click beside the card.
        let is_begun = !self.paths.is_empty() && modal.backdrop_response.clicked();
        is_begun || matches!(self.stage, ImportStage::Writing(..)) || !modal.should_close()
    }

    fn contents(&mut self, ui: &mut Ui, action: &mut Option<CardAction>) {
        row(ui, "Footage", |ui| {
            ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
                if text_button(ui, "Choose folder…").clicked() {
                    *action = Some(CardAction::Ask(ImportPath::Footage));
                }
                let path = self.paths.first().map_or_else(String::new, |path| path.display().to_string());
                let mut typed = path.clone();
                let response = text_field(ui, "Footage", "a folder with videos or pictures", &mut typed);
                if typed != path {
                    self.paths = vec![PathBuf::from(&typed)];
                }
                if response.lost_focus() && !typed.is_empty() && !matches!(self.stage, ImportStage::Found(_))
                {
                    *action = Some(CardAction::Look);
                }
            });
        });
        let palette = theme::palette(ui);
        match &self.stage {
            ImportStage::Empty => {
                let text = "Videos or numbered pictures of calibrated cameras, and their calibration. Projects of Pose2Sim, \
                            EasyMocap, Anipose, FreeMoCap, Caliscope and OpenCap are known. Nothing is copied.";
                ui.label(RichText::new(text).color(palette.text2));
            }
            ImportStage::Looking => {
                ui.label(RichText::new("Looking through the folder…").color(palette.text2));
            }
            ImportStage::Unusable(why) => {
                ui.label(RichText::new(why).color(palette.warn));
                calibration_row(ui, None, action);
            }
            ImportStage::Found(looked) | ImportStage::Writing(looked, _) => {
                let looked = (**looked).clone();
                found(ui, &looked, action);
                self.settings(ui, &looked, action);
            }
        }
        ui.add_space(space::WIDGET);
        self.buttons(ui, action);
    }

    fn settings(&mut self, ui: &mut Ui, looked: &SurveyedFolders, action: &mut Option<CardAction>) {
        row(ui, "Frames a second", |ui| {
            let field = vec2(76.0, size::BUTTON);
            let rate = |ui: &mut Ui| text_field(ui, "Frames a second", "", &mut self.rate);
            let response = ui.allocate_ui(field, rate).inner;
            let typed = self.rate.trim().parse().ok().filter(|rate: &f64| *rate > 0.0 && rate.is_finite());
            if response.lost_focus() && typed != looked.found.frame_rate && typed.is_some() {
                self.options.frame_rate = typed;
                *action = Some(CardAction::Look);
            }
            if looked.found.frame_rate.is_none() {
                hint(ui, "the footage does not say it");
            }
        });
        row(ui, "Take goes to", |ui| {
            ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
                if text_button(ui, "Choose…").clicked() {
                    *action = Some(CardAction::Ask(ImportPath::Out));
                }
                text_field(ui, "Take goes to", "a new folder", &mut self.out);
            });
        });
    }

    fn buttons(&self, ui: &mut Ui, action: &mut Option<CardAction>) {
        let problem = self.problem();
        if let ImportStage::Writing(_, said) = &self.stage {
            ui.label(RichText::new(format!("{said}…")).color(theme::palette(ui).text2));
        }
        button_row(ui, |ui| {
            if matches!(self.stage, ImportStage::Writing(..)) {
                if text_button(ui, "Stop").clicked() {
                    *action = Some(CardAction::Stop);
                }
                return;
            }
            let create = ui.add_enabled_ui(problem.is_none(), |ui| primary_button(ui, "Create take")).inner;
            if create.on_disabled_hover_text(problem.unwrap_or_default()).clicked() {
                *action = Some(CardAction::Create);
            }
            if text_button(ui, "Cancel").clicked() {
                *action = Some(CardAction::Close);
            }
        });
    }

    /// Why no take can be written as it is.
    fn problem(&self) -> Option<&'static str> {
        let ImportStage::Found(looked) = &self.stage else {
            return Some("Choose a folder with footage first");
        };
        if looked.found.frame_rate.is_none() {
            return Some("Say how many frames a second there are");
        }
        let out = self.out.trim();
        if out.is_empty() {
            return Some("Say where the take goes");
        }
        Path::new(out).join("take.toml").exists().then_some("There is a take in that folder already")
    }
}

/// What was found: the calibration, each camera, and what there is to know about them.
fn found(ui: &mut Ui, looked: &SurveyedFolders, action: &mut Option<CardAction>) {
    let (found, palette) = (&looked.found, theme::palette(ui));
    calibration_row(ui, Some(&found.calibration), action);
    let of = format!(
        "{}, {} frames of {} cameras",
        format::capitalised(&found.project.to_string()),
        found.count,
        found.cameras.len()
    );
    ui.label(RichText::new(of).color(palette.text2));
    let below = ui.ctx().content_rect().bottom() - ui.cursor().top();
    let room = (below - CAMERAS).clamp(PICTURE + 8.0, 4.5 * (PICTURE + 8.0));
    let cameras =
        ScrollArea::vertical().max_height(room).min_scrolled_height(room).auto_shrink([false, true]);
    cameras.show(ui, |ui| {
        for (camera, picture) in found.cameras.iter().zip(&looked.pictures) {
            ui.horizontal_top(|ui| {
                let (rect, response) = ui.allocate_exact_size(vec2(PICTURE, PICTURE), Sense::hover());
                let name = camera.camera.name();
                response.widget_info(|| {
                    WidgetInfo::labeled(Role::Image, true, format!("First picture of {name}"))
                });
                ui.painter().rect_filled(rect, CornerRadius::ZERO, PICTURE_GROUND);
                if let Some(image) = picture {
                    let id = Id::unique(("new take", camera.pictures.path()));
                    let texture = cached_texture(ui.ctx(), id, image.size, false, || (**image).clone());
                    let [width, height] = image.size.map(|side| side as f32);
                    let scale = PICTURE / width.max(height);
                    let shown = Rect::from_center_size(rect.center(), vec2(width, height) * scale);
                    paint_whole(ui.painter(), &texture, shown);
                }
                ui.vertical(|ui| words(ui, camera, action));
            });
        }
        for (name, why) in &found.left_out {
            ui.label(RichText::new(format!("{name} is left out: {why}")).small().color(palette.warn));
        }
    });
    if found.matched_by == MatchedBy::Order {
        let text = "No names or numbers match, so footage was given to the cameras in its order. Compare the \
                    pictures.";
        ui.label(RichText::new(text).small().color(palette.warn));
    }
}

/// A camera: its footage, its size, its background.
fn words(ui: &mut Ui, camera: &ImportCamera, action: &mut Option<CardAction>) {
    let palette = theme::palette(ui);
    let (path, [width, height]) = (camera.pictures.path(), [camera.camera.width(), camera.camera.height()]);
    let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let kind = match &camera.pictures {
        Pictures::Video(video) => video.codec().to_owned(),
        Pictures::Numbered { .. } => "numbered pictures".to_owned(),
    };
    ui.label(RichText::new(camera.camera.name()).color(palette.text));
    let rate = camera.frame_rate.map_or_else(String::new, |rate| format!(", {rate:.2} a second"));
    let count = camera.pictures.count();
    let facts = format!("{file}, {kind}, {count} frames{rate}, {width} × {height}");
    ui.label(RichText::new(facts).small().color(palette.text2));
    let background = match (&camera.masks, &camera.plate, &camera.keypoints) {
        (Some(masks), ..) if masks.are_alone => "silhouettes: these masks, with no footage",
        (Some(_), ..) => "silhouettes: masks made elsewhere",
        (None, Some(_), _) => "background: a picture",
        (None, None, Some(_)) => "background: learnt from the footage, away from the keypoints",
        (None, None, None) => "background: learnt from the footage",
    };
    ui.label(RichText::new(background).small().color(palette.text2));
    if camera.picture_size != PictureSize::Same {
        let [width, height] = camera.calibrated_size;
        ui.horizontal(|ui| {
            let text = format!("the calibration is for {width} × {height}; pictures are");
            ui.label(RichText::new(text).small().color(palette.warn));
            let mut chosen = camera.picture_size;
            egui::ComboBox::from_id_salt(("picture size", camera.camera.name()))
                .width(200.0)
                .selected_text(RichText::new(chosen.to_string()).small())
                .show_ui(ui, |ui| {
                    for how in PictureSize::CHOICES {
                        ui.selectable_value(&mut chosen, how, how.to_string());
                    }
                });
            if chosen != camera.picture_size {
                *action = Some(CardAction::Pictures(chosen));
            }
        });
    }
    for note in &camera.notes {
        ui.label(RichText::new(note).small().color(palette.warn));
    }
}

fn calibration_row(ui: &mut Ui, path: Option<&Path>, action: &mut Option<CardAction>) {
    row(ui, "Calibration", |ui| {
        ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
            if text_button(ui, "Choose file…").clicked() {
                *action = Some(CardAction::Ask(ImportPath::Calibration));
            }
            let name = path.and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
            ui.with_layout(Direction::left_to_right(Align::Center), |ui| {
                ui.label(name.unwrap_or_else(|| "none".to_owned()));
            });
        });
    });
}

fn row(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        row_name(ui, name, NAMES);
        contents(ui);
    });
}
