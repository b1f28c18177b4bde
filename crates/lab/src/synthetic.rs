//! Bodies and scenes with known truth, most of them drawn by other geometry than the model's.
//!
//! | file | holds |
//! |---|---|
//! | [`motion`] | a two-second movement of the full body, its true pose at every moment |
//! | [`figure`] | the person as a smooth union of solids that are not capsules; [`Build`] for other people |
//! | [`room`] | a furnished room of blocks, cylinders and ellipsoids |
//! | [`studio`] | the cameras of the built-in take |
//! | [`render`] | rays into pictures: empty room, figure, shadows, edges |
//! | [`noise`] | the sensor: exposure, curve, noise |
//! | [`silhouettes`] | exact masks |
//! | [`exercise`] | different motions one after the other, whose names are looked for |
//! | [`capsules`] | exact masks and grey levels of a model's own capsules |
//! | [`squats`] | the full body's squats with raised arms, before two telephones |
//! | [`occlusions`] | arms folded, legs crossed and the like before two telephones |
//! | [`retarget`] | recorded motion on a body |
//! | [`upper_body`] | the report's upper body before its cameras: a movement |
//!
//! Nothing here reads a clock: the same numbers in give the same bytes out, on any number of threads.

mod anatomy;
pub mod capsules;
pub mod exercise;
pub mod figure;
mod furniture;
pub mod motion;
pub mod noise;
pub mod occlusions;
pub mod people;
pub mod render;
pub mod retarget;
pub mod room;
mod shading;
pub mod silhouettes;
mod solid;
pub mod squats;
pub mod studio;
pub mod upper_body;

pub use figure::{Build, Figure, Material};
pub use noise::Sensor;
pub use render::{Picture, Plate};
pub use room::Room;
pub use shading::Lighting;
pub use silhouettes::silhouette;
