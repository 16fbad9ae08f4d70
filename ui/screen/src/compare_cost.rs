//! Computing time that comparing all modes adds to a tick, from the measured work of the ticks.

use std::collections::VecDeque;

use nima_core::impedance::Mode;
use nima_machine::messages::{LoopState, Tick};

/// Ticks of which the median is taken; an interrupted tick does not move it.
const TICKS: usize = 500;
/// Ticks needed for a median.
const ENOUGH: usize = 200;
/// Engaged ticks after which comparing starts although there was too little contact to measure without it.
const PATIENCE: u64 = 3000;

/// Work of the last engaged ticks in contact; in free motion most of the identification rests.
#[derive(Clone, Debug, Default)]
pub struct CompareCost {
    mode: Option<Mode>,
    waited: u64,
    alone_s: VecDeque<f32>,
    compared_s: VecDeque<f32>,
}

impl CompareCost {
    /// Adds a tick; `compares`: whether it computed all modes.
    pub fn push(&mut self, tick: &Tick, compares: bool) {
        if self.mode != Some(tick.mode) {
            *self = Self { mode: Some(tick.mode), waited: self.waited, ..Self::default() };
        }
        if tick.state != LoopState::Engaged {
            return;
        }
        self.waited += u64::from(!compares);
        if tick.identification.resting || !tick.timing.work_s.is_finite() {
            return;
        }
        let of = if compares { &mut self.compared_s } else { &mut self.alone_s };
        of.push_back(tick.timing.work_s as f32);
        if of.len() > TICKS {
            of.pop_front();
        }
    }

    /// Returns whether the work without comparing is known, or cannot be expected soon.
    pub fn has_waited(&self) -> bool {
        self.alone_s.len() >= ENOUGH || self.waited >= PATIENCE
    }

    /// Returns the work of a tick that computes all modes, and what it takes more than a tick of the mode in use, us;
    /// `None` if not measured.
    pub fn us(&self) -> [Option<f64>; 2] {
        let [alone, compared] = [&self.alone_s, &self.compared_s].map(median_us);
        [compared, compared.zip(alone).map(|(compared, alone)| compared - alone)]
    }
}

fn median_us(seconds: &VecDeque<f32>) -> Option<f64> {
    if seconds.len() < ENOUGH {
        return None;
    }
    let mut sorted: Vec<f32> = seconds.iter().copied().collect();
    let (_, median, _) = sorted.select_nth_unstable_by(seconds.len() / 2, f32::total_cmp);
    Some(f64::from(*median) * 1e6)
}

#[cfg(test)]
mod tests {
    use nima_simulation::run_virtual;

    use super::*;

    #[test]
    fn the_cost_is_the_difference_of_medians_and_unknown_before() {
        let mut cost = CompareCost::default();
        let mut last = None;
        run_virtual(&nima_tests::plan("peg_transfer"), 0.1, |tick| {
            last = Some(*tick);
            None
        })
        .unwrap();
        let mut tick = last.unwrap();
        tick.state = LoopState::Engaged;
        tick.identification.resting = false;
        assert_eq!((cost.us(), cost.has_waited()), ([None; 2], false));
        for number in 0..2 * ENOUGH {
            // One tick in ten was interrupted for a millisecond.
            tick.timing.work_s = if number % 10 == 0 { 1e-3 } else { 10e-6 };
            cost.push(&tick, false);
            tick.timing.work_s += 15e-6;
            cost.push(&tick, true);
        }
        assert!(cost.has_waited());
        let [all, more] = cost.us().map(Option::unwrap);
        assert!((all - 25.0).abs() < 0.1 && (more - 15.0).abs() < 0.1, "{all} {more}");
        tick.mode = Mode::Dfr;
        cost.push(&tick, false);
        assert_eq!(cost.us(), [None; 2], "another mode costs something else");
    }
}
