//! Colours of pictures and data: one set for both themes.
//!
//! Pictures and the 3-D scene lie on their own dark ground in both themes, so what is drawn in them never
//! changes with the theme. Orange is data without model, blue is model without data, here, in the
//! residual map and in every bar that counts them.

use std::sync::LazyLock;

use backlit_plot::colours::{GRADIENT_STOPS, RUNS, interpolate};
use egui::Color32;

use super::rgb;

/// The ground of pictures without footage, and of the scene.
pub const PICTURE_GROUND: Color32 = rgb(0x17191C);
/// The body in the scene, in full light.
pub const SCENE_BODY: Color32 = rgb(0xD3D7DC);
/// The grid of the scene's floor.
pub const SCENE_FLOOR: Color32 = rgb(0x2F343A);
/// Data and model agree.
pub const AGREEMENT: Color32 = rgb(0x84919E);
/// Data without model. [`super::Palette::missing_text`] is its text form.
pub const MISSING: Color32 = rgb(0xDC6A12);
/// Model without data. [`super::Palette::spurious_text`] is its text form.
pub const SPURIOUS: Color32 = rgb(0x2F80DB);
/// Opacity of [`AGREEMENT`] over footage.
pub const AGREEMENT_TINT: f32 = 0.34;
/// Opacity of [`MISSING`] and [`SPURIOUS`] over footage.
pub const MISMATCH_TINT: f32 = 0.62;
/// How much black lies on footage under overlays.
pub const FOOTAGE_DIM: f32 = 0.18;
/// The selected or dragged joint, the selected limb and its sight ray.
pub const SELECTED: Color32 = rgb(0xFFD24A);
/// Opacity of the fill of the selected limb.
pub const SELECTED_LIMB_FILL: f32 = 0.13;
/// Joints that are not selected, and pinned ones.
pub const JOINT: Color32 = rgb(0xF4F6F8);
/// The outline of the body.
pub const BODY_OUTLINE: Color32 = rgb(0xEAF0F5);
/// Opacity of the casing under the body's outline.
pub const BODY_OUTLINE_CASING: f32 = 0.55;
/// Opacity of the limb edges inside the body's outline.
pub const INNER_EDGE: f32 = 0.13;
/// Bodies that are looked at beside or in the place of the posed one.
pub const GHOST: Color32 = rgb(0x6FB7F2);
/// Lies under every mark on footage, so that nothing relies on its own contrast.
pub const CASING: Color32 = rgb(0x0B0D0F);
/// Opacity of the casing under a sight ray.
pub const RAY_CASING: f32 = 0.6;
/// Hatch of pixels inside the ramp that have no gradient.
pub const NO_GRADIENT: Color32 = rgb(0xC35BB0);
/// Hatch of don't-know pixels.
pub const UNKNOWN: Color32 = AGREEMENT;
/// Hatch of pixels in the subject's shadow.
pub const SHADOW: Color32 = rgb(0x3E9A5B);
/// Outline of limbs that silhouettes do not hold, and a cue does.
pub const HELD_BY_CUE: Color32 = rgb(0x2FC3B4);
/// Outline of limbs that nothing holds.
pub const UNSURE: Color32 = rgb(0xF0506E);
/// Arrows to where a prior learnt from motion would have limbs.
pub const LIKELIER: Color32 = rgb(0xB79CF2);
/// White digits on badges.
pub const WHITE: Color32 = rgb(0xFFFFFF);

/// Ground of the report's overlay: neither data nor model.
pub const REPORT_GROUND: u8 = 0x80;
/// The report's overlay where only the data is.
pub const REPORT_DATA: u8 = 0x00;
/// The report's overlay where only the model is.
pub const REPORT_MODEL: u8 = 0xFF;
/// The report's overlay where both are.
pub const REPORT_BOTH: u8 = 0x56;

