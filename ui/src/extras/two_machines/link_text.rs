//! State of the link to the other machine, and remedies.

use nima_network::{
    control::{LinkCause, SessionRefusal},
    endpoint::LinkState,
    figures::SessionMeasurements,
};
use nima_words::language::{text_format, word};

use super::line::LineReport;

/// Returns the state, a clause without a full stop.
pub(super) fn state_text(state: LinkState) -> String {
    match link_trouble(state) {
        None => word("connected to the other machine", "mit der Gegenstelle verbunden").to_owned(),
        Some([cause, cure]) => format!("{cause}: {cure}"),
    }
}

/// Returns the cause and remedy of a broken link, clauses without a full stop; `None` if the link works.
pub(super) fn link_trouble(state: LinkState) -> Option<[String; 2]> {
    let cause = match state {
        LinkState::Open => return None,
        LinkState::Waiting => {
            return Some([
                word("no data from the other machine yet", "noch keine Daten von der Gegenstelle").to_owned(),
                word(
                    "check that it is running, and that no firewall blocks UDP",
                    "prüfen, ob sie läuft und ob eine Firewall UDP sperrt",
                )
                .to_owned(),
            ]);
        }
        LinkState::Down(cause) => cause,
    };
    if let LinkCause::ClockJumped { by_s } = cause {
        return Some([
            text_format!(
                "the clock of one of the two machines jumped by {:.0} ms",
                "eine Uhr der beiden Rechner sprang um {:.0} ms",
                by_s * 1e3
            ),
            word("find out what sets that clock", "klären, was sie stellt").to_owned(),
        ]);
    }
    if let LinkCause::Refused(SessionRefusal::Version(version)) = cause {
        return Some([
            text_format!(
                "the other machine uses version {version} of the protocol",
                "die Gegenstelle spricht Version {version} des Protokolls"
            ),
            word("install the same program version on both", "auf beiden dasselbe Programm installieren").to_owned(),
        ]);
    }
    let [cause, cure] = match cause {
        LinkCause::PeerClosed => [
            word("the program on the other machine was closed", "das Programm der Gegenstelle wurde geschlossen"),
            word("restart it there", "dort neu starten"),
        ],
        LinkCause::HeldByAnother => [
            word("another console controls the follower", "eine andere Konsole steuert den Folgearm"),
            word(
                "request control in the Link panel (F2), or wait until the follower is free",
                "Steuerung im Panel Verbindung (F2) anfragen oder warten, bis er frei ist",
            ),
        ],
        LinkCause::NotAsked => [
            word("no console controls the follower", "keine Konsole steuert den Folgearm"),
            word("request control in the Link panel (F2)", "Steuerung im Panel Verbindung (F2) anfragen"),
        ],
        LinkCause::Refused(SessionRefusal::Full) => [
            word(
                "too many consoles are connected to the other machine",
                "zu viele Konsolen sind mit der Gegenstelle verbunden",
            ),
            word("close one of them", "eine davon schließen"),
        ],
        LinkCause::Refused(_) => [
            word(
                "the other machine rejects the key of this machine",
                "die Gegenstelle lehnt den Schlüssel dieses Rechners \
             ab",
            ),
            word("pair the two machines with `nima pair`", "beide Rechner mit `nima pair` paaren"),
        ],
        LinkCause::Flooded => [
            word(
                "other computers send so much to this port that data of the other machine are lost",
                "andere Rechner senden so viel an diesen Port, dass Daten der Gegenstelle verloren gehen",
            ),
            word(
                "restrict the firewall to the address of the other machine",
                "die Firewall auf die Adresse der Gegenstelle beschränken",
            ),
        ],
        LinkCause::Silent { .. } | LinkCause::ClockJumped { .. } => [
            word("no response from the other machine", "keine Antwort von der Gegenstelle"),
            word(
                "check cable and network, and check that the other machine is running",
                "Kabel und Netzwerk prüfen, und ob der Rechner läuft",
            ),
        ],
    };
    Some([cause.to_owned(), cure.to_owned()])
}

/// One measurement of the link.
#[derive(Clone)]
pub(super) struct LinkRow {
    pub(super) name: &'static str,
    pub(super) value: String,
    /// A sentence.
    pub(super) meaning: &'static str,
}

pub(super) fn link_rows(report: &LineReport) -> Vec<LinkRow> {
    let figures = &report.figures;
    let state = match report.state {
        LinkState::Open => word("connected", "verbunden"),
        LinkState::Waiting => word("waiting", "wartet"),
        LinkState::Down(_) => word("down", "getrennt"),
    };
    let open = LinkRow {
        name: word("Link", "Verbindung"),
        value: state.to_owned(),
        meaning: word(
            "Whether messages pass between the two machines.",
            "Ob Nachrichten zwischen den beiden Rechnern laufen.",
        ),
    };
    [vec![open], times(figures), amounts(report)].concat()
}

