//! What is plotted of an arm in a session file, tick by tick: for tables, and for the identification.

use std::{
    ops::Range,
    path::{Path, PathBuf},
};

use nalgebra::{Isometry3, Vector3};
use nima_core::impedance::{AXES, Sample};
use nima_machine::{messages::LoopState, rig::Side};
use nima_recording::{
    csv::{Recording, RecordingError},
    session::{Message, ReadError, Reader},
};

use crate::{
    cut::BEGINNING,
    topics::{FRAMES_TOPIC, STATES, columns::Columns, endoscope_of},
};

/// Why the plots of a session cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum PlottedError {
    #[error(transparent)]
    File(#[from] ReadError),
    #[error(transparent)]
    Recording(#[from] RecordingError),
    #[error("session {path} has no forces of an arm: it was not recorded by this program")]
    NoArms { path: PathBuf },
    #[error("session {path} has two arms: choose one with --arm right or --arm left")]
    TwoArms { path: PathBuf },
    #[error("session {path} has no {} arm: leave --arm away", .arm.word())]
    NoArm { path: PathBuf, arm: Side },
    #[error("session {path} at {t_s} s: the plots of the {} arm are not those of this program", .arm.word())]
    Foreign { path: PathBuf, arm: Side, t_s: f64 },
    #[error("session {path} at {t_s} s: {what} is not a finite number; choose a stretch without it: nima export")]
    NotFinite { path: PathBuf, t_s: f64, what: &'static str },
    #[error("session {path}: time does not rise at {t_s} s; choose a stretch without it: nima export")]
    Clock { path: PathBuf, t_s: f64 },
}

/// What is plotted of one arm in one tick.
#[derive(Clone, Debug, PartialEq)]
pub struct PlottedTick {
    /// Time of its messages, ns since 1970 (UTC).
    pub time_ns: u64,
    /// Since the session began, s.
    pub t_s: f64,
    pub tip_m: Vector3<f64>,
    pub leader_m: Vector3<f64>,
    /// No numbers while it was not known.
    pub measured_n: Vector3<f64>,
    /// The same.
    pub delayed_n: Vector3<f64>,
    pub asked_n: Vector3<f64>,
    pub rendered_n: Vector3<f64>,
    /// Of faults only that there was one is plotted.
    pub state: LoopState,
}

/// When the session began, ns: for a stretch that was cut out, the session that it was cut from.
///
/// # Errors
/// [`ReadError`] if the tables of the file cannot be read.
pub fn beginning_ns(reader: &Reader) -> Result<u64, ReadError> {
    let tables = reader.metadata()?;
    let told = tables.iter().find_map(|(_, table)| table.get(BEGINNING)?.parse().ok());
    Ok(told.unwrap_or(reader.statistics().times_ns.0))
}

/// The arms that are plotted.
pub fn arms(reader: &Reader) -> Vec<Side> {
    let is_plotted = |side: &Side| reader.channels().iter().any(|channel| channel.topic == topic(*side, "forces"));
    Side::ALL.into_iter().filter(is_plotted).collect()
}

/// The arm that is meant: the only one, or the one that was asked for.
///
/// # Errors
/// [`PlottedError`] if there is none, not this one, or no choice among two.
pub fn arm(reader: &Reader, path: &Path, asked: Option<Side>) -> Result<Side, PlottedError> {
    let path = path.to_owned();
    match (asked, &*arms(reader)) {
        (_, []) => Err(PlottedError::NoArms { path }),
        (None, &[only]) => Ok(only),
        (None, _) => Err(PlottedError::TwoArms { path }),
        (Some(arm), there) if there.contains(&arm) => Ok(arm),
        (Some(arm), _) => Err(PlottedError::NoArm { path, arm }),
    }
}

/// Where the endoscope's marker was in these times (ns), the newest last; nothing where no tracker saw it, or the file has no frames.
pub fn endoscope(reader: &Reader, times_ns: Range<u64>) -> Vec<Isometry3<f64>> {
    let messages = reader.messages(&[FRAMES_TOPIC], times_ns);
    messages.filter_map(|message| endoscope_of(message.ok()?.data())).collect()
}

/// Calls `each` with every tick of this arm between these times (ns). A tick that was not written to its end is left out.
///
/// # Errors
/// [`PlottedError`] for a file that cannot be read or that another program wrote, or what `each` returns.
pub fn each_tick<E: From<PlottedError>>(
    reader: &Reader,
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
    // The last message of each topic.
    let mut parts: [Option<Message>; 3] = Default::default();
    let Some(mut columns) = Columns::of(topics[0]).zip(Columns::of(topics[1])).zip(Columns::of(topics[2])) else {
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

/// Motion and force at the tip of an arm, as the same from an exported table. Ticks in which the force was not known are left out.
///
/// # Errors
/// [`PlottedError`] for a file that cannot be read, no such arm, a value that is not finite, or too few ticks.
pub fn recording(path: &Path, asked: Option<Side>) -> Result<Recording, PlottedError> {
    let reader = Reader::open(path)?;
    let arm = arm(&reader, path, asked)?;
    let mut samples: Vec<Sample> = Vec::new();
    each_tick(&reader, path, arm, 0..u64::MAX, |tick| {
        let PlottedTick { t_s, tip_m: position_m, measured_n: force_n, .. } = tick;
        if force_n.iter().all(|value| value.is_nan()) {
            return Ok(());
        }
        let is_finite = |vector: &Vector3<f64>| vector.iter().all(|value| value.is_finite());
        for (vector, what) in [(&position_m, "the place of the tip"), (&force_n, "the force at the tip")] {
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
    Ok(Recording::of_samples(path, (0..AXES).collect(), samples)?)
}

pub(crate) fn topic(side: Side, what: &str) -> String {
    format!("{}/{what}", side.word())
}

/// A tick of what its messages say, in the order in which they are written.
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

/// A state from its number in the plots.
fn state(number: f64) -> Option<LoopState> {
    let index = (number >= 0.0 && number.fract() == 0.0).then_some(number as usize)?;
    STATES.get(index).copied()
}
