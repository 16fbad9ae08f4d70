//! `nima study tradeoff`: what every knob of the identification costs and gives.

use std::{
    fmt::Write as _,
    fs,
    io::{self, IsTerminal as _, Write},
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use anyhow::{Context as _, bail};
use clap::Args;
use nima::{
    config::Scene,
    files::write_atomically,
    impedance::{MAX_DELAY_S, Mode, Settings},
    recording::{Mapping, Recording},
    study::tradeoff::{Choice, Knob, Method, Plan, Point, Source, SourceFigures, Study, sweep},
};

use super::output;

/// Scenes that are measured when nothing is named.
const SCENES: [&str; 2] = ["peg_transfer", "free_motion"];
/// Length of a scene, s, and of one in a hurry.
const SCENE_S: f64 = 10.0;
const QUICK_SCENE_S: f64 = 6.0;
const RATE_HZ: f64 = 1000.0;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// CSV file with motion and force, as for `nima identify`; may be given several times
    #[arg(long, value_name = "FILE")]
    recording: Vec<PathBuf>,
    /// Other column names in the recordings, with an optional factor: `x=px_mm*0.001`
    #[arg(long, value_name = "NAME=COLUMN[*SCALE]")]
    map: Vec<String>,
    /// Scene, recorded open-loop: an embedded name or a TOML file; several (default: all embedded, if no recording is given)
    #[arg(long, value_name = "SCENE")]
    scene: Vec<String>,
    /// One-way delay of the link in ms; several (default: 10, 50, 100 and 300; with --quick 50)
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    delay_ms: Vec<f64>,
    /// Fewer values of every knob, one pass
    #[arg(long)]
    quick: bool,
    /// Write tradeoff.json, tradeoff.csv and the pictures tradeoff-*.svg into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the figures as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let plan = plan(arguments)?;
    let sources = sources(arguments)?;
    if let Some(out) = &arguments.out {
        fs::create_dir_all(out).with_context(|| format!("cannot make the folder {}", out.display()))?;
    }
    let cancel = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&cancel);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).context("Ctrl-C cannot be caught")?;
    let study = sweep(&sources, &plan, &cancel, progress)?;
    if let Some(out) = &arguments.out {
        write_all(out, &study)?;
    }
    if arguments.json { output::json(&study) } else { output::line(in_words(&study).trim_end()) }
}

fn plan(arguments: &Arguments) -> anyhow::Result<Plan> {
    let most_ms = MAX_DELAY_S * 1e3;
    if let Some(delay_ms) = arguments.delay_ms.iter().find(|delay_ms| !(0.0..=most_ms).contains(*delay_ms)) {
        bail!("--delay-ms {delay_ms}: the delay must lie between 0 and {most_ms} ms");
    }
    let delays_s: Vec<f64> = arguments.delay_ms.iter().map(|ms| ms * 1e-3).collect();
    let usual = Settings::default();
    // The base stands at the usual delay where that is among those asked for.
    let asked = delays_s.iter().copied().find(|delay_s| (delay_s - usual.delay_s).abs() < 1e-9);
    let base = Settings { delay_s: asked.or(delays_s.first().copied()).unwrap_or(usual.delay_s), ..usual };
    let mut plan = if arguments.quick { Plan::quick(base) } else { Plan::full(base) };
    if !delays_s.is_empty() {
        plan.delays_s = delays_s;
    }
    Ok(plan)
}

fn sources(arguments: &Arguments) -> anyhow::Result<Vec<Source>> {
    let mapping = Mapping::parse(&arguments.map)?;
    if !arguments.map.is_empty() && arguments.recording.is_empty() {
        bail!("--map names columns of a recording: give one with --recording");
    }
    let unit =
        if ["fx_n", "fy_n", "fz_n"].into_iter().any(|force| mapping.names(force)) { "recorded unit" } else { "N" };
    let mut sources = Vec::new();
    for path in &arguments.recording {
        sources.push(Source::from_recording(Recording::read(path, &mapping)?, unit));
    }
    let all = SCENES.map(str::to_owned);
    let scenes = if arguments.scene.is_empty() && sources.is_empty() { &all[..] } else { &arguments.scene[..] };
    let seconds = if arguments.quick { QUICK_SCENE_S } else { SCENE_S };
    for name in scenes {
        sources.push(Source::from_scene(&Scene::load(name)?, RATE_HZ, seconds));
    }
    Ok(sources)
}