fn ms(seconds: f64) -> String {
    format!("{:.1} ms", seconds * 1e3)
}

fn times(figures: &SessionMeasurements) -> Vec<LinkRow> {
    let mut rows = Vec::new();
    let mut row = |name, value, meaning| rows.push(LinkRow { name, value, meaning });
    if let Some(clock) = &figures.clock {
        row(
            word("Round trip", "Umlaufzeit"),
            text_format!("minimum {}", "mindestens {}", ms(clock.round_trip_s)),
            word("The shortest recent round trip (ms).", "Die kürzeste zuletzt gemessene Zeit hin und zurück (ms)."),
        );
        row(
            word("Clock offset", "Uhrenversatz"),
            format!("{} ± {}", ms(clock.offset_s), ms(clock.bound_s)),
            word(
                "The other machine's clock minus this machine's clock. The error is at most half the shortest \
                 round trip.",
                "Uhr der Gegenstelle minus Uhr dieses Rechners. Höchstens um die halbe kürzeste Umlaufzeit falsch.",
            ),
        );
    }
    if let Some(delays) = &figures.one_way {
        row(
            word("One way", "Einfacher Weg"),
            text_format!("{} mean, {} p99.9", "{} Mittel, {} p99.9", ms(delays.mean_s), ms(delays.p999_s)),
            word(
                "From the other machine to this one (ms), by the clock offset above.",
                "Von der Gegenstelle hierher (ms), nach dem Uhrenversatz oben.",
            ),
        );
        row(
            word("Jitter", "Jitter"),
            ms(delays.p999_s - delays.mean_s),
            word(
                "How much longer than the mean the slowest of 1000 messages takes (ms).",
                "Wie viel länger als das Mittel die langsamste von tausend Nachrichten braucht (ms).",
            ),
        );
    }
    if let Some(playout_s) = figures.playout_s {
        row(
            word("Playout delay", "Ausgabeverzögerung"),
            ms(playout_s),
            word(
                "Every message is held back until it is this old (ms), so that the hand does not feel jitter.",
                "Jede Nachricht wird bis zu diesem Alter (ms) gehalten, damit die Hand keinen Jitter spürt.",
            ),
        );
    }
    rows
}

fn amounts(report: &LineReport) -> Vec<LinkRow> {
    let figures = &report.figures;
    let counts = &report.figures.counts;
    let mut rows = Vec::new();
    let mut row = |name, value, meaning| rows.push(LinkRow { name, value, meaning });
    row(
        word("Loss", "Verlust"),
        text_format!(
            "{:.1} % inbound, {:.1} % outbound",
            "{:.1} % hierher, {:.1} % dorthin",
            figures.loss * 1e2,
            figures.loss_there * 1e2
        ),
        word("Percentage of datagrams that never arrived.", "Anteil der Datagramme, die nie ankamen."),
    );
    row(
        word("Copies", "Kopien"),
        figures.copies.used.to_string(),
        word(
            "How often each message is sent. More copies are sent when the loss is higher, as far as the rate \
             allows.",
            "Wie oft jede Nachricht gesendet wird. Je mehr Verlust, desto mehr Kopien, soweit die Rate es erlaubt.",
        ),
    );
    row(
        word("Rate", "Rate"),
        text_format!(
            "{:.2} Mbit/s out, {:.2} in",
            "{:.2} Mbit/s aus, {:.2} ein",
            figures.sent.rate_bit_s / 1e6,
            figures.received.rate_bit_s / 1e6
        ),
        word(
            "Network rate of the link, headers included.",
            "Was die Verbindung vom Netzwerk belegt, mit allen Headern.",
        ),
    );
    row(
        word("Messages", "Nachrichten"),
        text_format!(
            "{}, {} late, {} lost",
            "{}, {} verspätet, {} verloren",
            counts.delivered,
            counts.late,
            counts.lost
        ),
        word(
            "Messages that arrived, messages too late for playout, and lost messages (no copy arrived).",
            "Angekommene Nachrichten, davon für die Ausgabe verspätete; verloren sind solche, von denen keine Kopie \
             ankam.",
        ),
    );
    row(
        word("Foreign datagrams", "Fremde Datagramme"),
        report.dropped.total().to_string(),
        word(
            "Dropped because they were forged, repeated, too old, of another version, or not meant for this link.",
            "Verworfen, weil gefälscht, wiederholt, zu alt, von anderer Version oder nicht für diese Verbindung \
             bestimmt.",
        ),
    );
    rows
}
