//! Every colour, distance and type size of the window, as named tokens.
//!
//! A dim room and one warm light: greys carry the interface, the yellow accent marks what the user holds
//! (the selected joint, its row, its sight ray, the current frame and step, the one primary button) and
//! nothing else. Colours of pictures and data are the same in both themes: see `data_colours`.
//!
//! All lengths are egui points. [`apply`] hands the tokens to egui.

pub mod data_colours;
mod style;

use backlit_plot::colours::PageColours;
use egui::{Color32, Frame, Margin, Stroke, TextStyle};

pub use backlit_plot::Theme;
pub use data_colours::{
    camera_colours, gradient_colour, gradient_map, motion_colours, residual_colour, residual_map, run_style,
};
pub use style::{apply, set_reduced_motion};

/// The colours of a theme.
pub const fn colours(theme: Theme) -> &'static Palette {
    match theme {
        Theme::Dark => &DARK,
        Theme::Light => &LIGHT,
    }
}

/// The same choice in egui's words.
pub const fn egui_theme(theme: Theme) -> egui::Theme {
    match theme {
        Theme::Dark => egui::Theme::Dark,
        Theme::Light => egui::Theme::Light,
    }
}

/// The colours in use where `ui` draws.
pub fn palette(ui: &egui::Ui) -> &'static Palette {
    if ui.visuals().dark_mode { &DARK } else { &LIGHT }
}

