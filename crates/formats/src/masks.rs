//! Masks made elsewhere, by a neural net or a keyer: pictures or a video of one camera's silhouettes.

mod evidence;
mod numbers;
mod values;

pub(crate) use evidence::{drawn, mask_of, shares};
pub(crate) use numbers::Numbers;
pub use values::{MaskProblem, MaskValues};
pub(crate) use values::{MaskSequence, values_of};
