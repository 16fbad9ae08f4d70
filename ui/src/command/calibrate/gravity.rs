//! `nima calibrate gravity`: fits a gravity model to still poses and judges it on held-out poses.

use std::{fmt::Write as _, path::PathBuf};

use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};
use nima_core::calibration::{
    Residuals, Verdict,
    gravity::{GravityRecord, GravityReport, GravitySettings, ModelKind, fit},
};
use nima_recording::{
    csv::{ColumnMapping, POSES, read_mapped_poses},
    store,
};
use nima_report::output;
use nima_words::report_text::ShortText as _;

#[derive(Clone, Copy, Debug, ValueEnum)]
enum GravityModelChoice {
    Physical,
    Gain,
    Paper,
}

#[derive(Debug, Args)]
pub(in crate::command) struct GravityArguments {
    /// CSV file, one still pose per row: `fx_n,fy_n,fz_n[,tx_nm,ty_nm,tz_nm]` with `ax,ay,az` (m/s^2) or `qw,qx,qy,qz` (base from sensor)
    poses: PathBuf,
    /// Column of a quantity: `fxyz=A,B,C`, `rpy=A,B,C` (roll, pitch, yaw, degrees), `rxyz=A,B,C` (rotation vector, rad), `qwxyz=A,B,C,D`,
    /// each with `*SCALE`; an unknown name lists all; may be repeated
    #[arg(long, value_name = "NAME=COLUMN[*SCALE]")]
    map: Vec<String>,
    /// Write an accepted calibration to this TOML file and keep the previous one as F.toml.previous (replaces an existing
    /// file and keeps its permissions; follows a link; rejects the input file, a device or a pipe)
    #[arg(long, value_name = "F.toml")]
    out: Option<PathBuf>,
    /// Serial number of the sensor
    #[arg(long, default_value = "unknown")]
    sensor: String,
    /// Name of the tool on the sensor
    #[arg(long, default_value = "unknown")]
    tool: String,
    /// Mass of the tool as weighed, kg; the fitted mass must agree with it, which reveals forces in other units
    #[arg(long, value_name = "KG")]
    mass_kg: Option<f64>,
    /// The accelerometer's vector points down at rest, not up
    #[arg(long)]
    flip_imu: bool,
    /// Model to use (default: physical, or gain if the poses clearly support it)
    #[arg(long)]
    model: Option<GravityModelChoice>,
    /// Write the file even if the verdict rejects it; your name is stored in the file
    #[arg(long = "override", value_name = "NAME", requires = "out")]
    override_by: Option<String>,
    /// Reason for --override
    #[arg(long, value_name = "TEXT", requires = "override_by")]
    override_reason: Option<String>,
    /// Print the report as one JSON object
    #[arg(long)]
    json: bool,
}

pub(in crate::command) fn run(arguments: &GravityArguments) -> anyhow::Result<()> {
    if let Some(out) = &arguments.out {
        super::check::<GravityRecord>(out, &arguments.poses)?;
    }
    let mapping = ColumnMapping::parse_for(&POSES, &arguments.map)?;
    let poses = read_mapped_poses(&arguments.poses, &mapping)?;
    let model = arguments.model.map(|model| match model {
        GravityModelChoice::Physical => ModelKind::Physical,
        GravityModelChoice::Gain => ModelKind::Gain,
        GravityModelChoice::Paper => ModelKind::Paper,
    });
    if let Some(mass_kg) = arguments.mass_kg.filter(|mass_kg| !(*mass_kg > 0.0 && *mass_kg <= 10.0)) {
        bail!("--mass-kg {mass_kg} is outside its range: enter the mass in kg, above 0 and at most 10");
    }
    let imu_sign = if arguments.flip_imu { -1 } else { 1 };
    let settings = GravitySettings { model, imu_sign, weighed_kg: arguments.mass_kg, ..GravitySettings::default() };
    let report = fit(&poses, &settings).with_context(|| format!("poses {}", arguments.poses.display()))?;
    let accepted = report.verdict == Verdict::Accepted;
    if accepted || arguments.override_by.is_some() {
        save(arguments, &report)?;
    }
    if arguments.json {
        output::json(&report)?;
    } else {
        output::line(&as_text(&report))?;
    }
    if !accepted {
        bail!("{}: {}", report.verdict.words(), report.reason);
    }
    Ok(())
}

fn save(arguments: &GravityArguments, report: &GravityReport) -> anyhow::Result<()> {
    let Some(out) = &arguments.out else { return Ok(()) };
    let Some(mut record) = report.record(&arguments.sensor, &arguments.tool, &store::utc_now()) else {
        bail!("no model to write to {}: {}", out.display(), report.reason);
    };
    if let (false, Some(name)) = (report.verdict == Verdict::Accepted, &arguments.override_by) {
        record.judgement.override_by(name, arguments.override_reason.as_deref());
    }
    store::write(out, &record)?;
    Ok(())
}

fn as_text(report: &GravityReport) -> String {
    let mut text = format!("{}: {}\n", report.verdict.words(), report.reason);
    let condition = report.condition.map_or_else(|| "infinite".to_owned(), |condition| format!("{condition:.1}"));
    // Writing to a String cannot fail.
    writeln!(text, "{} poses, coverage {:.2}, condition {condition}", report.poses, report.coverage).ok();
    if !report.outliers.is_empty() {
        let rows: Vec<String> = report.outliers.iter().map(|index| (index + 1).to_string()).collect();
        writeln!(text, "left out: pose {}", rows.join(", ")).ok();
    }
    if let Some(mass_kg) = report.mass_kg {
        write!(text, "mass {mass_kg:.4} kg").ok();
        if let Some([x, y, z]) = report.com_m.map(|com| com.map(|c| c * 1e3)) {
            write!(text, ", centre of mass {x:.1}, {y:.1}, {z:.1} mm").ok();
        }
        text.push('\n');
    }
    for fit in &report.fits {
        let mark = if report.chosen == Some(fit.kind) { "(chosen)" } else { "" };
        writeln!(text, "{:<9} force {} N {mark}", fit.kind.name(), figures(&fit.force_n, 4)).ok();
        if let Some(torque_nm) = &fit.torque_nm {
            writeln!(text, "{:<9} torque {} Nm", "", figures(torque_nm, 5)).ok();
        }
    }
    text.push_str("(errors per axis x, y, z; held out: on poses that were not used for the fit)");
    text
}

fn figures(residuals: &Residuals, digits: usize) -> String {
    let triple = |values: [f64; 3]| values.map(|value| format!("{value:.digits$}")).join(" ");
    let held_out = &residuals.held_out;
    format!(
        "held out  mean {}  sd {}  max {}   fitted  mean {}",
        triple(held_out.mae),
        triple(held_out.sd),
        triple(held_out.max),
        triple(residuals.fitted.mae)
    )
}
