//! Objects of a scene in a session: positions of rings, state of jaws, events, and progress of the task.
//!
//! They come from a simulation outside the loop and are not an input of the loop, so the journal and its replay do not
//! include them. An [`ObjectSource`] provides them for the recording; [`happenings`], [`openings`] and [`at`] read them
//! back.

mod task_event;

use std::{fmt::Debug, ops::Range};

use nalgebra::{Isometry3, Vector3};
use nima_core::task::TimedTaskEvent;
use nima_machine::rig::{SIDES, Side};
use nima_recording::session::{ReadError, SessionMessage, SessionReader};

pub use task_event::kind;
pub(crate) use task_event::{SCHEMA, SCHEMA_NAME, decode, encode};

use crate::{
    plot_channels::{beginning_ns, topic},
    topics::{
        HAPPENINGS_TOPIC, JAWS_PLOT, MARKS_TOPIC, RINGS_TOPIC, TASK_TOPIC, columns::TopicColumns, jaws_of, marks_of,
        rings_of, standing_of,
    },
};

/// Maximum age of the objects shown for a moment, ns.
const STALE_NS: u64 = 200_000_000;

/// Jaws of an instrument, and the forces on it. Frame `world`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JawState {
    /// Angle between the fingers, rad.
    pub opening_rad: f64,
    /// Opening force at the end of a finger, N; negative if it closes the jaws.
    pub opens_n: f64,
    /// Total force of all contacts on the instrument, N.
    pub force_n: Vector3<f64>,
    /// Torque of these forces about the tip, N m.
    pub torque_nm: Vector3<f64>,
    /// Contact with a ring, a peg, the board and another instrument.
    pub touched: [bool; 4],
}

/// A position that was marked as a lump. Frame `world`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LumpMark {
    /// On the tissue at rest, m.
    pub position_m: Vector3<f64>,
    /// Whether there is a lump at the mark.
    pub is_true: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WireLoop {
    /// Whether it touches the wire.
    pub touches: bool,
    /// Whether the wire passes through it.
    pub on_wire: bool,
}

/// Progress of a scene's task at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TaskProgress {
    /// Whether the trial is over.
    pub ended: bool,
    /// Completed fraction of the path along the wire, 0 to 1.
    pub fraction: f64,
    /// Number of marked positions, and number of different lumps among them.
    pub marked: u32,
    /// See `marked`.
    pub found: u32,
    /// Number of contacts between loops and wire.
    pub touches: u32,
    /// Number of rings passed between instruments in mid-air, placed on pegs, and dropped, in or out of view.
    pub passed: u32,
    /// See `passed`.
    pub placed: u32,
    /// See `passed`.
    pub dropped: u32,
    /// The loop of each instrument.
    pub loops: [WireLoop; SIDES],
    /// The marked positions in their order; only the first ones if there are very many.
    pub marks: Vec<LumpMark>,
}

/// The objects of a scene at one time. Frame `world`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectStates {
    /// Time of the loop, s.
    pub t_s: f64,
    /// Centre and orientation of each ring, m, by its number; z is the axis through the ring. `None` if it is out of
    /// view or does not exist.
    pub rings: Vec<Option<Isometry3<f64>>>,
    /// Jaws of each side; `None` for an instrument without jaws, or none.
    pub jaws: [Option<JawState>; SIDES],
    /// Progress of the task; `None` if unknown.
    pub task: Option<TaskProgress>,
}

/// Provides objects for a recording: a simulation. Called on the recorder's thread; must not wait.
pub trait ObjectSource: Send + Debug {
    /// Returns the next state, in the order of time, if there is one.
    fn moment(&mut self) -> Option<ObjectStates>;

    /// Returns the next event, in the order of time, if there is one.
    fn happening(&mut self) -> Option<TimedTaskEvent>;
}

/// Returns whether the recording of this session had a source of events, even if none occurred.
pub fn are_reported(reader: &SessionReader) -> bool {
    has(reader, HAPPENINGS_TOPIC)
}

/// Returns whether rings, jaws or the state of a task are recorded in this session.
pub fn are_shown(reader: &SessionReader) -> bool {
    Side::ALL
        .into_iter()
        .map(|side| topic(side, JAWS_PLOT))
        .chain([RINGS_TOPIC, TASK_TOPIC].map(str::to_owned))
        .any(|name| has(reader, &name))
}

