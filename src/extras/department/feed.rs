//! Publishes a rig's recording: its session in batches, and the content of its screen.

use std::{
    collections::BTreeMap,
    mem::take,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

use crossbeam_channel::{Sender, TrySendError};
use nima_machine::{
    messages::{Event, LoopState, Tick},
    rig::SIDES,
};
use nima_recording::session::Encoding;
use nima_session::{
    monitor_stream::MomentWriter,
    objects::ObjectStates,
    recorder::AttachedFile,
    remote_copy::{Bundle, FilePart, SessionHead},
    sinks::Audience,
};

/// Duration of a batch of the session, ns; a remote file can lose at most this much. Shorter ones would compress worse
/// and cost more messages.
const BUNDLE_NS: u64 = 400_000_000;
/// Maximum size of a bundle, bytes.
const BUNDLE_BYTES: usize = 4 << 20;
/// States sent together: 50 ms.
const MOMENTS: u64 = 10;
/// Interval at which persistent state is repeated, s: a late watcher waits for at most this long. Only changes are sent
/// otherwise, so a watcher that joins later has no other way to get it.
const RECAP_S: f64 = 1.0;

/// Input of the publishing thread.
#[derive(Debug)]
pub(crate) enum FeedMessage {
    /// A session begins.
    Begins(SessionHead),
    /// A file that describes the running session: name and text.
    File(String, String),
    /// A part of the session.
    Bundle(Bundle),
    /// Content of the screen.
    Moments(u64, Vec<u8>),
}

/// The recorder's side. Data that the other side does not accept in time are dropped.
#[derive(Debug)]
pub(crate) struct DepartmentFeed {
    to: Sender<FeedMessage>,
    dropped: Arc<AtomicU64>,
    session: u64,
    number: u64,
    parts: Vec<FilePart>,
    bytes: usize,
    /// Time of the first message in the bundle, ns.
    since_ns: Option<u64>,
    moments: MomentWriter,
    recap: Recap,
}

impl DepartmentFeed {
    pub(crate) fn new(to: Sender<FeedMessage>, dropped: Arc<AtomicU64>) -> Self {
        Self {
            to,
            dropped,
            session: 0,
            number: 0,
            parts: Vec::new(),
            bytes: 0,
            since_ns: None,
            moments: MomentWriter::default(),
            recap: Recap::default(),
        }
    }

    fn report(&self, report: FeedMessage) {
        if let Err(TrySendError::Full(_)) = self.to.try_send(report) {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    fn part(&mut self, part: FilePart, bytes: usize) {
        self.parts.push(part);
        self.bytes += bytes;
    }

    fn close_bundle(&mut self, closes: bool) {
        let parts = take(&mut self.parts);
        self.bytes = 0;
        self.since_ns = None;
        self.report(FeedMessage::Bundle(Bundle::new(self.session, self.number, parts, closes)));
        self.number += 1;
    }
}

impl Audience for DepartmentFeed {
    fn begins(&mut self, program: &str, started_ns: u64) {
        // No two sessions of a machine begin in the same nanosecond.
        self.session = started_ns;
        self.report(FeedMessage::Begins(SessionHead::new(self.session, program, started_ns)));
    }

    fn metadata(&mut self, name: &str, entries: &BTreeMap<String, String>) {
        self.part(FilePart::table(name, entries), 0);
    }

    fn attachment(&mut self, time_ns: u64, attached: &AttachedFile) {
        if let Ok(text) = String::from_utf8(attached.data.clone()) {
            self.report(FeedMessage::File(attached.name.clone(), text));
        }
        self.part(FilePart::file(time_ns, attached), attached.data.len());
    }

    fn channel(&mut self, topic: &str, encoding: &Encoding) {
        self.part(FilePart::channel(topic, encoding), encoding.schema_data.len());
    }

    fn message(&mut self, channel: usize, log_time_ns: u64, data: &[u8]) {
        let since_ns = *self.since_ns.get_or_insert(log_time_ns);
        self.part(FilePart::message(channel, log_time_ns, data), data.len());
        if log_time_ns.saturating_sub(since_ns) >= BUNDLE_NS || self.bytes >= BUNDLE_BYTES {
            self.close_bundle(false);
        }
    }

    fn tick(&mut self, t_s: f64, ticks: &[Option<Tick>; SIDES], events: &[Event]) {
        let recap = self.recap.due(t_s);
        for event in events {
            self.recap.take(event);
        }
        match recap {
            Some(mut all) => {
                all.extend(events);
                self.moments.tick(t_s, ticks, &all);
            }
            None => self.moments.tick(t_s, ticks, events),
        }
        if self.moments.len() >= MOMENTS {
            let moments = self.moments.take();
            self.report(FeedMessage::Moments(self.session, moments));
        }
    }

    fn objects(&mut self, objects: &ObjectStates) {
        self.moments.objects(objects);
    }
}

impl Drop for DepartmentFeed {
    fn drop(&mut self) {
        self.close_bundle(true);
    }
}

/// The events that still apply, which a late monitor requires.
#[derive(Debug, Default)]
struct Recap {
    reported_s: Option<f64>,
    devices: BTreeMap<u8, Event>,
    scheduling: Option<Event>,
    /// The last change of each side's state, and the faults since.
    states: [Vec<Event>; SIDES],
}

impl Recap {
    fn take(&mut self, event: &Event) {
        match event {
            Event::Device(of) => drop(self.devices.insert(of.device, *event)),
            Event::Scheduling(_) => self.scheduling = Some(*event),
            Event::StateChanged { side, to, .. } => {
                let states = &mut self.states[side.index()];
                // The fault that led to this state was reported before it.
                let is_fault = matches!(to, LoopState::Faulted(_));
                states.retain(|state| is_fault && matches!(state, Event::FaultRaised { .. }));
                states.insert(0, *event);
            }
            Event::FaultRaised { side, .. } if self.states[side.index()].len() < 4 => {
                self.states[side.index()].push(*event);
            }
            Event::FaultRaised { .. } | Event::CommandRefused { .. } => {}
        }
    }

    /// Returns all of these events, once per second.
    fn due(&mut self, t_s: f64) -> Option<Vec<Event>> {
        if self.reported_s.is_some_and(|reported_s| (0.0..RECAP_S).contains(&(t_s - reported_s))) {
            return None;
        }
        self.reported_s = Some(t_s);
        let all = self.devices.values().chain(&self.scheduling).chain(self.states.iter().flatten());
        Some(all.copied().collect())
    }
}

#[cfg(test)]
mod tests {
    use nima_core::safety::TransitionCause;
    use nima_machine::{messages::Fault, rig::Side};

    use super::*;

    #[test]
    fn what_stands_is_told_every_second_and_a_fault_until_it_is_released() {
        let mut recap = Recap::default();
        let raised = Event::FaultRaised { t_s: 1.0, side: Side::Right, fault: Fault::SourceSilent };
        let changed =
            |from, to| Event::StateChanged { t_s: 1.0, side: Side::Right, from, to, why: TransitionCause::Fault };
        let faulted = changed(LoopState::Engaged, LoopState::Faulted(Fault::SourceSilent));
        assert_eq!(recap.due(0.0), Some(vec![]));
        for event in [raised, faulted] {
            recap.take(&event);
        }
        assert_eq!(recap.due(0.9), None);
        assert_eq!(recap.due(1.0), Some(vec![faulted, raised]));
        let released = changed(LoopState::Faulted(Fault::SourceSilent), LoopState::Idle);
        recap.take(&released);
        assert_eq!(recap.due(2.5), Some(vec![released]));
        // A new loop begins at zero.
        assert!(recap.due(0.1).is_some());
    }
}
