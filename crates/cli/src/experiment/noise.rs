//! How often noise alone passes for a subject, and how much of a faint subject is found, by the rule that joins the z-scores
//! of three channels.
//!
//! Every rule promises one pixel in 10⁴. The greatest of three scores keeps the promise if each channel's share is
//! 1 − (1 − 10⁻⁴)^⅓ (Šidák), with dependent channels too: then it is wrong less often. Their sum of squares keeps it only where the
//! channels are independent, which those of a camera are not.

use backlit_tracking::segment::BETA;
use backlit_tracking::statistics::normal;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use serde::Serialize;

use crate::output::number;
use crate::table::Table;

/// The z-score that one channel exceeds once in 10⁴ pixels: the report's β.
const ONE_CHANNEL: f64 = 3.891;
/// The sum of three squares that is exceeded once in 10⁴ pixels.
const CHI_SQUARED: f64 = 21.108;
/// How far a faint subject is off, in deviations: in one channel, or in each of the three.
const OFF: [[f64; 3]; 2] = [[6.0, 0.0, 0.0], [3.0, 3.0, 3.0]];

/// How three z-scores are joined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Rule {
    /// Some score beyond 3.891.
    OneChannel,
    /// Some score beyond [`BETA`].
    Sidak,
    /// The sum of squares beyond the χ² of three degrees of freedom.
    ChiSquared,
}

impl Rule {
    /// All of them.
    const ALL: [Self; 3] = [Self::OneChannel, Self::Sidak, Self::ChiSquared];

    fn label(self) -> &'static str {
        match self {
            Self::OneChannel => "greatest of three, 3.891",
            Self::Sidak => "greatest of three, Šidák",
            Self::ChiSquared => "sum of squares, χ²",
        }
    }

    fn is_subject(self, z: [f64; 3]) -> bool {
        match self {
            Self::OneChannel => z.iter().any(|z| z.abs() > ONE_CHANNEL),
            Self::Sidak => z.iter().any(|z| z.abs() > f64::from(BETA)),
            Self::ChiSquared => z.iter().map(|z| z * z).sum::<f64>() > CHI_SQUARED,
        }
    }
}

/// One rule under one kind of noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct NoiseCase {
    /// Of the channels' noise.
    correlation: f64,
    /// Frames that the deviation was measured over; none where it is known.
    frames: Option<usize>,
    rule: Rule,
    /// Pixels of noise that are called subject, of 10⁴.
    false_in_10_000: f64,
    /// Share that is found of a subject six deviations off in one channel.
    found_in_one: f64,
    /// Share that is found of a subject three deviations off in each channel.
    found_in_all: f64,
}

/// Normal noise of several correlations with a known deviation, then independent noise whose mean and deviation were measured
/// over some frames: a tenth of the pixels, as each takes all those frames.
pub(crate) fn run(pixels: usize, seed: u64) -> Vec<NoiseCase> {
    let known = [0.0, 0.5, 1.0].map(|correlation| (correlation, None));
    let measured = [6, 50].map(|frames| (0.0, Some(frames)));
    let kinds = known.into_iter().chain(measured);
    kinds
        .flat_map(|(correlation, frames)| {
            let pixels = if frames.is_some() { pixels / 10 } else { pixels };
            under(correlation, frames, pixels, seed)
        })
        .collect()
}

pub(crate) fn table(cases: &[NoiseCase]) -> String {
    let noise = |case: &&NoiseCase| match case.frames {
        Some(frames) => format!("independent, σ of {frames} frames"),
        None => format!("channels correlated by {:.1}", case.correlation),
    };
    Table::of(
        cases,
        &[
            ("noise", &noise),
            ("rule", &|case| case.rule.label().to_owned()),
            ("false, of 10 000", &|case| number(case.false_in_10_000, 2)),
            ("found: one channel 6 σ off", &|case| number(case.found_in_one, 3)),
            ("three channels 3 σ off", &|case| number(case.found_in_all, 3)),
        ],
    )
}

fn under(correlation: f64, frames: Option<usize>, pixels: usize, seed: u64) -> [NoiseCase; 3] {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    // Subject pixels by rule: of noise, of one channel off, of all.
    let mut counts = [[0_usize; 3]; 3];
    for _ in 0..pixels {
        let common = normal(&mut random);
        let own = [0; 3].map(|_| normal(&mut random));
        let noise = own.map(|own| correlation.sqrt() * common + (1.0 - correlation).sqrt() * own);
        let believed = noise.map(|_| frames.map_or((0.0, 1.0), |frames| estimated(frames, &mut random)));
        for (what, off) in [[0.0; 3], OFF[0], OFF[1]].into_iter().enumerate() {
            let z = [0, 1, 2].map(|c| (noise[c] + off[c] - believed[c].0) / believed[c].1);
            for (counts, rule) in counts.iter_mut().zip(Rule::ALL) {
                counts[what] += usize::from(rule.is_subject(z));
            }
        }
    }
    let share = |count: usize| count as f64 / pixels.max(1) as f64;
    [0, 1, 2].map(|rule| {
        let [noise, one, all] = counts[rule].map(share);
        NoiseCase {
            correlation,
            frames,
            rule: Rule::ALL[rule],
            false_in_10_000: 1e4 * noise,
            found_in_one: one,
            found_in_all: all,
        }
    })
}

/// Mean and deviation of this many standard normal numbers, drawn from their own distributions: the mean is normal, and the
/// square of the deviation a sum of squares.
fn estimated(frames: usize, random: &mut Pcg64Mcg) -> (f64, f64) {
    let degrees = frames.saturating_sub(1).max(1);
    let squares: f64 = (0..degrees).map(|_| normal(random).powi(2)).sum();
    (normal(random) / (frames as f64).sqrt(), (squares / degrees as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_shares_by_channel_keep_the_promise_whatever_the_noise() {
        let cases = run(300_000, 2);
        let of = |correlation: f64, rule| {
            let is_it = |case: &&NoiseCase| {
                case.frames.is_none() && case.correlation == correlation && case.rule == rule
            };
            cases.iter().find(is_it).unwrap().false_in_10_000
        };
        // Thirty pixels are expected: 1 ± 0.18 of 10⁴.
        assert!((of(0.0, Rule::Sidak) - 1.0).abs() < 0.75, "{cases:?}");
        assert!((of(0.0, Rule::ChiSquared) - 1.0).abs() < 0.75, "{cases:?}");
        assert!((of(0.0, Rule::OneChannel) - 3.0).abs() < 1.3, "{cases:?}");
        assert!(of(1.0, Rule::Sidak) < 1.0, "{cases:?}");
        assert!(of(1.0, Rule::ChiSquared) > 20.0, "{cases:?}");
    }
}
