//! `nima evaluate`: evaluates models on data that were not used for training.

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
};

use clap::{Args, Subcommand};
use nima_charts::{Axis, Chart, Series, SeriesStyle, svg};
use nima_core::tip_force::Estimator;
use nima_recording::tip_force::{DataSet, Selection, load_model};
use nima_report::output;
use nima_training::{Evaluation, EvaluationPart, evaluate};

#[derive(Debug, Subcommand)]
pub(super) enum EvaluateCommand {
    /// Compare a tip-force model with simpler methods fitted on its training data
    TipForce(EvaluateTipForce),
}

#[derive(Debug, Args)]
pub(super) struct EvaluateTipForce {
    /// Model file written by `nima train tip-force`
    model: PathBuf,
    /// CSV files with the model's columns; not the files used for training
    #[arg(required = true, value_name = "DATA.csv")]
    data: Vec<PathBuf>,
    /// Write predictions.csv, regression.svg and, if `contact` is a column, no-contact.svg into this folder (created if
    /// missing; replaces existing files and keeps their permissions; follows links; rejects input files, devices and pipes)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
}

const FILES: [&str; 3] = [PREDICTIONS, REGRESSION, NO_CONTACT];
const PREDICTIONS: &str = "predictions.csv";
const REGRESSION: &str = "regression.svg";
const NO_CONTACT: &str = "no-contact.svg";
/// Maximum number of points in a regression plot; more points are thinned evenly.
const POINTS: usize = 1500;
const BARS: usize = 40;

pub(super) fn run(command: &EvaluateCommand) -> anyhow::Result<()> {
    let EvaluateCommand::TipForce(arguments) = command;
    let mut estimator = Estimator::new(load_model(&arguments.model)?);
    let data = DataSet::read(&arguments.data, &Selection::of(estimator.model()))?;
    if let Some(out) = &arguments.out {
        let inputs: Vec<&Path> = [&arguments.model].into_iter().chain(&arguments.data).map(PathBuf::as_path).collect();
        output::folder(out, &FILES, &inputs)?;
    }
    let figures = evaluate(&mut estimator, &data)?;
    if let Some(out) = &arguments.out {
        output::write(out, PREDICTIONS, &predictions(&figures, &data))?;
        output::write(out, REGRESSION, &regression(&figures, &data))?;
        if let Some(contact) = &data.contact {
            output::write(out, NO_CONTACT, &histogram(&figures, contact))?;
        }
    }
    if arguments.json { output::json(&figures) } else { output::line(as_text(&figures).trim_end()) }
}

/// Writing to a String cannot fail, here and below.
fn predictions(figures: &Evaluation, data: &DataSet) -> String {
    let outputs = figures.outputs.len();
    let mut text = String::from("file,row,in_doubt");
    figures.outputs.iter().for_each(|name| write!(text, ",{name},{name}_predicted").unwrap_or_default());
    text.push('\n');
    for trajectory in &data.trajectories {
        for row in trajectory.rows.clone() {
            let doubt = u8::from(figures.in_doubt[row]);
            write!(text, "{},{row},{doubt}", data.files[trajectory.file].display()).ok();
            for k in 0..outputs {
                write!(text, ",{:e},{:e}", data.output(row)[k], figures.predictions[row * outputs + k]).ok();
            }
            text.push('\n');
        }
    }
    text
}

fn regression(figures: &Evaluation, data: &DataSet) -> String {
    let outputs = figures.outputs.len();
    let step = data.rows().div_ceil(POINTS).max(1);
    let chart = |k: usize| {
        let points: Vec<[f64; 2]> = (0..data.rows())
            .step_by(step)
            .map(|row| [data.output(row)[k], figures.predictions[row * outputs + k]].map(f64::from))
            .collect();
        let (low, high) =
            points.iter().flatten().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        let room = 0.05 * (high - low).max(1e-9);
        let low = low - room;
        let high = high + room;
        Chart {
            title: figures.outputs[k].clone(),
            x: Axis::linear("measured", low, high),
            y: Axis::linear("predicted", low, high),
            series: vec![
                Series { name: "held-out rows".into(), colour: 4, style: SeriesStyle::Points, points },
                Series {
                    name: "exact".into(),
                    colour: 6,
                    style: SeriesStyle::Dashed,
                    points: vec![[low, low], [high, high]],
                },
            ],
        }
    };
    svg(&(0..outputs).map(chart).collect::<Vec<_>>())
}

fn histogram(figures: &Evaluation, contact: &[bool]) -> String {
    let outputs = figures.outputs.len();
    let chart = |k: usize| {
        let values: Vec<f64> = (0..contact.len())
            .filter(|row| !contact[*row])
            .map(|row| f64::from(figures.predictions[row * outputs + k]))
            .collect();
        let reach = values.iter().fold(1e-9_f64, |max, value| max.max(value.abs())) * 1.05;
        let mut bars = vec![0.0_f64; BARS];
        for value in &values {
            let bar = ((value / reach + 1.0) * 0.5 * BARS as f64) as usize;
            bars[bar.min(BARS - 1)] += 1.0 / values.len() as f64;
        }
        let edge = |bar: usize| (2.0 * bar as f64 / BARS as f64 - 1.0) * reach;
        let steps = |(bar, fraction): (usize, &f64)| [[edge(bar), *fraction], [edge(bar + 1), *fraction]];
        let points: Vec<[f64; 2]> = bars.iter().enumerate().flat_map(steps).collect();
        let top = bars.iter().copied().fold(1e-3, f64::max) * 1.1;
        Chart {
            title: format!("{} without contact", figures.outputs[k]),
            x: Axis::linear("predicted", -reach, reach),
            y: Axis::linear("fraction of rows", 0.0, top),
            series: vec![Series { name: String::new(), colour: 4, style: SeriesStyle::Line, points }],
        }
    };
    svg(&(0..outputs).map(chart).collect::<Vec<_>>())
}

fn as_text(figures: &Evaluation) -> String {
    let mut text = String::new();
    if !figures.trained_on.is_empty() {
        let files = figures.trained_on.join(", ");
        writeln!(text, "THE MODEL WAS TRAINED ON {files}: these results do not apply to new data").ok();
    }
    for part in figures.files.iter().chain([&figures.overall]) {
        part_text(part, &figures.outputs, &mut text);
    }
    let time = &figures.inference_us;
    writeln!(text, "one prediction: p50 {:.1} us, p99 {:.1} us, max {:.1} us", time.p50, time.p99, time.max).ok();
    text.push_str("(units of the columns; baselines are fitted on the model's training data)");
    text
}

fn part_text(part: &EvaluationPart, outputs: &[String], text: &mut String) {
    writeln!(text, "{}: {:.1} % in doubt", part.name, 100.0 * part.doubt_fraction).ok();
    for method in &part.methods {
        for (name, stats) in outputs.iter().zip(&method.outputs) {
            let Some(s) = stats else { continue };
            writeln!(
                text,
                "  {:<9} {name:<16} mae {:<9.5} sd {:<9.5} 95 % within {:<9.5} r2 {:<8.4} n {}",
                method.method, s.mae, s.sd, s.band95, s.r2, s.n
            )
            .ok();
        }
    }
    for (name, free) in outputs.iter().zip(&part.no_contact) {
        writeln!(text, "  no contact {name:<16} mean {:.5} sd {:.5} n {}", free.mean, free.sd, free.n).ok();
    }
}