/// Declares [`Palette`] with the colours of both themes: dark, light.
macro_rules! palette {
    ($($(#[$doc:meta])* $name:ident: $dark:expr, $light:expr;)*) => {
        /// The colours of one theme. Every pair of a text colour and a ground passes WCAG AA, except
        /// [`text3`](Self::text3) on `hover` and `active`: use [`text2`](Self::text2) there.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Palette {
            $($(#[$doc])* pub $name: Color32,)*
            /// Edge of the primary button: none in the dark theme, whose accent stands out by itself.
            pub accent_edge: Stroke,
        }

        const DARK: Palette = Palette { $($name: rgb($dark),)* accent_edge: Stroke::NONE };
        const LIGHT: Palette = Palette {
            $($name: rgb($light),)*
            accent_edge: Stroke { width: size::HAIRLINE, color: rgb(0x7A5600) },
        };
    };
}

const PAGE_DARK: &PageColours = Theme::Dark.page();
const PAGE_LIGHT: &PageColours = Theme::Light.page();

palette! {
    /// Behind pictures, between tiles.
    well: 0x0E1012, 0xE3E5E8;
    /// Panels, timeline.
    panel: PAGE_DARK.panel, PAGE_LIGHT.panel;
    /// Toolbar, tile header, status bar, cards.
    raised: 0x202327, 0xFFFFFF;
    /// Button, combo.
    widget: 0x2A2E33, 0xE6E8EB;
    /// Hovered widget.
    hover: 0x343A41, 0xDADDE1;
    /// Pressed widget, chosen segment.
    active: 0x3E454D, 0xCDD1D6;
    /// Number and text fields, slider well.
    field: 0x121417, 0xFFFFFF;
    /// Plot ground.
    plot: PAGE_DARK.plot, PAGE_LIGHT.plot;
    /// Plot grid.
    grid: PAGE_DARK.grid, PAGE_LIGHT.grid;
    /// Hairline separators and field edges; decorative.
    line: PAGE_DARK.line, PAGE_LIGHT.line;
    /// Edges that must be seen: unticked box, card, window.
    line2: PAGE_DARK.line2, PAGE_LIGHT.line2;
    /// Selected row.
    select: 0x3A3320, 0xFBEFCB;
    /// Primary text.
    text: PAGE_DARK.text, PAGE_LIGHT.text;
    /// Labels, secondary text.
    text2: PAGE_DARK.text2, PAGE_LIGHT.text2;
    /// Hints, summaries, disabled text, figures that are being recomputed.
    text3: 0x959DA7, 0x5E656E;
    /// Fill of the selection bar, the primary button, the slider trail and the playhead.
    accent: 0xF2C14E, 0xE9B32A;
    /// The accent as text or thin line.
    accent_text: 0xF2C14E, 0x7A5600;
    /// Text on the accent.
    on_accent: 0x1A1608, 0x1A1608;
    /// Notice.
    info: 0x7FB2F0, 0x1F5FA8;
    /// Warning.
    warn: 0xF09A5A, 0x9A4B0C;
    /// Error.
    error: 0xF57F75, 0xB3261E;
    /// Passed check.
    ok: 0x5FC3A0, 0x1B6B52;
    /// "Missing" (data without model) as text.
    missing_text: 0xF0A564, 0x9A4B0C;
    /// "Spurious" (model without data) as text.
    spurious_text: 0x7FB2F0, 0x1F5FA8;
}

impl Palette {
    /// A hairline separator.
    pub fn hairline(&self) -> Stroke {
        Stroke::new(size::HAIRLINE, self.line)
    }

    /// An edge that must be seen.
    pub fn edge(&self) -> Stroke {
        Stroke::new(size::HAIRLINE, self.line2)
    }

    /// The frame of a card that lies on what is below it.
    pub fn raised_frame(&self, radius: u8, margin: Margin) -> Frame {
        Frame::NONE.fill(self.raised).stroke(self.edge()).corner_radius(radius).inner_margin(margin)
    }

    /// The outline of the active tile.
    pub fn active_tile(&self) -> Stroke {
        Stroke::new(size::ACTIVE_TILE, self.accent_text)
    }

    /// The ring around the widget that has the keyboard.
    pub fn focus_ring(&self) -> Stroke {
        Stroke::new(size::FOCUS_RING, self.accent_text)
    }
}

/// An opaque colour from `0xRRGGBB`.
const fn rgb(hex: u32) -> Color32 {
    let [r, g, b] = backlit_plot::colours::rgb(hex);
    Color32::from_rgb(r, g, b)
}

/// Distances between things, in points.
pub mod space {
    /// Between tiles.
    pub const TILE_GAP: f32 = 2.0;
    /// Inside rows.
    pub const ROW: f32 = 4.0;
    /// Between widgets.
    pub const WIDGET: f32 = 8.0;
    /// Between groups.
    pub const GROUP: f32 = 12.0;
    /// Panel margin.
    pub const PANEL_MARGIN: f32 = 14.0;
    /// Tile gutter margin.
    pub const GUTTER_MARGIN: f32 = 16.0;
    /// Page margin of the demonstrate layout.
    pub const PAGE_MARGIN: f32 = 24.0;
}

/// Sizes of things, in points.
pub mod size {
    /// Below this width of the toolbar, renderer and preset are chosen elsewhere only.
    pub const FOLD_CHOICES: f32 = 1280.0;
    /// Corner radius of fields and swatches.
    pub const FIELD_RADIUS: u8 = 3;
    /// Corner radius of buttons, combos and cards.
    pub const BUTTON_RADIUS: u8 = 4;
    /// Corner radius of windows, menus and laboratory columns.
    pub const WINDOW_RADIUS: u8 = 6;

    /// Tree and list rows.
    pub const ROW: f32 = 22.0;
    /// Buttons.
    pub const BUTTON: f32 = 24.0;
    /// Tile headers.
    pub const TILE_HEADER: f32 = 26.0;
    /// Slider rows.
    pub const SLIDER_ROW: f32 = 27.0;
    /// Collapsed sections.
    pub const SECTION: f32 = 30.0;
    /// Toolbar.
    pub const TOOLBAR: f32 = 40.0;
    /// Status bar.
    pub const STATUS_BAR: f32 = 24.0;

    /// Right panel.
    pub const RIGHT_PANEL: f32 = 324.0;
    /// Right panel in the debug layout.
    pub const RIGHT_PANEL_DEBUG: f32 = 340.0;
    /// Range of the right panel.
    pub const RIGHT_PANEL_RANGE: std::ops::RangeInclusive<f32> = 280.0..=460.0;
    /// Timeline with three lanes.
    pub const TIMELINE: f32 = 136.0;
    /// Timeline with one lane.
    pub const TIMELINE_ONE_LANE: f32 = 78.0;
    /// The timeline's lane of motions by name.
    pub const MOTION_LANE: f32 = 18.0;
    /// Timeline when shut.
    pub const TIMELINE_SHUT: f32 = 40.0;
    /// Convergence panel.
    pub const CONVERGENCE: f32 = 330.0;
    /// Run list beside the convergence plot.
    pub const RUN_LIST: f32 = 366.0;
    /// A split is taken hold of within this width.
    pub const SPLIT_HIT: f32 = 8.0;
    /// A split leaves a tile at least this, both ways.
    pub const TILE_LEAST: f32 = 120.0;
    /// Gutter beside a picture.
    pub const GUTTER: f32 = 196.0;
    /// A tile this much wider than its picture has a gutter.
    pub const GUTTER_FROM: f32 = 180.0;
    /// Hover card over a pixel.
    pub const HOVER_CARD: egui::Vec2 = egui::vec2(196.0, 150.0);
    /// Notice cards.
    pub const NOTICE: f32 = 340.0;
    /// The smallest window the layout is made for.
    pub const WINDOW_MIN: egui::Vec2 = egui::vec2(1024.0, 640.0);
    /// Scroll bar at rest.
    pub const SCROLL_BAR: f32 = 6.0;
    /// Scroll bar under the pointer.
    pub const SCROLL_BAR_HOVERED: f32 = 10.0;
    /// Box of an icon.
    pub const ICON: f32 = 14.0;
    /// Side of a camera badge.
    pub const BADGE: f32 = 16.0;

    /// Hairlines and field edges.
    pub const HAIRLINE: f32 = 1.0;
    /// Outline of the active tile.
    pub const ACTIVE_TILE: f32 = 1.5;
    /// Focus ring.
    pub const FOCUS_RING: f32 = 1.5;
    /// Strokes of icons.
    pub const ICON_STROKE: f32 = 1.4;
    /// Curves in plots.
    pub const CURVE: f32 = 1.75;
    /// Curves in the demonstrate layout.
    pub const CURVE_DEMONSTRATE: f32 = 2.0;
    /// Limit marks on sliders.
    pub const LIMIT_MARK: f32 = 2.0;
    /// What a casing adds on each side of its line.
    pub const CASING: f32 = 1.0;
}

/// Laboratory title, empty states, tour: proportional 18.
pub fn title() -> TextStyle {
    TextStyle::Name("Title".into())
}

/// Headings of laboratory columns: proportional 15.
pub fn column_heading() -> TextStyle {
    TextStyle::Name("Column heading".into())
}

/// Explanatory text of the demonstrate layout: proportional 16, on lines of `CAPTION_LINE_HEIGHT`.
pub fn caption() -> TextStyle {
    TextStyle::Name("Caption".into())
}

/// The one headline number of a tile: monospace 15.
pub fn headline() -> TextStyle {
    TextStyle::Name("Headline".into())
}

/// Plot ticks, in [`Palette::text2`]: monospace 11.
pub fn tick() -> TextStyle {
    TextStyle::Name("Tick".into())
}

/// Line height of [`caption`] text.
pub const CAPTION_LINE_HEIGHT: f32 = 24.0;

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance(colour: Color32) -> f64 {
        let linear = |channel: u8| {
            let c = f64::from(channel) / 255.0;
            if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(colour.r()) + 0.7152 * linear(colour.g()) + 0.0722 * linear(colour.b())
    }

    fn contrast(a: Color32, b: Color32) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn every_text_is_readable_on_every_ground() {
        let mut failures = Vec::new();
        for theme in Theme::ALL {
            let p = colours(theme);
            let texts = [
                ("text", p.text),
                ("text2", p.text2),
                ("text3", p.text3),
                ("accent_text", p.accent_text),
                ("info", p.info),
                ("warn", p.warn),
                ("error", p.error),
                ("ok", p.ok),
                ("missing", p.missing_text),
                ("spurious", p.spurious_text),
            ];
            let grounds = [
                ("well", p.well),
                ("panel", p.panel),
                ("raised", p.raised),
                ("widget", p.widget),
                ("field", p.field),
                ("select", p.select),
            ];
            for (text_name, text) in texts {
                for (ground_name, ground) in grounds {
                    let ratio = contrast(text, ground);
                    if ratio < 4.5 {
                        failures.push(format!("{theme:?}: {text_name} on {ground_name}: {ratio:.2}"));
                    }
                }
            }
            for (name, ground) in [("hover", p.hover), ("active", p.active)] {
                if contrast(p.text2, ground) < 4.5 {
                    failures.push(format!("{theme:?}: text2 on {name}"));
                }
            }
            if contrast(p.on_accent, p.accent) < 4.5 || contrast(p.line2, p.panel) < 3.0 {
                failures.push(format!("{theme:?}: accent or edge"));
            }
        }
        assert!(failures.is_empty(), "{failures:#?}");
    }

    #[test]
    fn digits_are_readable_on_badges_and_motions_are_seen_on_both_grounds_with_their_words() {
        for index in 0..8 {
            let colours = camera_colours(index);
            let ratio = contrast(colours.fill, colours.text);
            assert!(ratio >= 4.5, "camera {}: {ratio:.2}", index + 1);
        }
        for index in (0..8).map(Some).chain([None]) {
            let motion = motion_colours(index);
            assert!(contrast(motion.fill, motion.text) >= 4.5, "{index:?}");
            for theme in Theme::ALL {
                let ratio = contrast(motion.fill, colours(theme).plot);
                assert!(ratio >= 3.0, "{index:?} in {theme:?}: {ratio:.2}");
            }
        }
    }
}
