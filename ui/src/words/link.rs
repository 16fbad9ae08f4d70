//! Texts: what the line to the other machine does, and what the operator can do.

use nima_network::{
    control::{Cause, Refusal},
    endpoint::LinkState,
};

use crate::line::LineReport;

/// The state, a clause without a full stop.
pub(crate) fn state_in_words(state: LinkState) -> String {
    match link_trouble(state) {
        None => "connected to the other machine".to_owned(),
        Some([cause, cure]) => format!("{cause}: {cure}"),
    }
}

/// Why nothing passes, and what to do, clauses without a full stop; `None` if all is well.
pub(crate) fn link_trouble(state: LinkState) -> Option<[String; 2]> {
    let cause = match state {
        LinkState::Open => return None,
        LinkState::Waiting => {
            return Some([
                "the other machine has not been heard of yet".to_owned(),
                "see whether it runs, and whether a firewall stops UDP".to_owned(),
            ]);
        }
        LinkState::Down(cause) => cause,
    };
    if let Cause::ClockJumped { by_s } = cause {
        return Some([
            format!("a clock of the two machines jumped by {:.0} ms", by_s * 1e3),
            "find out what sets it".to_owned(),
        ]);
    }
    if let Cause::Refused(Refusal::Version(version)) = cause {
        return Some([
            format!("the other machine speaks version {version} of the protocol"),
            "install the same program on both".to_owned(),
        ]);
    }
    let [cause, cure] = match cause {
        Cause::PeerClosed => ["the program at the other machine was closed", "start it again there"],
        Cause::HeldByAnother => {
            ["another console holds the follower", "ask for control in the panel Link, or wait until it is free"]
        }
        Cause::NotAsked => ["nobody holds the follower", "ask for control in the panel Link"],
        Cause::Refused(Refusal::Full) => ["too many consoles are connected to the other machine", "close one of them"],
        Cause::Refused(_) => {
            ["the other machine refuses the key of this one", "pair the two machines with `nima pair`"]
        }
        Cause::Silent { .. } | Cause::ClockJumped { .. } => {
            ["nothing comes from the other machine", "check cable and network, and whether that machine runs"]
        }
    };
    Some([cause.to_owned(), cure.to_owned()])
}

/// A figure of a line.
pub(crate) struct LinkRow {
    pub(crate) name: &'static str,
    pub(crate) value: String,
    /// A sentence.
    pub(crate) meaning: &'static str,
}

/// The figures of a line, one to a row.
pub(crate) fn link_rows(report: &LineReport) -> Vec<LinkRow> {
    let ms = |seconds: f64| format!("{:.1} ms", seconds * 1e3);
    let (figures, counts) = (&report.figures, &report.figures.counts);
    let state = match report.state {
        LinkState::Open => "connected",
        LinkState::Waiting => "waiting",
        LinkState::Down(_) => "down",
    };
    let mut rows = Vec::new();
    let mut row = |name, value, meaning| rows.push(LinkRow { name, value, meaning });
    row("Link", state.to_owned(), "Whether messages pass between the two machines.");
    if let Some(clock) = &figures.clock {
        row(
            "Round trip",
            format!("{} at least", ms(clock.round_trip_s)),
            "The shortest time there and back that was measured lately (ms).",
        );
        row(
            "Clock offset",
            format!("{} ± {}", ms(clock.offset_s), ms(clock.bound_s)),
            "The other machine's clock minus this one's. It is wrong by half the shortest round trip at most.",
        );
    }
    if let Some(delays) = &figures.one_way {
        row(
            "One way",
            format!("{} mean, {} p99.9", ms(delays.mean_s), ms(delays.p999_s)),
            "From the other machine to this one (ms), by the clock offset above.",
        );
        row(
            "Jitter",
            ms(delays.p999_s - delays.mean_s),
            "How much longer than the mean the slowest of a thousand messages takes (ms).",
        );
    }
    if let Some(playout_s) = figures.playout_s {
        row(
            "Play-out delay",
            ms(playout_s),
            "Every message is held until it is this old (ms), so that jitter is not felt in the hand.",
        );
    }
    row(
        "Loss",
        format!("{:.1} % to here, {:.1} % to there", figures.loss * 1e2, figures.loss_there * 1e2),
        "Share of the datagrams that never arrived.",
    );
    row(
        "Copies",
        figures.copies.used.to_string(),
        "How often each message is sent. The worse the loss, the more copies, as far as the rate allows.",
    );
    row(
        "Rate",
        format!("{:.2} Mbit/s out, {:.2} in", figures.sent.rate_bit_s / 1e6, figures.received.rate_bit_s / 1e6),
        "What the link takes of the network, with all headers.",
    );
    row(
        "Messages",
        format!("{}, {} late, {} lost", counts.delivered, counts.late, counts.lost),
        "Messages that arrived, and of these late for their play-out; lost are those of which no copy arrived.",
    );
    row(
        "Foreign datagrams",
        report.dropped.total().to_string(),
        "Dropped because they were forged, repeated, too old, of another version, or not meant for this link.",
    );
    rows
}
