//! A record of the session, written with the figures when the window is closed: tests can check a session by what the
//! loop did, not by how it looked.

use nima_core::impedance::Mode;
use nima_machine::{messages::Tick, runtime::Summary};
use serde::Serialize;

/// Most states and modes stored.
const KEPT: usize = 200;

/// Record of the right arm pair.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Diary {
    /// Names of the loop's states in the order in which they were entered.
    pub states: Vec<&'static str>,
    /// Rendering modes in the order of their use.
    pub modes: Vec<Mode>,
    /// Gain at the end, without unit.
    pub gain: f64,
    /// Ticks in which the instrument was led from the window.
    pub led_ticks: u64,
    /// Number of marks at the end.
    pub marks: usize,
    /// Whether the traces were paused at the end.
    pub paused: bool,
}

/// Figures of the loop and record of the session, in one object.
#[derive(Debug, Serialize)]
pub struct WithScreen<'a> {
    /// Figures of the last loop.
    #[serde(flatten)]
    pub summary: &'a Summary,
    /// Record of the whole session.
    pub screen: &'a Diary,
}

impl Diary {
    /// Adds one tick.
    pub(super) fn tick(&mut self, tick: &Tick) {
        follow(&mut self.states, tick.state.word());
        follow(&mut self.modes, tick.mode);
        self.gain = tick.gates.gain;
        self.led_ticks += u64::from(tick.guide_m.is_some());
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
