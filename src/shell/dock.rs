//! The centre: panes in tiles that are split, dragged by their headers, stacked, closed and filled the window
//! with.

use backlit_ui::style::theme::{self, Palette, size, space};
use backlit_ui::widgets::{Icon, camera_badge, icon_button, text_button, within};
use egui::{
    Align, Button, Color32, Layout as Direction, Popup, Rect, Role, Sense, Stroke, Ui, UiBuilder, Visuals,
    WidgetInfo, pos2, vec2,
};
use egui_tiles::{Behavior, EditAction, ResizeState, TabState, Tabs, TileId, Tiles, UiResponse};

use super::docking::Docking;
use crate::context::arrangement::{Arrangement, Centre, automatic, has_strip, panes_with, snap};
use crate::context::command::{Command, WindowCommand};
use crate::context::pane::{HEADER_BUTTONS, Pane};
use crate::context::{Context, PaneEvent, Requests, ShellRequest};
use crate::features::Features;
use crate::features::camera_views::TilePlace;

/// Height of the strip that names the cameras where two are shown.
const STRIP: f32 = 30.0;
/// Height of the bar of tabs.
const TABS: f32 = 26.0;
/// How much of the accent lies where a dragged tile would go.
const DROP_TINT: f32 = 0.22;

/// The centre, in all of the space that is left.
pub(crate) fn ui(
    ui: &mut Ui,
    context: &Context<'_>,
    features: &mut Features,
    docking: &Docking,
    requests: &mut Requests,
) {
    let mut rect = ui.available_rect_before_wrap();
    ui.painter().rect_filled(rect, 0.0, theme::palette(ui).well);
    if let Some(pane) = docking.alone {
        // Alone in the window, a camera has the badges of all others.
        let cameras = (0..context.session.camera_count()).map(Pane::Camera);
        let others: Vec<Pane> = match pane {
            Pane::Camera(_) => cameras.filter(|other| *other != pane).collect(),
            _ => Vec::new(),
        };
        let input = Contents { context, docking, pane, siblings: &others };
        contents(ui, rect, &input, features, requests);
        return;
    }
    let cameras = context.session.camera_count();
    let centre = Centre {
        layout: context.preferences.layout,
        cameras,
        pair: docking.pair,
        size: rect.size(),
        aspect: context.session.aspect(),
    };
    let kept = context.preferences.kept.get(centre.layout, cameras);
    if kept.is_none() && has_strip(&centre) {
        let strip = Rect::from_min_max(pos2(rect.left(), rect.bottom() - STRIP), rect.max);
        rect.set_bottom(strip.top());
        strip_of_cameras(ui, context, docking.pair, strip, requests);
    }
    let mut tree = kept.cloned().unwrap_or_else(|| automatic(&centre));
    let before = tree.clone();
    let mut behavior = Dock {
        context,
        docking,
        shows_siblings: kept.is_some() || !has_strip(&centre),
        features,
        requests,
        before: &before,
        edit: None,
    };
    ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| tree.ui(&mut behavior, ui));
    let edit = behavior.edit.take();
    if tree.active_tiles().is_empty() {
        nothing_open(ui, rect, requests);
    }
    match edit {
        Some(EditAction::TileResized) => {
            if let Some(pointer) = ui.input(|input| input.pointer.latest_pos()) {
                snap(&before, &mut tree, pointer);
            }
            requests.request(ShellRequest::Arrange(Box::new(tree)));
        }
        Some(EditAction::TileDropped | EditAction::TabSelected) => {
            requests.request(ShellRequest::Arrange(Box::new(tree)));
        }
        Some(EditAction::TileDragged) | None => {}
    }
}

/// What stands in a tile.
struct Contents<'a> {
    context: &'a Context<'a>,
    docking: &'a Docking,
    pane: Pane,
    /// Panes that stand behind this one.
    siblings: &'a [Pane],
}

