//! The tokens as an egui style.

use egui::epaint::Shadow;
use egui::style::{HandleShape, ScrollStyle, Selection, Spacing, TextCursorStyle, WidgetVisuals, Widgets};
use egui::{Color32, CornerRadius, FontFamily, FontId, Margin, Stroke, Style, TextStyle, Visuals, vec2};

use super::{Palette, Theme, caption, colours, column_heading, egui_theme, headline, size, tick, title};

/// How long an animation takes, in seconds: five frames at 60 Hz.
const ANIMATION_TIME: f32 = 0.083;

/// How long the pointer rests before a tooltip shows, in seconds.
const TOOLTIP_DELAY: f32 = 0.4;

/// Width of strokes that carry a widget's meaning: check marks, arrows.
const FOREGROUND_STROKE: f32 = 1.5;

/// Gives `ctx` the styles of both themes and switches to `theme`.
pub fn apply(ctx: &egui::Context, theme: Theme) {
    for theme in Theme::ALL {
        ctx.set_style_of(egui_theme(theme), style(theme));
    }
    ctx.set_theme(egui_theme(theme));
}

/// Switches animations off where the system asks for less motion, and on again.
pub fn set_reduced_motion(ctx: &egui::Context, reduced: bool) {
    ctx.all_styles_mut(|style| style.animation_time = if reduced { 0.0 } else { ANIMATION_TIME });
}

fn style(theme: Theme) -> Style {
    let mut style = Style {
        text_styles: text_styles().into(),
        drag_value_text_style: TextStyle::Monospace,
        spacing: spacing(),
        visuals: visuals(theme),
        animation_time: ANIMATION_TIME,
        ..Style::default()
    };
    style.interaction.tooltip_delay = TOOLTIP_DELAY;
    style.interaction.selectable_labels = false;
    style.interaction.resize_grab_radius_side = 0.5 * size::SPLIT_HIT;
    style
}

fn text_styles() -> [(TextStyle, FontId); 10] {
    let font = |size: f32, family: FontFamily| FontId::new(size, family);
    [
        (title(), font(18.0, FontFamily::Proportional)),
        (column_heading(), font(15.0, FontFamily::Proportional)),
        (TextStyle::Heading, font(14.0, FontFamily::Proportional)),
        (TextStyle::Body, font(13.0, FontFamily::Proportional)),
        (TextStyle::Button, font(13.0, FontFamily::Proportional)),
        (TextStyle::Small, font(12.0, FontFamily::Proportional)),
        (caption(), font(16.0, FontFamily::Proportional)),
        (TextStyle::Monospace, font(12.0, FontFamily::Monospace)),
        (headline(), font(15.0, FontFamily::Monospace)),
        (tick(), font(11.0, FontFamily::Monospace)),
    ]
}

/// Taller than any window, points.
const MOST: f32 = 1e5;

fn spacing() -> Spacing {
    Spacing {
        item_spacing: vec2(8.0, 4.0),
        button_padding: vec2(8.0, 4.0),
        interact_size: vec2(40.0, 22.0),
        indent: 14.0,
        icon_width: size::ICON,
        icon_width_inner: 8.0,
        icon_spacing: 6.0,
        slider_rail_height: 3.0,
        slider_width: 124.0,
        combo_width: 90.0,
        // What opens over the window may be as tall as that: menus end, and do not scroll where there is room.
        combo_height: MOST,
        default_area_size: vec2(600.0, MOST),
        window_margin: Margin::same(12),
        menu_margin: Margin::same(6),
        menu_spacing: 2.0,
        tooltip_width: 320.0,
        scroll: ScrollStyle {
            bar_width: size::SCROLL_BAR_HOVERED,
            floating_width: size::SCROLL_BAR,
            ..ScrollStyle::floating()
        },
        ..Spacing::default()
    }
}

fn visuals(theme: Theme) -> Visuals {
    let palette = colours(theme);
    let base = match theme {
        Theme::Dark => Visuals::dark(),
        Theme::Light => Visuals::light(),
    };
    Visuals {
        weak_text_color: Some(palette.text2),
        widgets: widgets(palette),
        selection: Selection {
            bg_fill: palette.select,
            stroke: Stroke::new(size::HAIRLINE, palette.accent_text),
        },
        hyperlink_color: palette.info,
        faint_bg_color: palette.raised,
        extreme_bg_color: palette.field,
        text_edit_bg_color: Some(palette.field),
        code_bg_color: palette.widget,
        warn_fg_color: palette.warn,
        error_fg_color: palette.error,
        window_corner_radius: CornerRadius::same(size::WINDOW_RADIUS),
        menu_corner_radius: CornerRadius::same(size::WINDOW_RADIUS),
        window_shadow: Shadow::NONE,
        popup_shadow: Shadow::NONE,
        window_fill: palette.raised,
        window_stroke: palette.edge(),
        window_highlight_topmost: false,
        panel_fill: palette.panel,
        indent_has_left_vline: false,
        slider_trailing_fill: true,
        handle_shape: HandleShape::Circle,
        text_cursor: TextCursorStyle {
            stroke: Stroke::new(size::FOCUS_RING, palette.accent_text),
            ..base.text_cursor
        },
        ..base
    }
}

fn widgets(palette: &Palette) -> Widgets {
    let interactive = |fill: Color32| WidgetVisuals {
        bg_fill: fill,
        weak_bg_fill: fill,
        bg_stroke: Stroke::NONE,
        corner_radius: CornerRadius::same(size::BUTTON_RADIUS),
        fg_stroke: Stroke::new(FOREGROUND_STROKE, palette.text),
        expansion: 0.0,
    };
    Widgets {
        noninteractive: WidgetVisuals {
            bg_fill: palette.panel,
            weak_bg_fill: palette.panel,
            bg_stroke: palette.hairline(),
            corner_radius: CornerRadius::same(size::BUTTON_RADIUS),
            fg_stroke: Stroke::new(size::HAIRLINE, palette.text),
            expansion: 0.0,
        },
        inactive: interactive(palette.widget),
        hovered: interactive(palette.hover),
        active: interactive(palette.active),
        open: interactive(palette.hover),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_themes_are_set_whichever_is_shown() {
        let ctx = egui::Context::default();
        apply(&ctx, Theme::Light);
        for theme in Theme::ALL {
            let visuals = ctx.style_of(egui_theme(theme)).visuals.clone();
            assert_eq!(visuals.panel_fill, colours(theme).panel);
            assert_eq!(visuals.dark_mode, theme == Theme::Dark);
        }
        assert_eq!(ctx.theme(), egui::Theme::Light);
    }

    #[test]
    fn reduced_motion_stops_animations() {
        let ctx = egui::Context::default();
        apply(&ctx, Theme::Dark);
        set_reduced_motion(&ctx, true);
        assert!(ctx.global_style().animation_time <= 0.0);
        set_reduced_motion(&ctx, false);
        assert!(ctx.global_style().animation_time > 0.0);
    }
}
