//! Widgets that egui does not have, drawn with the tokens of [`crate::theme`].
//!
//! Every one of them has a role and an accessible name, so tests and screen readers find it.

mod badge;
mod button;
mod checkbox;
mod icons;
mod segmented;
mod slider;

pub use badge::{camera_badge, paint_camera_badge};
pub use button::{icon_button, icon_toggle, primary_button};
pub use checkbox::checkbox;
pub use icons::Icon;
pub use segmented::segmented;
pub use slider::ValueSlider;
