//! Part that runs on the recorder's thread: converts events into markers with time stamps.

use std::sync::Arc;

use nima_machine::{
    messages::{Event, Tick},
    rig::SIDES,
};
use nima_recording::{messages::foxglove::Log, session::Encoding};
use nima_session::sinks::Audience;
use prost::Message as _;

use super::{
    LslShared, MarkContext,
    clock::LslLoopClock,
    marks::{MarkFollower, happening},
};

/// Topics of a session, and the name of the operator's lines in its log.
const HAPPENINGS: &str = "happenings";
const LOG: &str = "log";
const OPERATORS: &str = "mark";

/// The topics of a session that are used, in addition to its ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum AudienceTopic {
    Happenings,
    Log,
    Other,
}

/// Maximum number of markers that wait until the clock is known. If the clock never becomes known, the queue must not
/// grow for ever.
const MAX_EARLY: usize = 1024;

/// Makes the markers of one session.
#[derive(Debug)]
pub(super) struct SessionMarks {
    shared: Arc<LslShared>,
    trial: Option<String>,
    follower: MarkFollower,
    clock: LslLoopClock,
    channels: Vec<AudienceTopic>,
    started_ns: u64,
    /// Time of the last tick, s.
    last_s: Option<f64>,
    /// Events from before the clock was known, with their times of the loop, s.
    early: Vec<(f64, String)>,
}

impl SessionMarks {
    pub(super) fn new(shared: Arc<LslShared>, about: MarkContext) -> Self {
        let MarkContext { contact_n, trial, words } = about;
        let clock = LslLoopClock::default();
        let channels = Vec::new();
        let early = Vec::new();
        let follower = MarkFollower::new(contact_n, words);
        Self { shared, trial, follower, clock, channels, started_ns: 0, last_s: None, early }
    }

    /// Adds a marker at this time of the loop, s. The caller must keep the order of times.
    fn mark(&mut self, t_s: f64, what: String) {
        match self.clock.settled(t_s) {
            Some(at_s) => self.shared.mark(at_s, what),
            None if self.early.len() < MAX_EARLY => self.early.push((t_s, what)),
            None => {}
        }
    }

    /// Sends the waiting markers.
    fn catch_up(&mut self) {
        for (t_s, what) in std::mem::take(&mut self.early) {
            if let Some(at_s) = self.clock.at(t_s) {
                self.shared.mark(at_s, what);
            }
        }
    }
}

impl Audience for SessionMarks {
    fn begins(&mut self, _program: &str, started_ns: u64) {
        self.started_ns = started_ns;
    }

    fn clock(&mut self, started_ns: u64) {
        // The times of the messages refer to the first one.
        if self.last_s.is_none() {
            self.started_ns = started_ns;
        }
    }

    fn channel(&mut self, topic: &str, _encoding: &Encoding) {
        self.channels.push(match topic {
            HAPPENINGS => AudienceTopic::Happenings,
            LOG => AudienceTopic::Log,
            _ => AudienceTopic::Other,
        });
    }

    fn message(&mut self, channel: usize, log_time_ns: u64, data: &[u8]) {
        let what = match self.channels.get(channel) {
            Some(AudienceTopic::Happenings) => happening(data),
            // Only the operator's marks; all other lines are covered by ticks.
            Some(AudienceTopic::Log) => {
                Log::decode(data).ok().filter(|log| log.name == OPERATORS).map(|log| log.message)
            }
            _ => None,
        };
        if let Some(what) = what {
            let t_s = log_time_ns.saturating_sub(self.started_ns) as f64 * 1e-9;
            self.mark(t_s, what);
        }
    }

    fn tick(&mut self, t_s: f64, ticks: &[Option<Tick>; SIDES], _events: &[Event]) {
        let is_first = self.last_s.replace(t_s).is_none();
        self.clock.note(t_s, self.shared.lsl.local_clock());
        if let Some(trial) = self.trial.as_ref().filter(|_| is_first) {
            self.early.insert(0, (t_s, format!("trial begin {trial}")));
        }
        if self.clock.settled(t_s).is_some() && !self.early.is_empty() {
            self.catch_up();
        }
        let mut marks = Vec::new();
        self.follower.tick(ticks, |what| marks.push(what));
        for what in marks {
            self.mark(t_s, what);
        }
    }
}

impl Drop for SessionMarks {
    fn drop(&mut self) {
        self.catch_up();
        if let Some((trial, at_s)) = self.trial.take().zip(self.last_s.and_then(|t_s| self.clock.at(t_s))) {
            self.shared.mark(at_s, format!("trial end {trial}"));
        }
    }
}
