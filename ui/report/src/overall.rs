//! The part of the page about a session as a whole, and the comparison of several sessions.

use maud::{Markup, html};
use nima_session::{
    anonymous::ANONYMOUS,
    report::{ArmFigures, EventMark, ImageReport, MarkLevel, SessionFigures},
};

use super::{
    html::{digits, percent, section, table, table_or, time},
    name,
};

/// Maximum number of stalls that are listed one by one.
const STALLS: usize = 20;
/// Maximum number of rows in the list of events.
const MARKS: usize = 1000;
const ABOUT: [(&str, &str); 13] = [
    ("started", "started (UTC)"),
    ("program", "program"),
    ("build", "build"),
    ("system", "system"),
    ("rig", "rig"),
    ("scene", "scene"),
    ("seed", "seed"),
    ("clock", "clock"),
    ("clock_profile", "lateness of the clock"),
    ("clock_seed", "seed of the late ticks"),
    ("rate_hz", "rate (Hz)"),
    ("mode", "mode at the start"),
    ("delay_s", "delay of the link at the start (s)"),
];

/// Metadata keys about the quality of a calibration, with their names on the page.
const CALIBRATIONS: [(&str, &str); 7] = [
    ("gravity_verdict", "gravity: verdict"),
    ("network_verdict", "network: verdict"),
    ("gravity_error_n", "gravity: mean error on held-out poses (N)"),
    ("gravity_poses", "gravity: still poses"),
    ("network_error_n", "network: mean error on data recorded after its training (N)"),
    ("network_rows", "network: rows of the check"),
    ("network_doubt_share", "network: fraction of the check outside its training data"),
];

/// Returns the properties of the session, and warnings.
pub(super) fn summary(session: &SessionFigures) -> Markup {
    let mut rows = vec![["file".to_owned(), name(session)], ["length".to_owned(), time(session.length_s)]];
    for (key, words) in ABOUT {
        if let Some(value) = session.about.get(key) {
            rows.push([words.to_owned(), value.clone()]);
        }
    }
    rows.push(["end".to_owned(), end(session).to_owned()]);
    rows.push(["gaps in the journal".to_owned(), holes(session)]);
    rows.push(["stalls of the computer".to_owned(), stalls(session)]);
    if let Some(images) = &session.images {
        rows.push(["endoscope images".to_owned(), of_images(images)]);
    }
    let faults = of_level(session, MarkLevel::Error).count();
    rows.push(["faults".to_owned(), faults.to_string()]);
    let marked: Vec<_> = of_level(session, MarkLevel::Mark).take(20).map(|mark| time(mark.t_s)).collect();
    let marked = if marked.is_empty() { "none".to_owned() } else { marked.join(", ") };
    rows.push(["operator marks".to_owned(), marked]);
    let body = html! {
        table.about {
            @for [what, value] in rows { tr { td { (what) } td { (value) } } }
        }
        @if session.about.contains_key(ANONYMOUS) {
            p.note { "Anonymous session: names, devices, calibrations, the journal and the date were removed." }
        }
        @for note in &session.notes { p.warning { "Note: " (note) } }
        @for fault in of_level(session, MarkLevel::Error).take(10) { p.error { (time(fault.t_s)) ": " (fault.words) } }
    };
    section("Session", &body)
}

fn end(session: &SessionFigures) -> &'static str {
    match session.closed {
        Some(true) => "closed properly",
        _ if session.stretch => "an excerpt of a session",
        Some(false) => "not closed: the program was killed or the file was cut; the last half second may be missing",
        None => "unknown: no journal",
    }
}

fn holes(session: &SessionFigures) -> String {
    if session.closed.is_none() {
        return "not known".to_owned();
    }
    let report = session.holes.iter().map(|hole| format!("{} entries before {}", hole.lost, time(hole.until_s)));
    let report: Vec<_> = report.collect();
    if report.is_empty() { "none".to_owned() } else { report.join("; ") }
}

