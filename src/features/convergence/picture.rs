//! The plot as a file.

use backlit_ui::drawing::plot::png;
use backlit_ui::style::theme;
use backlit_ui::style::theme::Theme;
use egui::{CentralPanel, Frame, Margin, RichText};
use egui_painter::Headless;
use image::{ImageResult, RgbaImage};

use super::plot::Plot;
use super::{ConvergencePreferences, Quantity};
use crate::document::run::Run;

/// Size in points; a pixel each.
const SIZE: [f32; 2] = [820.0, 460.0];

/// The plot of the runs that are shown, as the window draws it, as the bytes of a PNG.
///
/// # Errors
/// None that is known: the picture is small.
pub(super) fn bytes(
    runs: &[Run],
    preferences: ConvergencePreferences,
    title: &str,
    theme: Theme,
) -> ImageResult<Vec<u8>> {
    png(picture(runs, preferences, title, theme))
}

fn picture(runs: &[Run], preferences: ConvergencePreferences, title: &str, theme: Theme) -> RgbaImage {
    let shown: Vec<&Run> = runs.iter().filter(|run| run.is_shown).collect();
    let plot = Plot::of(&shown, preferences, None);
    let steps =
        if preferences.rejected { "accepted steps are dots, rejected ones ×" } else { "accepted steps" };
    let subtitle = format!("{} over accepted steps; {steps}", label(preferences.quantity));
    let mut window = Headless::new(SIZE[0], SIZE[1], 1.0);
    theme::apply(&window.ctx, theme);
    let palette = theme.palette();
    window.frames(4, Vec::new(), |ui| {
        let frame = Frame::NONE.fill(palette.panel).inner_margin(Margin::symmetric(14, 10));
        CentralPanel::default().frame(frame).show(ui, |ui| {
            ui.label(RichText::new(title).text_style(theme::title()).color(palette.text));
            ui.label(RichText::new(&subtitle).color(palette.text2));
            plot.show(ui, ui.available_size(), true);
        });
    })
}

const fn label(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Percent => "Cost in % of the start",
        Quantity::Cost => "Cost in squared grey levels",
        Quantity::Rms => "RMS in grey levels",
        Quantity::StepNorm => "Step in m and rad",
        Quantity::Damping => "Damping in parts of the diagonal",
        Quantity::Decrease => "Decrease in % of the cost before, foretold ones as rings,",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_has_the_runs_that_are_shown_and_their_rejected_steps() {
        let run = crate::features::convergence::quantity::tests::run();
        let hidden = Run { is_shown: false, ..run.clone() };
        let all = ConvergencePreferences::default();
        let of = |runs: &[Run], preferences| picture(runs, preferences, "Robust", Theme::Light);
        let both = of(&[run.clone(), hidden.clone()], all);
        assert_eq!(both, of(std::slice::from_ref(&run), all));
        assert_ne!(both, of(&[hidden], all));
        let accepted = ConvergencePreferences { rejected: false, ..all };
        assert_ne!(both, of(std::slice::from_ref(&run), accepted));
    }
}
