//! The colours of plots. Curves and maps have the same colours in both themes; the window uses these tables too.

use serde::{Deserialize, Serialize};

/// Red, green and blue.
pub type Rgb = [u8; 3];

/// Dark or light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Theme {
    /// Light on dark; the first choice, since pictures are judged better in a dim surround.
    #[default]
    Dark,
    /// Dark on light, for print, projectors and bright rooms.
    Light,
}

impl Theme {
    /// Both themes.
    pub const ALL: [Self; 2] = [Self::Dark, Self::Light];

    /// The other theme.
    pub const fn toggled(self) -> Self {
        match self {
            Self::Dark => Self::Light,
            Self::Light => Self::Dark,
        }
    }

    /// The colours of a page in this theme.
    pub const fn page(self) -> &'static PageColours {
        match self {
            Self::Dark => &DARK,
            Self::Light => &LIGHT,
        }
    }
}

/// The colours of a page, as `0xRRGGBB`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PageColours {
    /// The ground of the page.
    pub panel: u32,
    /// The ground of a plot.
    pub plot: u32,
    /// The grid of a plot.
    pub grid: u32,
    /// Hairlines.
    pub line: u32,
    /// Edges that must be seen.
    pub line2: u32,
    /// Titles and names.
    pub text: u32,
    /// Conditions and numbers of an axis.
    pub text2: u32,
}

const DARK: PageColours = PageColours {
    panel: 0x191B1E,
    plot: 0x121417,
    grid: 0x262A2F,
    line: 0x2C3035,
    line2: 0x717A85,
    text: 0xE7E9EC,
    text2: 0xB2B8C0,
};

const LIGHT: PageColours = PageColours {
    panel: 0xF6F7F8,
    plot: 0xFFFFFF,
    grid: 0xE8EAED,
    line: 0xD9DCE0,
    line2: 0x838B95,
    text: 0x1B1E22,
    text2: 0x474D55,
};

/// Colours, and dash and gap lengths in points, of the curves of a plot; no dash is a solid line.
pub const RUNS: [(u32, &[f32]); 6] = [
    (0x4182DE, &[]),
    (0xD06911, &[7.0, 3.0]),
    (0x117865, &[2.0, 3.5]),
    (0xBF7FA5, &[10.0, 3.0, 2.0, 3.0]),
    (0xC43037, &[4.0, 4.0]),
    (0x6D5CA1, &[1.0, 3.0]),
];

/// Width of a curve, points.
pub const CURVE_WIDTH: f32 = 1.75;
/// Radius of the dot of a value on a curve, points.
pub const DOT_RADIUS: f32 = 2.3;

/// From zero to the largest magnitude shown.
pub const GRADIENT_STOPS: [u32; 9] =
    [0x101417, 0x12312F, 0x134E49, 0x176C62, 0x26897A, 0x4CA690, 0x7FC2A9, 0xB4DCC6, 0xE8F6E6];

/// A colour from `0xRRGGBB`.
pub const fn rgb(hex: u32) -> Rgb {
    let [_, r, g, b] = hex.to_be_bytes();
    [r, g, b]
}

/// The colour at a place from 0 to 1 between stops that are equally far apart.
pub fn interpolate(stops: &[u32; 9], place: f32) -> Rgb {
    let position = place * (stops.len() - 1) as f32;
    let lower = (position as usize).min(stops.len() - 2);
    let weight = position - lower as f32;
    let (from, to) = (rgb(stops[lower]), rgb(stops[lower + 1]));
    let mix = |a: u8, b: u8| (f32::from(a) * (1.0 - weight) + f32::from(b) * weight).round() as u8;
    [0, 1, 2].map(|channel| mix(from[channel], to[channel]))
}

/// Place in the gradient map of a distance: dark at none, lightest from ten times the limit on.
pub fn error_share(value: f64, limit: f64) -> f32 {
    (value / (LAST_COLOUR * limit)).clamp(0.0, 1.0).sqrt() as f32
}

/// The lightest colour stands for this many times the limit, and more.
pub const LAST_COLOUR: f64 = 10.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn themes_are_written_in_lower_case() {
        #[derive(Serialize, Deserialize)]
        struct Settings {
            theme: Theme,
        }
        let text = toml::to_string(&Settings { theme: Theme::Light }).unwrap();
        assert_eq!(text, "theme = \"light\"\n");
        assert_eq!(toml::from_str::<Settings>(&text).unwrap().theme, Theme::Light);
    }
}
