//! The events that become markers, and their texts.
//!
//! A marker is a short text that a program can split at spaces: event, side, and numbers. It contains nothing about the
//! rendering of forces.

use nima_core::safety::InterlockState;
use nima_machine::{
    messages::{Fault, LoopState, Tick},
    rig::{SIDES, Side},
};
use serde_json::{Map, Value};

/// Contact ends below this fraction of the force at which it begins. Hysteresis, because the noise of a light touch
/// would otherwise start and end it many times.
const CONTACT_ENDS: f64 = 0.5;
/// The fields of an event that come first in its marker.
const EVENT: &str = "event";
const TIME: &str = "t_s";

/// Follows the arms from tick to tick.
#[derive(Debug)]
pub(super) struct MarkFollower {
    contact_n: f64,
    /// Text of a fault's cause; `None` in a trial, where some causes occur only with force.
    words: Option<fn(Fault) -> &'static str>,
    states: [Option<LoopState>; SIDES],
    contacts: [bool; SIDES],
}

impl MarkFollower {
    pub(super) const fn new(contact_n: f64, words: Option<fn(Fault) -> &'static str>) -> Self {
        Self { contact_n, words, states: [None; SIDES], contacts: [false; SIDES] }
    }

    /// Reports the events in these ticks.
    pub(super) fn tick(&mut self, ticks: &[Option<Tick>; SIDES], mut mark: impl FnMut(String)) {
        for tick in ticks.iter().flatten() {
            let side = tick.side;
            let place = tick.side.index();
            let before = self.states[place].replace(tick.state);
            if before != Some(tick.state) {
                self.change(side, before, tick.state, &mut mark);
            }
            let force_n = tick.measured_n.norm();
            let was = self.contacts[place];
            let min_n = if was { CONTACT_ENDS * self.contact_n } else { self.contact_n };
            // An unknown force does not count as contact.
            let is = tick.state != InterlockState::Disconnected && force_n >= min_n;
            self.contacts[place] = is;
            if is != was {
                mark(format!("contact {} {}", if is { "on" } else { "off" }, side.word()));
            }
        }
    }

    fn change(&self, side: Side, before: Option<LoopState>, to: LoopState, mark: &mut impl FnMut(String)) {
        let side = side.word();
        let coupled = |state: &LoopState| matches!(state, InterlockState::Engaged | InterlockState::Clutched);
        match (before.as_ref().is_some_and(coupled), coupled(&to)) {
            (false, true) => mark(format!("engage {side}")),
            (true, false) => mark(format!("disengage {side}")),
            _ => {}
        }
        let cause = |fault| self.words.map_or_else(String::new, |words| format!(": {}", words(fault)));
        match (before, to) {
            (_, InterlockState::Faulted(fault)) => mark(format!("fault {side}{}", cause(fault))),
            (_, InterlockState::Stopped) => mark(format!("stop {side}")),
            (_, InterlockState::Clutched) => mark(format!("clutch on {side}")),
            (Some(InterlockState::Clutched), _) => mark(format!("clutch off {side}")),
            _ => {}
        }
    }
}

/// Converts an event of a session to a marker: `task ring_dropped in_view=false ring=2 side=left`.
pub(super) fn happening(message: &[u8]) -> Option<String> {
    let fields: Map<String, Value> = serde_json::from_slice(message).ok()?;
    let event = fields.get(EVENT)?.as_str()?;
    let report = fields.iter().filter(|(name, value)| ![EVENT, TIME].contains(&name.as_str()) && !value.is_null());
    Some(report.fold(format!("task {event}"), |mark, (name, value)| {
        mark + &format!(" {name}={}", value.as_str().map_or_else(|| value.to_string(), str::to_owned))
    }))
}
