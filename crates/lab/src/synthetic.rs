//! Bodies and scenes with known truth, most of them drawn by other geometry than the model's.
//!
//! | file | holds |
//! |---|---|
//! | [`motion`] | a two-second movement of the full body, its true pose at every moment |
//! | [`figure`] | the person as a smooth union of solids that are not capsules; [`Build`] for other clothes |
//! | [`room`] | a furnished room of blocks, cylinders and ellipsoids |
//! | [`studio`] | the cameras of the built-in take |
//! | [`render`] | rays into pictures: empty room, figure, shadows, edges |
//! | [`noise`] | the sensor: exposure, curve, noise |
//! | [`masks`] | exact masks of the figure, and masks with known faults |
//! | [`occlusions`] | arms folded, legs crossed and the like before two telephones |
//! | [`exercise`] | different motions one after the other, whose names are looked for |
//! | [`capsules`] | exact masks and grey levels of a model's own capsules |
//! | [`squats`] | the full body's squats with raised arms, before two telephones |
//! | [`filmed`] | what the telephones see of squats: pictures, masks, keypoints |
//! | [`single_limb`] | one limb seen from the side |
//! | [`people`] | people of several builds |
//! | [`take`] | any motion filmed as a take, with its truth |
//! | [`two_people`] | two people who pass each other, as a take of masks |
//! | [`upper_body`] | the report's upper body before its cameras: a movement |
//!
//! Nothing here reads a clock: the same numbers in give the same bytes out, on any number of threads.

mod anatomy;
pub mod capsules;
pub mod exercise;
pub mod figure;
pub mod filmed;
mod furniture;
mod hulls;
pub mod masks;
pub mod motion;
pub mod noise;
pub mod occlusions;
pub mod people;
pub mod render;
pub mod room;
mod shading;
pub mod single_limb;
mod solid;
pub mod squats;
pub mod studio;
pub mod take;
pub mod two_people;
pub mod upper_body;

pub use figure::{Build, Figure};
pub use masks::silhouette;
pub use noise::Sensor;
pub use render::{Picture, Plate};
pub use room::Room;
