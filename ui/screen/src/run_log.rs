//! A log of the run, written with the results when the window is closed: tests check the behaviour of the loop, not the look
//! of the window.

use nima_core::impedance::Mode;
use nima_machine::{messages::Tick, runtime::RuntimeSummary};
use serde::Serialize;

/// Maximum number of stored states and modes.
const KEPT: usize = 200;

/// Log of the right arm pair.
#[derive(Clone, Debug, Default, Serialize)]
pub struct RunLog {
    /// Names of the loop's states in the order in which they were entered.
    pub states: Vec<&'static str>,
    /// Rendering modes in the order of their use.
    pub modes: Vec<Mode>,
    /// Gain at the end, without unit.
    pub gain: f64,
    /// Ticks in which the instrument was driven from the window.
    pub led_ticks: u64,
    /// Number of marks at the end.
    pub marks: usize,
    /// Whether the traces were paused at the end.
    pub paused: bool,
}

/// Results of the loop and log of the run, in one object.
#[derive(Debug, Serialize)]
pub struct WithScreen<'a> {
    #[serde(flatten)]
    pub summary: &'a RuntimeSummary,
    pub screen: &'a RunLog,
}

impl RunLog {
    pub fn tick(&mut self, tick: &Tick) {
        follow(&mut self.states, tick.state.word());
        follow(&mut self.modes, tick.mode);
        self.gain = tick.gates.gain;
        self.led_ticks += u64::from(tick.guidance.guide_m.is_some());
    }
}

fn follow<T: PartialEq>(kept: &mut Vec<T>, now: T) {
    if kept.last() != Some(&now) && kept.len() < KEPT {
        kept.push(now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_state_is_written_once_when_it_is_entered() {
        let mut states = Vec::new();
        for state in ["Idle", "Idle", "Engaged", "Stopped", "Idle"] {
            follow(&mut states, state);
        }
        assert_eq!(states, ["Idle", "Engaged", "Stopped", "Idle"]);
    }
}