/// Shows a pane; whether its tile is dragged away by its header.
fn contents(
    ui: &mut Ui,
    rect: Rect,
    input: &Contents<'_>,
    features: &mut Features,
    requests: &mut Requests,
) -> bool {
    let Contents { context, docking, pane, siblings } = *input;
    let mut dragged = false;
    ui.scope_builder(UiBuilder::new().scope_id(pane.scope()).max_rect(rect), |ui| {
        ui.set_clip_rect(rect.intersect(ui.clip_rect()));
        if let Pane::Camera(camera) = pane {
            let place = TilePlace { camera, is_alone: docking.alone == Some(pane), siblings };
            dragged = features.camera_views.pane(ui, context, place, requests);
        } else if let Some(feature) = features.of_pane(pane) {
            dragged = handle(ui, rect, pane, requests);
            feature.pane(ui, context, siblings, requests);
            header_buttons(ui, rect, pane, docking.alone == Some(pane), requests);
        }
    });
    dragged
}

/// The header of a pane that is no camera: drag it, or make it large. It lies under the pane's own widgets.
fn handle(ui: &Ui, rect: Rect, pane: Pane, requests: &mut Requests) -> bool {
    let header = Rect::from_min_size(rect.min, vec2(rect.width(), size::TILE_HEADER));
    let response = ui.interact(header, ui.scope_id().with("handle"), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::TitleBar, true, format!("{} header", pane.title())));
    if response.double_clicked() {
        requests.request(ShellRequest::Pane(pane, PaneEvent::ToggleAlone));
    }
    response.drag_started()
}

/// Full window and more, at the right end of the header.
fn header_buttons(ui: &mut Ui, rect: Rect, pane: Pane, is_alone: bool, requests: &mut Requests) {
    let title = pane.title();
    let left = pos2(rect.right() - HEADER_BUTTONS, rect.top());
    let place = Rect::from_min_size(left, vec2(HEADER_BUTTONS, size::TILE_HEADER));
    within(ui, place, Direction::left_to_right(Align::Center), |ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        let tooltip = if is_alone { "Back to all tiles" } else { "Fill the window with this tile" };
        if icon_button(ui, Icon::Expand, &format!("Expand {title}"), tooltip).clicked() {
            requests.request(ShellRequest::Pane(pane, PaneEvent::ToggleAlone));
        }
        let more = icon_button(ui, Icon::More, &format!("More for {title}"), "More");
        Popup::menu(&more).show(|ui| {
            let close = ui.add(Button::new("Close tile"));
            if close.on_hover_text("The View menu opens it again").clicked() {
                requests.request(ShellRequest::Pane(pane, PaneEvent::Close));
            }
        });
    });
}

fn nothing_open(ui: &mut Ui, rect: Rect, requests: &mut Requests) {
    let middle = Rect::from_center_size(rect.center(), vec2(320.0, 64.0));
    within(ui, middle, Direction::top_down(Align::Center), |ui| {
        ui.label("All tiles are closed.");
        let command = Command::Window(WindowCommand::ArrangeTiles);
        let button = text_button(ui, command.text());
        if button.on_hover_text(command.tooltip()).clicked() {
            requests.run(command);
        }
    });
}

fn strip_of_cameras(
    ui: &mut Ui,
    context: &Context<'_>,
    pair: [usize; 2],
    strip: Rect,
    requests: &mut Requests,
) {
    let palette = theme::palette(ui);
    ui.painter().rect_filled(strip, 0.0, palette.raised);
    let inner = strip.shrink2(vec2(space::WIDGET, 0.0));
    within(ui, inner, Direction::left_to_right(Align::Center), |ui| {
        for camera in 0..context.session.camera_count() {
            let response = camera_badge(ui, camera);
            if pair.contains(&camera) {
                let line = response.rect.translate(vec2(0.0, 4.0));
                ui.painter().hline(line.x_range(), line.bottom(), Stroke::new(2.0, palette.text));
            }
            if response.on_hover_text(format!("Show camera {}", camera + 1)).clicked() {
                requests.request(ShellRequest::Camera(camera));
            }
        }
        let text =
            egui::RichText::new("There is room for two views. Click a number to see another camera").small();
        ui.label(text.color(palette.text3));
    });
}

/// How the tree is shown.
struct Dock<'a> {
    context: &'a Context<'a>,
    docking: &'a Docking,
    /// Whether panes that stand behind one are named in its header.
    shows_siblings: bool,
    features: &'a mut Features,
    requests: &'a mut Requests,
    before: &'a Arrangement,
    edit: Option<EditAction>,
}

