//! Which of the processor's vectors are used: the widest there are, unless results are to be the same on all processors.

use std::sync::atomic::{AtomicBool, Ordering};

use pulp::{Arch, Simd, WithSimd};

/// f32 of the vectors that every x86 processor of the last ten years has.
#[cfg(target_arch = "x86_64")]
const NARROW_LANES: usize = 8;

static IS_NARROW: AtomicBool = AtomicBool::new(false);

/// From now on fits use vectors of at most 256 bits, as on processors that have no wider ones. A fit is then the same to
/// the bit on all x86 processors with AVX2, and slower on those with AVX-512. Fits that were begun before go on as they
/// were.
pub fn use_narrow_vectors() {
    IS_NARROW.store(true, Ordering::Relaxed);
}

/// How many f32 the vectors of new work have.
pub(crate) fn f32_lanes() -> usize {
    struct Ask;
    impl WithSimd for Ask {
        type Output = usize;
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) -> usize {
            S::F32_LANES
        }
    }
    let widest = Arch::new().dispatch(Ask);
    #[cfg(target_arch = "x86_64")]
    if IS_NARROW.load(Ordering::Relaxed) {
        return widest.min(NARROW_LANES);
    }
    widest
}

/// Runs work in vectors of this many f32, as [`f32_lanes`] has said.
#[inline]
pub(crate) fn run_in_lanes<Op: WithSimd>(f32_lanes: usize, op: Op) -> Op::Output {
    #[cfg(target_arch = "x86_64")]
    if f32_lanes == NARROW_LANES
        && let Some(simd) = pulp::x86::V3::try_new()
    {
        return Simd::vectorize(simd, op);
    }
    let _ = f32_lanes;
    Arch::new().dispatch(op)
}

/// Runs work in the vectors of new work.
#[inline]
pub(crate) fn run<Op: WithSimd>(op: Op) -> Op::Output {
    run_in_lanes(f32_lanes(), op)
}

/// Runs work that is written for vectors of at most four f64, and the same on all processors that have them.
#[inline]
pub(crate) fn run_in_four_f64s<Op: WithSimd>(op: Op) -> Op::Output {
    #[cfg(target_arch = "x86_64")]
    return run_in_lanes(NARROW_LANES, op);
    #[cfg(not(target_arch = "x86_64"))]
    Arch::new().dispatch(op)
}
