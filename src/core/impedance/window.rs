//! A sliding window over any data that can be summed row by row and merged.

/// Summary of the rows of a window: a sum, or a triangular factor.
///
/// Adding rows one by one and merging two summaries must agree: the summary of a sequence equals the merged summaries
/// of its parts, in any order, up to rounding.
pub trait WindowSummary: Clone {
    /// Entries of one sample.
    type Row: Copy;
    const BLANK_ROW: Self::Row;
    fn add(&mut self, row: &Self::Row);
    fn add_three(targets: [&mut Self; 3], rows: [&Self::Row; 3]) {
        for (target, row) in targets.into_iter().zip(rows) {
            target.add(row);
        }
    }
    /// Adds all rows of `other`, which may be used as scratch space.
    fn merge(&mut self, other: &mut Self);
}

/// The summary of the last `2 B` rows, at a constant cost per tick and without ever removing a row.
///
/// Time is divided into blocks of `B`. In block `c`, after `p + 1` of its rows, the window holds those, all of block
/// `c - 1`, and the last `B - p - 1` rows of block `c - 2`. Each tick
/// 1. adds its row to two running summaries, one that began with block `c - 1`, one with block `c`;
/// 2. moves one step backwards through block `c - 1`, and stores the summary of each of its endings for the next block;
/// 3. merges the running summary that began with `c - 1` with the ending of `c - 2` stored one block ago.
///
/// Every tick therefore does the same work; at the end of a block only names change. The endings of two blocks share
/// one array: at each tick the ending just read makes room for the new one, which the next block reads in the opposite
/// direction.
#[derive(Clone, Debug)]
pub struct SlidingWindow<S: WindowSummary> {
    block: usize,
    /// Rows of the previous block (first or second half) and of this block (the other half).
    rows: Vec<S::Row>,
    this_half_first: bool,
    /// Endings of block `c - 2` (not yet read) and of block `c - 1` (written), `B - 1` in all.
    endings: Vec<S>,
    upwards: bool,
    position: usize,
    /// Number of completed blocks, counted up to two.
    completed: usize,
    since_last_block: S,
    since_this_block: S,
    backwards: S,
    empty: S,
    prior: S,
    current: S,
}

impl<S: WindowSummary> SlidingWindow<S> {
    /// Creates a window of `2 * block` rows. `empty` is the summary of no rows; `prior` is the initial content of every
    /// window (for example a ridge), or the same as `empty`.
    pub fn new(block: usize, empty: S, prior: S) -> Self {
        let block = block.max(1);
        Self {
            block,
            rows: vec![S::BLANK_ROW; 2 * block],
            this_half_first: true,
            endings: vec![empty.clone(); block],
            upwards: true,
            // Starts as if full blocks of nothing came before; `is_full` reports the difference.
            position: 0,
            completed: 0,
            since_last_block: prior.clone(),
            since_this_block: prior.clone(),
            backwards: empty.clone(),
            current: prior.clone(),
            empty,
            prior,
        }
    }

    /// Returns the number of rows in a full window.
    pub fn len(&self) -> usize {
        2 * self.block
    }

    pub fn is_empty(&self) -> bool {
        self.completed == 0 && self.position == 0
    }

    /// Returns whether the window has as many rows as it can hold.
    pub fn is_full(&self) -> bool {
        self.completed >= 2
    }

    /// Returns the summary of the last `len()` rows (fewer at the beginning), on top of the prior.
    pub fn current(&self) -> &S {
        &self.current
    }

    /// Adds the newest row and removes the row `len()` rows older.
    pub fn push(&mut self, row: &S::Row) {
        self.advance(row, true);
    }

    /// Like [`SlidingWindow::push`], but updates [`SlidingWindow::current`] only if `wanted` is set; otherwise its
    /// value is invalid.
    pub fn advance(&mut self, row: &S::Row, wanted: bool) {
        let b = self.block;
        let p = self.position;
        let (this, last) = if self.this_half_first { (0, b) } else { (b, 0) };
        self.rows[this + p] = *row;
        // Read the last block backwards, so that each step extends its ending by one older row.
        let backward_row = self.rows[last + b - 1 - p];
        S::add_three(
            [&mut self.since_last_block, &mut self.since_this_block, &mut self.backwards],
            [row, row, &backward_row],
        );
        if wanted {
            self.current.clone_from(&self.since_last_block);
        }
        // The last tick of a block needs no ending: the two blocks are then complete.
        if p + 1 < b {
            // Alternating direction: the slot just read is the one to overwrite.
            let slot = if self.upwards { p } else { b - 2 - p };
            if wanted && self.completed >= 2 {
                self.current.merge(&mut self.endings[slot]);
            }
            self.endings[slot].clone_from(&self.backwards);
        }
        self.position += 1;
        if self.position == b {
            self.begin_block();
        }
    }

    fn begin_block(&mut self) {
        self.position = 0;
        self.completed = (self.completed + 1).min(2);
        self.this_half_first = !self.this_half_first;
        self.upwards = !self.upwards;
        // The running summary of this block becomes that of the last one; nothing is summed again.
        self.since_last_block.clone_from(&self.since_this_block);
        self.since_this_block.clone_from(&self.prior);
        self.backwards.clone_from(&self.empty);
    }

