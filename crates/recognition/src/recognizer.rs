//! The classifiers of all classes, learnt from named motions.

use serde::{Deserialize, Serialize};

use crate::discriminant::Discriminant;
use crate::hmm::{HiddenMarkov, Network, log_sum};
use crate::nearest::Exemplars;
use crate::novelty::Novelty;
use crate::observed::{Observed, SHORT, STEP, WINDOW};
use crate::principal::PrincipalComponents;
use crate::radial::RadialBasis;
use crate::svm::SupportVectors;

/// How a motion is named.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Hidden Markov models of short windows.
    Hmm,
    /// Support vector machines of windows of two seconds.
    Svm,
    /// Nearest neighbours of windows of two seconds.
    Nearest,
    /// Support vectors and distances from the classes' means together, of windows of two seconds.
    Combined,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Hmm, Self::Svm, Self::Nearest, Self::Combined];

    /// The word for it in files and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Hmm => "hmm",
            Self::Svm => "svm",
            Self::Nearest => "nearest",
            Self::Combined => "combined",
        }
    }
}

/// Windows overlap: the part of a short window that the one before it does not have.
const NEW_PART_OF_SHORT: f64 = STEP as f64 / SHORT as f64;
/// The same of a window, where one is looked at every [`STEP`] frames.
const NEW_PART_OF_WINDOW: f64 = STEP as f64 / WINDOW as f64;
/// Margins are made probabilities by a softmax of this many times the margin.
const MARGIN_NATS: f64 = 6.0;
/// Weight of squared distances: measures of a window are not independent, so their sum says too much.
const DISTANCE_WEIGHT: f64 = 0.3;
/// Shares of neighbours count as at least so much.
const LEAST_SHARE: f64 = 0.01;

/// Where a class lies on the plane of the first two principal components.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneCloud {
    /// The middle of its frames.
    pub mean: [f64; 2],
    /// Their variances along both axes, and their covariance.
    pub covariance: [f64; 3],
}

/// Names motions. See [`Recognizer::learn`], [`Recognizer::recognise`] and [`model_file`](crate::model_file).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recognizer {
    /// The classes' names.
    pub classes: Vec<String>,
    /// The plane that motions are drawn on: principal components of frames.
    pub plane: PrincipalComponents,
    /// Where each class lies on it.
    pub clouds: Vec<PlaneCloud>,
    /// Axes of short windows.
    pub short: Discriminant,
    /// Axes of windows.
    pub long: Discriminant,
    /// A model a class, of short windows.
    pub models: Vec<HiddenMarkov>,
    /// Where each person who was learnt from does each class, along the axes of windows.
    pub basis: RadialBasis,
    /// Planes between the classes among the values of that basis.
    pub machine: SupportVectors,
    /// The same among all standardised measures of windows; learnt in coordinates in which people and moments scatter alike in all directions.
    pub wide_machine: SupportVectors,
    /// What known windows look like.
    pub novelty: Novelty,
    /// Known windows; a model that is to hold no motion has none.
    pub exemplars: Option<Exemplars>,
    /// Nats that going from one class to another costs.
    pub switch_penalty: f64,
}

/// What was learnt from the 72 clips of the CMU motion capture database, statistics only (see `docs/chapter6.md`).
const BUILT_IN: &str = include_str!("../assets/motions.json");

impl Recognizer {
    /// The recognizer that comes with the program: seven classes, without single windows.
    #[must_use]
    pub fn built_in() -> Self {
        #[expect(clippy::expect_used, reason = "the embedded file is checked by a test")]
        Self::from_text(BUILT_IN).expect("the built-in recognizer is valid")
    }

    /// The methods that this model holds.
    pub fn methods(&self) -> impl Iterator<Item = Method> {
        let has_exemplars = self.exemplars.is_some();
        Method::ALL.into_iter().filter(move |method| *method != Method::Nearest || has_exemplars)
    }

    /// Where each class lies on the plane of the first two axes of short windows, by its hidden Markov model.
    #[must_use]
    pub fn clouds_apart(&self) -> Vec<PlaneCloud> {
        let cloud = |model: &HiddenMarkov| {
            let parts = model.occupancy();
            let at = |row: &Vec<f64>, axis: usize| row.get(axis).copied().unwrap_or(0.0);
            let sum = |of: &dyn Fn(usize) -> f64| -> f64 {
                parts.iter().enumerate().map(|(state, part)| part * of(state)).sum()
            };
            let mean = [0, 1].map(|axis| sum(&|state| at(&model.means[state], axis)));
            let off = |state: usize, axis: usize| at(&model.means[state], axis) - mean[axis];
            let variance =
                |axis: usize| sum(&|state| at(&model.variances[state], axis) + off(state, axis).powi(2));
            let both = sum(&|state| off(state, 0) * off(state, 1));
            PlaneCloud { mean, covariance: [variance(0), variance(1), both] }
        };
        self.models.iter().map(cloud).collect()
    }

