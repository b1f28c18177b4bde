//! Widgets that egui does not have, drawn with the tokens of [`crate::style::theme`].
//!
//! Every one of them has a role and an accessible name, so tests and screen readers find it.

pub mod accessible;
mod buttons;
mod cards;
mod curves;
mod handles;
pub mod heat_map;
mod icons;
pub mod image_canvas;
mod marks;
mod slider;
mod still_plot;
mod work_card;

pub use buttons::{
    CHEVRON, camera_badge, checkbox, choice, icon_button, icon_toggle, menu_words, paint_camera_badge,
    primary_button, segmented, text_button,
};
pub use cards::{
    Card, button_row, card, cut_off, first_that_fits, fitting_label, named_section, paint_text, search_card,
    search_field, section, text_field, two_words, within,
};
pub use curves::{PointMark, apart, end_with_room, mark_points, paint_run_sample, run_line};
pub use handles::{Grip, JointLook, SizeHandles, grip_at};
pub use icons::Icon;
pub use image_canvas::{Framing, ViewTransform, paint_whole};
pub use marks::{Overlay, cased};
pub use slider::{
    SliderRow, ValueSlider, focus_holds_arrows_only, hint, hold_arrows, named_row, number_field, row_name,
};
pub use still_plot::{grid_marks, still_plot};
pub use work_card::{WorkAnswer, work_buttons, work_head, work_progress, work_results, work_row};
