//! `nima replay`: runs a recorded session again through the same loop.

mod what_if;

use std::{
    ops::Range,
    path::{Path, PathBuf},
    time::Instant,
};

use anyhow::{Context as _, bail};
use clap::Args;
use nima_core::{
    impedance::Mode,
    limits::{DELAY_S, GAIN, Limits},
};
use nima_report::output;
use nima_screen::recording::PROGRAM;
use nima_session::{
    file::RecordedFile,
    replay::{Differs, Journal, JournalGap, ReplayError, ReplayOutcome, StepsMessages, WhatIfChange, verify},
};
use serde::Serialize;

use super::{missing::report_missing, time_range::TimeRange};

#[derive(Debug, Args)]
pub(super) struct ReplayArguments {
    /// Session file written by `nima run --record` or the console
    session: PathBuf,
    #[command(flatten)]
    stretch: TimeRange,
    /// Replay with this mode instead
    #[arg(long)]
    mode: Option<Mode>,
    /// Replay with this one-way delay of the link, in ms
    #[arg(long, value_name = "D", value_parser = delay_ms, allow_negative_numbers = true)]
    delay_ms: Option<f64>,
    #[arg(long, value_name = "G", value_parser = gain, allow_negative_numbers = true, help = format!("Replay with this feedback gain, {GAIN}"))]
    gain: Option<f64>,
    /// Write the recorded and the changed forces, tick by tick, into this folder (requires a changed setting)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
}

fn within(text: &str, limits: &Limits) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|value| limits.contains(*value));
    value.ok_or_else(|| format!("give {limits}"))
}

fn delay_ms(text: &str) -> Result<f64, String> {
    within(text, &DELAY_S.per(1e-3, "ms"))
}

fn gain(text: &str) -> Result<f64, String> {
    within(text, &GAIN)
}

pub(super) fn run(arguments: &ReplayArguments) -> anyhow::Result<()> {
    let ReplayArguments { session, stretch, mode, delay_ms, gain, out, json } = arguments;
    let change = WhatIfChange { mode: *mode, delay_s: delay_ms.map(|delay_ms| delay_ms * 1e-3), gain: *gain };
    if !change.is_any() && out.is_some() {
        bail!("--out requires a change: add --mode, --delay-ms or --gain");
    }
    let file = RecordedFile::open(session)?;
    report_missing(session, file.reader());
    let stretch_s = stretch.of(session, file.reader())?;
    let journal = || file.journal();
    if change.is_any() {
        return what_if::run(&journal, session, &change, &stretch_s, out.as_deref(), *json);
    }
    once_more(journal(), session, &stretch_s, *json)
}

/// The journal from its start, or the reason why it is missing.
type JournalOpening = Result<Journal<StepsMessages>, ReplayError>;

#[derive(Serialize)]
struct ReplayReport<'a> {
    session: &'a Path,
    recorded_by: &'a str,
    rig: &'a str,
    ticks: u64,
    /// Ticks that were replayed but not compared.
    ticks_before: u64,
    seconds: f64,
    times_real_time: f64,
    identical: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    differs: Option<Different>,
    #[serde(skip_serializing_if = "Option::is_none")]
    hole: Option<MissingEntries>,
    closed: bool,
}

#[derive(Serialize)]
struct Different {
    tick: u64,
    t_s: f64,
    side: Option<&'static str>,
    stage: &'static str,
}

#[derive(Serialize)]
struct MissingEntries {
    after_tick: u64,
    lost: u64,
}

fn once_more(journal: JournalOpening, session: &Path, stretch_s: &Range<f64>, json: bool) -> anyhow::Result<()> {
    let journal = journal.with_context(|| session.display().to_string())?;
    let start = journal.start().clone();
    let begin = Instant::now();
    let mut read = 0;
    let outcome = verify(journal, stretch_s, |ticks| read = ticks);
    let outcome = outcome.with_context(|| format!("{} ({read} ticks before it were replayed)", session.display()))?;
    let took_s = begin.elapsed().as_secs_f64();
    let ReplayOutcome { ticks, before, seconds, differs, hole, closed } = outcome;
    let different = differs.map(|Differs { tick, t_s, place }| Different {
        tick,
        t_s,
        side: place.map(|(side, _)| side.word()),
        stage: place.map_or("events", |(_, stage)| stage.name()),
    });
    let report = ReplayReport {
        session,
        recorded_by: &start.program,
        rig: &start.origin.rig.name,
        ticks,
        ticks_before: before,
        seconds,
        times_real_time: seconds / took_s.max(1e-9),
        identical: different.is_none(),
        differs: different,
        hole: hole.map(|JournalGap { tick, lost }| MissingEntries { after_tick: tick, lost }),
        closed,
    };
    if json {
        output::json(&report)?;
    } else {
        output::line(&as_text(&report, stretch_s))?;
    }
    match &report.differs {
        None => Ok(()),
        Some(different) => bail!("{}", difference(different, &start.program)),
    }
}

fn as_text(report: &ReplayReport<'_>, stretch_s: &Range<f64>) -> String {
    let ReplayReport {
        session,
        recorded_by,
        rig,
        ticks,
        ticks_before,
        seconds,
        times_real_time,
        hole,
        closed,
        differs,
        ..
    } = report;
    let mut text = format!(
        "{}: rig \"{rig}\", recorded by {recorded_by}\n{ticks} ticks, up to {seconds:.1} s, {times_real_time:.0} times real time",
        session.display(),
    );
    if *ticks_before > 0 {
        let words = format!(
            "\nthe {ticks_before} ticks before it were replayed but not compared, because each tick depends on \
             all earlier ones"
        );
        text.push_str(&words);
    }
    if differs.is_none() && *ticks > 0 {
        text.push_str("\nall ticks match the recording bit by bit");
    }
    if let Some(MissingEntries { after_tick, lost }) = hole {
        let words = format!(
            "\nafter tick {after_tick} the recording lost {lost} entries: later ticks cannot be replayed and \
             were not compared"
        );
        text.push_str(&words);
    } else if !closed && differs.is_none() && stretch_s.end.is_infinite() {
        text.push_str("\nthe recording was not closed: it ends where the program was killed or the file was cut");
    }
    text
}

/// Returns the text of the first tick that differs.
fn difference(Different { tick, t_s, side, stage }: &Different, recorded_by: &str) -> String {
    let whose = side.map_or_else(String::new, |side| format!(" of the {side} arm"));
    let versions = if recorded_by == PROGRAM {
        "the same version of the program recorded it: the file was changed, or this build computes differently"
            .to_owned()
    } else {
        format!("{recorded_by} recorded it, this is {PROGRAM}")
    };
    format!("tick {tick} at {t_s:.3} s differs from the recording, first in its {stage}{whose}; {versions}")
}