    /// By class, ln of its probability in the window that begins at a frame, seen by itself.
    #[must_use]
    pub fn window_logs(&self, seen: &Observed, first: usize, method: Method) -> Vec<f64> {
        let logs = self.logs_of_measures(seen, first, method).unwrap_or_else(|| {
            let rows: Vec<Vec<f64>> =
                seen.short[seen.short_within(first)].iter().map(|row| self.short.project(row)).collect();
            self.models.iter().map(|model| NEW_PART_OF_SHORT * model.log_likelihood(&rows)).collect()
        });
        let sum = log_sum(logs.iter().copied());
        logs.iter().map(|log| log - sum).collect()
    }

    /// The same but for a constant, of methods that look at the measures of a whole window; hidden Markov models look at its short windows.
    fn logs_of_measures(&self, seen: &Observed, first: usize, method: Method) -> Option<Vec<f64>> {
        let logs_of = match method {
            Method::Hmm => return None,
            Method::Svm => Self::machine_logs,
            Method::Nearest => Self::neighbour_logs,
            Method::Combined => Self::combined_logs,
        };
        Some(logs_of(self, &seen.window(first)))
    }

    fn machine_logs(&self, measures: &[f64]) -> Vec<f64> {
        let narrow = self.machine.margins(&self.basis.values(&self.long.project(measures)));
        let wide = self.wide_machine.margins(&self.long.standardised(measures));
        narrow.iter().zip(wide).map(|(narrow, wide)| MARGIN_NATS * 0.5 * (narrow + wide)).collect()
    }

    /// −w d²/2, with d the distances from the classes' means and w [`DISTANCE_WEIGHT`].
    fn distance_logs(&self, measures: &[f64]) -> Vec<f64> {
        let squared = self.novelty.squared_distances(&self.long.standardised(measures));
        squared.iter().map(|squared| -0.5 * DISTANCE_WEIGHT * squared).collect()
    }

    /// The mean of both: support vectors know the borders between classes, distances count how people differ as noise.
    fn combined_logs(&self, measures: &[f64]) -> Vec<f64> {
        let both = self.machine_logs(measures).into_iter().zip(self.distance_logs(measures));
        both.map(|(machine, distance)| 0.5 * (machine + distance)).collect()
    }

    fn neighbour_logs(&self, measures: &[f64]) -> Vec<f64> {
        match &self.exemplars {
            Some(known) => {
                let shares = known.shares(&self.long.project(measures), self.classes.len());
                shares.iter().map(|share| share.max(LEAST_SHARE).ln()).collect()
            }
            None => vec![0.0; self.classes.len()],
        }
    }

    /// By class, the probability that a whole motion is of it.
    #[must_use]
    pub fn clip_shares(&self, seen: &Observed, method: Method) -> Vec<f64> {
        let starts = seen.window_starts();
        let mut shares = vec![0.0; self.classes.len()];
        for &start in &starts {
            let logs = self.window_logs(seen, start, method);
            for (share, log) in shares.iter_mut().zip(logs) {
                *share += log.exp() / starts.len() as f64;
            }
        }
        shares
    }

    /// What each short window says for each state of each class, nats.
    fn evidence(&self, seen: &Observed, method: Method) -> Vec<Vec<Vec<f64>>> {
        let moment = |step: usize| -> Vec<Vec<f64>> {
            let place = self.short.project(&seen.short[step]);
            let logs = self.logs_of_measures(seen, seen.window_about(step), method);
            let states = |(class, model): (usize, &HiddenMarkov)| match &logs {
                Some(logs) => vec![NEW_PART_OF_WINDOW * logs[class]; model.state_count()],
                None => model.log_densities(&place).iter().map(|log| NEW_PART_OF_SHORT * log).collect(),
            };
            self.models.iter().enumerate().map(states).collect()
        };
        (0..seen.short.len()).map(moment).collect()
    }

    /// How far the window that begins at a frame is from all that is known; beyond 1 it is unknown.
    #[must_use]
    pub fn strangeness(&self, seen: &Observed, first: usize) -> f64 {
        self.novelty.strangeness(&self.long.standardised(&seen.window(first))) / self.novelty.threshold
    }

