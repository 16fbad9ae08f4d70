//! Texts: what the line to the other machine does, and what the operator can do.

use nima_network::{
    control::{Cause, Refusal},
    endpoint::LinkState,
    figures::Figures,
};

use crate::language::{told, word};
use crate::line::LineReport;

/// The state, a clause without a full stop.
pub(crate) fn state_in_words(state: LinkState) -> String {
    match link_trouble(state) {
        None => word("connected to the other machine", "connected to the other machine").to_owned(),
        Some([cause, cure]) => format!("{cause}: {cure}"),
    }
}

/// Why nothing passes, and what to do, clauses without a full stop; `None` if all is well.
pub(crate) fn link_trouble(state: LinkState) -> Option<[String; 2]> {
    let cause = match state {
        LinkState::Open => return None,
        LinkState::Waiting => {
            return Some([
                word("the other machine has not been heard of yet", "the other machine has not been heard of yet")
                    .to_owned(),
                word(
                    "see whether it runs, and whether a firewall stops UDP",
                    "see whether it runs, and whether a firewall stops UDP",
                )
                .to_owned(),
            ]);
        }
        LinkState::Down(cause) => cause,
    };
    if let Cause::ClockJumped { by_s } = cause {
        return Some([
            told!(
                "a clock of the two machines jumped by {:.0} ms",
                "a clock of the two machines jumped by {:.0} ms",
                by_s * 1e3
            ),
            word("find out what sets it", "find out what sets it").to_owned(),
        ]);
    }
    if let Cause::Refused(Refusal::Version(version)) = cause {
        return Some([
            told!(
                "the other machine speaks version {version} of the protocol",
                "the other machine speaks version {version} of the protocol"
            ),
            word("install the same program on both", "install the same program on both").to_owned(),
        ]);
    }
    let [cause, cure] = match cause {
        Cause::PeerClosed => [
            word("the program at the other machine was closed", "the program at the other machine was closed"),
            word("start it again there", "start it again there"),
        ],
        Cause::HeldByAnother => [
            word("another console holds the follower", "another console holds the follower"),
            word(
                "ask for control in the panel Link, or wait until it is free",
                "ask for control in the panel Link, or wait until it is free",
            ),
        ],
        Cause::NotAsked => [
            word("nobody holds the follower", "nobody holds the follower"),
            word("ask for control in the panel Link", "ask for control in the panel Link"),
        ],
        Cause::Refused(Refusal::Full) => [
            word(
                "too many consoles are connected to the other machine",
                "too many consoles are connected to the other machine",
            ),
            word("close one of them", "close one of them"),
        ],
        Cause::Refused(_) => [
            word("the other machine refuses the key of this one", "the other machine refuses the key of this one"),
            word("pair the two machines with `nima pair`", "pair the two machines with `nima pair`"),
        ],
        Cause::Silent { .. } | Cause::ClockJumped { .. } => [
            word("nothing comes from the other machine", "nothing comes from the other machine"),
            word(
                "check cable and network, and whether that machine runs",
                "check cable and network, and whether that machine runs",
            ),
        ],
    };
    Some([cause.to_owned(), cure.to_owned()])
}

/// A figure of a line.
#[derive(Clone)]
pub(crate) struct LinkRow {
    pub(crate) name: &'static str,
    pub(crate) value: String,
    /// A sentence.
    pub(crate) meaning: &'static str,
}

/// The figures of a line, one to a row.
pub(crate) fn link_rows(report: &LineReport) -> Vec<LinkRow> {
    let figures = &report.figures;
    let state = match report.state {
        LinkState::Open => word("connected", "connected"),
        LinkState::Waiting => word("waiting", "waiting"),
        LinkState::Down(_) => word("down", "down"),
    };
    let open = LinkRow {
        name: word("Link", "Link"),
        value: state.to_owned(),
        meaning: word(
            "Whether messages pass between the two machines.",
            "Whether messages pass between the two machines.",
        ),
    };
    [vec![open], times(figures), amounts(report)].concat()
}