    pub fn reset(&mut self) {
        self.position = 0;
        self.completed = 0;
        self.since_last_block.clone_from(&self.prior);
        self.since_this_block.clone_from(&self.prior);
        self.backwards.clone_from(&self.empty);
        self.current.clone_from(&self.prior);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{
        impedance::{ImpedanceFactor, ImpedanceSolution, factor::MAX_ROW},
        signal::Lanes,
    };

    /// The numbers of the rows in a summary, in order.
    #[derive(Clone, Debug, Default, PartialEq)]
    struct Numbers(Vec<usize>);

    impl WindowSummary for Numbers {
        type Row = usize;
        const BLANK_ROW: usize = usize::MAX;
        fn add(&mut self, row: &usize) {
            self.0.push(*row);
        }
        fn merge(&mut self, other: &mut Self) {
            self.0.extend(&other.0);
        }
    }

    #[test]
    fn holds_exactly_the_last_rows() {
        for block in 1..12 {
            let mut window = SlidingWindow::new(block, Numbers::default(), Numbers::default());
            for round in 0..2 {
                for k in 0..10 * block + 3 {
                    window.push(&k);
                    let mut held = window.current().0.clone();
                    held.sort_unstable();
                    let expected: Vec<_> = ((k + 1).saturating_sub(2 * block)..=k).collect();
                    assert_eq!(held, expected, "block {block}, round {round}");
                    assert_eq!(window.is_full(), k + 1 >= 2 * block);
                }
                window.reset();
                assert!(window.is_empty());
            }
        }
    }

    fn row(k: usize) -> [Lanes; MAX_ROW] {
        let t = k as f64;
        let mut row = [Lanes::ZERO; MAX_ROW];
        for (lane, phase) in [0.0, 1.0, 2.0, 3.0].into_iter().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                entry[lane] = if j == 0 { 1.0 } else { ((0.1 + 0.37 * j as f64) * t + phase).sin() };
            }
        }
        row
    }

    #[test]
    fn a_slid_factor_solves_like_a_fresh_one() {
        for (block, columns) in [(5, 4), (20, 16), (150, 16), (33, 7)] {
            let ridge = ImpedanceFactor::with_ridge(columns, 1e-6 * block as f64);
            let mut window = SlidingWindow::new(block, ImpedanceFactor::new(columns), ridge.clone());
            let mut slid = ImpedanceSolution::new(columns);
            let mut fresh = ImpedanceSolution::new(columns);
            for k in 0..7 * block {
                window.push(&row(k));
                slid.solve(window.current());
                let mut factor = ridge.clone();
                ((k + 1).saturating_sub(2 * block)..=k).for_each(|k| factor.add(&row(k)));
                fresh.solve(&factor);
                for prefix in 1..=columns {
                    let a = slid.coefficients(prefix);
                    let b = fresh.coefficients(prefix);
                    let condition = fresh.condition(prefix);
                    for lane in 0..4 {
                        let size = b.iter().map(|b| b[lane].abs()).fold(1.0, f64::max);
                        let off = a.iter().zip(&b).map(|(a, b)| (a[lane] - b[lane]).abs()).fold(0.0, f64::max);
                        assert!(
                            off <= 1e-14 * condition[lane].powi(2) * size,
                            "block {block} tick {k} prefix {prefix}: {off}"
                        );
                    }
                }
            }
        }
    }

    proptest! {
        #[test]
        fn any_window_solves_like_a_fresh_one(
            block in 5_usize..60, columns in 1_usize..=16, length in 0_usize..300, rejected in 2_usize..40, ridge in 1e-8..1e-2_f64,
        ) {
            let prior = ImpedanceFactor::with_ridge(columns, ridge);
            let mut window = SlidingWindow::new(block, ImpedanceFactor::new(columns), prior.clone());
            let blank = |k: usize| if k.is_multiple_of(rejected) { ImpedanceFactor::BLANK_ROW } else { row(k) };
            (0..length).for_each(|k| window.push(&blank(k)));
            let mut slid = ImpedanceSolution::new(columns);
            let mut fresh = ImpedanceSolution::new(columns);
            slid.solve(window.current());
            let mut factor = prior;
            (length.saturating_sub(2 * block)..length).for_each(|k| factor.add(&blank(k)));
            fresh.solve(&factor);
            for (slid, fresh) in slid.coefficients(columns).iter().zip(fresh.coefficients(columns)) {
                for lane in 0..4 {
                    let tolerance = 1e-13 * solution_size(&factor, lane);
                    prop_assert!((slid[lane] - fresh[lane]).abs() <= tolerance, "{} {}", slid[lane], fresh[lane]);
                }
            }
        }
    }

    /// Returns the condition number squared: the amplification of rounding errors in a solution of magnitude one.
    fn solution_size(factor: &ImpedanceFactor, lane: usize) -> f64 {
        let mut solution = ImpedanceSolution::new(factor.columns());
        solution.solve(factor);
        let size = solution.coefficients(factor.columns()).iter().map(|m| m[lane].abs()).fold(1.0, f64::max);
        size * solution.condition(factor.columns())[lane].max(1.0).powi(2)
    }

    #[test]
    fn nothing_drifts_and_a_long_window_is_exact() {
        for (block, ticks) in [(150, 200_000), (5000, 25_000)] {
            let columns = 7;
            let ridge = ImpedanceFactor::with_ridge(columns, 1e-6 * block as f64);
            let mut window = SlidingWindow::new(block, ImpedanceFactor::new(columns), ridge.clone());
            (0..ticks).for_each(|k| window.push(&row(k)));
            let mut slid = ImpedanceSolution::new(columns);
            let mut fresh = ImpedanceSolution::new(columns);
            slid.solve(window.current());
            let mut factor = ridge;
            (ticks - 2 * block..ticks).for_each(|k| factor.add(&row(k)));
            fresh.solve(&factor);
            for (slid, fresh) in slid.coefficients(columns).iter().zip(fresh.coefficients(columns)) {
                for lane in 0..4 {
                    assert!((slid[lane] - fresh[lane]).abs() < 1e-12, "block {block}: {} {}", slid[lane], fresh[lane]);
                }
            }
        }
    }
}
