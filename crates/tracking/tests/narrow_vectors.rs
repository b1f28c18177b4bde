//! The kernels once more on vectors of at most 256 bits, where the processor has wider ones: those are what most
//! processors have, and the pictures in other tests are compared by.

#![expect(clippy::unwrap_used, reason = "helpers of tests, where a panic is the answer")]

#[path = "tracking/drawing.rs"]
mod drawing;
#[path = "tracking/fixtures.rs"]
mod fixtures;
#[path = "tracking/kernel_parity.rs"]
mod kernel_parity;
#[path = "tracking/normal_equations.rs"]
mod normal_equations;

/// What the tests call before they begin.
mod vectors {
    pub(crate) fn choose() {
        backlit_tracking::processor::use_narrow_vectors();
    }
}
