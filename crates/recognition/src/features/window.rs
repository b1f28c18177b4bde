//! A stretch of time as numbers: for each channel what matters of its course. None of them knows left from right, so a mirrored motion measures
//! the same. Speeds and swings are logarithms, so that twice as fast is a step and not a leap.

use super::Channels;
use super::channels::Row;
use super::normalised::percentile_of_sorted;

/// Numbers of a window.
pub const MEASURE_COUNT: usize = 113;

/// Frequencies, Hz, between which swings are summed.
const BANDS_HZ: [[f64; 2]; 3] = [[0.3, 1.4], [1.4, 2.6], [2.6, 6.0]];
/// Length of the transform that swings are read from, frames.
const TRANSFORM: usize = 90;

/// What is measured between two frames, [`MEASURE_COUNT`] numbers; `first < past ≤` the channels' length.
#[must_use]
pub fn window_measures(channels: &Channels, first: usize, past: usize) -> Vec<f64> {
    let window = Window { channels, first, past: past.min(channels.hip_height.len()) };
    let mut out = Vec::with_capacity(MEASURE_COUNT);
    for part in [Window::root, Window::feet, Window::legs, Window::trunk, Window::hands, Window::swings] {
        part(&window, &mut out);
    }
    out
}

struct Window<'a> {
    channels: &'a Channels,
    first: usize,
    past: usize,
}

