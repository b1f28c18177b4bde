//! Cards over the window, which wait for an answer or for Esc.

use egui::{Align, Align2, Context, Frame, Id, Layout, Modal, ModalResponse, Ui, Vec2, vec2};

/// Distance of a search card's upper edge from the window's, as a share of its height.
const FROM_TOP: f32 = 0.16;

/// A card over the window.
#[expect(missing_debug_implementations, reason = "egui has none for what it shows")]
pub struct Card {
    id: Id,
    modal: Modal,
}

impl Card {
    /// Shows it. A card is placed by the size that it had a frame before: where that has changed, another frame is drawn at once,
    /// so that nothing moves under the pointer later.
    pub fn show<T>(self, ctx: &Context, contents: impl FnOnce(&mut Ui) -> T) -> ModalResponse<T> {
        let shown = self.modal.show(ctx, contents);
        let (id, size) = (self.id.with("size"), shown.response.rect.size());
        let before: Option<Vec2> = ctx.data_mut(|data| data.get_temp(id));
        if before != Some(size) {
            ctx.data_mut(|data| data.insert_temp(id, size));
            ctx.request_repaint();
        }
        shown
    }
}

/// A card in the middle of the window.
pub fn card(ctx: &Context, name: &'static str) -> Card {
    let id = Id::unique(name);
    Card { id, modal: Modal::new(id).frame(Frame::window(&ctx.global_style())) }
}

/// A card that hangs from its upper edge: what is typed into stays where it is, however much is found.
pub fn search_card(ctx: &Context, name: &'static str) -> Card {
    let below = (ctx.content_rect().height() * FROM_TOP).round();
    let area = Modal::default_area(Id::unique(name)).anchor(Align2::CENTER_TOP, vec2(0.0, below));
    let Card { id, modal } = card(ctx, name);
    Card { id, modal: modal.area(area) }
}

/// The buttons at the lower right of a card, from the right to the left.
pub fn button_row<T>(ui: &mut Ui, buttons: impl FnOnce(&mut Ui) -> T) -> T {
    // In a row of its own: by itself it would be as high as the card was before.
    ui.horizontal(|ui| ui.with_layout(Layout::right_to_left(Align::Center), buttons).inner).inner
}
