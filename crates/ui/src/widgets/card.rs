//! Cards over the window, which wait for an answer or for Esc.

use egui::{Align2, Context, Frame, Id, Modal, vec2};

/// Distance of a search card's upper edge from the window's, as a share of its height.
const FROM_TOP: f32 = 0.16;

/// A card in the middle of the window.
pub fn card(ctx: &Context, name: &'static str) -> Modal {
    Modal::new(Id::unique(name)).frame(Frame::window(&ctx.global_style()))
}

/// A card that hangs from its upper edge: what is typed into stays where it is, however much is found.
pub fn search_card(ctx: &Context, name: &'static str) -> Modal {
    let below = (ctx.content_rect().height() * FROM_TOP).round();
    let area = Modal::default_area(Id::unique(name)).anchor(Align2::CENTER_TOP, vec2(0.0, below));
    card(ctx, name).area(area)
}
