//! One file = one panel = one function. Panels read; what the user does comes back as values, and the app applies
//! it after the frame.

pub mod camera_tile;

pub use camera_tile::{CameraTileInput, Drag, TileEvent, Wipe, camera_tile};
