//! The link to the other machine as the loop uses it, and its reports.

use egui::Ui;
use nima_machine::{
    hand_over::{FromLoop, ToLoop, from_loop, to_loop},
    remote::{RemoteWire, joined},
    rig::RigEnds,
    runtime::Assembly,
};
use nima_network::{
    endpoint::{ControlRole, Endpoint, LinkState},
    figures::{DroppedCounts, SessionMeasurements},
};
use nima_screen::link::{LineConnection, RemoteLine};
use rtrb::{Consumer, Producer};
use serde::Serialize;

use super::{
    link_text::{link_rows, link_trouble, state_text},
    screen::link_ui,
    text,
};

/// Interval of the reports, s.
const REPORT_EVERY_S: f64 = 0.1;

/// Maximum number of waiting reports and requests.
const WAITING: usize = 4;

/// One end of the link. The loop's thread drives it.
pub(super) struct NetworkLine {
    endpoint: Endpoint,
    here: RigEnds,
    reported: Producer<LineReport>,
    wishes: Consumer<LineWish>,
    door: Channels,
    next_s: f64,
}

/// The channel ends for another thread.
#[derive(Clone, Debug)]
struct Channels {
    reports: FromLoop<LineReport>,
    wishes: ToLoop<LineWish>,
}

/// Handle of a link for other threads.
#[derive(Debug)]
pub(super) struct NetworkDoor {
    channels: Channels,
    newest: Option<LineReport>,
    /// Text of the last reported state.
    reported: Option<String>,
}

/// An operator's request about the follower at the other end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineWish {
    /// Request control, which another console has.
    Control,
    /// Withdraw the request.
    Nothing,
    /// Give control to the requesting console, or keep it.
    Answer { consents: bool },
}

impl NetworkDoor {
    pub(super) const fn newest(&self) -> Option<&LineReport> {
        self.newest.as_ref()
    }

    /// Sends a request to the link. If too many wait it is lost, and the next report shows that nothing has changed.
    pub(super) fn wish(&self, wish: LineWish) {
        self.channels.wishes.try_send(wish).ok();
    }
}

impl LineConnection for NetworkDoor {
    fn receive(&mut self) -> Option<String> {
        let newest = self.channels.reports.try_iter().last()?;
        self.newest = Some(newest);
        let words = state_text(newest.state);
        (self.reported.as_ref() != Some(&words)).then(|| self.reported.insert(words).clone())
    }

    fn has_reported(&self) -> bool {
        self.newest.is_some()
    }

    fn ui(&self, ui: &mut Ui, drives: bool) {
        link_ui(ui, self, drives);
    }

    fn trouble(&self) -> Option<[String; 2]> {
        link_trouble(self.newest?.state)
    }

    fn has_delivered(&self) -> bool {
        self.newest.is_some_and(|report| report.figures.counts.delivered > 0)
    }

    fn question(&self) -> Option<[&'static str; 2]> {
        let asks = self.newest?.control == ControlRole::HoldsAsked;
        asks.then(|| [text::CONTROL_ASKED_CAUSE.get(), text::CONTROL_ASKED_CURE.get()])
    }

    fn rows(&self) -> Vec<[String; 2]> {
        let rows = self.newest.as_ref().map(link_rows).unwrap_or_default();
        rows.into_iter().map(|row| [row.name.to_owned(), row.value]).collect()
    }

    fn figures(&self) -> Option<serde_json::Value> {
        serde_json::to_value(self.newest.as_ref().map(LinkFigures::from)?).ok()
    }
}

/// Report of a link.
#[derive(Clone, Copy, Debug)]
pub(super) struct LineReport {
    pub(super) state: LinkState,
    /// Owner of control over the follower.
    pub(super) control: ControlRole,
    pub(super) figures: SessionMeasurements,
    pub(super) dropped: DroppedCounts,
}