/// One line on stderr, rewritten in place; nothing on a pipe.
fn progress(done: usize, total: usize) {
    let mut err = io::stderr().lock();
    if err.is_terminal() {
        let end = if done == total { "\n" } else { "" };
        write!(err, "\r{done} of {total} points{end}").and_then(|()| err.flush()).ok();
    }
}

fn write_all(out: &Path, study: &Study) -> anyhow::Result<()> {
    let json = serde_json::to_string_pretty(study)?;
    let mut files = vec![("tradeoff.json".to_owned(), json), ("tradeoff.csv".to_owned(), study.csv())];
    files.extend(study.pictures().into_iter().map(|(name, svg)| (format!("tradeoff-{name}.svg"), svg)));
    for (name, text) in files {
        let path = out.join(name);
        let fill = |file: &mut dyn Write| -> io::Result<()> { file.write_all(text.as_bytes()) };
        write_atomically(&path, fill).with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(())
}

fn in_words(study: &Study) -> String {
    let mut text = String::new();
    for figures in &study.sources {
        source_in_words(figures, &mut text);
    }
    text.push_str(
        "cost: time of one tick of identification on this computer, the quietest pass; error: mean 3-D distance between the \
         force rendered for t from data up to t - D and the force measured at t; ratio: to delayed DFR; *: nothing beats it in both",
    );
    text
}

/// Writing into a String cannot fail: its results are dropped.
fn source_in_words(figures: &SourceFigures, text: &mut String) {
    let SourceFigures { source, unit, rate_hz, samples, axes, judged_from_s, .. } = figures;
    writeln!(
        text,
        "{source}: {samples} samples at {rate_hz:.0} Hz, {axes} axes, force in {unit}, judged from {judged_from_s:.1} s + delay"
    )
    .ok();
    for curve in figures.curves.iter().filter(|curve| curve.knob != Knob::Grid) {
        writeln!(text, "  {} ({})", curve.knob.name(), curve.method.name()).ok();
        for &index in &curve.points {
            row(&figures.points[index], &value(curve.knob, &figures.points[index].choice), text);
        }
    }
    let mut front: Vec<&Point> = figures.points.iter().filter(|p| p.pareto && p.choice.every == 1).collect();
    front.sort_by(|a, b| a.choice.delay_ms.total_cmp(&b.choice.delay_ms).then(a.cost_us.p50.total_cmp(&b.cost_us.p50)));
    writeln!(text, "  front (delay, mode, degree, window)").ok();
    for point in front {
        let Choice { method, degree, window_ms, delay_ms, .. } = point.choice;
        let knobs = match method {
            Method::Mode(Mode::Dfr) => String::new(),
            Method::Mode(Mode::Linear) => format!(" {window_ms:.0} ms"),
            _ => format!(" N={degree} {window_ms:.0} ms"),
        };
        row(point, &format!("{delay_ms:.0} ms {}{knobs}", method.name()), text);
    }
    if let Some(first) = figures.skipped.first() {
        writeln!(text, "  {} points left out; the first: {}", figures.skipped.len(), first.reason).ok();
    }
    text.push('\n');
}

fn row(point: &Point, name: &str, text: &mut String) {
    let mark = if point.pareto { '*' } else { ' ' };
    writeln!(
        text,
        "  {mark} {name:<34} p50 {:>9.2} us   p99 {:>9.2} us   error {:<11.4e} ratio {:.3e}",
        point.cost_us.p50, point.cost_us.p99, point.error, point.ratio
    )
    .ok();
}

fn value(knob: Knob, choice: &Choice) -> String {
    match knob {
        Knob::Degree => format!("N = {}", choice.degree),
        Knob::Window => format!("{:.0} ms", choice.window_ms),
        Knob::Rate => format!("{:.1} Hz", choice.rate_hz),
        Knob::Delay => format!("{:.0} ms", choice.delay_ms),
        Knob::Differentiator => choice.differentiator.name().to_owned(),
        Knob::Mode | Knob::Grid => match choice.method {
            Method::Mode(mode) => mode.name().to_owned(),
            Method::Solver(solver) => solver.name().to_owned(),
        },
    }
}