    /// By short window, the number of the class that a take's evidence makes it, and the probability of each class. Hidden Markov models by
    /// themselves cut the take by their best walk; otherwise each moment has its own likeliest class, given all moments.
    pub(crate) fn names(&self, seen: &Observed, method: Method) -> (Vec<usize>, Vec<Vec<f64>>) {
        let evidence = self.evidence(seen, method);
        let network = Network { models: &self.models, switch_penalty: self.switch_penalty };
        let beliefs = network.beliefs(&evidence);
        let names = match method {
            Method::Hmm => network.segment(&evidence),
            _ => beliefs.iter().map(|row| largest(row)).collect(),
        };
        (names, beliefs)
    }
}

/// The number of the largest value; 0 of none.
pub(crate) fn largest(values: &[f64]) -> usize {
    (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{learnt, standing_and_walking, walker};

    #[test]
    fn every_method_gives_probabilities() {
        let recognizer = learnt();
        let seen = Observed::new(&walker(2.0, 0.5)).unwrap();
        for method in Method::ALL {
            let logs = recognizer.window_logs(&seen, 5, method);
            assert!((logs.iter().map(|log| log.exp()).sum::<f64>() - 1.0).abs() < 1e-9, "{logs:?}");
            assert!((recognizer.clip_shares(&seen, method).iter().sum::<f64>() - 1.0).abs() < 1e-9);
            let evidence = recognizer.evidence(&seen, method);
            assert_eq!(evidence.len(), seen.short.len());
            for (states, model) in evidence[3].iter().zip(&recognizer.models) {
                assert_eq!(states.len(), model.state_count());
                assert!(states.iter().all(|state| state.is_finite()));
            }
        }
    }

    #[test]
    fn a_model_without_windows_has_no_neighbours() {
        let mut recognizer = learnt();
        assert_eq!(recognizer.methods().collect::<Vec<_>>(), Method::ALL);
        recognizer.exemplars = None;
        assert!(recognizer.methods().all(|method| method != Method::Nearest));
        let seen = Observed::new(&walker(1.5, 1.0)).unwrap();
        let logs = recognizer.window_logs(&seen, 0, Method::Nearest);
        assert!(logs.iter().all(|log| (log - 0.5_f64.ln()).abs() < 1e-12), "{logs:?}");
    }

    #[test]
    fn classes_lie_apart_where_their_windows_do() {
        let recognizer = learnt();
        let clouds = recognizer.clouds_apart();
        for named in standing_and_walking() {
            let class = recognizer.classes.iter().position(|class| *class == named.class).unwrap();
            let seen = Observed::new(&named.motion).unwrap();
            let places = seen.short.iter().map(|row| recognizer.short.project(row)[0]);
            let mean = places.sum::<f64>() / seen.short.len() as f64;
            let off = |cloud: &PlaneCloud| (cloud.mean[0] - mean).abs();
            assert!(off(&clouds[class]) < off(&clouds[1 - class]), "{}: {mean} {clouds:?}", named.name);
            assert!(clouds[class].covariance[0] > 0.0);
        }
    }

    #[test]
    fn the_class_whose_mean_is_nearer_is_likelier() {
        let recognizer = learnt();
        let mut before = f64::NEG_INFINITY;
        for speed in [0.1, 0.3, 0.6, 0.9, 1.1] {
            let measures = Observed::new(&walker(2.0, speed)).unwrap().window(0);
            let squared = recognizer.novelty.squared_distances(&recognizer.long.standardised(&measures));
            let logs = recognizer.distance_logs(&measures);
            assert_eq!(logs[1] > logs[0], squared[1] < squared[0], "{speed}: {logs:?} {squared:?}");
            assert!(logs[1] - logs[0] > before, "{speed}: {logs:?}");
            before = logs[1] - logs[0];
        }
    }

    #[test]
    fn combined_odds_lie_between_those_of_support_vectors_and_distances() {
        let recognizer = learnt();
        let measures = Observed::new(&walker(2.0, 0.4)).unwrap().window(0);
        let odds = |logs: Vec<f64>| logs[1] - logs[0];
        let [machine, distance] =
            [recognizer.machine_logs(&measures), recognizer.distance_logs(&measures)].map(odds);
        let combined = odds(recognizer.combined_logs(&measures));
        assert!((machine - distance).abs() > 0.01);
        let (least, most) = (machine.min(distance), machine.max(distance));
        assert!(least < combined && combined < most, "{machine} {combined} {distance}");
    }
}
