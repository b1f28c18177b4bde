//! The measurement prediction Λ(X) (4.16): the model's soft silhouette in each camera, with derivatives.
//!
//! A ray goes through every pixel; d is its distance to a limb; a ramp turns d into a grey level λ
//! (0 = subject, 255 = background). Over limbs the darkest wins: λ is compared, never d, because radii differ.
//!
//! | | |
//! |---|---|
//! | [`RendererKind`] | which solid a limb is, and what is said of it |
//! | [`Ramp`] | distance to grey level: `thesis`, `half`, `width`, `distance` |
//! | [`View`] | all solids of a pose prepared for one camera; what a pixel of it sees |
//! | [`predict`], [`Prediction`] | Λ as a picture, with the limb that owns each pixel |
//! | [`draw`], [`Drawing`] | Λ and derivatives as pictures for the screen, fast |
//! | [`dense_jacobian`], [`jacobian_along`] | ∂Λ/∂X: all of it, along a direction |
//! | [`prediction`] | λ alone: in f64, as a picture, as a coverage |
//! | [`Mismatch`] | Σ w (D − Λ)² of what was drawn, in all and for each limb |
//! | [`wrench`] | a pixel's gradient as force and moment on its limb |
//!
//! Two kernels find which solid wins each pixel of a row. The reference is plain f64, one pixel and one solid at a
//! time, and stays for ever: the fast one, in f32 lanes of whatever width the processor has, is tested against it. Which
//! of them a view gets says [`View::suits_lanes`].

mod drawing;
mod footprint;
mod jacobian;
mod kernels;
mod mismatch;
pub mod prediction;
mod primitive;
mod ramp;
mod renderer;
mod view;
pub mod wrench;

pub(crate) use kernels::lanes::{Lanes, PixelGrid};
pub(crate) use kernels::scalar::RowWinners;
pub(crate) use primitive::Primitive;
pub(crate) use wrench::JointBlock;

pub use drawing::{DrawOptions, Drawing, MOST_ERROR, draw, draw_over, draw_plainly, predict};
pub use footprint::Footprint;
pub use jacobian::{BodyMotion, dense_jacobian, jacobian_along};
pub use mismatch::{BodilessMismatch, Mismatch};
pub use prediction::Prediction;
pub use primitive::sphere_fractions;
pub use ramp::{BACKGROUND, Ramp};
pub use renderer::{MAX_SPHERES, ParseError, RendererKind};
pub use view::{PixelPull, SeenLimb, View};
