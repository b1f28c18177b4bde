//! The panels: one file is one panel is one function. They read [`Showing`](crate::showing::Showing) and push
//! [`Intents`](crate::showing::Intents); none of them has the document. A tile's events come back as values.

pub(crate) mod about;
mod camera_subsets;
pub mod camera_tile;
mod command;
pub(crate) mod convergence;
pub(crate) mod dock;
pub(crate) mod drop_overlay;
pub(crate) mod empty;
pub(crate) mod explanation;
pub(crate) mod export_dialog;
mod joint;
pub(crate) mod laboratory;
mod measurement;
mod menus;
pub(crate) mod messages;
pub(crate) mod notice_cards;
mod observability;
mod other_poses;
pub(crate) mod palette;
mod pose;
mod recent;
mod refit;
mod renderer;
pub(crate) mod right_panel;
mod runs;
mod scene;
pub(crate) mod shortcuts;
mod sizes;
mod solver;
pub(crate) mod status_bar;
mod steps;
pub(crate) mod tiles;
pub(crate) mod timeline;
pub(crate) mod toolbar;
pub(crate) mod tour;
mod tracking_choices;
pub(crate) mod words;

pub use camera_tile::{CameraTileInput, Comparison, Drag, ObservedMarks, TileEvent, TileLook, camera_tile};
pub(crate) use command::dragged_until_now;
pub(crate) use observability::{length, name_of};
pub(crate) use pose::rotation_tree;
pub(crate) use renderer::renderer_of;
pub(crate) use solver::preset_of;
pub use timeline::{Span, TimelineEvent};
pub(crate) use toolbar::view_mode_of;
