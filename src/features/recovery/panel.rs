//! Unsaved work that an earlier start of the program left unsaved: a card for each copy, the newest first.

use backlit_ui::style::theme::data_colours::PICTURE_GROUND;
use backlit_ui::style::theme::{size, space, title};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::image_canvas::cached_texture;
use backlit_ui::widgets::{card as over, paint_text, paint_whole, primary_button, text_button, within};
use egui::{
    Align, CornerRadius, Id, Label, Layout as Direction, Margin, Rect, RichText, Role, ScrollArea, Sense, Ui,
    WidgetInfo, pos2, vec2,
};

use super::{Recovery, UnsavedCopy};
use crate::context::clock::Clock;
use crate::context::{Context, Decision, FeatureRequest, Requests};

/// Width of a card.
const WIDTH: f32 = 560.0;
/// Side of the square that the picture lies in.
const PICTURE: f32 = 112.0;
/// What stands around the cards where they are over a take: title, buttons, margins.
const AROUND: f32 = 200.0;
/// What stands below the cards: buttons, and how to open something else.
const BELOW: f32 = 150.0;

impl Recovery {
    /// The cards, and what may be done with all of them; what the user has decided.
    pub(crate) fn ui(&self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) -> Option<Decision> {
        let room = ui.available_height() - BELOW;
        let decision = self.cards(ui, room, context, requests);
        ui.add_space(space::PAGE_MARGIN);
        decision
    }

    /// The same with cards that are `room` high together.
    fn cards(
        &self,
        ui: &mut Ui,
        room: f32,
        context: &Context<'_>,
        requests: &mut Requests,
    ) -> Option<Decision> {
        let decision = cards(ui, &self.offered, context.clock, room.max(PICTURE + 2.0 * space::GROUP));
        if let Some(decision) = decision {
            requests.request(FeatureRequest::Recover(decision));
        }
        decision
    }

    /// The same over the window; whether it stays open.
    pub(super) fn show(&self, ui: &Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        let modal = over(ui.ctx(), "unsaved work").show(ui.ctx(), |ui| {
            ui.set_width(WIDTH);
            // A card over the window is no taller than it was, unless it is told to be.
            let room = ui.ctx().content_rect().height() - AROUND;
            self.cards(ui, room, context, requests)
        });
        let stays = match modal.inner {
            None => true,
            // Of several the next may be decided.
            Some(Decision::Discard(_)) => self.offered.len() > 1,
            Some(Decision::Restore(_) | Decision::DiscardAll | Decision::Later) => false,
        };
        stays && !modal.should_close()
    }
}

fn cards(ui: &mut Ui, offered: &[UnsavedCopy], clock: &Clock, room: f32) -> Option<Decision> {
    let palette = theme::palette(ui);
    let mut decision = None;
    ui.label(RichText::new("Unsaved work is kept").text_style(title()).color(palette.text));
    ui.add_space(space::WIDGET);
    let area = ScrollArea::vertical().max_height(room).min_scrolled_height(room);
    area.auto_shrink([false, true]).show(ui, |ui| {
        ui.vertical_centered(|ui| {
            for index in 0..offered.len() {
                decision = card(ui, offered, index, clock).or(decision);
            }
        });
    });
    ui.add_space(space::ROW);
    all(ui, offered.len()).or(decision)
}

fn card(ui: &mut Ui, offered: &[UnsavedCopy], index: usize, clock: &Clock) -> Option<Decision> {
    let mut decision = None;
    let palette = theme::palette(ui);
    let left = &offered[index];
    let frame = palette.raised_frame(size::BUTTON_RADIUS, Margin::same(10));
    let outside = vec2(WIDTH, PICTURE + 20.0 + space::WIDGET);
    ui.allocate_ui_with_layout(outside, Direction::top_down(Align::Min), |ui| {
        frame.show(ui, |ui| {
            ui.set_width(WIDTH - 20.0);
            ui.horizontal_top(|ui| {
                picture(ui, left);
                ui.add_space(space::ROW);
                let size = vec2(ui.available_width(), PICTURE);
                let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
                words(ui, rect, left, clock);
                let row = Rect::from_min_max(pos2(rect.left(), rect.bottom() - size::BUTTON), rect.max);
                decision = within(ui, row, Direction::left_to_right(Align::Center), |ui| {
                    buttons(ui, offered, index, clock)
                });
            });
        });
        ui.add_space(space::WIDGET);
    });
    decision
}