fn has(reader: &SessionReader, topic: &str) -> bool {
    reader.channels().iter().any(|channel| channel.topic == topic)
}

/// Returns the events between these times (ns since 1970), with their seconds since the start of the session. Kinds of
/// events that a later version adds are left out.
///
/// # Errors
/// [`ReadError`] if the session cannot be read.
pub fn happenings(reader: &SessionReader, times_ns: Range<u64>) -> Result<Vec<TimedTaskEvent>, ReadError> {
    let begin_ns = beginning_ns(reader)?;
    let mut all = Vec::new();
    for message in reader.messages(&[HAPPENINGS_TOPIC], times_ns) {
        let message = message?;
        let t_s = message.log_time_ns().saturating_sub(begin_ns) as f64 / 1e9;
        all.extend(decode(message.data()).map(|happening| TimedTaskEvent { t_s, ..happening }));
    }
    Ok(all)
}

/// Returns the opening of this side's jaws between these times (ns since 1970): seconds since the start of the session,
/// rad.
///
/// # Errors
/// [`ReadError`] if the session cannot be read.
pub fn openings(reader: &SessionReader, side: Side, times_ns: Range<u64>) -> Result<Vec<(f64, f64)>, ReadError> {
    let begin_ns = beginning_ns(reader)?;
    let topic = topic(side, JAWS_PLOT);
    let Some(mut columns) = TopicColumns::of(&topic).filter(|_| has(reader, &topic)) else { return Ok(Vec::new()) };
    let mut all = Vec::new();
    for message in reader.messages(&[&topic], times_ns) {
        let message = message?;
        let t_s = message.log_time_ns().saturating_sub(begin_ns) as f64 / 1e9;
        all.extend(columns.read(message.data()).and_then(jaws_of).map(|jaws| (t_s, jaws.opening_rad)));
    }
    Ok(all)
}

/// Returns the objects at this time (ns since 1970) of a session that began at `begin_ns`; `None` if there is no recent
/// state of them.
///
/// # Errors
/// [`ReadError`] if the session cannot be read.
pub fn at(reader: &SessionReader, begin_ns: u64, time_ns: u64) -> Result<Option<ObjectStates>, ReadError> {
    let jaws_topics = Side::ALL.map(|side| topic(side, JAWS_PLOT));
    let topics = [RINGS_TOPIC, MARKS_TOPIC, TASK_TOPIC, &jaws_topics[0], &jaws_topics[1]];
    let place = |id| {
        let channel = reader.channels().iter().find(|channel| channel.id == id)?;
        topics.iter().position(|topic| *topic == channel.topic)
    };
    let mut newest = [None, None, None, None, None];
    for message in reader.messages(&topics, time_ns.saturating_sub(STALE_NS)..time_ns.saturating_add(1)) {
        let message = message?;
        if let Some(place) = place(message.channel()) {
            newest[place] = Some(message);
        }
    }
    let Some(last_ns) = newest.iter().flatten().map(SessionMessage::log_time_ns).max() else { return Ok(None) };
    let [rings, marks, task, jaws @ ..] = &newest;
    let read = |(message, topic): (&Option<SessionMessage>, &String)| {
        jaws_of(TopicColumns::of(topic)?.read(message.as_ref()?.data())?)
    };
    let standing = || standing_of(TopicColumns::of(TASK_TOPIC)?.read(task.as_ref()?.data())?);
    let marks = marks.as_ref().map(|marks| marks_of(marks.data())).unwrap_or_default();
    let mut objects = ObjectStates {
        t_s: last_ns.saturating_sub(begin_ns) as f64 / 1e9,
        rings: rings.as_ref().map(|rings| rings_of(rings.data())).unwrap_or_default(),
        jaws: [None; SIDES],
        task: standing().map(|standing| TaskProgress { marks, ..standing }),
    };
    for (side, one) in Side::ALL.into_iter().zip(jaws.iter().zip(&jaws_topics)) {
        objects.jaws[side.index()] = read(one);
    }
    Ok(Some(objects))
}
