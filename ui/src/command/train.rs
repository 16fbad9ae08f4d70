//! `nima train`: trains models from data.

use std::{fmt::Write as _, path::PathBuf};

use anyhow::anyhow;
use clap::{Args, Subcommand};
use nima_core::tip_force::{ForceModel, TrainingSettings};
use nima_recording::tip_force::{DataSet, Selection, TipForceError, save_model};
use nima_report::output;
use nima_screen::stderr::show_progress;
use nima_training::{TrainingProgress, train_model};
use serde::Serialize;

use crate::shutdown::Leave;

#[derive(Debug, Subcommand)]
pub(super) enum TrainCommand {
    /// Train the network that removes the trocar's friction from the wrist force
    TipForce(TrainTipForce),
}

#[derive(Debug, Args)]
pub(super) struct TrainTipForce {
    /// CSV files with named columns (see --inputs); rows with the same `trajectory` number form a trajectory; without this
    /// column, each file is one
    #[arg(required = true, value_name = "DATA.csv")]
    data: Vec<PathBuf>,
    /// Model file to write (replaces an existing file and keeps its permissions; follows a link; rejects the input file, a
    /// device or a pipe)
    #[arg(long, value_name = "MODEL.safetensors")]
    out: PathBuf,
    /// Input columns, and inputs computed from the history of columns: `presliding:POSITION:WIDTH` separates sliding from
    /// reversals, `midline:LOAD:POSITION:WIDTH` is a load without the friction seen at reversals [default: all existing
    /// columns of
    /// `fx_n,fy_n,fz_n,tx_nm,ty_nm,tz_nm,qw,qx,qy,qz,insertion_m,insertion_speed_m_s,presliding_200um_m,presliding_600um_m,slip_m_s`]
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    inputs: Option<Vec<String>>,
    /// Output columns [default: `tip_fx_n,tip_fy_n,tip_fz_n`]
    #[arg(long, value_name = "D,E", value_delimiter = ',')]
    outputs: Option<Vec<String>>,
    /// Seed: the same data, settings and seed give the same model
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Networks in the ensemble
    #[arg(long, value_name = "N", default_value_t = 4)]
    members: usize,
    /// Widths of the hidden layers
    #[arg(long, value_name = "W,W", value_delimiter = ',', default_value = "32,32")]
    hidden: Vec<usize>,
    /// Maximum number of passes over the data [default: about 5000 steps]
    #[arg(long, value_name = "N")]
    epochs: Option<usize>,
    /// Serial number of the sensor, stored in the file
    #[arg(long, value_name = "S")]
    sensor: Option<String>,
    /// Name of the tool, stored in the file
    #[arg(long, value_name = "T")]
    tool: Option<String>,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct TrainReport<'a> {
    model: String,
    inputs: &'a [String],
    outputs: &'a [String],
    seconds: f64,
    origin: &'a nima_core::tip_force::ModelOrigin,
}

pub(super) fn run(command: &TrainCommand) -> anyhow::Result<()> {
    let TrainCommand::TipForce(arguments) = command;
    let selection = Selection { inputs: arguments.inputs.clone(), outputs: arguments.outputs.clone() };
    output::check(&arguments.out, &arguments.data.iter().map(PathBuf::as_path).collect::<Vec<_>>())?;
    let data = DataSet::read(&arguments.data, &selection).map_err(|error| match error {
        TipForceError::NoColumn { .. } => anyhow!("{error}; select other columns with --inputs and --outputs"),
        other => other.into(),
    })?;
    let settings = TrainingSettings {
        seed: arguments.seed,
        members: arguments.members,
        hidden: arguments.hidden.clone(),
        epochs: arguments.epochs,
        ..TrainingSettings::default()
    };
    let leave = Leave::on_signals()?;
    let start = std::time::Instant::now();
    let names = [arguments.sensor.clone(), arguments.tool.clone()];
    let model = train_model(&data, &settings, names, leave.flag(), &|progress| {
        if !arguments.json {
            show_progress(Some(&progress_text(progress)));
        }
    });
    show_progress(None);
    let model = model?;
    save_model(&model, &arguments.out)?;
    let seconds = start.elapsed().as_secs_f64();
    if arguments.json {
        let ForceModel { inputs, outputs, origin, .. } = &model;
        return output::json(&TrainReport {
            model: arguments.out.display().to_string(),
            inputs,
            outputs,
            seconds,
            origin,
        });
    }
    output::line(&as_text(&model, arguments, seconds))
}

fn progress_text(progress: &TrainingProgress) -> String {
    let TrainingProgress { member, members, epoch, epochs_max, best, .. } = progress;
    format!("network {} of {members}: epoch {epoch} of at most {epochs_max}, held-out loss {best:.4}", member + 1)
}

/// Writing to a String cannot fail.
fn as_text(model: &ForceModel, arguments: &TrainTipForce, seconds: f64) -> String {
    let origin = &model.origin;
    let losses: Vec<String> = origin.figures.iter().map(|f| format!("{:.4}", f.validation_loss)).collect();
    let mut text = format!(
        "{} rows, {} inputs, {} outputs; {} networks in {seconds:.1} s\n\
         held-out mean square error, in variances of the outputs: {}\n",
        origin.rows,
        model.inputs.len(),
        model.outputs.len(),
        origin.figures.len(),
        losses.join("  ")
    );
    if !origin.constant.is_empty() {
        let list = origin.constant.join(", ");
        writeln!(text, "constant and therefore not used (any other value counts as uncertain): {list}").ok();
    }
    let out = arguments.out.display();
    write!(text, "written to {out}; evaluate it on other data with `nima evaluate tip-force`").ok();
    text
}
