//! `nima study`: experiments that print figures.

use std::{
    io::{self, IsTerminal as _, Write as _},
    path::{Path, PathBuf},
};

use anyhow::Context as _;
use clap::{Args, Subcommand};
use nima::{
    files::write_atomically,
    impedance::MAX_DELAY_S,
    study::{faults, gates, release, stability, stability_map::StabilityMap, validation},
    tip_force::MOST_ROWS,
};

use super::{output, timing, tradeoff};

#[derive(Debug, Subcommand)]
pub(super) enum StudyCommand {
    /// Let every kind of fault happen in every state, and see what is told, how soon, and how wrong the hand was
    Faults(Faults),
    /// Attack the gates between model and hand with requests that no honest mode makes, and count what gets through
    Gates(Gates),
    /// Let go of a handle pressed with 5 N, in every mode and at every delay, without and with gates
    Release(Release),
    /// Compare every solver with an arbitrary-precision reference at the extremes
    Stability(Stability),
    /// Find by simulation where gain, delay and stiffness are stable in a gripping hand (minutes)
    StabilityMap(Map),
    /// Measure what every knob of the identification costs in time and gives in accuracy
    Tradeoff(tradeoff::Arguments),
    /// Time the loop beside its console, busy cores, a held-up window and heavy disk writing
    Timing(timing::Arguments),
    /// Repeat the paper's three validations on the simulated rig, its figures beside ours
    Validation(Validation),
}

#[derive(Debug, Args)]
pub(super) struct Validation {
    /// Write validation.json and validation.md into this folder (made if absent)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Seed of the simulated rig and of the training
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Rows to train the tip force on
    #[arg(long, value_name = "N", default_value_t = validation::isolation::ROWS, value_parser = rows)]
    rows: usize,
    /// Delay of the link in the rendering part, ms
    #[arg(long, value_name = "D", default_value_t = 300.0, value_parser = delay_ms)]
    delay_ms: f64,
    /// Print the figures as one JSON object
    #[arg(long)]
    json: bool,
}

fn rows(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(rows @ 2000..=MOST_ROWS) => Ok(rows),
        _ => Err(format!("give a number of rows from 2000 to {MOST_ROWS}")),
    }
}

fn delay_ms(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(delay_ms) if (0.0..=1e3 * MAX_DELAY_S).contains(&delay_ms) => Ok(delay_ms),
        _ => Err(format!("give a delay from 0 to {:.0} ms", 1e3 * MAX_DELAY_S)),
    }
}

#[derive(Debug, Args)]
pub(super) struct Gates {
    /// Requests to make, up to 1e12
    #[arg(long, value_name = "N", default_value = "1e8", value_parser = requests)]
    requests: u64,
    /// Seed of the adversary
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Print the figures as one JSON object
    #[arg(long)]
    json: bool,
}

/// A whole number, also as `1e8`.
fn requests(text: &str) -> Result<u64, String> {
    match text.parse::<f64>() {
        Ok(count) if (1.0..=1e12).contains(&count) && count.fract() == 0.0 => Ok(count as u64),
        _ => Err("give a whole number from 1 to 1e12".to_owned()),
    }
}

#[derive(Debug, Args)]
pub(super) struct Faults {
    /// Write faults.json and faults.md into this folder (made if absent)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Moments at which each fault begins while engaged, 1 to 20
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=20))]
    moments: u32,
    /// Length of each of the 32 healthy runs in which nothing may be told, s
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = super::run::positive_seconds)]
    calm: f64,
    /// Print the figures as one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
