//! `nima score`: motion and force of the hands in recorded sessions, as measures and as a table of trials.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, bail};
use clap::Args;
use nima_files::{csv_cell, quoted, write_atomically};
use nima_recording::session::SessionReader;
use nima_report::output;
use nima_score::{MEASURES, Measure, Score, TaskFile, trial_score};
use nima_screen::recording::SCENE;
use nima_session::{objects, plot_channels};
use nima_simulation::scene::Scene;
use serde::Serialize;

use crate::command::{missing::report_missing, time_range::TimeRange};

/// The task of a session without recorded objects.
const FREE: &str = "name = 'Free'\nkind = 'free'\ntime_limit_s = 1200.0";

#[derive(Debug, Args)]
pub(super) struct ScoreArguments {
    /// Session files, one trial each
    #[arg(required = true, value_name = "SESSION.mcap")]
    sessions: Vec<PathBuf>,
    #[command(flatten)]
    stretch: TimeRange,
    /// Task file (TOML): name, kind, time limit, thresholds (default: the task of the recorded scene, if its events are
    /// recorded)
    #[arg(long, value_name = "FILE")]
    task: Option<PathBuf>,
    /// Participant of these trials, for the table
    #[arg(long, value_name = "NAME", requires = "out")]
    participant: Option<String>,
    /// Condition, for the table (default: mode and delay of the session)
    #[arg(long, value_name = "NAME", requires = "out")]
    condition: Option<String>,
    /// Write a table of trials (CSV) for `nima study trials`
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print the measures as one JSON object, or a list of them
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct ScoredSession {
    session: String,
    condition: String,
    task: String,
    /// Data that the file lacks; empty for a whole session.
    missing: Vec<String>,
    #[serde(flatten)]
    score: Score,
}

pub(super) fn run(arguments: &ScoreArguments) -> anyhow::Result<()> {
    let ScoreArguments { sessions, stretch, task, participant, condition, out, json } = arguments;
    if stretch.is_asked() && sessions.len() > 1 {
        bail!("--from and --to apply to a single session, not to {}", sessions.len());
    }
    if let Some(out) = out {
        output::check(out, &sessions.iter().map(PathBuf::as_path).collect::<Vec<_>>())?;
    }
    let task = task.as_deref().map(task_of).transpose()?;
    let scored = |session: &PathBuf| scored(session, stretch, task.as_ref(), condition.as_deref());
    let scored = sessions.iter().map(scored).collect::<anyhow::Result<Vec<_>>>()?;
    if let Some(out) = out {
        let table = table(&scored, participant.as_deref().unwrap_or("unnamed"));
        write_atomically(out, |file| file.write_all(table.as_bytes()))
            .with_context(|| format!("cannot write {}", out.display()))?;
    }
    match scored.as_slice() {
        [one] if *json => output::json(one),
        several if *json => output::json(&several),
        several => several.iter().try_for_each(|one| output::line(&one.as_text())),
    }
}

fn task_of(path: &Path) -> anyhow::Result<TaskFile> {
    let text = nima_files::read_text(path, nima_files::CONFIG_MAX);
    let text = text.with_context(|| format!("cannot read {}", path.display()))?;
    TaskFile::from_toml(&text).with_context(|| path.display().to_string())
}

/// Returns the task of the session's scene. Without recorded events there is nothing to count, so it is free motion.
fn recorded_task(session: &Path, reader: &SessionReader) -> anyhow::Result<TaskFile> {
    let scene = reader.attachments().iter().find(|one| one.name == SCENE).filter(|_| objects::are_reported(reader));
    let Some(scene) = scene else { return Ok(TaskFile::from_toml(FREE)?) };
    let text = String::from_utf8_lossy(&reader.attachment(scene)?).into_owned();
    let scene = Scene::parse(Path::new(SCENE), &text).with_context(|| {
        format!("session {}: its scene cannot be read; set the task with --task FILE", session.display())
    })?;
    Ok(scene.task.map_or_else(|| TaskFile::from_toml(FREE), |task| TaskFile::of(&task))?)
}

fn scored(
    session: &Path,
    stretch: &TimeRange,
    task: Option<&TaskFile>,
    condition: Option<&str>,
) -> anyhow::Result<ScoredSession> {
    let reader = SessionReader::open(session)?;
    let missing = report_missing(session, &reader);
    let task = task.map_or_else(|| recorded_task(session, &reader), |task| Ok(task.clone()))?;
    let begin_ns = plot_channels::beginning_ns(&reader)?;
    let times_s = stretch.of(session, &reader)?;
    let ns = |t_s: f64| if t_s.is_finite() { begin_ns.saturating_add((t_s * 1e9).round() as u64) } else { u64::MAX };
    let score = trial_score::score(&reader, session, &(ns(times_s.start)..ns(times_s.end)), &task)?;
    let score =
        score.with_context(|| format!("session {}: no arm was engaged, so it contains no trial", session.display()))?;
    let tables: BTreeMap<_, _> = reader.metadata()?.into_iter().collect();
    // A file of another program may contain anything.
    let word =
        |key: &str| tables.get("session").and_then(|table| table.get(key)).map(|word| quoted(word)).unwrap_or_default();
    let delay_ms =
        word("delay_s").parse::<f64>().map_or_else(|_| String::new(), |delay_s| format!(" {:.0} ms", 1e3 * delay_s));
    let condition = condition.map_or_else(|| word("mode") + &delay_ms, str::to_owned);
    Ok(ScoredSession { session: session.display().to_string(), condition, task: task.name, missing, score })
}

impl ScoredSession {
    fn as_text(&self) -> String {
        let Self { session, condition, task, missing: _, score } = self;
        let mut text = format!("{session}, {condition}, task: {}\n", quoted(task));
        for definition in MEASURES {
            let known: Vec<Measure> = score.measures().filter(|one| one.definition.id == definition.id).collect();
            let values = known.iter().filter_map(|one| {
                let side = one.side.map_or_else(String::new, |side| format!("{} ", side.word()));
                Some(format!("{side}{}", four_digits(one.value?)))
            });
            let values: Vec<String> = values.collect();
            if !values.is_empty() {
                let unit = if definition.unit == "1" { "" } else { definition.unit };
                writeln!(text, "  {:<34} {} {unit}", definition.id, values.join(", ")).ok();
            }
        }
        text.trim_end().to_owned()
    }
}

fn four_digits(value: f64) -> String {
    let places = if value == 0.0 { 0 } else { (3 - value.abs().log10().floor() as i32).clamp(0, 6) };
    format!("{value:.*}", places as usize)
}

/// Returns one row per session, one column per available measure.
fn table(scored: &[ScoredSession], participant: &str) -> String {
    let has =
        |place: &usize| scored.iter().any(|one| one.score.measures().nth(*place).is_some_and(|m| m.value.is_some()));
    let names: Vec<String> =
        scored.first().map(|one| one.score.measures().map(|m| m.key()).collect()).unwrap_or_default();
    let columns: Vec<usize> = (0..names.len()).filter(has).collect();
    let mut text = "participant,condition,trial,session,complete".to_owned();
    for place in &columns {
        write!(text, ",{}", names[*place]).ok();
    }
    text.push('\n');
    for (number, one) in scored.iter().enumerate() {
        let ScoredSession { session, condition, missing, score, .. } = one;
        let complete = if missing.is_empty() { "yes" } else { "no" };
        let [participant, condition, session] = [participant, condition, session].map(csv_cell);
        write!(text, "{participant},{condition},{},{session},{complete}", number + 1).ok();
        let values: Vec<Option<f64>> = score.measures().map(|measure| measure.value).collect();
        for place in &columns {
            let value = values[*place].map_or_else(String::new, |value| value.to_string());
            write!(text, ",{value}").ok();
        }
        text.push('\n');
    }
    text
}
