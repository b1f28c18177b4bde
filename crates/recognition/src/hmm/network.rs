//! A model a class, and going from one to another.
//!
//! Within a class its own steps hold. From any state the walk may leave for another class, at a cost of `switch_penalty` nats, and begins there as
//! that class begins. The best walk (Viterbi) cuts a long take into stretches; the sum over all walks says how sure each moment is.

use super::{HiddenMarkov, log_sum};

/// The models of all classes as one.
#[derive(Debug, Clone, Copy)]
pub struct Network<'a> {
    /// One a class.
    pub models: &'a [HiddenMarkov],
    /// Nats that leaving a class costs, more than none.
    pub switch_penalty: f64,
}

impl Network<'_> {
    /// The classes of the best walk, one a moment. `evidence[t][class][state]` is what the moment says for the state, nats: as a rule ln b.
    #[must_use]
    pub fn segment(&self, evidence: &[Vec<Vec<f64>>]) -> Vec<usize> {
        let Some(first) = evidence.first() else { return Vec::new() };
        let mut scores: Vec<Vec<f64>> = self.begin(first);
        let mut came: Vec<Vec<Vec<(usize, usize)>>> = Vec::with_capacity(evidence.len());
        for moment in &evidence[1..] {
            let best = best_of(&scores);
            let leaving = scores[best.0][best.1] - self.switch_penalty;
            let mut from = Vec::with_capacity(self.models.len());
            let mut next = Vec::with_capacity(self.models.len());
            for (class, model) in self.models.iter().enumerate() {
                let mut origins = Vec::with_capacity(model.state_count());
                let mut row = Vec::with_capacity(model.state_count());
                for (to, seen) in moment[class].iter().enumerate() {
                    let mut top = (leaving + model.start[to].ln(), best);
                    for (state, score) in scores[class].iter().enumerate() {
                        let score = score + model.transitions[state][to].ln();
                        if score > top.0 {
                            top = (score, (class, state));
                        }
                    }
                    row.push(top.0 + seen);
                    origins.push(top.1);
                }
                next.push(row);
                from.push(origins);
            }
            scores = next;
            came.push(from);
        }
        let mut at = best_of(&scores);
        let mut walk = vec![at.0];
        for from in came.iter().rev() {
            at = from[at.0][at.1];
            walk.push(at.0);
        }
        walk.reverse();
        walk
    }

    /// By moment, the probability of each class given all moments.
    #[must_use]
    pub fn beliefs(&self, evidence: &[Vec<Vec<f64>>]) -> Vec<Vec<f64>> {
        let Some(first) = evidence.first() else { return Vec::new() };
        let mut forward = vec![self.begin(first)];
        for moment in &evidence[1..] {
            let before = &forward[forward.len() - 1];
            let leaving = log_sum(before.iter().flatten().copied()) - self.switch_penalty;
            let next = self.models.iter().enumerate().map(|(class, model)| {
                let to = |to: usize| {
                    let within = before[class].iter().zip(&model.transitions);
                    let within = within.map(|(score, row)| score + row[to].ln());
                    log_sum(within.chain([leaving + model.start[to].ln()])) + moment[class][to]
                };
                (0..model.state_count()).map(to).collect()
            });
            let next = next.collect();
            forward.push(next);
        }
        let mut after: Vec<Vec<f64>> =
            self.models.iter().map(|model| vec![0.0; model.state_count()]).collect();
        let mut all = vec![Vec::new(); evidence.len()];
        for t in (0..evidence.len()).rev() {
            let total =
                |class: usize| log_sum(forward[t][class].iter().zip(&after[class]).map(|(a, b)| a + b));
            let logs: Vec<f64> = (0..self.models.len()).map(total).collect();
            let sum = log_sum(logs.iter().copied());
            all[t] = logs.iter().map(|log| (log - sum).exp()).collect();
            let seen = |class: usize, state: usize| evidence[t][class][state] + after[class][state];
            let models = || self.models.iter().enumerate();
            let starts = models().flat_map(|(class, model)| {
                model.start.iter().enumerate().map(move |(state, start)| (class, state, start))
            });
            let starts = starts.map(|(class, state, start)| seen(class, state) + start.ln());
            let entering = log_sum(starts) - self.switch_penalty;
            let before = models().map(|(class, model)| {
                let from = |row: &Vec<f64>| {
                    let within = row.iter().enumerate().map(|(to, p)| p.ln() + seen(class, to));
                    log_sum(within.chain([entering]))
                };
                model.transitions.iter().map(from).collect()
            });
            after = before.collect();
        }
        all
    }

    fn begin(&self, moment: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let start = |(model, evidence): (&HiddenMarkov, &Vec<f64>)| {
            model.start.iter().zip(evidence).map(|(start, evidence)| start.ln() + evidence).collect()
        };
        self.models.iter().zip(moment).map(start).collect()
    }
}

