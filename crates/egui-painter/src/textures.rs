//! The textures egui has asked for.

use std::collections::HashMap;

use egui::epaint::{ImageData, ImageDelta};
use egui::{TextureFilter, TextureId, TextureOptions, TextureWrapMode, TexturesDelta};

use crate::pixel;

/// Textures by their id, kept up to date with egui's deltas.
#[derive(Debug, Default)]
pub(crate) struct TextureStore {
    textures: HashMap<TextureId, Texture>,
    to_free: Vec<TextureId>,
}

impl TextureStore {
    /// Applies what changed in a frame and empties `delta`. Textures that are freed in it may still be
    /// painted with until the next call. Returns how many images were refused.
    pub(crate) fn update(&mut self, delta: &mut TexturesDelta) -> usize {
        for id in self.to_free.drain(..) {
            self.textures.remove(&id);
        }
        let images =
            delta.set.drain().flat_map(|(id, images)| images.into_iter().map(move |image| (id, image)));
        // The textures' order does not matter, and a texture's own images stay in theirs.
        let refused = images.map(|(id, image)| self.set(id, &image)).filter(Option::is_none).count();
        self.to_free.extend(delta.free.drain());
        refused
    }

    pub(crate) fn get(&self, id: TextureId) -> Option<&Texture> {
        self.textures.get(&id)
    }

    /// `None`, and nothing done, if the image is empty, has a wrong number of pixels, reaches beyond its
    /// texture, or is a patch of a texture that was never set.
    fn set(&mut self, id: TextureId, delta: &ImageDelta) -> Option<()> {
        let ImageData::Color(image) = &delta.image;
        let [width, height] = image.size;
        if image.pixels.is_empty() || width.checked_mul(height) != Some(image.pixels.len()) {
            return None;
        }
        let pixels: Vec<u32> = image.pixels.iter().map(|colour| pixel::pack(*colour)).collect();
        let Some([left, top]) = delta.pos else {
            self.textures.insert(id, Texture { width, height, pixels, options: delta.options });
            return Some(());
        };
        let texture = self.textures.get_mut(&id)?;
        let fits =
            |start: usize, length: usize, room| start.checked_add(length).is_some_and(|end| end <= room);
        if !fits(left, width, texture.width) || !fits(top, height, texture.height) {
            return None;
        }
        texture.options = delta.options;
        for (row, source) in pixels.chunks_exact(width).enumerate() {
            let start = (top + row) * texture.width + left;
            texture.pixels[start..start + width].copy_from_slice(source);
        }
        Some(())
    }
}

/// A texture's pixels, premultiplied.
#[derive(Debug)]
pub(crate) struct Texture {
    width: usize,
    height: usize,
    pixels: Vec<u32>,
    options: TextureOptions,
}

/// Where a coordinate falls between two texels of a row or column.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tap {
    near: u32,
    far: u32,
    /// Share of `far`, in 1/256.
    weight: u32,
}

impl Texture {
    /// Whether texels are to be picked rather than mixed, when one pixel is `texels_per_pixel` texels wide.
    pub(crate) fn is_nearest(&self, texels_per_pixel: f32) -> bool {
        let filter =
            if texels_per_pixel > 1.0 { self.options.minification } else { self.options.magnification };
        filter == TextureFilter::Nearest
    }

    /// Texels across and down.
    pub(crate) fn size(&self) -> [f32; 2] {
        [self.width as f32, self.height as f32]
    }

    pub(crate) fn tap_x(&self, u: f32, nearest: bool) -> Tap {
        tap(u, self.width, nearest, self.options.wrap_mode)
    }

    pub(crate) fn tap_y(&self, v: f32, nearest: bool) -> Tap {
        tap(v, self.height, nearest, self.options.wrap_mode)
    }

    #[inline]
    pub(crate) fn sample(&self, x: Tap, y: Tap) -> u32 {
        self.rows(y).sample(x)
    }

    /// The two rows of texels that `y` falls between.
    #[inline]
    pub(crate) fn rows(&self, y: Tap) -> TexelRows<'_> {
        let row = |index: u32| {
            let start = index as usize * self.width;
            &self.pixels[start..start + self.width]
        };
        TexelRows { near: row(y.near), far: row(y.far), weight: y.weight }
    }
}

/// Two rows of texels and the share of the second, in 1/256.
pub(crate) struct TexelRows<'a> {
    near: &'a [u32],
    far: &'a [u32],
    weight: u32,
}