impl NetworkLine {
    /// Creates a line over this endpoint, with these devices at this end.
    pub(super) fn new(endpoint: Endpoint, here: RigEnds) -> Self {
        let (reported, reports) = from_loop(WAITING);
        let (wish, wishes) = to_loop(WAITING);
        Self { endpoint, here, reported, wishes, door: Channels { reports, wishes: wish }, next_s: 0.0 }
    }

    pub(super) fn network_door(&self) -> NetworkDoor {
        NetworkDoor { channels: self.door.clone(), newest: None, reported: None }
    }

    /// Handles one waiting request per tick.
    fn obey(&mut self) {
        match self.wishes.pop() {
            Ok(LineWish::Control) => self.endpoint.ask_for_control(),
            Ok(LineWish::Nothing) => self.endpoint.withdraw(),
            Ok(LineWish::Answer { consents }) => self.endpoint.answer(consents),
            Err(_) => {}
        }
    }

    fn notify(&mut self, now_s: f64) {
        if now_s < self.next_s {
            return;
        }
        self.next_s = now_s + REPORT_EVERY_S;
        let Self { endpoint, reported, .. } = self;
        let report = LineReport {
            state: endpoint.state(),
            control: endpoint.control(),
            figures: endpoint.figures(),
            dropped: endpoint.dropped(),
        };
        // If the reports are not read, the queue is full after four, and further reports are dropped.
        reported.push(report).ok();
    }
}

impl RemoteLine for NetworkLine {
    fn here(&self) -> RigEnds {
        self.here
    }

    fn door(&self) -> Box<dyn LineConnection> {
        Box::new(self.network_door())
    }

    fn join(self: Box<Self>, assembly: Assembly) -> Assembly {
        let here = self.here;
        joined(assembly, self, here)
    }
}

impl RemoteWire for NetworkLine {
    fn send(&mut self, now_s: f64, message: &[u8]) {
        self.endpoint.send(now_s, message);
    }

    fn receive(&mut self, now_s: f64, take: &mut dyn FnMut(&[u8])) {
        let mut received = self.endpoint.poll(now_s);
        while let Some(payload) = received.next_due() {
            take(payload.bytes);
        }
        self.obey();
        self.notify(now_s);
    }
}

/// Link statistics for JSON output.
#[derive(Clone, Copy, Debug, Serialize)]
struct LinkFigures {
    /// Whether messages pass.
    open: bool,
    /// Minimum round trip, s, and resulting uncertainty of the other clock, s.
    round_trip_s: Option<f64>,
    clock_bound_s: Option<f64>,
    clock_offset_s: Option<f64>,
    one_way_mean_s: Option<f64>,
    one_way_p999_s: Option<f64>,
    playout_s: Option<f64>,
    /// Fractions of datagrams.
    loss: f64,
    loss_there: f64,
    copies: usize,
    sent_bit_s: f64,
    received_bit_s: f64,
    delivered: u64,
    late: u64,
    lost: u64,
    recovered: u64,
    dropped: u64,
}

impl From<&LineReport> for LinkFigures {
    fn from(report: &LineReport) -> Self {
        let LineReport { state, figures, dropped, control: _ } = report;
        Self {
            open: *state == LinkState::Open,
            round_trip_s: figures.clock.map(|clock| clock.round_trip_s),
            clock_bound_s: figures.clock.map(|clock| clock.bound_s),
            clock_offset_s: figures.clock.map(|clock| clock.offset_s),
            one_way_mean_s: figures.one_way.map(|delays| delays.mean_s),
            one_way_p999_s: figures.one_way.map(|delays| delays.p999_s),
            playout_s: figures.playout_s,
            loss: figures.loss,
            loss_there: figures.loss_there,
            copies: figures.copies.used,
            sent_bit_s: figures.sent.rate_bit_s,
            received_bit_s: figures.received.rate_bit_s,
            delivered: figures.counts.delivered,
            late: figures.counts.late,
            lost: figures.counts.lost,
            recovered: figures.counts.recovered,
            dropped: dropped.total(),
        }
    }
}
