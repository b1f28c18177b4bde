//! The runs as files: the plot as a picture, and all their steps as a table.

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

/// Names of the columns.
const TITLES: [&str; 20] = [
    "run",
    "name",
    "choices",
    "frame",
    "step",
    "stage",
    "accepted",
    "mismatch",
    "percent_of_start",
    "rms",
    "stage_cost",
    "trial_cost",
    "fell",
    "foretold",
    "damping",
    "step_norm",
    "seconds",
    "iou",
    "joint_error_mm",
    "ending",
];

/// Every step of the runs as CSV, one row a step; mismatch and costs in squared grey levels, RMS in grey levels, the
/// step in metres and radians together. `ending` is in a run's last row.
pub(crate) fn csv<'a>(runs: impl IntoIterator<Item = &'a Run>) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let known = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    // A vector takes all that is written to it.
    let mut row = |fields: &[String]| drop(writer.write_record(fields));
    row(&TITLES.map(str::to_owned));
    for run in runs {
        for (index, step) in run.steps.iter().enumerate() {
            let percent = run.fraction(index).map_or_else(String::new, |share| (100.0 * share).to_string());
            let is_last = index == run.last_step();
            row(&[
                run.number.to_string(),
                run.name.clone(),
                run.detail.clone(),
                run.frame.to_string(),
                index.to_string(),
                run.stages.get(step.iteration.stage).cloned().unwrap_or_default(),
                step.iteration.accepted.to_string(),
                step.mismatch.to_string(),
                percent,
                step.rms.to_string(),
                step.iteration.cost.to_string(),
                step.iteration.trial_cost.to_string(),
                step.iteration.actual_decrease.to_string(),
                step.iteration.predicted_decrease.to_string(),
                step.iteration.damping.to_string(),
                step.iteration.step_norm.to_string(),
                step.seconds.to_string(),
                known(step.iou),
                known(step.joint_error_mm),
                if is_last { run.ending_text() } else { String::new() },
            ]);
        }
    }
    writer.into_inner().unwrap_or_default()
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

    #[test]
    fn every_step_has_a_row() {
        let mut run = crate::features::convergence::quantity::tests::run();
        run.name = "Robust, capsule".to_owned();
        let bytes = csv([&run]);
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let rows: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().unwrap();
        assert_eq!(rows.len(), run.steps.len());
        let column = |name: &str| TITLES.iter().position(|title| *title == name).unwrap();
        assert_eq!(&rows[1][column("name")], "Robust, capsule");
        assert_eq!(&rows[1][column("percent_of_start")], "50");
        assert_eq!(&rows[2][column("accepted")], "false");
        assert_eq!(&rows[4][column("ending")], "4 steps so far");
        assert_eq!(&rows[3][column("ending")], "");
    }
}
