//! The part on the recorder's thread: forwards only the data that the hub needs.

use std::sync::{Arc, atomic::Ordering};

use nima_machine::{
    messages::{Event, LoopState, Tick},
    rig::SIDES,
};
use nima_recording::session::Encoding;
use nima_session::sinks::Audience;

use super::{
    IgtlShared, LoopOutline,
    moment::{HubMessage, IgtlArm, LoopMoment},
};

/// Watches one loop.
#[derive(Debug)]
pub(super) struct LoopWatcher {
    shared: Arc<IgtlShared>,
    outline: LoopOutline,
    states: [Option<LoopState>; SIDES],
}

impl LoopWatcher {
    pub(super) const fn new(shared: Arc<IgtlShared>, outline: LoopOutline) -> Self {
        Self { shared, outline, states: [None; SIDES] }
    }

    /// Sends to the hub; returns whether the queue had room.
    fn report(&self, report: HubMessage) -> bool {
        let arrived = self.shared.report.try_send(report).is_ok();
        if !arrived {
            self.shared.dropped.fetch_add(1, Ordering::Relaxed);
        }
        arrived
    }
}

impl Audience for LoopWatcher {
    fn begins(&mut self, _program: &str, started_ns: u64) {
        self.report(HubMessage::Begins(started_ns, self.outline));
    }

    fn clock(&mut self, started_ns: u64) {
        self.report(HubMessage::Clock(started_ns));
    }

    fn channel(&mut self, _topic: &str, _encoding: &Encoding) {}

    fn message(&mut self, _channel: usize, _log_time_ns: u64, _data: &[u8]) {}

    fn tick(&mut self, t_s: f64, ticks: &[Option<Tick>; SIDES], _events: &[Event]) {
        let states = ticks.each_ref().map(|tick| tick.as_ref().map(|tick| tick.state));
        let has_changed = states != self.states;
        if !has_changed && t_s < self.shared.due_s() {
            return;
        }
        let arms = ticks.each_ref().map(|tick| tick.as_ref().map(IgtlArm::of));
        // If a change did not fit into the queue, send it with the next tick.
        if self.report(HubMessage::Moment(LoopMoment { t_s, arms })) {
            self.states = states;
        }
    }
}

impl Drop for LoopWatcher {
    fn drop(&mut self) {
        self.report(HubMessage::Ends);
    }
}
