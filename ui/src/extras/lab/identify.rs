//! `nima identify`: runs the identification over recordings.

use std::{
    fmt::Write as _,
    io::{self, Write},
    path::{Path, PathBuf},
};

use anyhow::{Context as _, bail};
use clap::Args;
use nima_core::impedance::{DegreeChoice, IncrementReading, MAX_DEGREE, Mode, OwnMotion, Recipe};
use nima_files::write_atomically;
use nima_machine::rig::Side;
use nima_recording::csv::{AXIS_NAMES, CsvRecording};
use nima_report::output;
use nima_study::replay::{ReplayFigures, ReplayOptions, ReplayRow, ReplaySummary, replay};
use serde::{
    Serialize,
    de::{DeserializeOwned, IntoDeserializer as _, value::Error},
};

use super::recording_input;
use crate::command::rig_args::side;

#[derive(Debug, Args)]
pub(super) struct IdentifyArguments {
    /// CSV files with `t_s`, `x_m, y_m, z_m`, `fx_n, fy_n, fz_n` (one to three axes), or recorded sessions (.mcap); for
    /// several, a summary is printed too
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// Arm of a session, right or left (required if it has both)
    #[arg(long, value_name = "ARM", value_parser = side)]
    arm: Option<Side>,
    /// Column of a quantity that has another name, with an optional factor: `x=px_mm*0.001`, or three axes at once:
    /// `xyz=px_mm,py_mm,pz_mm*0.001`, `fxyz=...`. `lx`, `ly`, `lz` or `lxyz` select the leader's own motion; the force
    /// is then computed from it
    #[arg(long, value_name = "NAME=COLUMN[*SCALE]")]
    map: Vec<String>,
    /// Rendering mode: anchored, matched, best, nima, dfr, linear, literal, or a baseline: `model_mediated`, waves, passivity,
    /// kalman, autoregressive, increments
    #[arg(long, default_value = "best")]
    mode: Mode,
    /// Length of the identification window, ms
    #[arg(long, value_name = "MS", default_value_t = 300.0, allow_negative_numbers = true)]
    window_ms: f64,
    /// One-way delay of the link, ms
    #[arg(long, value_name = "MS", default_value_t = 0.0, allow_negative_numbers = true)]
    delay_ms: f64,
    /// Highest polynomial degree
    #[arg(long, value_name = "N", default_value_t = MAX_DEGREE)]
    max_degree: usize,
    /// Let the force on each axis depend on the motion of all axes (matched and best; slower)
    #[arg(long)]
    cross_talk: bool,
    /// Regressors of literal and linear: increments (changes of the motion over the window) or displacement (from the origin)
    #[arg(long, value_name = "READING", default_value = "increments", value_parser = word::<IncrementReading>)]
    reading: IncrementReading,
    /// Error by which literal chooses its degree: window (inside the fitted window) or next (in the 10 ms after the
    /// window)
    #[arg(long, value_name = "CHOICE", default_value = "window", value_parser = word::<DegreeChoice>)]
    choice: DegreeChoice,
    /// Let literal and linear also fit a constant force
    #[arg(long)]
    constant: bool,
    /// Ridge parameter of literal and linear per row of the window, for columns divided by the scales of the workspace;
    /// 0 for none
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true)]
    ridge: f64,
    /// Write one row per sample of a single recording to this CSV file (replaces an existing file and keeps its permissions;
    /// follows a link; rejects the input file, a device or a pipe)
    #[arg(long, value_name = "TRACE.csv")]
    out: Option<PathBuf>,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
}

/// Output for several recordings.
#[derive(Serialize)]
struct SummaryReport<'a> {
    recordings: Vec<RecordingReport<'a>>,
    summary: &'a ReplaySummary,
}

#[derive(Serialize)]
struct RecordingReport<'a> {
    recording: &'a str,
    #[serde(flatten)]
    figures: &'a ReplayFigures,
}

pub(super) fn run(arguments: &IdentifyArguments) -> anyhow::Result<()> {
    let [recording] = &arguments.recordings[..] else { return run_many(arguments) };
    if let Some(out) = &arguments.out {
        output::check(out, &[recording])?;
    }
    let figures = identify(arguments, recording)?;
    if arguments.json { output::json(&figures) } else { output::line(&as_text(&figures)) }
}

