//! A pose put together from templates, one after the other, where no start is known.
//!
//! After I. Mikić, M. Trivedi, E. Hunter and P. Cosman, "Human body model acquisition and tracking using voxel data", IJCV 53,
//! 2003, with pixels in the place of voxels:
//!
//! 1. **Head.** A ball of the skull's radius. Of all places inside the silhouettes that one is the head's at which the ball's
//!    outlines hold most border pixels, as shares of their lengths.
//! 2. **Trunk.** A template hangs from the neck. In every camera the centroid of the subject's pixels in it is taken; the point
//!    nearest to the rays of all centroids is q; the template turns about the neck to pass through q; and so on until it
//!    rests,
//!
//!    ```text
//!    q = argmin Σ m |(I − u uᵀ)(q − c)|² + ε Σm |q − middle|²,   d ← (q − neck)/|q − neck|
//!    ```
//!
//!    with a camera's centre c, its centroid's ray u and its pixels m; ε leaves the depth as it is where one camera alone sees it.
//!    Which way the trunk faces, its own limbs' Λ says.
//! 3. **Limbs.** Of the pixels that no template holds yet: thick limbs first, each from its joint, begun in the direction
//!    in which it holds most of the subject and least background, then turned as the trunk is; then the limb after it.
//!
//! The report's sizes of limbs are given here. Every turn is kept as a [`TemplateStep`]. The result is rough, the start of a fit.
//!
//! | file | holds |
//! |---|---|
//! | `options` | [`TemplateOptions`], errors |
//! | `pictures` | what a template holds in every camera, and the point nearest to the centroids' rays |
//! | `head` | the ball of the head |
//! | `frame` | the body's parts as templates: neck, trunk, chains |
//! | `trunk` | the trunk, turned until it rests, and the ways that it may face |
//! | `limbs` | limb after limb |
//! | `steps` | all of it, step by step |

mod frame;
mod head;
mod limbs;
mod options;
mod pictures;
mod steps;
mod trunk;

pub(crate) use frame::{Frame, Segment};
pub use options::{TemplateError, TemplateOptions};
pub(crate) use pictures::{Pictures, Template};
pub use steps::{Placed, TemplateStep, place};
