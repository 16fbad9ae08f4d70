//! `nima export`: writes a recorded session as a table, or an excerpt as a separate session.

use std::{
    fmt::Write as _,
    io,
    ops::Range,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, bail};
use clap::Args;
use nima_files::write_atomically;
use nima_machine::{
    config::RigConfig,
    rig::{DeviceName, Side},
};
use nima_recording::session::SessionReader;
use nima_report::output;
use nima_screen::recording::{PROGRAM, RIG, SCENE, WORDS, toml_file};
use nima_session::{
    anonymous::{self, SessionFacts},
    layouts,
    plot_channels::{self, PlottedError, PlottedTick},
    recorder::AttachedFile,
    trim::{self, Cut, CutError, JournalOutcome},
};
use nima_simulation::scene::Scene;

use super::{missing::report_missing, rig_args::side, time_range::TimeRange};
use crate::shutdown::Leave;

const HEADER: &str = "t_s,time_ns,x_m,y_m,z_m,fx_n,fy_n,fz_n,leader_x_m,leader_y_m,leader_z_m,\
delayed_x_n,delayed_y_n,delayed_z_n,asked_x_n,asked_y_n,asked_z_n,rendered_x_n,rendered_y_n,rendered_z_n,state";

/// Extensions of viewer layouts, and the names of their attachments.
const LAYOUTS: [(&str, &str); 2] = [("json", layouts::FOXGLOVE), ("xml", layouts::PLOTJUGGLER)];

#[derive(Debug, Args)]
pub(super) struct ExportArguments {
    /// Session file
    session: PathBuf,
    /// New file: a table that `nima identify` reads (.csv), a session (.mcap), or a layout for Foxglove (.json)
    /// or `PlotJuggler` (.xml)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    stretch: TimeRange,
    /// Arm to write into the table, right or left (required if the session has both)
    #[arg(long, value_name = "ARM", value_parser = side)]
    arm: Option<Side>,
    /// Remove person, place and time of the recording (.mcap only)
    #[arg(long)]
    anonymous: bool,
}

pub(super) fn run(arguments: &ExportArguments) -> anyhow::Result<()> {
    let ExportArguments { session, out, arm, anonymous, .. } = arguments;
    let is = |extension: &str| out.extension().is_some_and(|one| one.eq_ignore_ascii_case(extension));
    let layout = LAYOUTS.iter().find(|(extension, _)| is(extension)).map(|(_, name)| *name);
    if !is("csv") && !is("mcap") && layout.is_none() {
        bail!("--out {}: the name must end in .csv, .mcap, .json or .xml", out.display());
    }
    if layout.is_some() && (arm.is_some() || *anonymous || arguments.stretch.is_asked()) {
        bail!("a layout applies to the whole session: omit --arm, --anonymous, --from and --to");
    }
    if is("mcap") && arm.is_some() {
        bail!("--arm applies only to tables: omit it; an exported session keeps both arms");
    }
    if is("csv") && *anonymous {
        bail!(
            "--anonymous applies only to sessions (.mcap): omit it; a table of an anonymous session is anonymous too"
        );
    }
    if out.symlink_metadata().is_ok() {
        bail!("cannot write {}: it already exists; choose another name", out.display());
    }
    output::check(out, &[session])?;
    let reader = SessionReader::open(session)?;
    report_missing(session, &reader);
    if let Some(name) = layout {
        return laid_out(&reader, session, name, out);
    }
    let times_ns = times_ns(&reader, arguments)?;
    // Remove half-written files before the program ends.
    let leave = Leave::on_signals()?;
    if is("csv") {
        return table(&reader, times_ns, arguments, &leave);
    }
    let words = if *anonymous {
        whole(out, |new| anonymously(&reader, &times_ns, new, &leave))?
    } else {
        whole(out, |new| cut_out(&reader, &times_ns, session, new, &leave))?
    };
    output::line(&format!("{} in {}, {}", words.0, out.display(), words.1))
}

/// Writes an attached layout into a separate file for viewers to import.
fn laid_out(reader: &SessionReader, session: &Path, name: &str, out: &Path) -> anyhow::Result<()> {
    let attachment = reader.attachments().iter().find(|attachment| attachment.name == name);
    let attachment = attachment.with_context(|| {
        format!(
            "session {} has no {name}, because an older program recorded it; export the layout of a newer session",
            session.display()
        )
    })?;
    let data = reader.attachment(attachment)?;
    write_atomically(out, |file| file.write_all(&data)).with_context(|| format!("cannot write {}", out.display()))?;
    output::line(&format!("{name} in {}: import it as a layout", out.display()))
}

/// Returns the requested times, ns.
fn times_ns(
    reader: &SessionReader,
    ExportArguments { session, stretch, .. }: &ExportArguments,
) -> anyhow::Result<Range<u64>> {
    let Range { start, end } = stretch.of(session, reader)?;
    let begin_ns = plot_channels::beginning_ns(reader)?;
    let time_ns = |seconds: f64| begin_ns.saturating_add((seconds * 1e9).round() as u64);
    // Entries before the first tick belong to the first tick.
    Ok(if start > 0.0 { time_ns(start) } else { 0 }..time_ns(end))
}

enum ExportFailure {
    Session(PlottedError),
    File(io::Error),
}

impl From<PlottedError> for ExportFailure {
    fn from(error: PlottedError) -> Self {
        Self::Session(error)
    }
}

