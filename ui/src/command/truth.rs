//! The loop's force at the tip beside the true one, which the emulators tell from their own process.
//!
//! The two processes share the time of day: it says which tick belongs to a true force. A tick is never seen before it was made, so
//! the smallest difference between the time of day and the loop's time is how the two clocks stand.

use std::{
    collections::VecDeque,
    fmt::Write as _,
    time::{SystemTime, UNIX_EPOCH},
};

use nalgebra::Vector3;
use nima_machine::{
    messages::Tick,
    rig::{SIDES, Side},
};
use nima_world::emulated::{TipError, TipErrors};
use serde::{Deserialize, Serialize};

/// Ticks of a side that are kept for the truth about them: two seconds at 1 kHz.
const KEPT: usize = 2000;
/// A true force is compared with a tick at most this far from it, s.
const NEAR_S: f64 = 0.002;

/// The true force at a tip.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Known {
    /// The side.
    pub(super) truth: Side,
    /// Time of day, s since 1970.
    pub(super) at_s: f64,
    /// Force of the tissue on the tip, N (`world`).
    pub(super) tip_n: [f64; 3],
}

/// The time of day, s since 1970.
pub(super) fn now_s() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64())
}

/// Compares ticks with what is known about them.
#[derive(Debug)]
pub(super) struct Comparison {
    errors: TipErrors,
    recent: [VecDeque<Tick>; SIDES],
    waiting: VecDeque<Known>,
    /// Time of day at the start of the loop, s.
    began_s: f64,
}

impl Default for Comparison {
    fn default() -> Self {
        Self {
            errors: TipErrors::default(),
            recent: Default::default(),
            waiting: VecDeque::new(),
            began_s: f64::INFINITY,
        }
    }
}

impl Comparison {
    /// Adds a tick that is seen at this time of day, s.
    pub(super) fn tick(&mut self, tick: &Tick, seen_s: f64) {
        self.began_s = self.began_s.min(seen_s - tick.t_s);
        let recent = &mut self.recent[tick.side.index()];
        if recent.len() == KEPT {
            recent.pop_front();
        }
        recent.push_back(*tick);
    }

    /// Adds what is known, and compares what can be compared by now.
    pub(super) fn know(&mut self, known: impl Iterator<Item = Known>) {
        self.waiting.extend(known);
        while let Some(known) = self.waiting.front().copied() {
            let (recent, t_s) = (&self.recent[known.truth.index()], known.at_s - self.began_s);
            if recent.back().is_none_or(|last| last.t_s < t_s + NEAR_S) {
                return;
            }
            self.waiting.pop_front();
            let after = recent.partition_point(|tick| tick.t_s < t_s);
            let near = [after.saturating_sub(1), after].into_iter().filter_map(|index| recent.get(index));
            let nearest = near.min_by(|a, b| (a.t_s - t_s).abs().total_cmp(&(b.t_s - t_s).abs()));
            if let Some(tick) = nearest.filter(|tick| (tick.t_s - t_s).abs() < NEAR_S) {
                self.errors.add(tick, &Vector3::from(known.tip_n));
            }
        }
    }

    /// The figures.
    pub(super) fn figures(&self) -> Vec<TipError> {
        self.errors.figures()
    }
}

/// The figures as a table.
pub(super) fn in_words(figures: &[TipError]) -> String {
    if figures.is_empty() {
        return String::new();
    }
    let mut text =
        "\nforce at the tip against the true one, N per axis (x, y, z of the workspace), while engaged:".to_owned();
    // Writing into a String cannot fail.
    for TipError { side, method, mae_n: [x, y, z], free, without_network, .. } in figures {
        write!(text, "\n  {:5}  {method:12}  mean error {x:.3} {y:.3} {z:.3}", side.word()).ok();
        if let Some(free) = free {
            let ([a, b, c], [d, e, f]) = (free.mean_n, free.sd_n);
            write!(text, "   without contact mean {a:.3} {b:.3} {c:.3}   sd {d:.3} {e:.3} {f:.3}").ok();
        }
        if *method == "tip force" {
            write!(text, "   without the network {:.1} % of the time", 100.0 * without_network).ok();
        }
    }
    text
}