/// Marks on pictures: radii and widths in points.
pub mod mark {
    /// Disc of the selected joint.
    pub const SELECTED_RADIUS: f32 = 6.6;
    /// Its casing.
    pub const SELECTED_CASING_RADIUS: f32 = 8.2;
    /// Its dark core.
    pub const SELECTED_CORE_RADIUS: f32 = 2.2;
    /// The further ring while it is dragged.
    pub const DRAG_RING_RADIUS: f32 = 11.5;
    /// Width of that ring.
    pub const DRAG_RING_WIDTH: f32 = 1.6;
    /// Ring of any other joint.
    pub const JOINT_RADIUS: f32 = 3.4;
    /// Width of that ring.
    pub const JOINT_WIDTH: f32 = 1.5;
    /// Side of a pinned joint's square.
    pub const PIN_SIDE: f32 = 8.4;
    /// Side of its casing.
    pub const PIN_CASING_SIDE: f32 = 10.8;
    /// Body outline.
    pub const OUTLINE_WIDTH: f32 = 1.25;
    /// Its casing.
    pub const OUTLINE_CASING_WIDTH: f32 = 2.75;
    /// Limb edges inside the outline.
    pub const INNER_EDGE_WIDTH: f32 = 0.75;
    /// Outline of the selected limb.
    pub const SELECTED_LIMB_WIDTH: f32 = 1.5;
    /// Sight ray.
    pub const RAY_WIDTH: f32 = 1.5;
    /// Its casing.
    pub const RAY_CASING_WIDTH: f32 = 3.6;
    /// Its dash and gap.
    pub const RAY_DASH: [f32; 2] = [7.0, 4.0];
    /// Width and period of the no-gradient hatch, at 45°.
    pub const NO_GRADIENT_HATCH: [f32; 2] = [2.0, 6.0];
    /// Width and period of the don't-know hatch, at −45°.
    pub const UNKNOWN_HATCH: [f32; 2] = [1.0, 5.0];
    /// Width and period of the shadow hatch, level.
    pub const SHADOW_HATCH: [f32; 2] = [1.0, 3.0];
    /// Dot of an accepted step in a plot.
    pub const ACCEPTED_RADIUS: f32 = 2.3;
    /// Side of a rejected step's cross in a plot.
    pub const REJECTED_SIZE: f32 = 6.6;
    /// Ring of the current step in a plot.
    pub const CURRENT_STEP_RADIUS: f32 = 4.5;
}

/// The colour and dash of one run in a plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunStyle {
    /// Colour of the curve and its dots.
    pub colour: Color32,
    /// Dash and gap lengths in points, alternating; empty for a solid line.
    pub dash: &'static [f32],
    /// Width of the line, in points.
    pub width: f32,
}

/// How the run of this index, counted from zero, is drawn. From the seventh on the list is reused with a
/// thinner line.
pub fn run_style(index: usize) -> RunStyle {
    let (colour, dash) = RUNS[index % RUNS.len()];
    let width = if index < RUNS.len() { super::size::CURVE } else { 1.0 };
    RunStyle { colour: rgb(colour), dash, width }
}

/// The colour of a badge or a stretch of time, and that of a digit or a word on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FillColours {
    /// Badge and frustum of a camera; stretches, curves and regions of a kind of motion.
    pub fill: Color32,
    /// What is written on it.
    pub text: Color32,
}

const fn on(fill: u32, text: Color32) -> FillColours {
    FillColours { fill: rgb(fill), text }
}

const CAMERAS: [FillColours; 8] = [
    on(0x488BD3, CASING),
    on(0xC9742B, CASING),
    on(0x25754E, WHITE),
    on(0xCD376C, WHITE),
    on(0x6C5DDC, WHITE),
    on(0xAC4A13, WHITE),
    on(0xEE6588, CASING),
    on(0x9846A3, WHITE),
];

/// The colours of the camera of this index, counted from zero. The ninth and later reuse the list.
pub fn camera_colours(index: usize) -> FillColours {
    CAMERAS[index % CAMERAS.len()]
}

const MOTIONS: [FillColours; 8] = [
    on(0xC8373E, WHITE),
    on(0xC05AA0, CASING),
    on(0x7A63D2, WHITE),
    on(0xC9701A, CASING),
    on(0x2F8F5B, CASING),
    on(0x8C7A2E, CASING),
    on(0x3E82D6, CASING),
    on(0x168C98, CASING),
];
/// What is no known motion.
const NO_MOTION: FillColours = on(0x7C858F, CASING);

/// The colour of a kind of motion of this index, counted from zero; `None` is no known motion. The ninth and later reuse the
/// list.
pub fn motion_colours(index: Option<usize>) -> FillColours {
    index.map_or(NO_MOTION, |index| MOTIONS[index % MOTIONS.len()])
}

/// The owner-limb colour: hue by chain, lightness by depth in the chain.
pub fn limb_colour(chain: usize, depth: usize) -> Color32 {
    const LIGHTNESS: [f32; 3] = [1.0, 0.8, 0.65];
    let colour = camera_colours(chain).fill;
    let lightness = LIGHTNESS[depth % LIGHTNESS.len()];
    let scale = |channel: u8| (f32::from(channel) * lightness).round() as u8;
    Color32::from_rgb(scale(colour.r()), scale(colour.g()), scale(colour.b()))
}

/// Entries of a colour map.
pub const MAP_LEN: usize = 256;

