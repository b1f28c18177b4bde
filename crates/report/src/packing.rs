//! Places as whole steps of a tenth of a millimetre or a little more, two bytes a number, as base64.

use glam::DVec3;
use serde_json::{Value, json};

/// The finest step, metres.
const FINEST: f64 = 1e-4;

/// All these places: where the lowest number of each axis is, the step between numbers, and the bytes, little end first. A place
/// that is not finite is the lowest.
pub(crate) fn places<'a>(all: impl Iterator<Item = &'a DVec3> + Clone) -> Value {
    let finite = all.clone().filter(|place| place.is_finite());
    let low = finite.clone().copied().reduce(DVec3::min).unwrap_or(DVec3::ZERO);
    let high = finite.copied().reduce(DVec3::max).unwrap_or(DVec3::ZERO);
    let step = ((high - low).max_element() / f64::from(u16::MAX)).max(FINEST);
    let mut bytes = Vec::new();
    for place in all {
        for offset in ((*place - low) / step).to_array() {
            bytes.extend((offset.round() as u16).to_le_bytes());
        }
    }
    json!({"low": low.to_array(), "step": step, "data": base64(&bytes)})
}

/// Base64 with padding.
pub(crate) fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |index: usize| u32::from(three.get(index).copied().unwrap_or(0));
        let bits = (byte(0) << 16) | (byte(1) << 8) | byte(2);
        for place in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * place)) as usize & 63];
            out.push(if place > three.len() { '=' } else { char::from(letter) });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_rfc_4648() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn places_keep_a_tenth_of_a_millimetre() {
        let all = [DVec3::new(-1.0, 0.0, 2.0), DVec3::new(0.5, 0.12345, 2.0), DVec3::NAN];
        let packed = places(all.iter());
        assert_eq!(packed["low"], json!([-1.0, 0.0, 2.0]));
        assert_eq!(packed["step"], json!(1e-4));
        // 0, 0, 0; 15000, 1235, 0 (rounded up from 1234.5); 0, 0, 0.
        let bytes: Vec<u8> =
            [0, 0, 0, 15_000, 1235, 0, 0, 0, 0].into_iter().flat_map(u16::to_le_bytes).collect();
        assert_eq!(packed["data"], json!(base64(&bytes)));
        // A walk of a hundred metres still fits.
        let far = [DVec3::ZERO, DVec3::splat(100.0)];
        let step = places(far.iter())["step"].as_f64().unwrap();
        assert!((100.0 / step - 65_535.0).abs() < 1e-6, "{step}");
    }
}