impl Dock<'_> {
    fn palette(visuals: &Visuals) -> &'static Palette {
        let theme = if visuals.dark_mode { theme::Theme::Dark } else { theme::Theme::Light };
        theme::colours(theme)
    }

    fn siblings(&self, pane: Pane) -> Vec<Pane> {
        if !self.shows_siblings {
            return Vec::new();
        }
        panes_with(self.before, pane).into_iter().filter(|other| *other != pane).collect()
    }
}

impl Behavior<Pane> for Dock<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile_id: TileId, pane: &mut Pane) -> UiResponse {
        let siblings = self.siblings(*pane);
        let input =
            Contents { context: self.context, docking: self.docking, pane: *pane, siblings: &siblings };
        let dragged = contents(ui, ui.max_rect(), &input, self.features, self.requests);
        if dragged { UiResponse::DragStarted } else { UiResponse::None }
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> egui::WidgetText {
        pane.title().into()
    }

    fn tab_title_for_tile(&mut self, tiles: &Tiles<Pane>, tile_id: TileId) -> egui::WidgetText {
        let mut left = vec![tile_id];
        let mut titles = Vec::new();
        while let Some(id) = left.pop() {
            match tiles.get(id) {
                Some(egui_tiles::Tile::Pane(pane)) => titles.push(pane.title()),
                Some(egui_tiles::Tile::Container(container)) => left.extend(container.children().copied()),
                None => {}
            }
        }
        titles.sort();
        titles.join(", ").into()
    }

    /// Panes stand behind each other without a bar: their headers name the others. Only what is split has none.
    fn is_tab_bar_visible(&self, _tile_id: TileId, tabs: &Tabs) -> bool {
        !tabs.children.iter().all(|child| self.before.tiles.get_pane(child).is_some())
    }

    fn on_tab_button(
        &mut self,
        tiles: &mut Tiles<Pane>,
        tile_id: TileId,
        response: egui::Response,
    ) -> egui::Response {
        if let Some(pane) = tiles.get_pane(&tile_id)
            && response.double_clicked()
        {
            self.requests.request(ShellRequest::Pane(*pane, PaneEvent::ToggleAlone));
        }
        response
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        TABS
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        space::TILE_GAP
    }

    fn min_size(&self) -> f32 {
        size::TILE_LEAST
    }

    fn dragged_overlay_color(&self, visuals: &Visuals) -> Color32 {
        Self::palette(visuals).well.gamma_multiply(0.6)
    }

    fn resize_stroke(&self, style: &egui::Style, resize_state: ResizeState) -> Stroke {
        let palette = Self::palette(&style.visuals);
        let colour = match resize_state {
            ResizeState::Idle => palette.well,
            ResizeState::Hovering => palette.line2,
            ResizeState::Dragging => palette.accent,
        };
        Stroke::new(space::TILE_GAP, colour)
    }

    fn tab_bar_color(&self, visuals: &Visuals) -> Color32 {
        Self::palette(visuals).well
    }

    fn tab_bg_color(&self, visuals: &Visuals, _: &Tiles<Pane>, _: TileId, state: &TabState) -> Color32 {
        let palette = Self::palette(visuals);
        if state.active { palette.raised } else { palette.well }
    }

    fn tab_outline_stroke(&self, _: &Visuals, _: &Tiles<Pane>, _: TileId, _: &TabState) -> Stroke {
        Stroke::NONE
    }

    fn tab_bar_hline_stroke(&self, _: &Visuals) -> Stroke {
        Stroke::NONE
    }

    fn tab_text_color(&self, visuals: &Visuals, _: &Tiles<Pane>, _: TileId, state: &TabState) -> Color32 {
        let palette = Self::palette(visuals);
        if state.active { palette.text } else { palette.text2 }
    }

    fn drag_preview_stroke(&self, visuals: &Visuals) -> Stroke {
        Self::palette(visuals).active_tile()
    }

    fn drag_preview_color(&self, visuals: &Visuals) -> Color32 {
        Self::palette(visuals).accent.gamma_multiply(DROP_TINT)
    }

    fn on_edit(&mut self, edit_action: EditAction) {
        self.edit = Some(edit_action);
    }
}
