//! What happened in front of the screen, for the figures that are written when the window is closed: so that a session can be checked
//! from outside by what the loop did, not by how it looked.

use nima_core::impedance::Mode;
use nima_machine::{messages::Tick, runtime::Summary};
use serde::Serialize;

/// States and modes kept; a session has few.
const KEPT: usize = 200;

/// The session so far, of the right arm pair.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Diary {
    /// Words of the loop's states in their order, each when it was entered.
    pub states: Vec<&'static str>,
    /// Modes that were rendered with, in their order.
    pub modes: Vec<Mode>,
    /// Gain at the end, without unit.
    pub gain: f64,
    /// Ticks in which somebody led the instrument from the screen.
    pub led_ticks: u64,
    /// Marks in the traces at the end.
    pub marks: usize,
    /// The traces were held at the end.
    pub paused: bool,
}

/// The loop's figures and what happened before the screen, in one object.
#[derive(Debug, Serialize)]
pub struct WithScreen<'a> {
    /// Of the last loop.
    #[serde(flatten)]
    pub summary: &'a Summary,
    /// Of the whole session.
    pub screen: &'a Diary,
}

impl Diary {
    /// Takes in one tick.
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