pub(super) struct Release {
    /// Write release.json, release.md and release.svg into this folder (made if absent)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the figures as one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
pub(super) struct Map {
    /// Write the map (CSV) and its table (Markdown) into this folder (made if absent)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct Stability {
    /// Write stability.json, stability.csv and stability.svg into this folder (made if absent)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Ticks of the run that looks for drift, about 3 us each
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    ticks: u64,
    /// Leave out windows longer than 300 samples
    #[arg(long)]
    quick: bool,
    /// Print the figures as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(command: &StudyCommand) -> anyhow::Result<()> {
    match command {
        StudyCommand::Faults(arguments) => faults(arguments),
        StudyCommand::Gates(arguments) => gates(arguments),
        StudyCommand::Release(arguments) => release(arguments),
        StudyCommand::StabilityMap(arguments) => stability_map(arguments),
        StudyCommand::Stability(arguments) => stability(arguments),
        StudyCommand::Tradeoff(arguments) => tradeoff::run(arguments),
        StudyCommand::Timing(arguments) => timing::run(arguments),
        StudyCommand::Validation(arguments) => validation(arguments),
    }
}

fn validation(arguments: &Validation) -> anyhow::Result<()> {
    make(arguments.out.as_deref())?;
    let options =
        validation::Options { seed: arguments.seed, rows: arguments.rows, delay_s: 1e-3 * arguments.delay_ms };
    let report = validation::study(&options, progress)?;
    if let Some(folder) = &arguments.out {
        write(folder, "validation.json", &serde_json::to_string_pretty(&report)?)?;
        write(folder, "validation.md", &report.markdown())?;
    }
    if arguments.json { output::json(&report) } else { output::line(report.text().trim_end()) }
}

fn faults(arguments: &Faults) -> anyhow::Result<()> {
    make(arguments.out.as_deref())?;
    let options = faults::Options { moments: arguments.moments, live: true, calm_s: arguments.calm };
    let report = faults::study(&options, progress)?;
    if let Some(folder) = &arguments.out {
        write(folder, "faults.json", &serde_json::to_string_pretty(&report)?)?;
        write(folder, "faults.md", &report.markdown())?;
    }
    if arguments.json { output::json(&report) } else { output::line(report.markdown().trim_end()) }?;
    let (silent, false_alarms) = (report.sums.silent, report.calm.false_alarms.len());
    anyhow::ensure!(silent == 0, "{silent} cases are silent: see the table");
    anyhow::ensure!(false_alarms == 0, "{false_alarms} faults were told of healthy machines: see the table");
    Ok(())
}

fn gates(arguments: &Gates) -> anyhow::Result<()> {
    let report = gates::study(arguments.requests, arguments.seed, progress);
    if arguments.json { output::json(&report) } else { output::line(&report.text()) }?;
    let breaches = report.breaches.total();
    anyhow::ensure!(breaches == 0, "{breaches} breaches in {} requests: the gates do not hold", report.requests);
    Ok(())
}

fn release(arguments: &Release) -> anyhow::Result<()> {
    make(arguments.out.as_deref())?;
    let report = release::study(progress)?;
    if let Some(folder) = &arguments.out {
        write(folder, "release.json", &serde_json::to_string_pretty(&report)?)?;
        write(folder, "release.md", &report.markdown())?;
        write(folder, "release.svg", &report.svg())?;
    }
    if arguments.json { output::json(&report) } else { output::line(report.markdown().trim_end()) }
}

fn stability_map(arguments: &Map) -> anyhow::Result<()> {
    make(arguments.out.as_deref())?;
    let map = StabilityMap::simulate(progress)?;
    if let Some(folder) = &arguments.out {
        write(folder, "stability_map.csv", &map.csv())?;
        write(folder, "stability_map.md", &map.markdown())?;
    }
    output::line(map.markdown().trim_end())
}

/// Before the work, so that a wrong name does not cost its time.
fn make(folder: Option<&Path>) -> anyhow::Result<()> {
    let Some(folder) = folder else { return Ok(()) };
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))
}

fn stability(arguments: &Stability) -> anyhow::Result<()> {
    make(arguments.out.as_deref())?;
    let options = stability::Options { ticks: arguments.ticks, quick: arguments.quick };
    let report = stability::study(&options, progress)?;
    if let Some(folder) = &arguments.out {
        write(folder, "stability.json", &serde_json::to_string_pretty(&report)?)?;
        write(folder, "stability.csv", &report.csv())?;
        write(folder, "stability.svg", &report.svg())?;
    }
    if arguments.json { output::json(&report) } else { output::line(&report.table()) }
}

/// One line on a terminal's stderr, written over and over, and wiped at the end.
fn progress(done: usize, of: usize, what: &str) {
    let mut stderr = io::stderr().lock();
    if !stderr.is_terminal() {
        return;
    }
    // A terminal that cannot be written to is no reason to stop a study.
    if done < of {
        write!(stderr, "\r\x1b[K{}/{of} {what}", done + 1).ok();
    } else {
        write!(stderr, "\r\x1b[K").ok();
    }
    stderr.flush().ok();
}

fn write(folder: &Path, name: &str, text: &str) -> anyhow::Result<()> {
    let path = folder.join(name);
    write_atomically(&path, |file| file.write_all(text.as_bytes()))
        .with_context(|| format!("cannot write {}", path.display()))
}
