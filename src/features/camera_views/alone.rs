//! A camera's picture without header and gutter: what an export shows.

use egui::{Context, Id, Rect, Ui, UiBuilder};

use super::{CameraTileInput, TileLayout, TileState, picture_view};

/// What an exported picture of a camera has besides the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PictureAlone {
    /// The camera.
    pub(crate) camera: usize,
    /// Joints, limbs and rays.
    pub(crate) marks: bool,
    /// The strip that explains the colours, under the picture.
    pub(crate) legend: bool,
}

impl PictureAlone {
    /// Height of the strip in the last frame.
    pub(crate) fn legend_height(ctx: &Context) -> f32 {
        ctx.data(|data| data.get_temp(legend_id())).unwrap_or(0.0)
    }

    /// Shows the picture in all of the space that `ui` has.
    pub(crate) fn ui(self, ui: &mut Ui, input: &CameraTileInput<'_>) {
        let picture = ui.max_rect();
        let reserved = Self::legend_height(ui.ctx());
        let layout =
            TileLayout { header: Rect::NOTHING, picture, gutter: None, reserved, has_legend: self.legend };
        let mut input = *input;
        input.shows_hover_card = false;
        if !self.marks {
            (input.joints, input.limbs, input.outlines) = (&[], &[], &[]);
            (input.selected, input.sight_ray, input.quick_outline) = (None, None, None);
            input.limits = &[];
            input.settings.calibration_marks = false;
        }
        let id = ui.scope_id().with("picture alone");
        ui.scope_builder(UiBuilder::new().max_rect(picture), |ui| {
            let height =
                picture_view::show(ui, id, &layout, &input, &mut TileState::default(), &mut Vec::new());
            ui.data_mut(|data| data.insert_temp(legend_id(), height));
        });
    }
}

fn legend_id() -> Id {
    Id::unique("height of the legend")
}
