//! The part of the page about a session as a whole, and the comparison of several sessions.

use std::fmt::Write as _;

use nima_session::{
    anonymous::ANONYMOUS,
    report::{ArmFigures, Figures, Mark, MarkLevel, PicturesFigures},
};

use super::{
    html::{digits, escape, percent, table, time},
    name,
};

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
    ("network_doubt_share", "network: fraction of the check outside its training"),
];

/// Properties of the session, and warnings.
pub(super) fn summary(session: &Figures) -> String {
    let mut rows =
        vec![vec!["file".to_owned(), escape(&name(session))], vec!["length".to_owned(), time(session.length_s)]];
    for (key, words) in ABOUT {
        if let Some(value) = session.about.get(key) {
            rows.push(vec![words.to_owned(), escape(value)]);
        }
    }
    rows.push(vec!["end".to_owned(), end(session).to_owned()]);
    rows.push(vec!["gaps in the journal".to_owned(), holes(session)]);
    if let Some(pictures) = &session.pictures {
        rows.push(vec!["endoscope images".to_owned(), of_pictures(pictures)]);
    }
    let faults = of_level(session, MarkLevel::Error).count();
    rows.push(vec!["faults".to_owned(), faults.to_string()]);
    let marked: Vec<_> = of_level(session, MarkLevel::Mark).take(20).map(|mark| time(mark.t_s)).collect();
    rows.push(vec!["operator marks".to_owned(), if marked.is_empty() { "none".into() } else { marked.join(", ") }]);
    let mut out = format!(
        "<section>\n<h2>Session</h2>\n{}",
        table(&["", ""], &rows).replace("<table>", "<table class=\"about\">")
    );
    if session.about.contains_key(ANONYMOUS) {
        out.push_str(
            "<p class=\"note\">Anonymous session: names, devices, calibrations, the journal and the date were \
             removed.</p>\n",
        );
    }
    for note in &session.notes {
        writeln!(out, "<p class=\"warning\">Note: {}</p>", escape(note)).ok();
    }
    for fault in of_level(session, MarkLevel::Error).take(10) {
        writeln!(out, "<p class=\"error\">{}: {}</p>", time(fault.t_s), escape(&fault.words)).ok();
    }
    out.push_str("</section>\n");
    out
}

fn end(session: &Figures) -> &'static str {
    match session.closed {
        Some(true) => "closed properly",
        _ if session.stretch => "an excerpt of a session",
        Some(false) => "not closed: the program was killed or the file was cut; the last half second may be missing",
        None => "unknown: no journal",
    }
}

fn holes(session: &Figures) -> String {
    if session.closed.is_none() {
        return "not known".to_owned();
    }
    let told = session.holes.iter().map(|hole| format!("{} entries before {}", hole.lost, time(hole.until_s)));
    let told: Vec<_> = told.collect();
    if told.is_empty() { "none".to_owned() } else { told.join("; ") }
}

fn of_pictures(pictures: &PicturesFigures) -> String {
    let PicturesFigures { count, bytes, dropped, longest_gap_s, .. } = pictures;
    let rate = pictures.rate_hz().map_or_else(String::new, |rate_hz| format!(", {rate_hz:.1} per second"));
    let missing = if *dropped == 0 { "none missing".to_owned() } else { format!("{dropped} missing") };
    let megabytes = *bytes as f64 * 1e-6;
    format!("{count}{rate}, {megabytes:.1} MB; {missing}; longest gap {longest_gap_s:.2} s")
}

fn of_level(session: &Figures, level: MarkLevel) -> impl Iterator<Item = &Mark> {
    session.marks.iter().filter(move |mark| mark.level == level)
}

/// Number of events of each kind, for the objects of the scene; empty without events.
pub(super) fn happenings(session: &Figures) -> String {
    let Some(happenings) = &session.happenings else { return String::new() };
    let rows: Vec<_> =
        happenings.iter().map(|(kind, count)| vec![escape(&kind.replace('_', " ")), count.to_string()]).collect();
    let body = if rows.is_empty() { "<p>Nothing.</p>\n".to_owned() } else { table(&["what", "how often"], &rows) };
    format!("<section>\n<h2>Events of the objects</h2>\n{body}</section>\n")
}

pub(super) fn marks(session: &Figures) -> String {
    let row = |mark: &Mark| vec![time(mark.t_s), mark.level.word().to_owned(), escape(&mark.words)];
    let rows: Vec<_> = session.marks.iter().take(MARKS).map(row).collect();
    let more = session.marks.len().saturating_sub(MARKS);
    let more = if more == 0 { String::new() } else { format!("<p>{more} more are not listed; use --json</p>\n") };
    let body = if rows.is_empty() {
        "<p>No event and no command was recorded.</p>\n".to_owned()
    } else {
        table(&["time", "level", "what"], &rows)
    };
    format!("<section>\n<h2>Events</h2>\n{body}{more}</section>\n")
}

