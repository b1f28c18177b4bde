//! The key poses around a frame.

use backlit_document::Document;

/// The last key pose up to a frame and the first one after it. At the last key pose of the take, the one before it and
/// itself.
pub(super) fn keys_around(document: &Document, frame: usize) -> Option<(usize, usize)> {
    let keys = &document.keys;
    let before = |frame: usize| keys.range(..frame).next_back().map(|(key, _)| *key);
    let after = keys.range(frame + 1..).next().map(|(key, _)| *key);
    match after {
        Some(after) => keys.range(..=frame).next_back().map(|(key, _)| (*key, after)),
        None => keys.contains_key(&frame).then(|| before(frame).map(|first| (first, frame)))?,
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;
    use backlit_document::edit::Edit;

    #[test]
    fn keys_lie_around_a_frame() {
        let mut document = Document::new(builtin::single_limb());
        assert_eq!(keys_around(&document, 3), None);
        for frame in [2, 8, 20] {
            document.apply(Edit::SetKey { frame }).unwrap();
        }
        let around = |frame| keys_around(&document, frame);
        assert_eq!(around(1), None, "none before");
        assert_eq!((around(2), around(7)), (Some((2, 8)), Some((2, 8))));
        assert_eq!((around(8), around(20)), (Some((8, 20)), Some((8, 20))));
        assert_eq!(around(21), None, "none after");
    }
}