impl<'a> Window<'a> {
    fn cut(&self, row: &'a Row) -> &'a [f64] {
        &row[self.first..self.past]
    }

    fn both(&self, of: impl Fn(&'a super::channels::Side) -> &'a Row) -> [&'a [f64]; 2] {
        let [left, right] = &self.channels.sides;
        [self.cut(of(left)), self.cut(of(right))]
    }

    /// Way, height and turning of the hips.
    fn root(&self, out: &mut Vec<f64>) {
        let c = self.channels;
        let [side, up, forward] = [0, 1, 2].map(|axis| self.cut(&c.velocity[axis]));
        let yaw = self.cut(&c.yaw_rate);
        let mut heading = 0.0_f64;
        let mut way = [0.0; 2];
        for ((x, z), rate) in side.iter().zip(forward).zip(yaw) {
            heading += rate / super::RATE;
            let (sin, cos) = heading.sin_cos();
            way[0] += x * cos + z * sin;
            way[1] += z * cos - x * sin;
        }
        let count = side.len() as f64;
        let magnitude = |row: &[f64]| mean_of(row.iter().map(|x| x.abs()));
        out.extend([way[0].hypot(way[1]) / count, mean(self.cut(&c.speed)), mean(forward), magnitude(side)]);
        out.extend([deviation(forward), magnitude(yaw), mean(yaw).abs()]);
        let height = self.cut(&c.hip_height);
        out.extend([mean(height), least(height), most(height), most(height) - least(height)]);
        out.extend([root_mean_square(up), most(up), least(up)]);
    }

    /// How feet leave the ground, each for itself or together, and how far apart they go.
    fn feet(&self, out: &mut Vec<f64>) {
        let toes = self.both(|side| &side.toe_up);
        let mut lower: Row = pairwise(toes, f64::min);
        out.push(most(&lower));
        let aloft = mean_of(lower.iter().map(|height| (height - 0.05).max(0.0)));
        lower.sort_by(f64::total_cmp);
        out.extend([percentile_of_sorted(&lower, 0.8), aloft]);
        let up = self.both(|side| &side.ankle[0]);
        let higher = pairwise(up, f64::max);
        out.extend([most(&higher), mean(&higher)]);
        let apart = log(deviation(&pairwise(up, |a, b| a - b)), 0.01);
        let together = log(deviation(&pairwise(up, |a, b| a + b)), 0.01);
        out.extend([apart, together, apart - together]);
        let stride = pairwise(self.both(|side| &side.ankle[1]), |a, b| a - b);
        out.extend([deviation(&stride), mean_of(stride.iter().map(|x| x.abs())), mean(&stride).abs()]);
        out.push(log(root_mean_square(&rate(&stride)), 0.05));
        out.push(log(root_mean_square(&rate(&pairwise(up, |a, b| a - b))), 0.05));
        let speed = self.both(|side| &side.foot_speed);
        let [a, b] = speed.map(mean);
        let slower = mean(&pairwise(speed, f64::min));
        let faster = most(&pairwise(speed, f64::max));
        out.extend([log(0.5 * (a + b), 0.05), log(a.min(b), 0.05), log(slower, 0.05), log(faster, 0.05)]);
        let outward = pairwise(self.both(|side| &side.ankle[2]), |a, b| a + b);
        let between = self.cut(&self.channels.between_feet);
        out.extend([mean(&outward), deviation(&outward), mean(between), most(between)]);
    }

    /// Knees and thighs.
    fn legs(&self, out: &mut Vec<f64>) {
        let knee = self.both(|side| &side.knee);
        let [a, b] = knee.map(mean);
        out.extend([0.5 * (a + b), most(knee[0]).max(most(knee[1])), most(&pairwise(knee, f64::min))]);
        out.push(a.min(b));
        out.push(mean(&pairwise(knee, |a, b| (a - b).abs())));
        out.extend([
            0.5 * (deviation(knee[0]) + deviation(knee[1])),
            deviation(&pairwise(knee, |a, b| a + b)),
        ]);
        let [a, b] = self.both(|side| &side.knee_rate).map(root_mean_square);
        out.push(log((0.5 * (a * a + b * b)).sqrt(), 0.1));
        let thigh = self.both(|side| &side.thigh_forward);
        let [a, b] = thigh.map(mean);
        out.extend([0.5 * (a + b), most(thigh[0]).max(most(thigh[1]))]);
        out.push(mean(&pairwise(thigh, |a, b| (a - b).abs())));
        out.extend([least(thigh[0]).min(least(thigh[1])), most(&pairwise(thigh, f64::min))]);
        let [a, b] = self.both(|side| &side.thigh_outward).map(mean);
        out.push(0.5 * (a + b));
    }

    /// Lean of trunk and head.
    fn trunk(&self, out: &mut Vec<f64>) {
        let [forward, sideways] = [0, 1].map(|way| self.cut(&self.channels.lean[way]));
        out.extend([mean(forward), most(forward), most(forward) - least(forward)]);
        out.extend([mean_of(sideways.iter().map(|x| x.abs())), most(sideways) - least(sideways)]);
        out.push(mean(self.cut(&self.channels.head_lean)));
    }

    /// Where hands are and how they move.
    fn hands(&self, out: &mut Vec<f64>) {
        for row in [
            self.both(|side| &side.hand[0]),
            self.both(|side| &side.hand[1]),
            self.both(|side| &side.hand[2]),
            self.both(|side| &side.elbow),
            self.both(|side| &side.elbow_up),
        ] {
            let [a, b] = row.map(mean);
            let swing = 0.5 * (deviation(row[0]) + deviation(row[1]));
            out.extend([0.5 * (a + b), (a - b).abs(), most(row[0]).max(most(row[1]))]);
            out.extend([least(row[0]).min(least(row[1])), log(swing, 0.02)]);
            out.push(mean(&pairwise(row, f64::max)));
        }
        let speed = self.both(|side| &side.hand_speed);
        let [a, b] = speed.map(mean);
        let hands = log(0.5 * (a + b), 0.05);
        out.extend([hands, log(most(speed[0]).max(most(speed[1])), 0.1)]);
        out.extend([log(a.min(b), 0.05), log(a.max(b), 0.05)]);
        let velocity = [0, 1, 2].map(|axis| self.both(|side| &side.hand_velocity[axis]));
        let along = velocity.map(|row| {
            let [a, b] = row.map(root_mean_square);
            log((0.5 * (a * a + b * b)).sqrt(), 0.05)
        });
        out.extend(along);
        out.extend(along.map(|along| along - hands));
        for axis in [2, 1] {
            let sum = root_mean_square(&pairwise(velocity[axis], |a, b| a + b));
            let difference = root_mean_square(&pairwise(velocity[axis], |a, b| a - b));
            out.push(log(sum, 0.05) - log(difference, 0.05));
        }
        let between = self.cut(&self.channels.between_hands);
        out.extend([mean(between), least(between)]);
        let [a, b] = self.both(|side| &side.foot_speed).map(mean);
        out.push(hands - log(0.5 * (a + b), 0.05));
        let arms = pairwise(self.both(|side| &side.hand[1]), |a, b| a - b);
        let feet = pairwise(self.both(|side| &side.ankle[1]), |a, b| a - b);
        out.push(-covariance(&arms, &feet) / (deviation(&arms) * deviation(&feet) + 0.01));
    }

    /// How strongly hips, feet and hands swing at which rate.
    fn swings(&self, out: &mut Vec<f64>) {
        out.extend(bands(self.cut(&self.channels.hip_height)));
        out.extend(bands(&pairwise(self.both(|side| &side.ankle[0]), |a, b| a - b)));
        out.extend(bands(&pairwise(self.both(|side| &side.ankle[1]), |a, b| a - b)));
        let mut hands = [0.0; 3];
        for side in &self.channels.sides {
            for row in &side.hand {
                for (sum, band) in hands.iter_mut().zip(bands(self.cut(row))) {
                    *sum += band / 6.0;
                }
            }
        }
        out.extend(hands);
    }
}

fn log(value: f64, floor: f64) -> f64 {
    (value + floor).ln()
}

fn mean_of(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1) as f64;
    values.sum::<f64>() / count
}

fn mean(values: &[f64]) -> f64 {
    mean_of(values.iter().copied())
}

fn covariance(a: &[f64], b: &[f64]) -> f64 {
    let (mean_a, mean_b) = (mean(a), mean(b));
    mean_of(a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)))
}