impl TexelRows<'_> {
    #[inline]
    pub(crate) fn sample(&self, x: Tap) -> u32 {
        let (left, right) = (x.near as usize, x.far as usize);
        if x.weight == 0 && self.weight == 0 {
            return self.near[left];
        }
        let texels = [self.near[left], self.near[right], self.far[left], self.far[right]];
        if texels == [texels[0]; 4] { texels[0] } else { pixel::bilinear(texels, x.weight, self.weight) }
    }
}

/// The texels about the normalised coordinate `coordinate` of an axis of `len` texels. Rounded to 1/256
/// texel first, so that a picture shown at its own size is copied exactly.
#[inline]
fn tap(coordinate: f32, len: usize, nearest: bool, wrap: TextureWrapMode) -> Tap {
    let position = (coordinate * len as f32 * 256.0).round() as i64;
    if nearest {
        let texel = wrapped(position >> 8, len, wrap);
        return Tap { near: texel, far: texel, weight: 0 };
    }
    let position = position.saturating_sub(128);
    Tap {
        near: wrapped(position >> 8, len, wrap),
        far: wrapped((position >> 8) + 1, len, wrap),
        weight: (position & 255) as u32,
    }
}

#[inline]
fn wrapped(texel: i64, len: usize, wrap: TextureWrapMode) -> u32 {
    let len = len as i64;
    let texel = match wrap {
        TextureWrapMode::ClampToEdge => texel.clamp(0, len - 1),
        TextureWrapMode::Repeat => texel.rem_euclid(len),
        TextureWrapMode::MirroredRepeat => {
            let texel = texel.rem_euclid(2 * len);
            texel.min(2 * len - 1 - texel)
        }
    };
    texel as u32
}

#[cfg(test)]
mod tests {
    use egui::{Color32, ColorImage};

    use super::*;

    fn numbered(size: [usize; 2], first: u8) -> ColorImage {
        let pixels = (0..size[0] * size[1]).map(|i| Color32::from_gray(first + i as u8)).collect();
        ColorImage::new(size, pixels)
    }

    fn greys(texture: &Texture) -> Vec<u32> {
        texture.pixels.iter().map(|p| p & 0xFF).collect()
    }

    #[test]
    fn partial_updates_change_their_patch_only() {
        let id = TextureId::Managed(0);
        let mut store = TextureStore::default();
        let mut delta = TexturesDelta::default();
        delta.push(id, ImageDelta::full(numbered([3, 2], 0), TextureOptions::LINEAR));
        delta.push(id, ImageDelta::partial([1, 0], numbered([2, 1], 90), TextureOptions::LINEAR));
        assert_eq!(store.update(&mut delta), 0);
        assert!(delta.is_empty());
        assert_eq!(greys(store.get(id).unwrap()), [0, 90, 91, 3, 4, 5]);

        delta.push(id, ImageDelta::partial([2, 0], numbered([2, 1], 7), TextureOptions::LINEAR));
        assert_eq!(store.update(&mut delta), 1);
        assert_eq!(
            greys(store.get(id).unwrap()),
            [0, 90, 91, 3, 4, 5],
            "an update beyond the edge is refused"
        );
    }

    #[test]
    fn freed_textures_live_until_the_next_update() {
        let id = TextureId::Managed(3);
        let mut store = TextureStore::default();
        let mut delta = TexturesDelta::default();
        delta.push(id, ImageDelta::full(numbered([1, 1], 0), TextureOptions::LINEAR));
        delta.free(id);
        store.update(&mut delta);
        assert!(store.get(id).is_some());
        store.update(&mut delta);
        assert!(store.get(id).is_none());
    }

    #[test]
    fn taps_follow_the_wrap_mode() {
        use TextureWrapMode::{ClampToEdge, MirroredRepeat, Repeat};
        let texels = |wrap| [-1, 0, 3, 4, 5, 9].map(|texel| wrapped(texel, 4, wrap));
        assert_eq!(texels(ClampToEdge), [0, 0, 3, 3, 3, 3]);
        assert_eq!(texels(Repeat), [3, 0, 3, 0, 1, 1]);
        assert_eq!(texels(MirroredRepeat), [0, 0, 3, 3, 2, 1]);
    }

    #[test]
    fn linear_taps_at_texel_centres_take_one_texel() {
        for texel in 0..7 {
            let centre = (texel as f32 + 0.5) / 7.0;
            let tap = tap(centre, 7, false, TextureWrapMode::ClampToEdge);
            assert_eq!((tap.near, tap.weight), (texel, 0));
        }
        let between = tap(0.5, 2, false, TextureWrapMode::ClampToEdge);
        assert_eq!((between.near, between.far, between.weight), (0, 1, 128));
        let picked = tap(0.74, 2, true, TextureWrapMode::ClampToEdge);
        assert_eq!((picked.near, picked.weight), (1, 0));
    }
}