pub(super) fn calibrations(session: &Figures) -> String {
    let mut rows = Vec::new();
    for (of, table) in &session.calibrations {
        let whose = match of.as_str() {
            "right" | "left" => format!("{of}, from the start"),
            number => format!("number {number}, activated later"),
        };
        // The verdict comes first.
        let (verdicts, others): (Vec<_>, Vec<_>) = table.iter().partition(|(key, _)| key.ends_with("_verdict"));
        for (key, value) in verdicts.into_iter().chain(others) {
            let known = CALIBRATIONS.iter().find(|(known, _)| known == key);
            rows.push(vec![
                escape(&whose),
                known.map_or_else(|| escape(&key.replace('_', " ")), |(_, words)| (*words).to_owned()),
                match value.parse::<f64>() {
                    Ok(number) if known.is_some() && number.fract() != 0.0 => digits(number),
                    _ => format!("<pre>{}</pre>", escape(value.trim())),
                },
            ]);
        }
        if table.is_empty() {
            rows.push(vec![escape(&whose), "none".to_owned(), String::new()]);
        }
    }
    let body = if rows.is_empty() {
        "<p>The file has no tables of calibrations.</p>\n".to_owned()
    } else {
        table(&["for", "what", "value"], &rows)
    };
    format!("<section>\n<h2>Calibrations in use</h2>\n{body}</section>\n")
}

/// Missed periods, and percentiles.
pub(super) fn timing(session: &Figures) -> String {
    let Some(timing) = &session.timing else { return String::new() };
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
    let missed = if missed.is_empty() { String::new() } else { format!(": {}", missed.join(", ")) };
    let is_perfect = session.about.get("clock").is_some_and(|clock| clock == "virtual")
        && !session.about.contains_key("clock_profile");
    let clock = if is_perfect { "<p class=\"note\">On the perfect virtual clock nothing is late.</p>\n" } else { "" };
    format!(
        "<section>\n<h2>Timing</h2>\n<p>Periods missed: {}{missed}</p>\n{}{clock}</section>\n",
        timing.missed,
        table(&["", "median", "99 %", "99.9 %", "largest"], &rows)
    )
}

/// One column per session.
pub(super) fn comparison(sessions: &[Figures]) -> String {
    let names: Vec<String> = sessions.iter().map(|session| escape(&name(session))).collect();
    let heads: Vec<&str> = std::iter::once("").chain(names.iter().map(String::as_str)).collect();
    let about = |key: &'static str| {
        move |session: &Figures| session.about.get(key).map_or_else(|| "-".to_owned(), |value| escape(value))
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

type OfArm = (&'static str, fn(&ArmFigures) -> Option<String>);

const OF_ARM: [OfArm; 8] = [
    ("engaged (s)", |arm| Some(format!("{:.1}", arm.seconds[3]))),
    ("measured peak (N)", |arm| arm.forces[0].map(|force| digits(force.peak_n))),
    ("measured mean (N)", |arm| arm.forces[0].map(|force| digits(force.mean_n))),
    ("force volume (N<sup>3</sup>)", |arm| arm.forces[0].map(|force| digits(force.volume_n3))),
    ("rendered peak (N)", |arm| arm.forces[2].map(|force| digits(force.peak_n))),
    ("rendered mean (N)", |arm| arm.forces[2].map(|force| digits(force.mean_n))),
    ("rendered rate RMS (N/s)", |arm| arm.forces[2].map(|force| digits(force.rate_rms_n_s))),
    ("ceiling acted", |arm| {
        Some(percent(arm.gates.iter().find(|of| of.gate == nima_core::safety::Gate::Ceiling)?.share))
    }),
];

fn of_arm(side: &'static str, sessions: &[Figures]) -> Vec<Vec<String>> {
    let arm = |session: &Figures| session.arms.iter().find(|arm| arm.side == side).cloned();
    if !sessions.iter().any(|session| arm(session).is_some()) {
        return Vec::new();
    }
    let figure = |(words, figure): &OfArm| {
        row(&format!("{side}: {words}"), sessions, |session| {
            arm(session).and_then(|arm| figure(&arm)).unwrap_or_else(|| "-".to_owned())
        })
    };
    OF_ARM.iter().map(figure).collect()
}

fn row(words: &str, sessions: &[Figures], figure: impl Fn(&Figures) -> String) -> Vec<String> {
    std::iter::once(words.to_owned()).chain(sessions.iter().map(figure)).collect()
}
