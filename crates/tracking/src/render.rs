//! The measurement prediction Λ(X) (4.16): the model's soft silhouette in each camera, with derivatives.
//!
//! A ray goes through every pixel; d is its distance to a limb; a ramp turns d into a grey level λ
//! (0 = subject, 255 = background). Over limbs the darkest wins: λ is compared, never d, because radii differ.
//!
//! | file | holds |
//! |---|---|
//! | [`ramp`] | distance to grey level: `thesis`, `half`, `width`, `distance` |
//! | [`radius_rate`] | how a grey level changes with the limb's radius |
//! | [`renderer`] | which solid a limb is: cylinder, capsule, sphere tree |
//! | [`primitive`] | one solid in camera axes, seen along a ray |
//! | [`view`] | all solids of a pose prepared for one camera, with conservative pixel boxes |
//! | [`wrench`] | a pixel's gradient as force and moment on its limb |
//! | [`joint_forces`] | the same as forces at the limb's two joints |
//! | [`prediction`] | Λ as a picture, with owner and depth |
//! | [`drawing`] | Λ and derivatives as pictures for the screen, fast |
//! | [`jacobian`] | the dense ∂Λ/∂X, for tests, inspection and export |
//! | [`kernels`] | which primitive wins each pixel of a row |

pub mod drawing;
pub mod jacobian;
pub mod joint_forces;
pub mod kernels;
pub mod prediction;
pub mod primitive;
pub mod radius_rate;
pub mod ramp;
pub mod renderer;
pub mod view;
pub mod wrench;

pub use drawing::{Drawing, Wanted, draw, predict};
pub use jacobian::dense_jacobian;
pub use prediction::Prediction;
pub use ramp::Ramp;
pub use renderer::RendererKind;
pub use view::{Sight, View};
