//! What is done in some lanes and not in others.

#[cfg(target_arch = "x86_64")]
use std::any::Any;

use pulp::Simd;
use pulp::bytemuck::{bytes_of, cast};
#[cfg(target_arch = "x86_64")]
use pulp::x86::V3;

/// Puts numbers into the lanes in which a mask is true.
///
/// Of a plain choice between what is there and what is new the compiler makes a masked store of 256 bits, which costs some processors
/// more than all else that is done for a tile.
#[inline(always)]
pub(super) fn put_u32s<S: Simd>(simd: S, target: &mut S::u32s, mask: S::m32s, value: S::u32s) {
    let before = *target;
    let change = simd.select_u32s(mask, simd.xor_u32s(before, value), simd.splat_u32s(0));
    *target = simd.xor_u32s(before, change);
}

/// The same of f32.
#[inline(always)]
pub(super) fn put_f32s<S: Simd>(simd: S, target: &mut S::f32s, mask: S::m32s, value: S::f32s) {
    let mut bits = simd.transmute_u32s_f32s(*target);
    put_u32s(simd, &mut bits, mask, simd.transmute_u32s_f32s(value));
    *target = simd.transmute_f32s_u32s(bits);
}

/// Where λ/255 is between 0 and 1, so that it is not clipped and has a gradient.
#[inline(always)]
pub(super) fn on_ramp<S: Simd>(simd: S, level: S::f32s) -> S::m32s {
    let (zero, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
    simd.and_m32s(simd.less_than_f32s(zero, level), simd.less_than_f32s(level, one))
}

/// The lanes in which a mask is true, as bits: the first lane is the lowest.
#[inline(always)]
pub(super) fn lane_bits<S: Simd>(simd: S, mask: S::m32s) -> u32 {
    if const { size_of::<S::m32s>() == size_of::<u16>() } {
        return u32::from(cast::<S::m32s, u16>(mask));
    }
    // What S is, is known when this is compiled, and one instruction is all that stays.
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = (&simd as &dyn Any).downcast_ref::<V3>() {
        return simd.avx._mm256_movemask_ps(cast(mask)).cast_unsigned();
    }
    let _ = simd;
    let lanes: &[u8] = bytes_of(&mask);
    let size = lanes.len() / S::F32_LANES;
    (0..S::F32_LANES).map(|lane| u32::from(lanes[lane * size] != 0) << lane).sum()
}

#[cfg(test)]
mod tests {
    use pulp::{Simd, WithSimd};

    use super::lane_bits;
    use crate::processor::f32_lanes;
    use crate::processor::run_in_lanes;

    struct Each;

    impl WithSimd for Each {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            for wanted in 0..1_u32 << S::F32_LANES {
                let lanes: Vec<f32> = (0..S::F32_LANES).map(|lane| (wanted >> lane & 1) as f32).collect();
                let mask = simd.less_than_f32s(simd.splat_f32s(0.0), S::as_simd_f32s(&lanes).0[0]);
                assert_eq!(lane_bits(simd, mask), wanted);
            }
        }
    }

    #[test]
    fn bits_are_those_of_the_lanes() {
        run_in_lanes(f32_lanes(), Each);
        run_in_lanes(8, Each);
        Each.with_simd(pulp::Scalar);
    }
}