/// Runs all recordings with the same options, and a summary.
fn run_many(arguments: &IdentifyArguments) -> anyhow::Result<()> {
    if arguments.out.is_some() {
        bail!("--out writes the samples of a single recording: use one recording, or omit --out");
    }
    let one = |path: &PathBuf| Ok((path.display().to_string(), identify(arguments, path)?));
    let all: Vec<(String, ReplayFigures)> = arguments.recordings.iter().map(one).collect::<anyhow::Result<_>>()?;
    let summary = ReplaySummary::of(&all);
    if !arguments.json {
        return output::line(&many_as_text(&all, &summary));
    }
    let recordings = all.iter().map(|(recording, figures)| RecordingReport { recording, figures }).collect();
    output::json(&SummaryReport { recordings, summary: &summary })
}

fn identify(arguments: &IdentifyArguments, path: &Path) -> anyhow::Result<ReplayFigures> {
    let recording = recording_input::read_with_leader(path, &arguments.map, arguments.arm)?;
    let mut trace = header(&recording);
    let keep = arguments.out.is_some();
    let figures = replay(&recording, &options(arguments), |row| {
        if keep {
            push_row(&mut trace, row, recording.axes.len());
        }
    })?;
    if let Some(out) = &arguments.out {
        let fill = |file: &mut dyn Write| -> io::Result<()> { file.write_all(trace.as_bytes()) };
        write_atomically(out, fill).with_context(|| format!("cannot write the trace {}", out.display()))?;
    }
    Ok(figures)
}

fn options(arguments: &IdentifyArguments) -> ReplayOptions {
    let &IdentifyArguments { mode, max_degree, cross_talk, reading, choice, constant, ridge, .. } = arguments;
    let window_s = arguments.window_ms * 1e-3;
    let delay_s = arguments.delay_ms * 1e-3;
    let literal = Recipe { reading, choice, constant, ridge };
    ReplayOptions { mode, window_s, delay_s, max_degree, cross_talk, literal }
}

/// Parses a word of a rig file.
fn word<T: DeserializeOwned>(text: &str) -> Result<T, Error> {
    T::deserialize(text.into_deserializer())
}

fn header(recording: &CsvRecording) -> String {
    let mut text = String::from("t_s");
    for prefix in ["f", "r", "h"] {
        for &axis in &recording.axes {
            write!(text, ",{prefix}{}_n", AXIS_NAMES[axis]).ok();
        }
    }
    text.push_str(",degree,condition,gate\n");
    text
}

fn push_row(trace: &mut String, row: &ReplayRow, axes: usize) {
    // Writing to a String cannot fail. Rust prints the fewest digits that read back as the same number.
    write!(trace, "{}", row.t_s).ok();
    for force in [Some(&row.measured), row.rendered.as_ref(), row.held.as_ref()] {
        for lane in 0..axes {
            match force {
                Some(force) => write!(trace, ",{:e}", force[lane]).ok(),
                // Leave it blank: no value had arrived yet, which is not the same as zero.
                None => write!(trace, ",").ok(),
            };
        }
    }
    writeln!(trace, ",{},{:e},{}", row.degree, row.condition, row.gate).ok();
}

/// Returns the rendered force's error as a multiple of the held force's error, if there is one.
fn ratio_text(ratio: Option<f64>) -> String {
    ratio.map_or_else(|| "none: the held force is exact".to_owned(), |ratio| format!("{ratio:.3}"))
}

fn ratio_of(figures: &ReplayFigures) -> Option<f64> {
    (figures.hold.mae > 0.0).then(|| figures.error.mae / figures.hold.mae)
}

/// Returns the lines on a slow force and on positions in another unit; empty for an ordinary recording.
fn input_text(figures: &ReplayFigures) -> String {
    let mut text = String::new();
    if let Some(hz) = figures.force_renewal_hz {
        write!(text, "\nSLOW FORCE             the force renews {hz:.0} times a second").ok();
    }
    let scale = figures.position_scale;
    if (scale - 1.0).abs() > 0.0 {
        write!(text, "\nPOSITIONS              multiplied by {scale:e}: too large or too small for metres").ok();
    }
    text
}

