//! The line to the other machine as the loop uses it, and what is told of it.

use crossbeam_channel::{Receiver, Sender, bounded};
use nima_machine::{
    config::RigConfig,
    remote::{Wire, joined},
    rig::Ends,
    runtime::Assembly,
};
use nima_network::{
    endpoint::{Control, Endpoint, LinkState},
    figures::{Dropped, Figures},
};
use nima_world::scene::Scene;
use serde::Serialize;

use crate::words::state_in_words;

/// What is told is renewed so often, s.
const TOLD_EVERY_S: f64 = 0.1;

/// Reports and wishes that wait.
const WAITING: usize = 4;

/// One end of the line. The loop's thread drives it.
pub(crate) struct Line {
    endpoint: Endpoint,
    here: Ends,
    told: Sender<LineReport>,
    wishes: Receiver<LineWish>,
    door: LineDoor,
    next_s: f64,
}

/// What other threads hold of a line.
#[derive(Clone, Debug)]
pub(crate) struct LineDoor {
    reports: Receiver<LineReport>,
    wishes: Sender<LineWish>,
}

/// What an operator wants of the follower at the other end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LineWish {
    /// Control, which another console has.
    Control,
    /// Control no longer.
    Nothing,
    /// To give control to the console that asks for it, or to keep it.
    Answer { consents: bool },
}

impl LineDoor {
    /// The newest report, if one waits.
    pub(crate) fn newest(&self) -> Option<LineReport> {
        self.reports.try_iter().last()
    }

    /// Hands a wish to the line. With more than a few waiting it is lost, and the next report shows that nothing has changed.
    pub(crate) fn wish(&self, wish: LineWish) {
        self.wishes.try_send(wish).ok();
    }
}

type Open = dyn Fn(&mut RigConfig, &Scene) -> anyhow::Result<Option<Line>>;

/// Opens a line to the same follower again, for a loop that starts anew.
pub(crate) struct Reopen(Box<Open>);

impl Reopen {
    /// By this function.
    pub(crate) fn new(open: impl Fn(&mut RigConfig, &Scene) -> anyhow::Result<Option<Line>> + 'static) -> Self {
        Self(Box::new(open))
    }

    /// The line for this rig, which is changed to what is at this machine.
    pub(crate) fn open(&self, rig: &mut RigConfig, scene: &Scene) -> anyhow::Result<Option<Line>> {
        (self.0)(rig, scene)
    }
}

impl std::fmt::Debug for Reopen {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Reopen")
    }
}

/// What is told of a line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LineReport {
    pub(crate) state: LinkState,
    /// Who holds the follower.
    pub(crate) control: Control,
    pub(crate) figures: Figures,
    pub(crate) dropped: Dropped,
}

impl Line {
    /// Over this endpoint, with these devices at this end.
    pub(crate) fn new(endpoint: Endpoint, here: Ends) -> Self {
        let (told, reports) = bounded(WAITING);
        let (wish, wishes) = bounded(WAITING);
        Self { endpoint, here, told, wishes, door: LineDoor { reports, wishes: wish }, next_s: 0.0 }
    }

    /// Which devices are at this end.
    pub(crate) const fn here(&self) -> Ends {
        self.here
    }

    /// What other threads hold of it.
    pub(crate) fn door(&self) -> LineDoor {
        self.door.clone()
    }

    /// The assembly with the other half of its rig at the other end.
    pub(crate) fn join(self, assembly: Assembly) -> Assembly {
        let here = self.here;
        joined(assembly, Box::new(self), here)
    }

    /// One wish in a tick, if one waits.
    fn obey(&mut self) {
        match self.wishes.try_recv() {
            Ok(LineWish::Control) => self.endpoint.ask_for_control(),
            Ok(LineWish::Nothing) => self.endpoint.withdraw(),
            Ok(LineWish::Answer { consents }) => self.endpoint.answer(consents),
            Err(_) => {}
        }
    }

    fn tell(&mut self, now_s: f64) {
        if now_s < self.next_s {
            return;
        }
        self.next_s = now_s + TOLD_EVERY_S;
        let Self { endpoint, told, .. } = self;
        let report = LineReport {
            state: endpoint.state(),
            control: endpoint.control(),
            figures: endpoint.figures(),
            dropped: endpoint.dropped(),
        };
        // Nobody may be reading: the newest four wait.
        told.try_send(report).ok();
    }
}

impl Wire for Line {
    fn send(&mut self, now_s: f64, message: &[u8]) {
        self.endpoint.send(now_s, message);
    }

    fn receive(&mut self, now_s: f64, take: &mut dyn FnMut(&[u8])) {
        let mut received = self.endpoint.poll(now_s);
        while let Some(payload) = received.next_due() {
            take(payload.bytes);
        }
        self.obey();
        self.tell(now_s);
    }
}

/// Tells a line's changes in words, once each.
#[derive(Debug, Default)]
pub(crate) struct LinkNews {
    told: Option<String>,
    newest: Option<LineReport>,
}

impl LinkNews {
    /// What is new in the reports that wait.
    pub(crate) fn hear(&mut self, door: &LineDoor) -> Option<String> {
        let newest = door.newest()?;
        self.newest = Some(newest);
        let words = state_in_words(newest.state);
        (self.told.as_ref() != Some(&words)).then(|| self.told.insert(words).clone())
    }

    /// The newest report.
    pub(crate) const fn newest(&self) -> Option<&LineReport> {
        self.newest.as_ref()
    }
}

/// The figures of a line, as they are printed.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct LinkFigures {
    /// Whether messages pass.
    open: bool,
    /// Least round trip, s, and how wrong the other clock may be known by it, s.
    round_trip_s: Option<f64>,
    clock_bound_s: Option<f64>,
    clock_offset_s: Option<f64>,
    one_way_mean_s: Option<f64>,
    one_way_p999_s: Option<f64>,
    playout_s: Option<f64>,
    /// Shares of datagrams.
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