fn deviation(values: &[f64]) -> f64 {
    covariance(values, values).sqrt()
}

fn root_mean_square(values: &[f64]) -> f64 {
    mean_of(values.iter().map(|x| x * x)).sqrt()
}

fn most(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

fn pairwise([a, b]: [&[f64]; 2], of: impl Fn(f64, f64) -> f64) -> Row {
    a.iter().zip(b).map(|(&a, &b)| of(a, b)).collect()
}

fn rate(values: &[f64]) -> Row {
    super::smoothing::derivative(values, super::RATE)
}

/// Logarithms of the amplitude of a row in [`BANDS_HZ`]: the line from its first to its last number is taken away, a Hann window laid over it.
fn bands(row: &[f64]) -> [f64; 3] {
    let last = row.len().saturating_sub(1).max(1) as f64;
    let (from, to) = (row.first().copied().unwrap_or(0.0), row.last().copied().unwrap_or(0.0));
    let tapered: Row = row
        .iter()
        .enumerate()
        .map(|(index, x)| {
            let part = index as f64 / last;
            let taper = 0.5 - 0.5 * (std::f64::consts::TAU * part).cos();
            taper * (x - from - (to - from) * part)
        })
        .collect();
    let mut power = [0.0; 3];
    for bin in 0..=TRANSFORM / 2 {
        let frequency = bin as f64 * super::RATE / TRANSFORM as f64;
        let Some(band) = BANDS_HZ.iter().position(|band| (band[0]..band[1]).contains(&frequency)) else {
            continue;
        };
        let step = std::f64::consts::TAU * bin as f64 / TRANSFORM as f64;
        // A phasor that is turned on by a step a frame.
        let (step_sin, step_cos) = step.sin_cos();
        let (mut sin, mut cos) = (0.0, 1.0);
        let mut sums = [0.0; 2];
        for x in &tapered {
            sums[0] += x * cos;
            sums[1] += x * sin;
            (sin, cos) = (sin * step_cos + cos * step_sin, cos * step_cos - sin * step_sin);
        }
        power[band] += (sums[0] * sums[0] + sums[1] * sums[1]) / row.len().max(1) as f64;
    }
    power.map(|power| log(power.sqrt(), 0.01))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::augment::mirrored;
    use crate::features::Normalised;
    use crate::tests::walker;

    fn measures(motion: &crate::JointMotion) -> Vec<f64> {
        let channels = Channels::new(&Normalised::new(motion).unwrap());
        window_measures(&channels, 10, 40)
    }

    #[test]
    fn a_mirrored_motion_measures_the_same() {
        let motion = walker(2.0, 1.2);
        let (plain, other) = (measures(&motion), measures(&mirrored(&motion)));
        assert_eq!(plain.len(), MEASURE_COUNT);
        for (index, (a, b)) in plain.iter().zip(&other).enumerate() {
            assert!(a.is_finite() && (a - b).abs() < 1e-6, "measure {index}: {a} and {b}");
        }
    }

    #[test]
    fn a_swing_is_in_its_band() {
        for (hertz, band) in [(1.0, 0), (2.0, 1), (4.0, 2)] {
            let row: Row =
                (0..60).map(|i| (std::f64::consts::TAU * hertz * f64::from(i) / 30.0).sin()).collect();
            let found = bands(&row);
            let strongest = (0..3).max_by(|&a, &b| found[a].total_cmp(&found[b])).unwrap();
            assert_eq!(strongest, band, "{hertz} Hz: {found:?}");
        }
    }

    #[test]
    fn a_short_window_is_finite() {
        let channels = Channels::new(&Normalised::new(&walker(1.0, 0.5)).unwrap());
        assert!(window_measures(&channels, 3, 5).iter().all(|x| x.is_finite()));
    }
}