fn stalls(session: &SessionFigures) -> String {
    let Some(longest) = session.stalls.iter().max_by(|a, b| a.length_s.total_cmp(&b.length_s)) else {
        return "none".to_owned();
    };
    let each = session
        .stalls
        .iter()
        .take(STALLS)
        .map(|stall| format!("{:.0} ms at {}", 1e3 * stall.length_s, time(stall.from_s)));
    let listed = each.collect::<Vec<_>>().join("; ");
    let more = session.stalls.len().saturating_sub(STALLS);
    let rest =
        if more > 0 { format!("; {more} more, the longest {:.0} ms", 1e3 * longest.length_s) } else { String::new() };
    listed + &rest
}

fn of_images(images: &ImageReport) -> String {
    let ImageReport { count, bytes, dropped, longest_gap_s, .. } = images;
    let rate = images.rate_hz().map_or_else(String::new, |rate_hz| format!(", {rate_hz:.1} per second"));
    let missing = if *dropped == 0 { "none missing".to_owned() } else { format!("{dropped} missing") };
    let megabytes = *bytes as f64 * 1e-6;
    format!("{count}{rate}, {megabytes:.1} MB; {missing}; longest gap {longest_gap_s:.2} s")
}

fn of_level(session: &SessionFigures, level: MarkLevel) -> impl Iterator<Item = &EventMark> {
    session.marks.iter().filter(move |mark| mark.level == level)
}

/// Returns the number of events of each kind, for the objects of the scene; empty without events.
pub(super) fn happenings(session: &SessionFigures) -> Markup {
    let Some(happenings) = &session.happenings else { return html! {} };
    let rows: Vec<_> = happenings.iter().map(|(kind, count)| vec![kind.replace('_', " "), count.to_string()]).collect();
    section("Events of the objects", &table_or(&["what", "how often"], &rows, "Nothing."))
}

pub(super) fn marks(session: &SessionFigures) -> Markup {
    let row = |mark: &EventMark| vec![time(mark.t_s), mark.level.word().to_owned(), mark.words.clone()];
    let rows: Vec<_> = session.marks.iter().take(MARKS).map(row).collect();
    let more = session.marks.len().saturating_sub(MARKS);
    let body = html! {
        (table_or(&["time", "level", "what"], &rows, "No event and no command was recorded."))
        @if more > 0 { p { (more) " more are not listed; use --json" } }
    };
    section("Events", &body)
}

pub(super) fn calibrations(session: &SessionFigures) -> Markup {
    let mut rows: Vec<Vec<Markup>> = Vec::new();
    for (of, table) in &session.calibrations {
        let whose = match of.as_str() {
            "right" | "left" => format!("{of}, from the start"),
            number => format!("number {number}, activated later"),
        };
        // The verdict comes first.
        let (verdicts, others): (Vec<_>, Vec<_>) = table.iter().partition(|(key, _)| key.ends_with("_verdict"));
        for (key, value) in verdicts.into_iter().chain(others) {
            let known = CALIBRATIONS.iter().find(|(known, _)| known == key);
            let what = known.map_or_else(|| key.replace('_', " "), |(_, words)| (*words).to_owned());
            let value = match value.parse::<f64>() {
                Ok(number) if known.is_some() && number.fract() != 0.0 => html! { (digits(number)) },
                _ => html! { pre { (value.trim()) } },
            };
            rows.push(vec![html! { (whose) }, html! { (what) }, value]);
        }
        if table.is_empty() {
            rows.push(vec![html! { (whose) }, html! { "none" }, html! {}]);
        }
    }
    let body = table_or(&["for", "what", "value"], &rows, "The file has no tables of calibrations.");
    section("Calibrations in use", &body)
}