/// Class and state of the highest score.
fn best_of(scores: &[Vec<f64>]) -> (usize, usize) {
    let mut best = (0, 0);
    for (class, row) in scores.iter().enumerate() {
        for (state, score) in row.iter().enumerate() {
            if *score > scores[best.0][best.1] {
                best = (class, state);
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::super::tests::two_states;
    use super::*;

    fn evidence(models: &[HiddenMarkov], values: &[f64]) -> Vec<Vec<Vec<f64>>> {
        values.iter().map(|&x| models.iter().map(|model| model.log_densities(&[x])).collect()).collect()
    }

    #[test]
    fn a_take_is_cut_where_its_motion_changes() {
        let models = [two_states(-1.0, 0.0), two_states(3.0, 4.0)];
        let network = Network { models: &models, switch_penalty: 6.0 };
        let values: Vec<f64> = (0..40).map(|t| if (12..30).contains(&t) { 3.4 } else { -0.6 }).collect();
        let walk = network.segment(&evidence(&models, &values));
        let expected: Vec<usize> = (0..40).map(|t| usize::from((12..30).contains(&t))).collect();
        assert_eq!(walk, expected);
        let beliefs = network.beliefs(&evidence(&models, &values));
        for (belief, class) in beliefs.iter().zip(&expected) {
            assert!((belief.iter().sum::<f64>() - 1.0).abs() < 1e-9 && belief[*class] > 0.9, "{belief:?}");
        }
        let one_off = [vec![-0.6; 9], vec![3.4], vec![-0.6; 9]].concat();
        let dear = Network { models: &models, switch_penalty: 60.0 };
        assert!(dear.segment(&evidence(&models, &one_off)).iter().all(|&class| class == 0));
    }

    /// All walks through two classes of two states, three moments.
    #[test]
    fn beliefs_are_the_sum_over_all_walks() {
        let models = [two_states(-1.0, 0.5), two_states(0.0, 2.0)];
        let network = Network { models: &models, switch_penalty: 1.0 };
        let evidence = evidence(&models, &[0.1, 0.9, 0.2]);
        let mut sums = vec![vec![0.0; 2]; 3];
        for code in 0..64_usize {
            let walk: Vec<(usize, usize)> =
                (0..3).map(|t| ((code >> (2 * t)) & 1, (code >> (2 * t + 1)) & 1)).collect();
            let mut density = models[walk[0].0].start[walk[0].1];
            for t in 0..3 {
                density *= evidence[t][walk[t].0][walk[t].1].exp();
                if t > 0 {
                    let (from, to) = (walk[t - 1], walk[t]);
                    let leave = (-1.0_f64).exp() * models[to.0].start[to.1];
                    let stay = if from.0 == to.0 { models[to.0].transitions[from.1][to.1] } else { 0.0 };
                    density *= leave + stay;
                }
            }
            for t in 0..3 {
                sums[t][walk[t].0] += density;
            }
        }
        for (belief, sum) in network.beliefs(&evidence).iter().zip(&sums) {
            let total: f64 = sum.iter().sum();
            assert!((belief[0] - sum[0] / total).abs() < 1e-9, "{belief:?} {sum:?}");
        }
    }
}