/// Returns one line per recording, and one line for all.
fn many_as_text(all: &[(String, ReplayFigures)], summary: &ReplaySummary) -> String {
    let row = |name: &str, compared: usize, error: f64, hold: f64, ratio: Option<f64>| {
        format!("{compared:>9}  {error:>9.5}  {hold:>9.5}  {:>7}  {name}\n", ratio_text(ratio))
    };
    let mut text = String::from("  samples      error       held    ratio  recording\n");
    for (name, figures) in all {
        let ReplayFigures { compared, error, hold, .. } = figures;
        text += &row(name, *compared, error.mae, hold.mae, ratio_of(figures));
    }
    let ReplaySummary { compared, error_mae, hold_mae, ratio, holes, rejected, .. } = *summary;
    text += &row(&format!("all {}", summary.recordings), compared, error_mae, hold_mae, ratio);
    if let (Some(ratios), Some(worst)) = (&summary.ratios, &summary.worst) {
        let median = ratios.median;
        writeln!(text, "ratio: median {median:.3}, from {:.3} to {:.3} ({worst})", ratios.min, ratios.greatest).ok();
    }
    writeln!(text, "rejected {rejected}; gaps {holes}").ok();
    text.push_str("(mean prediction errors in units of the recordings; ratio: rendered force to held force)");
    text
}

fn as_text(figures: &ReplayFigures) -> String {
    let ratio = ratio_text(ratio_of(figures));
    let motion = match figures.own_motion {
        OwnMotion::Follower => "",
        OwnMotion::Handle => "; force from the leader's own motion",
    };
    let holes = match figures.holes {
        0 => String::new(),
        count => format!(
            "\nGAPS                   {count}, the longest {:.3} s: bridged; after more than 10 s, the identification restarts",
            figures.longest_hole_s
        ),
    };
    let input = input_text(figures);
    let reconstruction = &figures.reconstruction;
    let [d1, d2, d3, d4, d5] = figures.degree_fraction.map(|fraction| fraction * 100.0);
    format!(
        "{samples} samples at {rate:.1} Hz, axes {axes}; mode {mode}, window {window:.1} ms, delay {delay:.1} ms{motion}{holes}{input}\n\
         error at the horizon   mean {:.5}   sd {:.5}   p95 {:.5}   max {:.5}\n\
         held force (DFR)       mean {:.5}   sd {:.5}   p95 {:.5}   max {:.5}\n\
         rendered / held        {ratio}\n\
         in-window error        N=1 {:.6}   N=2 {:.6}   N=3 {:.6}   N=4 {:.6}   N=5 {:.6}   selected {:.6}\n\
         degree chosen          N=1 {d1:.1} %   N=2 {d2:.1} %   N=3 {d3:.1} %   N=4 {d4:.1} %   N=5 {d5:.1} %   nonlinear {:.1} %\n\
         condition              p50 {:.3e}   p95 {:.3e}   max {:.3e};   rejected {}\n\
         one tick               p50 {:.1} us   p99 {:.1} us   max {:.1} us\n\
         (units of the recording; in-window errors do not show accuracy: they are computed on the data used for the fit)",
        figures.error.mae,
        figures.error.sd,
        figures.error.p95,
        figures.error.max,
        figures.hold.mae,
        figures.hold.sd,
        figures.hold.p95,
        figures.hold.max,
        reconstruction.degree_1.mae,
        reconstruction.degree_2.mae,
        reconstruction.degree_3.mae,
        reconstruction.degree_4.mae,
        reconstruction.degree_5.mae,
        reconstruction.selected.mae,
        figures.nonlinear_fraction * 100.0,
        figures.condition.p50,
        figures.condition.p95,
        figures.condition.max,
        figures.rejected,
        figures.tick_us.p50,
        figures.tick_us.p99,
        figures.tick_us.max,
        samples = figures.samples,
        rate = figures.rate_hz,
        axes = figures.axes.join(", "),
        mode = figures.mode,
        window = figures.window_ms,
        delay = figures.delay_ms,
    )
}
