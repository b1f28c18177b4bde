//! All steps of all runs as a table.

use backlit_document::run::Run;

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
