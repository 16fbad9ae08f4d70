//! Reads the plotted signals of an arm from a session file, tick by tick: for tables, and for the identification.

use std::{
    ops::Range,
    path::{Path, PathBuf},
};

use nalgebra::{Isometry3, Vector3};
use nima_core::impedance::{AXES, Sample};
use nima_machine::{messages::LoopState, rig::Side};
use nima_recording::{
    csv::{CsvRecording, RecordingError},
    session::{ReadError, SessionMessage, SessionReader},
};

use crate::{
    topics::{FRAMES_TOPIC, STATES, columns::TopicColumns, endoscope_of},
    trim::{BEGINNING, CLOCK_TABLE},
};

#[derive(Debug, thiserror::Error)]
pub enum PlottedError {
    #[error(transparent)]
    File(#[from] ReadError),
    #[error(transparent)]
    Recording(#[from] RecordingError),
    #[error("session {path} has no forces of an arm: it was not recorded by this program; choose another session")]
    NoArms { path: PathBuf },
    #[error("session {path} has two arms: choose one with --arm right or --arm left")]
    TwoArms { path: PathBuf },
    #[error("session {path} has no {} arm: omit --arm", .arm.word())]
    NoArm { path: PathBuf, arm: Side },
    #[error("session {path} at {t_s} s: the plots of the {} arm were not written by this program; choose another session", .arm.word())]
    Foreign { path: PathBuf, arm: Side, t_s: f64 },
    #[error("session {path} at {t_s} s: {what} is not a finite number; export an excerpt without it: nima export")]
    NotFinite { path: PathBuf, t_s: f64, what: &'static str },
    #[error("session {path}: time does not increase at {t_s} s; export an excerpt without it: nima export")]
    Clock { path: PathBuf, t_s: f64 },
}

/// The plotted signals of one arm in one tick.
#[derive(Clone, Debug, PartialEq)]
pub struct PlottedTick {
    /// Time of its messages, ns since 1970 (UTC).
    pub time_ns: u64,
    /// s since the start of the session.
    pub t_s: f64,
    pub tip_m: Vector3<f64>,
    pub leader_m: Vector3<f64>,
    /// NaN while unknown.
    pub measured_n: Vector3<f64>,
    /// NaN while unknown.
    pub delayed_n: Vector3<f64>,
    pub asked_n: Vector3<f64>,
    pub rendered_n: Vector3<f64>,
    /// The plots do not contain the cause of a fault.
    pub state: LoopState,
}

/// Returns the start of the session, ns; for an excerpt, the start of its session.
///
/// # Errors
/// [`ReadError`] if the tables of the file cannot be read.
pub fn beginning_ns(reader: &SessionReader) -> Result<u64, ReadError> {
    let tables = reader.metadata()?;
    // An excerpt that was copied from another machine may state the beginning of the file only.
    let clock = tables.iter().filter(|(name, _)| name == CLOCK_TABLE).chain(&tables);
    let report = clock.into_iter().find_map(|(_, table)| table.get(BEGINNING)?.parse().ok());
    Ok(report.unwrap_or(reader.statistics().times_ns.0))
}

/// Returns the arms that are plotted.
pub fn arms(reader: &SessionReader) -> Vec<Side> {
    let is_plotted = |side: &Side| reader.channels().iter().any(|channel| channel.topic == topic(*side, "forces"));
    Side::ALL.into_iter().filter(is_plotted).collect()
}

/// Returns the requested arm, or the only one if none was requested.
///
/// # Errors
/// [`PlottedError`] if the session has no arm, not this arm, or two arms and none was requested.
pub fn arm(reader: &SessionReader, path: &Path, asked: Option<Side>) -> Result<Side, PlottedError> {
    let path = path.to_owned();
    match (asked, &*arms(reader)) {
        (_, []) => Err(PlottedError::NoArms { path }),
        (None, &[only]) => Ok(only),
        (None, _) => Err(PlottedError::TwoArms { path }),
        (Some(arm), there) if there.contains(&arm) => Ok(arm),
        (Some(arm), _) => Err(PlottedError::NoArm { path, arm }),
    }
}

/// Returns the poses of the endoscope's marker in this time range (ns), the newest last; empty if no tracker saw it or the
/// file has no frames.
pub fn endoscope(reader: &SessionReader, times_ns: Range<u64>) -> Vec<Isometry3<f64>> {
    let messages = reader.messages(&[FRAMES_TOPIC], times_ns);
    messages.filter_map(|message| endoscope_of(message.ok()?.data())).collect()
}

/// Calls `each` with every tick of this arm between these times (ns). An incomplete tick is left out.
///
/// # Errors
/// [`PlottedError`] for a file that cannot be read or was written by another program, or the error of `each`.
pub fn each_tick<E: From<PlottedError>>(
    reader: &SessionReader,
    path: &Path,
    arm: Side,
    times_ns: Range<u64>,
    mut each: impl FnMut(PlottedTick) -> Result<(), E>,
) -> Result<(), E> {
    let begin_ns = beginning_ns(reader).map_err(PlottedError::from)?;
    let topics = ["forces", "poses", "gates"].map(|what| topic(arm, what));
    let topics = topics.each_ref().map(String::as_str);
    let channel_of = |topic: &str| reader.channels().iter().find(|channel| channel.topic == topic).map(|one| one.id);
    let channels = topics.map(channel_of);
    // Last message of each topic.
    let mut parts: [Option<SessionMessage>; 3] = Default::default();
    let Some(mut columns) =
        TopicColumns::of(topics[0]).zip(TopicColumns::of(topics[1])).zip(TopicColumns::of(topics[2]))
    else {
        return Ok(());
    };
    for message in reader.messages(&topics, times_ns) {
        let message = message.map_err(PlottedError::from)?;
        let time_ns = message.log_time_ns();
        if let Some(which) = channels.iter().position(|channel| *channel == Some(message.channel())) {
            parts[which] = Some(message);
        }
        let [Some(forces), Some(poses), Some(gates)] = &parts else { continue };
        if [forces, poses, gates].iter().any(|part| part.log_time_ns() != time_ns) {
            continue;
        }
        let t_s = time_ns.saturating_sub(begin_ns) as f64 / 1e9;
        let ((of_forces, of_poses), of_gates) = &mut columns;
        let [forces, poses, gates] =
            [of_forces.read(forces.data()), of_poses.read(poses.data()), of_gates.read(gates.data())];
        let tick = tick((time_ns, t_s), forces, poses, gates);
        parts = Default::default();
        each(tick.ok_or_else(|| PlottedError::Foreign { path: path.to_owned(), arm, t_s })?)?;
    }
    Ok(())
}

/// Returns motion and force at the tip of an arm, the same as from an exported table. Ticks with an unknown force are
/// left out.
///
/// # Errors
/// [`PlottedError`] for a file that cannot be read, a missing arm, a value that is not finite, or too few ticks.
pub fn recording(path: &Path, asked: Option<Side>) -> Result<CsvRecording, PlottedError> {
    let reader = SessionReader::open(path)?;
    let arm = arm(&reader, path, asked)?;
    let mut samples: Vec<Sample> = Vec::new();
    each_tick(&reader, path, arm, 0..u64::MAX, |tick| {
        let PlottedTick { t_s, tip_m: position_m, measured_n: force_n, .. } = tick;
        if force_n.iter().all(|value| value.is_nan()) {
            return Ok(());
        }
        let is_finite = |vector: &Vector3<f64>| vector.iter().all(|value| value.is_finite());
        for (vector, what) in [(&position_m, "the position of the tip"), (&force_n, "the force at the tip")] {
            if !is_finite(vector) {
                return Err(PlottedError::NotFinite { path: path.to_owned(), t_s, what });
            }
        }
        if samples.last().is_some_and(|before| before.t_s >= t_s) {
            return Err(PlottedError::Clock { path: path.to_owned(), t_s });
        }
        samples.push(Sample { t_s, position_m, force_n });
        Ok(())
    })?;
    Ok(CsvRecording::of_samples(path, (0..AXES).collect(), samples)?)
}

pub(crate) fn topic(side: Side, what: &str) -> String {
    format!("{}/{what}", side.word())
}

/// Assembles a tick from its messages, in the order in which they are written.
fn tick(
    (time_ns, t_s): (u64, f64),
    forces: Option<&[f64]>,
    poses: Option<&[f64]>,
    gates: Option<&[f64]>,
) -> Option<PlottedTick> {
    let vectors = |of: &[f64]| of.chunks_exact(3).map(Vector3::from_column_slice).collect::<Vec<_>>();
    let &[measured_n, delayed_n, asked_n, rendered_n] = &vectors(forces?)[..] else { return None };
    let &[tip_m, leader_m] = &vectors(poses?)[..] else { return None };
    let state = state(*gates?.last()?)?;
    Some(PlottedTick { time_ns, t_s, tip_m, leader_m, measured_n, delayed_n, asked_n, rendered_n, state })
}

/// Returns the state of its number in the plots.
fn state(number: f64) -> Option<LoopState> {
    let index = (number >= 0.0 && number.fract() == 0.0).then_some(number as usize)?;
    STATES.get(index).copied()
}
