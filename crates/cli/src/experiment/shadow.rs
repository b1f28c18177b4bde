//! `backlit experiment shadow`: what each shadow test makes of subject, shadow and joints, and what noise makes of β.

use backlit_lab::experiment::shadow::noise::NoiseCase;
use backlit_lab::experiment::shadow::{self, Case, Found, JointErrors, Options, Report};
use backlit_plot::Figure;
use backlit_tracking::cancel::CancelToken;
use clap::Args;

use super::arguments::OutputArguments;
use super::files;
use super::waiting::Waiting;
use crate::table::Table;

/// What `backlit experiment shadow` is told.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Seed of noise and starts
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Moments of the built-in movement (its frames, 0 to 59) to look at
    #[arg(long, value_name = "K,…", value_delimiter = ',')]
    moments: Option<Vec<f64>>,
    #[command(flatten)]
    output: OutputArguments,
}

/// Runs the experiment, writes and prints.
///
/// # Errors
/// Options that make no sense, or files that cannot be written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut options = Options { seed: arguments.seed, ..Options::default() };
    options.moments = arguments.moments.clone().unwrap_or(options.moments);
    let report = shadow::run(&options, &CancelToken::new(), Waiting::new().listener())?;
    let table = format!("{}\n{}", cases(&report), noise(&report.noise));
    files::finish::<_, _, Figure>(&arguments.output, "shadow", &options, &report, &[], &table)
}

fn cases(report: &Report) -> String {
    let titles = [
        "scenery",
        "way",
        "subject: precision",
        "recall",
        "shadow: precision",
        "recall",
        "joints, mm",
        "95 %",
        "max",
        "nobody",
    ];
    let mut table = Table::new(titles);
    let share = |share: Option<f64>| share.map_or_else(|| "–".to_owned(), |share| format!("{share:.3}"));
    for case in &report.cases {
        let Case { subject, shadow, joints, .. } = case;
        let millimetres = |of: fn(&JointErrors) -> f64| {
            joints.as_ref().map_or_else(|| "–".to_owned(), |all| format!("{:.1}", of(all)))
        };
        let [of_subject, of_shadow] =
            [subject, shadow].map(|Found { precision, recall }| [share(*precision), share(*recall)]);
        let [[subject_precision, subject_recall], [shadow_precision, shadow_recall]] =
            [of_subject, of_shadow];
        table.row([
            case.scenery.label(),
            case.way.clone(),
            subject_precision,
            subject_recall,
            shadow_precision,
            shadow_recall,
            millimetres(|all| all.mean_mm),
            millimetres(|all| all.p95_mm),
            millimetres(|all| all.max_mm),
            case.nobody.to_string(),
        ]);
    }
    table.to_text()
}

fn noise(cases: &[NoiseCase]) -> String {
    let titles =
        ["noise", "rule", "false, of 10 000", "found: one channel 6 σ off", "three channels 3 σ off"];
    let mut table = Table::new(titles);
    for case in cases {
        let noise = match case.frames {
            Some(frames) => format!("independent, σ of {frames} frames"),
            None => format!("channels correlated by {:.1}", case.correlation),
        };
        table.row([
            noise,
            case.rule.label().to_owned(),
            format!("{:.2}", case.false_in_10_000),
            format!("{:.3}", case.found_in_one),
            format!("{:.3}", case.found_in_all),
        ]);
    }
    table.to_text()
}
