//! The plot as a file.

use backlit_document::run::Run;
use backlit_plot::png;
use backlit_ui::style::theme;
use backlit_ui::style::theme::Theme;
use egui::{CentralPanel, Frame, Margin, RichText, Ui};
use egui_painter::Headless;
use image::ImageResult;

use super::plot::Plot;
use super::{ConvergencePreferences, Quantity};

/// Size in points; a pixel each.
const SIZE: [f32; 2] = [820.0, 460.0];
/// Sizes settle over a few frames.
const FRAMES: usize = 4;

/// The plot of the runs that are shown, as the window draws it.
pub(super) struct PlotFile {
    pub(super) runs: Vec<Run>,
    pub(super) preferences: ConvergencePreferences,
    pub(super) title: String,
    pub(super) theme: Theme,
}

impl PlotFile {
    /// The bytes of a PNG.
    ///
    /// # Errors
    /// None that is known: the picture is small.
    pub(super) fn png(&self) -> ImageResult<Vec<u8>> {
        png(self.window().frames(FRAMES, Vec::new(), |ui| self.page(ui)))
    }

    /// The text of an SVG: lines and words that stay sharp at any size.
    pub(super) fn svg(&self) -> Vec<u8> {
        self.window().svg(FRAMES, Vec::new(), |ui| self.page(ui)).into_bytes()
    }

    fn window(&self) -> Headless {
        let window = Headless::new(SIZE[0], SIZE[1], 1.0);
        theme::apply(&window.ctx, self.theme);
        window
    }

    fn page(&self, ui: &mut Ui) {
        let Self { runs, preferences, title, theme } = self;
        let plot = Plot::of(runs, *preferences, None);
        let steps =
            if preferences.rejected { "accepted steps are dots, rejected ones ×" } else { "accepted steps" };
        let subtitle = format!("{} over accepted steps; {steps}", label(preferences.quantity));
        let palette = theme::colours(*theme);
        let frame = Frame::NONE.fill(palette.panel).inner_margin(Margin::symmetric(14, 10));
        CentralPanel::default().frame(frame).show(ui, |ui| {
            ui.label(RichText::new(title).text_style(theme::title()).color(palette.text));
            ui.label(RichText::new(subtitle).color(palette.text2));
            plot.show(ui, ui.available_size(), true);
        });
    }
}

const fn label(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Percent => "Cost in % of the start",
        Quantity::Cost => "Cost in squared grey levels",
        Quantity::Rms => "RMS in grey levels",
        Quantity::Iou => "IoU of body and silhouettes",
        Quantity::JointError => "Mean distance from the reference in mm",
        Quantity::StepNorm => "Step in m and rad",
        Quantity::Damping => "Damping in parts of the diagonal",
        Quantity::Decrease => "Decrease in % of the cost before, expected ones as rings,",
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
        let file = |runs: &[Run], preferences| PlotFile {
            runs: runs.to_vec(),
            preferences,
            title: "Robust".to_owned(),
            theme: Theme::Light,
        };
        let of = |runs: &[Run], preferences| file(runs, preferences).png().unwrap();
        let both = of(&[run.clone(), hidden.clone()], all);
        assert_eq!(both, of(std::slice::from_ref(&run), all));
        assert_ne!(both, of(&[hidden], all));
        let accepted = ConvergencePreferences { rejected: false, ..all };
        assert_ne!(both, of(std::slice::from_ref(&run), accepted));
        let svg = String::from_utf8(file(std::slice::from_ref(&run), all).svg()).unwrap();
        assert!(svg.contains(">Robust</text>") && svg.matches("<circle").count() >= 3, "{svg}");
    }
}