fn picture(ui: &mut Ui, left: &UnsavedCopy) {
    let palette = theme::palette(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(PICTURE, PICTURE), Sense::hover());
    let label = if left.picture.is_some() { "Silhouette and body" } else { "No picture" };
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, format!("{label}, {}", left.take)));
    ui.painter().rect_filled(rect, CornerRadius::ZERO, PICTURE_GROUND);
    let Some(image) = &left.picture else {
        let colour = theme::colours(theme::Theme::Dark).text3;
        let (middle, small) = (egui::Align2::CENTER_CENTER, egui::TextStyle::Small);
        paint_text(ui, rect.center(), middle, "No picture", small, colour);
        return;
    };
    let id = Id::unique(("recovery", &left.path));
    let texture = cached_texture(ui.ctx(), id, left.saved, false, || (**image).clone());
    let [width, height] = image.size.map(|side| side as f32);
    let scale = PICTURE / width.max(height);
    let shown = Rect::from_center_size(rect.center(), vec2(width, height) * scale);
    paint_whole(ui.painter(), &texture, shown);
    ui.painter().rect_stroke(rect, CornerRadius::ZERO, palette.edge(), egui::StrokeKind::Inside);
    let hover = "What the camera on the screen showed: grey is agreement, orange is missing, blue is \
                 spurious";
    response.on_hover_text(hover);
}

fn words(ui: &mut Ui, rect: Rect, left: &UnsavedCopy, clock: &Clock) {
    let palette = theme::palette(ui);
    within(ui, rect, Direction::top_down(Align::Min), |ui| {
        ui.spacing_mut().item_spacing.y = 3.0;
        let heading = RichText::new(&left.take).heading().color(palette.text);
        ui.add(Label::new(heading).truncate()).on_hover_text(left.path.display().to_string());
        for (text, colour) in [
            (format::capitalised(&left.when(clock)), palette.text),
            (format!("{}: {}", left.place(), format::uncapitalised(&left.work())), palette.text2),
        ] {
            ui.add(Label::new(RichText::new(text).color(colour)).truncate());
        }
        let belongs =
            ui.add(Label::new(RichText::new(left.belongs()).small().color(palette.text3)).truncate());
        if let Some(project) = &left.about.project {
            belongs.on_hover_text(project.display().to_string());
        }
    });
}

fn buttons(ui: &mut Ui, offered: &[UnsavedCopy], index: usize, clock: &Clock) -> Option<Decision> {
    let left = &offered[index];
    let hover = "Go on with it; it stays unsaved until you save it";
    let restore = if index == 0 { primary_button(ui, "Restore") } else { text_button(ui, "Restore") };
    let discard = text_button(ui, "Discard");
    if offered.len() > 1 {
        // Who only hears the buttons is to know which copy they are about.
        for (response, word) in [(&restore, "Restore"), (&discard, "Discard")] {
            let name = format!("{word} {}, {}", left.take, left.when(clock));
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
        }
    }
    let restores = restore.on_hover_text(hover).clicked().then_some(Decision::Restore(index));
    let hover = "It is no longer offered, but can be opened as a project later";
    restores.or(discard.on_hover_text(hover).clicked().then_some(Decision::Discard(index)))
}

/// What may be done with all copies at once.
fn all(ui: &mut Ui, count: usize) -> Option<Decision> {
    let mut decision = None;
    let row = vec2(WIDTH, size::BUTTON);
    ui.allocate_ui_with_layout(row, Direction::right_to_left(Align::Center), |ui| {
        let mut button = |text: &str, hover: &str, choice| {
            let button = text_button(ui, text);
            if button.on_hover_text(hover).clicked() {
                decision = Some(choice);
            }
        };
        button("Decide later", "All of it is kept, and the File menu offers it", Decision::Later);
        if count > 1 {
            let hover = "None of them is offered any longer; they can be opened as projects later";
            button("Discard all", hover, Decision::DiscardAll);
        }
    });
    decision
}
