//! Recorded lateness of wake-ups: the delay after the loop's deadlines, as compact tables.
//!
//! A [`JitterProfile`] is a model of two states, because late ticks come in clusters: a process that takes the
//! processor once soon takes it again. In each state the lateness is drawn from the quantiles recorded in that state,
//! linearly interpolated. `docs/timing.md` describes how the tables were recorded and how to record a new one.

use nima_core::noise::Noise;

/// Distribution of the lateness of wake-ups: quantiles in two states, and the duration of each state.
#[derive(Clone, Copy, Debug)]
pub(super) struct JitterProfile {
    /// The usual state, and the state in which late ticks cluster.
    states: [JitterState; 2],
}

#[derive(Clone, Copy, Debug)]
struct JitterState {
    /// Probability per tick of a change to the other state.
    leave: f64,
    /// Increasing pairs of probability, from 0 to 1, and lateness, us.
    late_us: &'static [[f64; 2]],
}

/// An ordinary thread on an idle computer. The quantiles are recorded; the frequency of the second state is chosen so
/// that as many periods are missed as in the quiet case of `docs/timing.md`, 0.2 %.
pub(super) const QUIET: JitterProfile = JitterProfile {
    states: [
        JitterState {
            leave: 8e-5,
            late_us: &[[0.0, 10.0], [0.01, 36.0], [0.1, 69.0], [0.5, 80.0], [0.9, 87.0], [0.99, 122.0], [1.0, 314.0]],
        },
        JitterState {
            leave: 0.0133,
            late_us: &[
                [0.0, 17.0],
                [0.1, 69.0],
                [0.5, 82.0],
                [0.6, 86.0],
                [0.7, 508.0],
                [0.8, 1014.0],
                [0.9, 1627.0],
                [0.95, 2195.0],
                [0.98, 3773.0],
                [0.99, 4839.0],
                [0.995, 6817.0],
                [1.0, 7971.0],
            ],
        },
    ],
};

/// An ordinary thread on two cores with two busy processes. The quantiles are recorded; the frequency of the second
/// state is chosen so that 5 % of the ticks are more than 0.5 ms late, the maximum observed with two busy processes
/// alone.
pub(super) const BUSY: JitterProfile = JitterProfile {
    states: [
        JitterState {
            leave: 0.012,
            late_us: &[[0.0, 8.0], [0.01, 29.0], [0.1, 64.0], [0.5, 66.0], [0.9, 75.0], [0.99, 128.0], [1.0, 446.0]],
        },
        JitterState {
            leave: 0.028,
            late_us: &[
                [0.0, 9.0],
                [0.1, 65.0],
                [0.5, 67.0],
                [0.7, 72.0],
                [0.8, 89.0],
                [0.85, 781.0],
                [0.9, 1148.0],
                [0.95, 1806.0],
                [0.98, 3024.0],
                [0.99, 5122.0],
                [0.995, 7464.0],
                [1.0, 10838.0],
            ],
        },
    ],
};

impl JitterProfile {
    /// Draws the lateness of the next wake-up, ns. `state` is the current state, 0 or 1, and is updated.
    pub(super) fn late_ns(&self, state: &mut usize, random: &mut Noise) -> u64 {
        if random.uniform() < self.states[*state].leave {
            *state = 1 - *state;
        }
        (1e3 * at(self.states[*state].late_us, random.uniform())).round() as u64
    }
}

/// Returns the value of a quantile table at this probability, linearly interpolated.
fn at(quantiles: &[[f64; 2]], probability: f64) -> f64 {
    let above = quantiles.partition_point(|[from, _]| *from <= probability).clamp(1, quantiles.len() - 1);
    let [from, low] = quantiles[above - 1];
    let [to, high] = quantiles[above];
    low + (high - low) * (probability - from) / (to - from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_rises_from_probability_0_to_1() {
        for JitterState { leave, late_us } in [QUIET, BUSY].into_iter().flat_map(|profile| profile.states) {
            assert!(leave > 0.0 && leave < 1.0 && late_us[0][1] >= 0.0, "{leave} {late_us:?}");
            let ends = [late_us[0][0], late_us[late_us.len() - 1][0]];
            assert!(ends[0].abs() < f64::EPSILON && (ends[1] - 1.0).abs() < f64::EPSILON, "{ends:?}");
            assert!(late_us.windows(2).all(|pair| pair[0][0] < pair[1][0] && pair[0][1] <= pair[1][1]), "{late_us:?}");
        }
    }

    #[test]
    fn the_drawn_lateness_has_the_quantiles_of_the_table() {
        let table: &[[f64; 2]] = &[[0.0, 10.0], [0.5, 20.0], [0.9, 100.0], [1.0, 1000.0]];
        for (probability, us) in [(0.0, 10.0), (0.25, 15.0), (0.5, 20.0), (0.7, 60.0), (0.95, 550.0), (1.0, 1000.0)] {
            assert!((at(table, probability) - us).abs() < 1e-9, "{probability}");
        }
    }
}
