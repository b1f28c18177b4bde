//! Widgets that egui does not have, drawn with the tokens of [`crate::style::theme`].
//!
//! Every one of them has a role and an accessible name, so tests and screen readers find it.

pub mod accessible;
mod badge;
mod button;
mod calibration_marks;
mod card;
mod checkbox;
mod choice;
mod fitting_label;
mod handles;
pub mod heat_map;
mod icons;
pub mod image_canvas;
mod limit_marks;
mod picture_marks;
mod section;
mod segmented;
mod side_marks;
mod size_handles;
mod slider;
mod slider_row;
mod still_plot;
mod text_field;

pub use badge::{camera_badge, paint_camera_badge};
pub use button::{icon_button, icon_toggle, primary_button};
pub use calibration_marks::paint_calibration;
pub use card::{Card, button_row, card, search_card};
pub use checkbox::checkbox;
pub use choice::choice;
pub use fitting_label::{first_that_fits, fitting_label};
pub use handles::{Grip, JointLook, grip_at, paint_joint, paint_limbs};
pub use icons::Icon;
pub use image_canvas::{Framing, ViewTransform};
pub use limit_marks::{paint_limit_words, paint_limits};
pub use picture_marks::{paint_body_outline, paint_limb_edges, paint_quick_outline, paint_sight_ray};
pub use section::{named_section, section};
pub use segmented::segmented;
pub use side_marks::paint_sides;
pub use size_handles::SizeHandles;
pub use slider::{ValueSlider, focus_holds_arrows_only, hold_arrows};
pub use slider_row::{SliderRow, hint, named_row, number_field, row_name};
pub use still_plot::{grid_marks, still_plot};
pub use text_field::{search_field, text_field};
