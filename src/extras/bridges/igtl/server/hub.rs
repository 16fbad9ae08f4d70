//! Converts the state of the loop into messages for each client.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use crossbeam_channel::RecvTimeoutError;
use nima_machine::{messages::LoopState, rig::SIDES};

use super::{
    super::{Content, ContentKind, IgtlMessage, StatusCode},
    HubReceiver, IgtlShared, LoopOutline,
    client::{EARLY_S, IgtlClient, now_ns, refusal},
    moment::{BUNDLE, HubMessage, IgtlWriter, LoopMoment},
};

/// Interval of the checks for disconnected clients and due states.
const LOOK_EVERY: Duration = Duration::from_millis(100);
/// Every client gets the status of the loop at this interval.
const STATUS_EVERY: Duration = Duration::from_secs(1);
/// A loop that sends nothing for this long is considered stopped if a client has requested data.
const SILENT: Duration = Duration::from_secs(2);

pub(super) struct Hub {
    shared: Arc<IgtlShared>,
    outline: LoopOutline,
    started_ns: u64,
    newest: Option<LoopMoment>,
    received: Instant,
    looked: Instant,
}

impl Hub {
    pub(super) fn new(shared: Arc<IgtlShared>) -> Self {
        let now = Instant::now();
        Self { shared, outline: LoopOutline::default(), started_ns: 0, newest: None, received: now, looked: now }
    }

    /// Runs until the server ends.
    pub(super) fn run(mut self, receives: &HubReceiver) {
        while !self.shared.is_ending() {
            match receives.recv_timeout(LOOK_EVERY) {
                Ok(HubMessage::Begins(started_ns, outline)) => {
                    self.started_ns = started_ns;
                    self.outline = outline;
                    self.newest = None;
                    self.shared.hurry();
                }
                Ok(HubMessage::Clock(started_ns)) => self.started_ns = started_ns,
                Ok(HubMessage::Moment(moment)) => self.moment(moment),
                Ok(HubMessage::Ends) => {
                    self.newest = None;
                    self.send_all();
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            let now = Instant::now();
            if now.duration_since(self.looked) >= LOOK_EVERY {
                self.looked = now;
                self.look_after(now);
            }
        }
    }

    fn time_ns(&self, t_s: f64) -> u64 {
        self.started_ns.saturating_add_signed((t_s * 1e9).round() as i64)
    }

    /// Processes a state of the loop.
    fn moment(&mut self, moment: LoopMoment) {
        let has_changed = self.newest.as_ref().map(states) != Some(states(&moment));
        self.newest = Some(moment);
        self.received = Instant::now();
        if has_changed {
            self.send_all();
        }
        let writer = IgtlWriter { moment: &moment, outline: &self.outline, time_ns: self.time_ns(moment.t_s) };
        let clients = self.shared.clients();
        let mut due_s = f64::INFINITY;
        for client in clients.iter().filter(|client| !client.is_gone()) {
            let mut wants = client.wants();
            if wants.asks() {
                let asked = wants.take_asked();
                let mut bytes = Vec::new();
                asked.of_moment().for_each(|kind| writer.put(kind, &mut bytes));
                if asked.has(ContentKind::Status) {
                    writer.put_status(self.shared.words, &mut bytes);
                }
                client.mailbox.report(bytes);
            }
            if let Some(kinds) = wants.due(moment.t_s) {
                let mut bytes = Vec::new();
                kinds.of_moment().for_each(|kind| writer.put(kind, &mut bytes));
                if !bytes.is_empty() {
                    client.mailbox.bundle(bytes);
                }
            }
            due_s = due_s.min(wants.due_s);
        }
        // Set while holding the clients, so that a new request is not overwritten.
        self.shared.set_due(due_s - EARLY_S);
    }

    fn look_after(&self, now: Instant) {
        let mut clients = self.shared.clients();
        clients.retain(|client| !client.is_gone());
        if clients.is_empty() {
            self.shared.set_due(f64::INFINITY);
        }
        let is_silent = self.newest.is_none() || now.duration_since(self.received) > SILENT;
        for client in clients.iter() {
            let mut wants = client.wants();
            let asked = is_silent && wants.asks();
            if asked {
                wants.take_asked();
            }
            if asked || wants.wants_states() && wants.status_due.is_none_or(|due| now >= due) {
                wants.status_due = Some(now + STATUS_EVERY);
                drop(wants);
                self.report(client, is_silent);
            }
        }
    }

    /// Sends the status of the loop to all clients that have requested it.
    fn send_all(&self) {
        for client in self.shared.clients().iter() {
            let mut wants = client.wants();
            if wants.wants_states() {
                wants.status_due = Some(Instant::now() + STATUS_EVERY);
                drop(wants);
                self.report(client, self.newest.is_none());
            }
        }
    }

    fn report(&self, client: &IgtlClient, is_silent: bool) {
        let bytes = match &self.newest {
            Some(moment) if !is_silent => {
                let writer = IgtlWriter { moment, outline: &self.outline, time_ns: self.time_ns(moment.t_s) };
                let mut bytes = Vec::new();
                writer.put_status(self.shared.words, &mut bytes);
                bytes
            }
            _ => IgtlMessage::new(BUNDLE, now_ns(), no_loop()).encode(),
        };
        client.mailbox.report(bytes);
    }
}

fn no_loop() -> Content {
    refusal(StatusCode::NOT_READY, "no data now: no loop is running, or a trial of a blind study is")
}

fn states(moment: &LoopMoment) -> [Option<LoopState>; SIDES] {
    moment.arms.map(|arm| arm.map(|arm| arm.state))
}
