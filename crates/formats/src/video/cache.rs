//! Decoded frames that are kept, the ones asked for last, within a limit.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use image::RgbImage;

/// Decoded frames of one or several videos. The limit is in megabytes of 10⁶ bytes and holds for all of them together.
#[derive(Debug)]
pub struct FrameCache(Mutex<CachedFrames>);

/// Megabytes that are kept unless something else is set.
const DEFAULT_CACHE_MB: usize = 256;

/// A frame of a video at a divisor of its size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key {
    pub(super) video: u64,
    pub(super) divisor: usize,
    pub(super) frame: usize,
}

#[derive(Debug)]
struct CachedFrames {
    limit: usize,
    bytes: usize,
    clock: u64,
    frames: BTreeMap<Key, (u64, Arc<RgbImage>)>,
    /// The same by when they were last asked for.
    ages: BTreeMap<u64, Key>,
}

impl Default for FrameCache {
    fn default() -> Self {
        Self::new(DEFAULT_CACHE_MB)
    }
}

impl FrameCache {
    /// An empty cache.
    #[must_use]
    pub fn new(megabytes: usize) -> Self {
        let limit = megabytes.saturating_mul(1_000_000);
        let (frames, ages) = (BTreeMap::new(), BTreeMap::new());
        Self(Mutex::new(CachedFrames { limit, bytes: 0, clock: 0, frames, ages }))
    }

    /// Changes the limit; what no longer fits is dropped at once. 0 keeps nothing.
    pub fn set_limit_mb(&self, megabytes: usize) {
        let mut kept = self.kept();
        kept.limit = megabytes.saturating_mul(1_000_000);
        kept.shrink();
    }

    /// The limit in megabytes.
    #[must_use]
    pub fn limit_mb(&self) -> usize {
        self.kept().limit / 1_000_000
    }

    /// What is kept now, in megabytes, rounded up.
    #[must_use]
    pub fn used_mb(&self) -> usize {
        self.kept().bytes.div_ceil(1_000_000)
    }

    pub(super) fn limit_bytes(&self) -> usize {
        self.kept().limit
    }

    pub(super) fn contains(&self, key: Key) -> bool {
        self.kept().frames.contains_key(&key)
    }

    pub(super) fn get(&self, key: Key) -> Option<Arc<RgbImage>> {
        let mut kept = self.kept();
        let now = kept.tick();
        let (age, picture) = kept.frames.get_mut(&key)?;
        let (before, picture) = (std::mem::replace(age, now), Arc::clone(picture));
        kept.ages.remove(&before);
        kept.ages.insert(now, key);
        Some(picture)
    }

    pub(super) fn insert(&self, key: Key, picture: Arc<RgbImage>) {
        let mut kept = self.kept();
        let now = kept.tick();
        kept.bytes += picture.as_raw().len();
        if let Some((age, before)) = kept.frames.insert(key, (now, picture)) {
            kept.bytes -= before.as_raw().len();
            kept.ages.remove(&age);
        }
        kept.ages.insert(now, key);
        kept.shrink();
    }

    /// Drops all frames of a video.
    pub(super) fn forget(&self, video: u64) {
        let mut kept = self.kept();
        let keys: Vec<Key> = kept.frames.keys().filter(|key| key.video == video).copied().collect();
        for key in keys {
            kept.remove(key);
        }
    }

    fn kept(&self) -> MutexGuard<'_, CachedFrames> {
        // Nothing in here can panic half done.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl CachedFrames {
    fn tick(&mut self) -> u64 {
        self.clock += 1;
        self.clock
    }

    fn remove(&mut self, key: Key) {
        if let Some((age, picture)) = self.frames.remove(&key) {
            self.bytes -= picture.as_raw().len();
            self.ages.remove(&age);
        }
    }

    fn shrink(&mut self) {
        while self.bytes > self.limit {
            let Some((_, &oldest)) = self.ages.first_key_value() else { break };
            self.remove(oldest);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(video: u64, frame: usize) -> Key {
        Key { video, divisor: 1, frame }
    }

    #[test]
    fn what_was_asked_for_last_stays_within_the_limit() {
        let cache = FrameCache::new(1);
        let picture = || Arc::new(RgbImage::new(1000, 100));
        for frame in 0..3 {
            cache.insert(key(1, frame), picture());
        }
        assert!((0..3).all(|frame| cache.get(key(1, frame)).is_some()));
        assert!(cache.get(key(1, 0)).is_some());
        cache.insert(key(2, 0), picture());
        assert!(!cache.contains(key(1, 1)), "the one that was asked for the longest ago");
        assert!(cache.contains(key(1, 0)) && cache.contains(key(2, 0)));
        cache.insert(key(2, 0), picture());
        assert_eq!((cache.used_mb(), cache.limit_mb()), (1, 1));
        cache.forget(1);
        assert!(!cache.contains(key(1, 0)) && cache.contains(key(2, 0)));
        cache.insert(key(3, 0), Arc::new(RgbImage::new(1000, 1000)));
        assert_eq!(cache.used_mb(), 0, "one that is larger than all is not kept");
        cache.set_limit_mb(0);
        cache.insert(key(1, 0), picture());
        assert_eq!(cache.used_mb(), 0);
    }
}