fn table(
    reader: &SessionReader,
    times_ns: Range<u64>,
    arguments: &ExportArguments,
    leave: &Leave,
) -> anyhow::Result<()> {
    let ExportArguments { session, out, arm, .. } = arguments;
    let arm = plot_channels::arm(reader, session, *arm)?;
    let mut rows = 0_u64;
    let mut trouble = None;
    let written = write_atomically(out, |file| {
        writeln!(file, "{HEADER}")?;
        let filled = plot_channels::each_tick(reader, session, arm, times_ns, |tick| {
            rows += 1;
            if leave.is_asked() {
                return Err(ExportFailure::File(io::Error::other(CutError::Asked)));
            }
            file.write_all(row(&tick).as_bytes()).map_err(ExportFailure::File)
        });
        match filled {
            Err(ExportFailure::File(error)) => Err(error),
            // An incomplete table is an error.
            Err(ExportFailure::Session(error)) => Err(io::Error::other(trouble.insert(error).to_string())),
            Ok(()) if rows == 0 => {
                Err(io::Error::other("the session has no tick in this excerpt; change --from or --to"))
            }
            Ok(()) => Ok(()),
        }
    });
    if let Some(trouble) = trouble {
        return Err(trouble.into());
    }
    written.with_context(|| format!("cannot write {}", out.display()))?;
    output::line(&format!("{rows} ticks of the {} arm in {}", arm.word(), out.display()))
}

/// Fewest digits that read back as the same numbers; empty for an unknown number.
fn row(tick: &PlottedTick) -> String {
    let PlottedTick { time_ns, t_s, tip_m, leader_m, measured_n, delayed_n, asked_n, rendered_n, state } = tick;
    let mut row = format!("{t_s},{time_ns}");
    for value in [tip_m, measured_n, leader_m, delayed_n, asked_n, rendered_n].into_iter().flatten() {
        row += &output::cell(*value);
    }
    writeln!(row, ",{}", state.word()).ok();
    row
}

/// Written content, and a remark about it.
type ExportReport = (String, &'static str);

/// Writes to a temporary folder next to the file first, so that no half-written file has its name.
fn whole(out: &Path, write: impl FnOnce(&Path) -> anyhow::Result<ExportReport>) -> anyhow::Result<ExportReport> {
    let failed = || format!("cannot write {}", out.display());
    let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    let beside = tempfile::Builder::new().prefix(".nima-export-").tempdir_in(folder).with_context(failed)?;
    let new = beside.path().join("session.mcap");
    let report = write(&new)?;
    std::fs::rename(&new, out).with_context(failed)?;
    Ok(report)
}

fn cut_out(
    reader: &SessionReader,
    times_ns: &Range<u64>,
    session: &Path,
    new: &Path,
    leave: &Leave,
) -> anyhow::Result<ExportReport> {
    let name = session.file_name().unwrap_or_default().to_string_lossy();
    let Cut { messages, journal } = trim::write(reader, &name, times_ns, new, leave.flag())?;
    let journal = match journal {
        JournalOutcome::Yes => "with the journal up to the end of the excerpt: `nima replay` can replay it",
        JournalOutcome::LeftOut => "without the journal, which can be replayed only from its start",
        JournalOutcome::None => "the session has no journal",
    };
    Ok((format!("{messages} messages"), journal))
}

fn anonymously(
    reader: &SessionReader,
    times_ns: &Range<u64>,
    new: &Path,
    leave: &Leave,
) -> anyhow::Result<ExportReport> {
    let (files, devices) = files(reader)?;
    let known = SessionFacts { program: PROGRAM, files: &files, words: WORDS, devices: &devices };
    let messages = anonymous::write(reader, &known, times_ns, new, leave.flag())?;
    Ok((format!("{messages} messages"), "anonymous, without the journal: docs/sessions.md lists the remaining data"))
}

/// Rig and scene of the session without their names, and the rig's devices. A file that this program cannot read is left out.
fn files(reader: &SessionReader) -> anyhow::Result<(Vec<AttachedFile>, Vec<DeviceName>)> {
    let mut files = Vec::new();
    let mut devices = Vec::new();
    for attachment in reader.attachments() {
        let Ok(text) = String::from_utf8(reader.attachment(attachment)?) else { continue };
        let path = Path::new(&attachment.name);
        let (name, text) = match &*attachment.name {
            RIG => {
                let rig = RigConfig::parse(path, &text).ok();
                devices = rig.as_ref().map_or_else(Vec::new, RigConfig::device_names);
                (RIG, rig.map(|rig| toml::to_string(&rig.anonymous())))
            }
            SCENE => (SCENE, Scene::parse(path, &text).ok().map(|scene| toml::to_string(&scene.anonymous()))),
            _ => continue,
        };
        files.extend(text.transpose()?.map(|text| toml_file(name, text)));
    }
    Ok((files, devices))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use nima_machine::messages::LoopState;

    use super::*;

    #[test]
    fn a_force_that_is_not_known_has_empty_fields() {
        let known = Vector3::new(0.0, 0.5, -1.0);
        let unknown = Vector3::repeat(f64::NAN);
        let tick = PlottedTick {
            time_ns: 7,
            t_s: 0.25,
            tip_m: known,
            leader_m: known,
            measured_n: unknown,
            delayed_n: unknown,
            asked_n: Vector3::zeros(),
            rendered_n: Vector3::zeros(),
            state: LoopState::Idle,
        };
        let row = row(&tick);
        assert_eq!(row, "0.25,7,0,0.5,-1,,,,0,0.5,-1,,,,0,0,0,0,0,0,Idle\n");
        assert_eq!(row.matches(',').count(), HEADER.matches(',').count());
    }
}
