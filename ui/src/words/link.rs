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
            ["another console holds the follower", "ask there for control, or wait until it is free"]
        }
        Cause::NotAsked => ["this console no longer holds the follower", "start it again to ask for control"],
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

/// The figures of a line, one to a row.
pub(crate) fn link_rows(report: &LineReport) -> Vec<[String; 2]> {
    let ms = |seconds: f64| format!("{:.1} ms", seconds * 1e3);
    let (figures, counts) = (&report.figures, &report.figures.counts);
    let state = match report.state {
        LinkState::Open => "connected",
        LinkState::Waiting => "waiting",
        LinkState::Down(_) => "down",
    };
    let mut rows = vec![["Link".to_owned(), state.to_owned()]];
    let mut row = |name: &str, value: String| rows.push([name.to_owned(), value]);
    if let Some(clock) = &figures.clock {
        row("Round trip", format!("{} at least", ms(clock.round_trip_s)));
        row("Other clock known to", format!("± {}", ms(clock.bound_s)));
    }
    if let Some(delays) = &figures.one_way {
        row("One way", format!("{} mean, {} p99.9", ms(delays.mean_s), ms(delays.p999_s)));
    }
    if let Some(playout_s) = figures.playout_s {
        row("Played out after", ms(playout_s));
    }
    row("Lost on the way", format!("{:.1} % to here, {:.1} % to there", figures.loss * 1e2, figures.loss_there * 1e2));
    row("Copies of each message", figures.copies.used.to_string());
    row(
        "Rate",
        format!("{:.2} Mbit/s out, {:.2} in", figures.sent.rate_bit_s / 1e6, figures.received.rate_bit_s / 1e6),
    );
    row("Messages", format!("{}, {} late, {} lost", counts.delivered, counts.late, counts.lost));
    row("Foreign datagrams", report.dropped.total().to_string());
    rows
}