/// Returns missed periods, and percentiles.
pub(super) fn timing(session: &SessionFigures) -> Markup {
    let Some(timing) = &session.timing else { return html! {} };
    let names = ["wake-up delay (us)", "work per tick (us)", "sample to force (us)"];
    let row = |(name, times): (&&str, &Option<[f64; 4]>)| {
        let times = times.map_or_else(|| [const { String::new() }; 4], |times| times.map(digits));
        std::iter::once((*name).to_owned()).chain(times).collect()
    };
    let rows: Vec<Vec<String>> = names.iter().zip(&timing.times_us).map(row).collect();
    let missed: Vec<_> = timing
        .missed_in
        .iter()
        .take(20)
        .map(|(until_s, missed)| format!("{missed} before {}", time(*until_s)))
        .collect();
    let is_perfect = session.about.get("clock").is_some_and(|clock| clock == "virtual")
        && !session.about.contains_key("clock_profile");
    let body = html! {
        p { "Periods missed: " (timing.missed) @if !missed.is_empty() { ": " (missed.join(", ")) } }
        (table(&["", "median", "99 %", "99.9 %", "largest"], &rows))
        @if is_perfect { p.note { "On the perfect virtual clock nothing is late." } }
    };
    section("Timing", &body)
}

/// Returns the comparison table, with one column per session.
pub(super) fn comparison(sessions: &[SessionFigures]) -> Markup {
    let heads: Vec<String> = std::iter::once(String::new()).chain(sessions.iter().map(name)).collect();
    let about = |key: &'static str| {
        move |session: &SessionFigures| session.about.get(key).cloned().unwrap_or_else(|| "-".to_owned())
    };
    let mut rows = vec![
        row("started (UTC)", sessions, about("started")),
        row("length", sessions, |session| time(session.length_s)),
        row("rig", sessions, about("rig")),
        row("scene", sessions, about("scene")),
        row("mode at the start", sessions, about("mode")),
        row("delay at the start (s)", sessions, about("delay_s")),
        row("end", sessions, |session| end(session).split(':').next().unwrap_or_default().to_owned()),
        row("faults", sessions, |session| of_level(session, MarkLevel::Error).count().to_string()),
        row("periods missed", sessions, |session| {
            session.timing.as_ref().map_or_else(|| "-".to_owned(), |of| of.missed.to_string())
        }),
    ];
    for side in ["right", "left"] {
        rows.extend(of_arm(side, sessions));
    }
    table(&heads, &rows)
}

type ArmNumber = (&'static str, fn(&ArmFigures) -> Option<String>);

const OF_ARM: [ArmNumber; 8] = [
    ("engaged (s)", |arm| Some(format!("{:.1}", arm.seconds[3]))),
    ("measured peak (N)", |arm| arm.forces[0].map(|force| digits(force.peak_n))),
    ("measured mean (N)", |arm| arm.forces[0].map(|force| digits(force.mean_n))),
    ("force volume (N³)", |arm| arm.forces[0].map(|force| digits(force.volume_n3))),
    ("rendered peak (N)", |arm| arm.forces[2].map(|force| digits(force.peak_n))),
    ("rendered mean (N)", |arm| arm.forces[2].map(|force| digits(force.mean_n))),
    ("rendered rate RMS (N/s)", |arm| arm.forces[2].map(|force| digits(force.rate_rms_n_s))),
    ("ceiling acted", |arm| {
        Some(percent(arm.gates.iter().find(|of| of.gate == nima_core::safety::Gate::Ceiling)?.fraction))
    }),
];

fn of_arm(side: &'static str, sessions: &[SessionFigures]) -> Vec<Vec<String>> {
    let arm = |session: &SessionFigures| session.arms.iter().find(|arm| arm.side == side).cloned();
    if !sessions.iter().any(|session| arm(session).is_some()) {
        return Vec::new();
    }
    let figure = |(words, figure): &ArmNumber| {
        row(&format!("{side}: {words}"), sessions, |session| {
            arm(session).and_then(|arm| figure(&arm)).unwrap_or_else(|| "-".to_owned())
        })
    };
    OF_ARM.iter().map(figure).collect()
}

fn row(words: &str, sessions: &[SessionFigures], figure: impl Fn(&SessionFigures) -> String) -> Vec<String> {
    std::iter::once(words.to_owned()).chain(sessions.iter().map(figure)).collect()
}
