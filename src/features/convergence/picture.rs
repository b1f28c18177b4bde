//! The runs as files: the plot as a picture, and all their steps as a table.

use backlit_document::run::{Run, RunStep};
use backlit_plot::png;
use backlit_ui::style::theme;
use backlit_ui::style::theme::Theme;
use egui::{CentralPanel, Frame, Margin, RichText, Ui};
use egui_painter::Headless;
use image::ImageResult;

use super::ConvergencePreferences;
use super::plot::Plot;

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
        let subtitle = format!("{} over accepted steps; {steps}", preferences.quantity.words().label);
        let palette = theme::colours(*theme);
        let frame = Frame::NONE.fill(palette.panel).inner_margin(Margin::symmetric(14, 10));
        CentralPanel::default().frame(frame).show(ui, |ui| {
            ui.label(RichText::new(title).text_style(theme::title()).color(palette.text));
            ui.label(RichText::new(subtitle).color(palette.text2));
            plot.show(ui, ui.available_size(), true);
        });
    }
}

/// What stands in a column of a run's step.
type Field = fn(&Run, usize, &RunStep, &[Run]) -> String;

/// The columns with their names.
const COLUMNS: [(&str, Field); 20] = [
    ("run", |run, _, _, _| run.number.to_string()),
    ("name", |run, _, _, _| run.name.clone()),
    ("choices", |run, _, _, _| run.detail.clone()),
    ("frame", |run, _, _, _| run.frame.to_string()),
    ("step", |_, index, _, _| index.to_string()),
    ("stage", |run, _, step, _| run.stages.get(step.iteration.stage).cloned().unwrap_or_default()),
    ("accepted", |_, _, step, _| step.iteration.accepted.to_string()),
    ("mismatch", |_, _, step, _| step.mismatch.to_string()),
    ("percent_of_start", |run, index, _, all| {
        known(run.fraction_among(all, index).map(|share| 100.0 * share))
    }),
    ("rms", |_, _, step, _| step.rms.to_string()),
    ("stage_cost", |_, _, step, _| step.iteration.cost.to_string()),
    ("trial_cost", |_, _, step, _| step.iteration.trial_cost.to_string()),
    ("fell", |_, _, step, _| step.iteration.actual_decrease.to_string()),
    ("foretold", |_, _, step, _| step.iteration.predicted_decrease.to_string()),
    ("damping", |_, _, step, _| step.iteration.damping.to_string()),
    ("step_norm", |_, _, step, _| step.iteration.step_norm.to_string()),
    ("seconds", |_, _, step, _| step.seconds.to_string()),
    ("iou", |_, _, step, _| known(step.iou)),
    ("joint_error_mm", |_, _, step, _| known(step.joint_error_mm)),
    ("ending", |run, index, _, _| if index == run.last_step() { run.ending_text() } else { String::new() }),
];

fn known(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// Every step of the runs as CSV, one row a step; mismatch and costs in squared grey levels, RMS in grey levels, the
/// step in metres and radians together. `ending` is in a run's last row.
pub(crate) fn csv(runs: &[Run]) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // A vector takes all that is written to it.
    let mut row = |fields: [String; COLUMNS.len()]| drop(writer.write_record(&fields));
    row(COLUMNS.map(|(name, _)| name.to_owned()));
    for run in runs {
        for (index, step) in run.steps.iter().enumerate() {
            row(COLUMNS.map(|(_, field)| field(run, index, step, runs)));
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
        let bytes = csv(std::slice::from_ref(&run));
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let rows: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().unwrap();
        assert_eq!(rows.len(), run.steps.len());
        let column = |name: &str| COLUMNS.iter().position(|column| column.0 == name).unwrap();
        assert_eq!(&rows[1][column("name")], "Robust, capsule");
        assert_eq!(&rows[1][column("percent_of_start")], "50");
        assert_eq!(&rows[2][column("accepted")], "false");
        assert_eq!(&rows[4][column("ending")], "4 steps so far");
        assert_eq!(&rows[3][column("ending")], "");
    }
}
