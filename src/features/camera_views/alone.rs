//! A camera's picture without header and gutter: what an export shows.

use egui::{Rect, Ui, UiBuilder};

use super::tile::{TileLayout, TileState};
use super::{CameraTileInput, picture_view};
use crate::context::picture_alone::PictureAlone;

/// Shows the picture in all of the space that `ui` has, above a legend that was so high in the last frame. Gives the
/// legend's height in this one.
pub(super) fn ui(
    ui: &mut Ui,
    mut input: CameraTileInput<'_>,
    alone: PictureAlone,
    legend_height: f32,
) -> f32 {
    let picture = ui.max_rect();
    let layout = TileLayout {
        header: Rect::NOTHING,
        picture,
        gutter: None,
        reserved: legend_height,
        has_legend: alone.legend,
    };
    input.shows_hover_card = false;
    if !alone.marks {
        (input.joints, input.limbs, input.outlines) = (&[], &[], &[]);
        (input.selected, input.sight_ray, input.quick_outline) = (None, None, None);
        (input.limits, input.sides) = (&[], None);
        input.settings.calibration_marks = false;
    }
    let id = ui.scope_id().with("picture alone");
    let scope = ui.scope_builder(UiBuilder::new().max_rect(picture), |ui| {
        picture_view::show(ui, id, &layout, &input, &mut TileState::default(), &mut Vec::new())
    });
    scope.inner.1
}
