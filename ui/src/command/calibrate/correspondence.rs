//! `nima calibrate correspondence`: fits the rotation between both sensors to a file of force pairs.

use std::{fmt::Write as _, path::PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;
use nima_core::calibration::{
    AxisStats, Verdict,
    correspondence::{CorrespondenceOptions, CorrespondenceRecord, CorrespondenceReport, CorrespondenceSolution, fit},
};
use nima_recording::{
    csv::{ColumnMapping, PAIRS, read_mapped_pairs},
    store::{self, utc_now},
};
use nima_report::output;
use nima_words::report_text::ShortText as _;

#[derive(Debug, Args)]
pub(in crate::command) struct CorrespondenceArguments {
    /// CSV file with `f1x_n, f1y_n, f1z_n` (wrist, gravity-free), `f2x_n, f2y_n, f2z_n` (tissue) and, if the wrist turned
    /// between the pushes, `qw, qx, qy, qz` (`s1_from_c`)
    pairs: PathBuf,
    /// Column of a quantity: `f1xyz=A,B,C`, `f2xyz=A,B,C`, `rpy=A,B,C` (roll, pitch, yaw, degrees), `rxyz=A,B,C` (rotation vector, rad),
    /// each with `*SCALE`; an unknown name lists all; may be repeated
    #[arg(long, value_name = "NAME=COLUMN[*SCALE]")]
    map: Vec<String>,
    /// Write the calibration to this file and keep the previous one as F.toml.previous (replaces an existing file and keeps
    /// its permissions; follows a link; rejects the input file, a device or a pipe)
    #[arg(long, value_name = "F.toml")]
    out: Option<PathBuf>,
    /// Serial number of the wrist sensor, stored in the file
    #[arg(long, value_name = "SERIAL", default_value = "unknown")]
    sensor: String,
    /// Name of the tool, stored in the file
    #[arg(long, value_name = "NAME", default_value = "unknown")]
    tool: String,
    /// Change the sign of sensor 2, which reports the force on the tissue instead of on the tool
    #[arg(long)]
    flip_s2: bool,
    /// Write the file even if the verdict rejects it; your name is stored in the file
    #[arg(long = "override", value_name = "NAME")]
    override_by: Option<String>,
    /// Reason for --override
    #[arg(long, value_name = "TEXT", requires = "override_by")]
    override_reason: Option<String>,
    /// Print the report as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &CorrespondenceArguments) -> anyhow::Result<()> {
    if arguments.override_by.as_deref().is_some_and(|name| name.trim().is_empty()) {
        bail!("--override requires the name of the person who decides");
    }
    if let Some(out) = &arguments.out {
        super::check::<CorrespondenceRecord>(out, &arguments.pairs)?;
    }
    let mapping = ColumnMapping::parse_for(&PAIRS, &arguments.map)?;
    let pairs = read_mapped_pairs(&arguments.pairs, &mapping)?;
    let options = CorrespondenceOptions { flip_s2: arguments.flip_s2, ..CorrespondenceOptions::default() };
    let report = fit(&pairs, &options).with_context(|| format!("cannot use {}", arguments.pairs.display()))?;
    if arguments.json { output::json(&report) } else { output::line(&as_text(&report)) }?;
    let accepted = report.verdict == Verdict::Accepted;
    if let Some(out) = &arguments.out
        && (accepted || arguments.override_by.is_some())
    {
        let record =
            CorrespondenceRecord::of(&report, [&arguments.sensor, &arguments.tool], arguments.flip_s2, &utc_now());
        let mut record = record.with_context(|| format!("{}: no rotation to write", report.reason))?;
        if let (false, Some(name)) = (accepted, &arguments.override_by) {
            record.judgement.override_by(name, arguments.override_reason.as_deref());
        }
        store::write(out, &record)?;
    }
    if !accepted {
        bail!("{}: {}", report.verdict.words(), report.reason);
    }
    Ok(())
}

fn as_text(report: &CorrespondenceReport) -> String {
    // Writing to a String cannot fail.
    let mut text = format!("{}: {}\n", report.verdict.words(), report.reason);
    let excitation = &report.excitation;
    writeln!(
        text,
        "{} pairs; too weak {:?}, contradicting the others {:?}\nspread of directions  second axis {:.2}   third axis {:.2}   \
         weakest {:.2} N",
        report.pairs, report.weak, report.outliers, excitation.second, excitation.third, excitation.weakest_n
    )
    .ok();
    match &report.solution {
        Some(solution) => describe(&mut text, solution),
        None => text.push_str("no rotation"),
    }
    text
}

fn describe(text: &mut String, solution: &CorrespondenceSolution) {
    let [w, x, y, z] = solution.rotation_wxyz;
    let [roll, pitch, yaw] = solution.roll_pitch_yaw_deg;
    let agreement = &solution.agreement;
    writeln!(
        text,
        "{}  quaternion w {w:.6} x {x:.6} y {y:.6} z {z:.6}   roll {roll:.2} pitch {pitch:.2} yaw {yaw:.2} deg\n\
         expected error {:.3} deg   Euler-angle search differs by {:.1e} deg   noise {:.4} N\n\
         error, fitted    {}   R2 {:.4}\n\
         error, held out  {}   R2 {:.4}",
        solution.target.name(),
        solution.uncertainty_deg,
        solution.cross_check_deg,
        solution.noise_n,
        axes(&agreement.residuals.fitted),
        agreement.r2_fitted_overall,
        axes(&agreement.residuals.held_out),
        agreement.r2_held_out_overall,
    )
    .ok();
    if let Some(diagnosis) = &solution.diagnosis {
        write!(
            text,
            "sensor 1 / sensor 2 {:.3} ± {:.3}   constant {:.3} N ± {:.3} N",
            diagnosis.gain,
            diagnosis.gain_se,
            diagnosis.offset_norm_n(),
            diagnosis.offset_se_n
        )
        .ok();
    }
}

fn axes(stats: &AxisStats) -> String {
    let [x, y, z] = stats.mae;
    let [sx, sy, sz] = stats.sd;
    format!("mean {x:.4} {y:.4} {z:.4} N   sd {sx:.4} {sy:.4} {sz:.4} N   max {:.4} N", stats.largest())
}