/// −255 … 0 … +255: orange where data lacks model, dark at zero, blue where model lacks data.
const RESIDUAL_STOPS: [u32; 9] =
    [0xFFB066, 0xE8862F, 0xB8601A, 0x6E3C16, 0x17191C, 0x173E66, 0x2467AE, 0x4C96EA, 0x9CC8FF];

static RESIDUAL_MAP: LazyLock<[Color32; MAP_LEN]> = LazyLock::new(|| map(RESIDUAL_STOPS));
static GRADIENT_MAP: LazyLock<[Color32; MAP_LEN]> = LazyLock::new(|| map(GRADIENT_STOPS));

/// The diverging map for residuals D − Λ and Jacobian columns, from its most negative to its most positive
/// entry.
pub fn residual_map() -> &'static [Color32; MAP_LEN] {
    &RESIDUAL_MAP
}

/// The sequential map for gradient magnitudes, from zero to the largest.
pub fn gradient_map() -> &'static [Color32; MAP_LEN] {
    &GRADIENT_MAP
}

/// The colour of a residual in grey levels, −255 to 255 (clamped; zero for NaN).
pub fn residual_colour(value: f32) -> Color32 {
    let value = if value.is_nan() { 0.0 } else { value.clamp(-255.0, 255.0) };
    residual_map()[entry((value + 255.0) / 510.0)]
}

/// The colour of a gradient magnitude as a fraction of the largest shown (clamped; zero for NaN).
pub fn gradient_colour(fraction: f32) -> Color32 {
    gradient_map()[entry(if fraction.is_nan() { 0.0 } else { fraction.clamp(0.0, 1.0) })]
}

fn entry(fraction: f32) -> usize {
    usize::from(byte(fraction * (MAP_LEN - 1) as f32))
}

/// The nearest of 0 to 255; 0 for NaN. `f32::round` would be a call for each pixel.
#[inline]
pub fn byte(level: f32) -> u8 {
    (level + 0.5) as u8
}

fn map(stops: [u32; 9]) -> [Color32; MAP_LEN] {
    std::array::from_fn(|index| {
        let [r, g, b] = interpolate(&stops, index as f32 / (MAP_LEN - 1) as f32);
        Color32::from_rgb(r, g, b)
    })
}

/// The grey of the report's overlay at one pixel, from the data's and the prediction's grey levels
/// (0 = subject). The picture goes quiet where both agree; what shines or is pitch black is error.
pub fn report_grey(data: f32, prediction: f32) -> u8 {
    let coverage = 1.0 - data / 255.0;
    let model = 1.0 - prediction / 255.0;
    let grey = f32::from(REPORT_GROUND) * (1.0 - coverage.max(model))
        + f32::from(REPORT_MODEL) * (model - coverage).max(0.0)
        + f32::from(REPORT_BOTH) * coverage.min(model);
    byte(grey)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_meet_their_stops() {
        assert_eq!(residual_map()[0], rgb(RESIDUAL_STOPS[0]));
        assert_eq!(residual_map()[255], rgb(RESIDUAL_STOPS[8]));
        assert_eq!(gradient_map()[0], rgb(GRADIENT_STOPS[0]));
        assert_eq!(gradient_map()[255], rgb(GRADIENT_STOPS[8]));
        assert_eq!(residual_colour(-900.0), rgb(RESIDUAL_STOPS[0]));
        assert_eq!(residual_colour(255.0), rgb(RESIDUAL_STOPS[8]));
        assert_eq!(gradient_colour(2.0), rgb(GRADIENT_STOPS[8]));
    }

    #[test]
    fn the_residual_map_is_dark_at_zero_and_warm_below() {
        let zero = residual_colour(0.0);
        assert_eq!(zero, residual_colour(f32::NAN));
        for channel in 0..3 {
            assert!(zero[channel].abs_diff(PICTURE_GROUND[channel]) <= 1, "{zero:?}");
        }
        let (missing, spurious) = (residual_colour(-120.0), residual_colour(120.0));
        assert!(missing.r() > missing.b() && spurious.b() > spurious.r());
    }

    #[test]
    fn lists_are_reused_with_a_second_sign() {
        assert_eq!(camera_colours(8), camera_colours(0));
        assert_eq!(run_style(6).colour, run_style(0).colour);
        assert!(run_style(6).width < run_style(0).width);
    }

    #[test]
    fn the_report_overlay_has_its_four_greys() {
        assert_eq!(report_grey(255.0, 255.0), REPORT_GROUND);
        assert_eq!(report_grey(0.0, 255.0), REPORT_DATA);
        assert_eq!(report_grey(255.0, 0.0), REPORT_MODEL);
        assert_eq!(report_grey(0.0, 0.0), REPORT_BOTH);
    }
}
