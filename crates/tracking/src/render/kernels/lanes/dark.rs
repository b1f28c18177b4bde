//! The tiles of a tile row that need not be looked at, because some solid darkens them altogether.

/// Runs that are known at the most; of more the longest stay.
const RUNS: usize = 4;
/// Pieces that they leave of a row, at the most.
pub(super) const MOST_PIECES: usize = RUNS + 1;
/// What is not a run: it begins behind all tiles.
const NO_RUN: [u32; 2] = [u32::MAX; 2];

/// Runs of dark tiles, the first and one past the last of each, from left to right and apart from each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DarkTiles([[u32; 2]; RUNS]);

impl DarkTiles {
    pub(super) const NONE: Self = Self([NO_RUN; RUNS]);

    /// From left to right.
    #[inline(always)]
    pub(super) fn runs(&self) -> impl Iterator<Item = [u32; 2]> {
        self.0.iter().copied().take_while(|run| run[0] < run[1])
    }

    /// Adds the tiles from one to before another, joined with the runs that they meet.
    #[inline(always)]
    pub(super) fn add(&mut self, [from, to]: [u32; 2]) {
        if from < to {
            self.add_some([from, to]);
        }
    }

    fn add_some(&mut self, mut added: [u32; 2]) {
        let mut apart = [NO_RUN; RUNS + 1];
        let mut count = 0;
        for run in self.runs() {
            if run[1] < added[0] || added[1] < run[0] {
                apart[count] = run;
                count += 1;
            } else {
                added = [added[0].min(run[0]), added[1].max(run[1])];
            }
        }
        let place = apart[..count].iter().take_while(|run| run[0] < added[0]).count();
        apart.copy_within(place..RUNS, place + 1);
        apart[place] = added;
        if count == RUNS {
            let shortest = (0..=RUNS).min_by_key(|&run| apart[run][1] - apart[run][0]).unwrap_or(RUNS);
            apart.copy_within(shortest + 1.., shortest);
        }
        self.0.copy_from_slice(&apart[..RUNS]);
    }
}

#[cfg(test)]
mod tests {
    use super::DarkTiles;

    fn runs_of(added: &[[u32; 2]]) -> Vec<[u32; 2]> {
        let mut dark = DarkTiles::NONE;
        added.iter().for_each(|&run| dark.add(run));
        dark.runs().collect()
    }

    #[test]
    fn runs_that_meet_are_one_and_all_are_in_order() {
        assert_eq!(runs_of(&[]), [] as [[u32; 2]; 0]);
        assert_eq!(runs_of(&[[7, 7], [9, 8]]), [] as [[u32; 2]; 0]);
        assert_eq!(runs_of(&[[20, 30], [1, 4], [10, 12]]), [[1, 4], [10, 12], [20, 30]]);
        assert_eq!(runs_of(&[[20, 30], [1, 4], [4, 20]]), [[1, 30]]);
        assert_eq!(runs_of(&[[1, 4], [6, 9], [3, 7], [12, 13]]), [[1, 9], [12, 13]]);
    }

    #[test]
    fn of_too_many_runs_the_shortest_is_forgotten() {
        let four = [[10, 20], [30, 33], [40, 50], [60, 70]];
        let with = |run: [u32; 2]| runs_of(&[four.as_slice(), &[run]].concat());
        assert_eq!(with([80, 90]), [[10, 20], [40, 50], [60, 70], [80, 90]]);
        assert_eq!(with([0, 8]), [[0, 8], [10, 20], [40, 50], [60, 70]]);
        assert_eq!(with([22, 24]), four);
        assert_eq!(with([33, 40]), [[10, 20], [30, 50], [60, 70]]);
    }

    /// Against a picture row of flags: what is said to be dark is dark, and all of it while there are few runs.
    #[test]
    fn dark_tiles_are_those_that_were_added() {
        let mut state = 7_u32;
        let mut next = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % below
        };
        for _ in 0..2000 {
            let (mut dark, mut flags, mut most) = (DarkTiles::NONE, [false; 64], 0);
            for _ in 0..6 {
                let from = next(60);
                let to = (from + next(12)).min(64);
                dark.add([from, to]);
                flags[from as usize..to as usize].fill(true);
                let runs = flags.chunk_by(|a, b| a == b).filter(|run| run[0]).count();
                most = most.max(runs);
            }
            let mut found = [false; 64];
            for run in dark.runs() {
                found[run[0] as usize..run[1] as usize].fill(true);
            }
            assert!(found.iter().zip(flags).all(|(&found, added)| added || !found));
            assert!(most > super::RUNS || found == flags, "{most} runs");
        }
    }
}
