//! Compares the loop's tip force with the true one.
//!
//! The two processes share the time of day, which assigns ticks to true forces. A tick never arrives before its time, so the
//! smallest difference between the time of day and the loop's time is the offset of the two clocks.

use std::{collections::VecDeque, fmt::Write as _};

use nalgebra::Vector3;
use nima_emulation::emulated::{DoubtFractions, IN_USE, TipError, TipErrors};
use nima_machine::{
    messages::Tick,
    rig::{SIDES, Side},
};
use serde::{Deserialize, Serialize};

use crate::ground_truth::TruthComparison;

/// Stored ticks of a side that wait for their true force: two seconds at 1 kHz.
const KEPT: usize = 2000;
/// A true force is compared with a tick at most this far from it, s.
const NEAR_S: f64 = 0.002;

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct TrueForce {
    pub(super) truth: Side,
    /// Time of day, s since 1970.
    pub(super) at_s: f64,
    /// Force of the tissue on the tip, N (`world`).
    pub(super) tip_n: [f64; 3],
}

/// Compares ticks with their true forces.
#[derive(Debug)]
pub(super) struct TipComparison {
    errors: TipErrors,
    recent: [VecDeque<Tick>; SIDES],
    waiting: VecDeque<TrueForce>,
    /// Time of day at the start of the loop, s.
    began_s: f64,
}

impl Default for TipComparison {
    fn default() -> Self {
        Self {
            errors: TipErrors::default(),
            recent: Default::default(),
            waiting: VecDeque::new(),
            began_s: f64::INFINITY,
        }
    }
}

impl TipComparison {
    /// Adds true forces, and compares all ticks that are now complete.
    fn know(&mut self, known: impl Iterator<Item = TrueForce>) {
        self.waiting.extend(known);
        while let Some(known) = self.waiting.front().copied() {
            let recent = &self.recent[known.truth.index()];
            let t_s = known.at_s - self.began_s;
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
}

impl TruthComparison for TipComparison {
    fn tick(&mut self, tick: &Tick, seen_s: f64) {
        self.began_s = self.began_s.min(seen_s - tick.t_s);
        let recent = &mut self.recent[tick.side.index()];
        if recent.len() == KEPT {
            recent.pop_front();
        }
        recent.push_back(*tick);
    }

    fn receive(&mut self, report: &mut dyn Iterator<Item = String>) {
        self.know(report.filter_map(|line| serde_json::from_str(&line).ok()));
    }

    fn figures(&self) -> Vec<serde_json::Value> {
        self.errors.figures().iter().filter_map(|error| serde_json::to_value(error).ok()).collect()
    }

    fn as_text(&self) -> String {
        as_text(&self.errors.figures())
    }
}

fn as_text(figures: &[TipError]) -> String {
    if figures.is_empty() {
        return String::new();
    }
    let mut text =
        "\ntip force compared with the true force, N per axis (x, y, z of the workspace), while engaged:".to_owned();
    // Writing to a String cannot fail.
    for TipError { side, method, mae_n: [x, y, z], free, without_network, doubt, .. } in figures {
        write!(text, "\n  {:5}  {method:12}  mean error {x:.3} {y:.3} {z:.3}", side.word()).ok();
        if let Some(free) = free {
            let [a, b, c] = free.mean_n;
            let [d, e, f] = free.sd_n;
            write!(text, "   without contact mean {a:.3} {b:.3} {c:.3}   sd {d:.3} {e:.3} {f:.3}").ok();
        }
        if *method == IN_USE {
            write!(text, "   without the network {:.1} % of the time", 100.0 * without_network).ok();
            let DoubtFractions { extrapolated, outside_training, not_moved, missing } = doubt;
            for (fraction, why) in [
                (extrapolated, "extrapolated"),
                (outside_training, "outside training"),
                (not_moved, "not moved yet"),
                (missing, "incomplete samples"),
            ] {
                if *fraction > 0.0 {
                    write!(text, ", {why} {:.1} %", 100.0 * fraction).ok();
                }
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use nima_machine::{config::RigConfig, messages::LoopState};
    use nima_simulation::{SimulationPlan, run_virtual, scene::Scene};

    use super::*;
    use nima_calibrations::active_calibrations::ActiveCalibrations;

    /// Returns the ticks of an engaged run on the simulated rig.
    fn ticks() -> Vec<Tick> {
        let rig = RigConfig::load("simulated").unwrap();
        let scene = Scene::load("palpation").unwrap();
        let folder = tempfile::tempdir().unwrap();
        nima_recording::store::Store::open(folder.path()).save(&nima_tests::gravity::gravity()).unwrap();
        let calibrations = ActiveCalibrations::load(Some(folder.path()), &rig, &scene).calibrations(&rig);
        let mut ticks = Vec::new();
        run_virtual(&SimulationPlan { rig, scene, calibrations, engage: true }, 6.0, |tick| {
            ticks.push(*tick);
            None
        })
        .unwrap();
        ticks
    }

    #[test]
    fn a_true_force_is_compared_with_the_tick_of_its_time() {
        const BEGAN_S: f64 = 1.7e9;
        let ticks = ticks();
        let compared = |late_s: f64| {
            let mut comparison = TipComparison::default();
            for (index, tick) in ticks.iter().enumerate() {
                // Ticks arrive up to 5 ms late, and the true force arrives before its tick.
                let known =
                    TrueForce { truth: Side::Right, at_s: BEGAN_S + tick.t_s + late_s, tip_n: tick.measured_n.into() };
                comparison.know(std::iter::once(known));
                comparison.tick(tick, BEGAN_S + tick.t_s + 1e-3 * (index % 6) as f64);
            }
            comparison.know(std::iter::empty());
            comparison.errors.figures()
        };
        let engaged = ticks.iter().filter(|tick| tick.state == LoopState::Engaged).count() as u64;
        let figures = compared(0.0);
        assert_eq!(
            figures.iter().map(|error| error.method).collect::<Vec<_>>(),
            ["tip force", "gravity only", "wrist only"]
        );
        assert!(figures[0].samples > engaged / 2, "{} of {engaged}", figures[0].samples);
        assert!(figures[0].mae_n.iter().all(|n| *n < 1e-3), "the same force at the same time: {:?}", figures[0]);
        assert!(figures[2].mae_n[2] > 2.0, "weight and bias are in the wrist's: {:?}", figures[2]);
        let late = compared(0.03);
        assert!(late[0].mae_n[2] > 5.0 * figures[0].mae_n[2] + 1e-3, "another time is another force: {:?}", late[0]);
        assert!(as_text(&figures).contains("wrist only") && as_text(&[]).is_empty());
    }
}
