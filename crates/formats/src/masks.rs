//! Masks made elsewhere, by a neural net or a keyer: pictures or a video of one camera's silhouettes.
//!
//! | file | holds |
//! |---|---|
//! | `numbers` | a picture's numbers as its file has them: grey levels, ids of a palette, alpha |
//! | `values` | [`MaskValues`]: what the numbers mean, told or guessed from some pictures |
//! | `evidence` | numbers to shares of subject, which can be averaged, and from shares to a mask |

mod evidence;
mod numbers;
mod values;

pub(crate) use evidence::{drawn, mask_of, shares};
pub(crate) use numbers::Numbers;
pub use values::{MaskProblem, MaskValues};
pub(crate) use values::{MaskSequence, values_of};
