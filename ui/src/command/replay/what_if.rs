//! A session with one changed setting: the forces that it would have rendered on the same inputs.

use std::{
    fmt::Write as _,
    io,
    ops::Range,
    path::{Path, PathBuf},
};

use anyhow::Context as _;
use nima_files::write_atomically;
use nima_machine::{messages::Tick, rig::Side};
use nima_session::replay::{ComparedSide, Difference, JournalGap, WhatIfChange, compare};
use serde::Serialize;

use super::{JournalOpening, output};

const FORCES: &str = "forces.csv";
const HEADER: &str = "t_s,side,recorded_state,changed_state,recorded_x_n,recorded_y_n,recorded_z_n,\
changed_x_n,changed_y_n,changed_z_n,measured_x_n,measured_y_n,measured_z_n";
/// Limitation of the comparison, printed with every result.
const LIMIT: &str = "the inputs come from the recording: a different force would have changed the motion of the hand and the tissue \
 force; these are the forces that the hand would have felt with the recorded motion";

#[derive(Serialize)]
struct WhatIfReport<'a> {
    session: &'a Path,
    changed: String,
    ticks: u64,
    arms: Vec<WhatIfArm>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ends_at_hole_after_tick: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    forces: Option<PathBuf>,
    limit: &'static str,
}

#[derive(Serialize)]
struct WhatIfArm {
    side: &'static str,
    engaged_ticks: u64,
    in_one_engaged_only: u64,
    difference: Lengths,
    recorded_error: Lengths,
    changed_error: Lengths,
}

#[derive(Serialize)]
#[expect(clippy::struct_field_names, reason = "units")]
struct Lengths {
    mean_n: f64,
    rms_n: f64,
    max_n: f64,
}

impl Lengths {
    fn of(difference: &Difference) -> Self {
        Self { mean_n: difference.mean_n, rms_n: difference.rms_n(), max_n: difference.max_n }
    }

    fn as_text(&self, name: &str) -> String {
        let Self { mean_n, rms_n, max_n } = self;
        format!("\n  {name:44}  mean {mean_n:8.4} N   rms {rms_n:8.4} N   max {max_n:8.4} N")
    }
}

pub(super) fn run(
    journal: &dyn Fn() -> JournalOpening,
    session: &Path,
    change: &WhatIfChange,
    stretch_s: &Range<f64>,
    out: Option<&Path>,
    json: bool,
) -> anyhow::Result<()> {
    let (compared, ticks, hole) = match out {
        None => compare(&mut journal().with_context(|| session.display().to_string())?, change, stretch_s, |_, _| {})
            .with_context(|| session.display().to_string())?,
        Some(out) => with_forces(journal, session, change, stretch_s, out)?,
    };
    let arm = |side: Side| {
        let ComparedSide { engaged, apart, rendered, recorded_error, changed_error } = compared[side.index()]?;
        let [difference, recorded_error, changed_error] =
            [rendered, recorded_error, changed_error].map(|one| Lengths::of(&one));
        let side = side.word();
        let engaged_ticks = engaged;
        let in_one_engaged_only = apart;
        Some(WhatIfArm { side, engaged_ticks, in_one_engaged_only, difference, recorded_error, changed_error })
    };
    let report = WhatIfReport {
        session,
        changed: as_text(change),
        ticks,
        arms: Side::ALL.into_iter().filter_map(arm).collect(),
        ends_at_hole_after_tick: hole.map(|JournalGap { tick, .. }| tick),
        forces: out.map(|out| out.join(FORCES)),
        limit: LIMIT,
    };
    if json { output::json(&report) } else { output::line(&table(&report)) }
}

type WhatIfAnswer = ([Option<ComparedSide>; nima_machine::rig::SIDES], u64, Option<JournalGap>);

/// Compares, and writes the forces of both.
fn with_forces(
    journal: &dyn Fn() -> JournalOpening,
    session: &Path,
    change: &WhatIfChange,
    stretch_s: &Range<f64>,
    out: &Path,
) -> anyhow::Result<WhatIfAnswer> {
    output::folder(out, &[FORCES], &[session])?;
    let path = out.join(FORCES);
    let mut answer = None;
    let written = write_atomically(&path, |to| {
        writeln!(to, "{HEADER}")?;
        let mut written = Ok(());
        let compared = journal().and_then(|mut journal| {
            compare(&mut journal, change, stretch_s, |was, would| {
                if written.is_ok() {
                    written = to.write_all(row(was, would).as_bytes());
                }
            })
        });
        // An incomplete table is an error.
        let compared = answer.insert(compared).as_ref();
        compared.map_or_else(|_| Err(io::Error::other("the session cannot be replayed")), |_| written)
    });
    let compared: WhatIfAnswer = answer.transpose().with_context(|| session.display().to_string())?.unwrap_or_default();
    written.with_context(|| format!("cannot write {}", path.display())).map(|()| compared)
}

fn row(was: &Tick, would: &Tick) -> String {
    let mut row = format!("{},{},{},{}", was.t_s, was.side.word(), was.state.word(), would.state.word());
    for force_n in [&was.rendering.rendered_n, &would.rendering.rendered_n, &was.measured_n] {
        for axis in force_n {
            row += &output::cell(*axis);
        }
    }
    row + "\n"
}

fn as_text(change: &WhatIfChange) -> String {
    let WhatIfChange { mode, delay_s, gain } = change;
    let parts = [
        mode.map(|mode| format!("mode {mode}")),
        delay_s.map(|delay_s| format!("delay {:.0} ms", delay_s * 1e3)),
        gain.map(|gain| format!("gain {gain}")),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn table(report: &WhatIfReport<'_>) -> String {
    let WhatIfReport { session, changed, ticks, arms, ends_at_hole_after_tick, forces, limit } = report;
    let mut text = format!("{}: {ticks} ticks with {changed}", session.display());
    for WhatIfArm { side, engaged_ticks, in_one_engaged_only, difference, recorded_error, changed_error } in arms {
        let apart = match in_one_engaged_only {
            0 => String::new(),
            _ => format!(", {in_one_engaged_only} more engaged in only one of the two"),
        };
        write!(text, "\n{side} arm, {engaged_ticks} ticks engaged{apart}").ok();
        text += &difference.as_text("rendered force, changed minus recorded");
        text += &recorded_error.as_text("recorded, minus the force at the tip then");
        text += &changed_error.as_text("changed, minus the force at the tip then");
    }
    if let Some(tick) = ends_at_hole_after_tick {
        write!(text, "\nthe recording has a gap after tick {tick}: the comparison ends there").ok();
    }
    if let Some(forces) = forces {
        write!(text, "\nforces of both in {}", forces.display()).ok();
    }
    write!(text, "\nnote: {limit}").ok();
    text
}