fn ms(seconds: f64) -> String {
    format!("{:.1} ms", seconds * 1e3)
}

/// What a message takes.
fn times(figures: &Figures) -> Vec<LinkRow> {
    let mut rows = Vec::new();
    let mut row = |name, value, meaning| rows.push(LinkRow { name, value, meaning });
    if let Some(clock) = &figures.clock {
        row(
            word("Round trip", "Round trip"),
            told!("{} at least", "{} at least", ms(clock.round_trip_s)),
            word(
                "The shortest time there and back that was measured lately (ms).",
                "The shortest time there and back that was measured lately (ms).",
            ),
        );
        row(
            word("Clock offset", "Clock offset"),
            format!("{} ± {}", ms(clock.offset_s), ms(clock.bound_s)),
            word(
                "The other machine's clock minus this one's. It is wrong by half the shortest round trip at most.",
                "The other machine's clock minus this one's. It is wrong by half the shortest round trip at most.",
            ),
        );
    }
    if let Some(delays) = &figures.one_way {
        row(
            word("One way", "One way"),
            told!("{} mean, {} p99.9", "{} mean, {} p99.9", ms(delays.mean_s), ms(delays.p999_s)),
            word(
                "From the other machine to this one (ms), by the clock offset above.",
                "From the other machine to this one (ms), by the clock offset above.",
            ),
        );
        row(
            word("Jitter", "Jitter"),
            ms(delays.p999_s - delays.mean_s),
            word(
                "How much longer than the mean the slowest of a thousand messages takes (ms).",
                "How much longer than the mean the slowest of a thousand messages takes (ms).",
            ),
        );
    }
    if let Some(playout_s) = figures.playout_s {
        row(
            word("Play-out delay", "Play-out delay"),
            ms(playout_s),
            word(
                "Every message is held until it is this old (ms), so that jitter is not felt in the hand.",
                "Every message is held until it is this old (ms), so that jitter is not felt in the hand.",
            ),
        );
    }
    rows
}

/// What is lost, and what it takes of the network.
fn amounts(report: &LineReport) -> Vec<LinkRow> {
    let (figures, counts) = (&report.figures, &report.figures.counts);
    let mut rows = Vec::new();
    let mut row = |name, value, meaning| rows.push(LinkRow { name, value, meaning });
    row(
        word("Loss", "Loss"),
        told!(
            "{:.1} % to here, {:.1} % to there",
            "{:.1} % to here, {:.1} % to there",
            figures.loss * 1e2,
            figures.loss_there * 1e2
        ),
        word("Share of the datagrams that never arrived.", "Share of the datagrams that never arrived."),
    );
    row(
        word("Copies", "Copies"),
        figures.copies.used.to_string(),
        word(
            "How often each message is sent. The worse the loss, the more copies, as far as the rate allows.",
            "How often each message is sent. The worse the loss, the more copies, as far as the rate allows.",
        ),
    );
    row(
        word("Rate", "Rate"),
        told!(
            "{:.2} Mbit/s out, {:.2} in",
            "{:.2} Mbit/s out, {:.2} in",
            figures.sent.rate_bit_s / 1e6,
            figures.received.rate_bit_s / 1e6
        ),
        word(
            "What the link takes of the network, with all headers.",
            "What the link takes of the network, with all headers.",
        ),
    );
    row(
        word("Messages", "Messages"),
        told!("{}, {} late, {} lost", "{}, {} late, {} lost", counts.delivered, counts.late, counts.lost),
        word(
            "Messages that arrived, and of these late for their play-out; lost are those of which no copy arrived.",
            "Messages that arrived, and of these late for their play-out; lost are those of which no copy arrived.",
        ),
    );
    row(
        word("Foreign datagrams", "Foreign datagrams"),
        report.dropped.total().to_string(),
        word(
            "Dropped because they were forged, repeated, too old, of another version, or not meant for this link.",
            "Dropped because they were forged, repeated, too old, of another version, or not meant for this link.",
        ),
    );
    rows
}
