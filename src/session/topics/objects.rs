//! The channels of objects: rings and marks as frames, jaws and the state of the task as named numbers, events as JSON
//! and as lines of the log.

use std::collections::VecDeque;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use nima_core::task::TimedTaskEvent;
use nima_machine::rig::{SIDES, Side};
use nima_recording::{
    messages::{
        foxglove::{self, FrameTransform, FrameTransforms, timestamp},
        json_encoding,
    },
    session::WriteError,
};
use prost::Message as _;

use super::{
    plot::Plot,
    scene::{WORLD, quaternion, vector},
};
use crate::{
    objects::{JawState, LumpMark, ObjectSource, ObjectStates, SCHEMA, SCHEMA_NAME, TaskProgress, WireLoop, encode},
    sinks::{SessionSinks, SinkChannel},
};

pub(crate) const RINGS_TOPIC: &str = "rings";
pub(crate) const HAPPENINGS_TOPIC: &str = "happenings";
/// The plot with the jaws of a side, and its numbers.
pub(crate) const JAWS_PLOT: &str = "jaws";
/// See [`JAWS_PLOT`]; a contact is 1.
pub(crate) const JAWS: [&str; 12] = [
    "opening_rad",
    "opens_n",
    "load.x_n",
    "load.y_n",
    "load.z_n",
    "torque.x_nm",
    "torque.y_nm",
    "torque.z_nm",
    "touches.ring",
    "touches.peg",
    "touches.board",
    "touches.instrument",
];
pub(crate) const MARKS_TOPIC: &str = "marks";
/// Topic of the state of the task, and its numbers; true is 1.
pub(crate) const TASK_TOPIC: &str = "task";
/// See [`TASK_TOPIC`].
pub(crate) const TASK: [&str; 12] = [
    "task.ended",
    "task.share",
    "task.marked",
    "task.found",
    "task.wire_touches",
    "task.passed",
    "task.placed",
    "task.dropped",
    "right.loop.touches",
    "right.loop.on_wire",
    "left.loop.touches",
    "left.loop.on_wire",
];
/// An unchanged state is repeated after this time, s, which is less than the maximum age of displayed objects.
const AGAIN_S: f64 = 0.1;
/// Prefix of the frames of marks, followed by their number from 0: on a lump, and elsewhere.
const MARK: &str = "mark.";
const FALSE_MARK: &str = "false_mark.";
/// Maximum number of marks read from a message.
const MARKS_MAX: usize = 64;
/// Prefix of the frames of rings, followed by their number from 0.
const RING: &str = "ring.";
/// Maximum number of rings read from a message.
const RINGS_MAX: usize = 64;

/// Writes the states of a source as soon as the loop's tick of their time has passed.
#[derive(Debug)]
pub(crate) struct OfObjects {
    source: Box<dyn ObjectSource>,
    moments: VecDeque<ObjectStates>,
    happenings: VecDeque<TimedTaskEvent>,
    rings: Option<SinkChannel>,
    jaws: [Option<Plot>; SIDES],
    marks: Option<SinkChannel>,
    task: Option<Plot>,
    /// The state of the task as last written, and when, s.
    standing: Option<(f64, TaskProgress)>,
    report: SinkChannel,
}

impl OfObjects {
    pub(crate) fn new(out: &mut SessionSinks, source: Box<dyn ObjectSource>) -> Result<Self, WriteError> {
        let report = happenings_channel(out)?;
        Ok(Self {
            source,
            moments: VecDeque::new(),
            happenings: VecDeque::new(),
            rings: None,
            jaws: [None, None],
            marks: None,
            task: None,
            standing: None,
            report,
        })
    }

    /// Writes the states up to this time of the loop, s, and returns the events up to it. `time_ns` computes the time
    /// of a message.
    pub(crate) fn until(
        &mut self,
        out: &mut SessionSinks,
        t_s: f64,
        time_ns: impl Fn(f64) -> u64,
    ) -> Result<Vec<TimedTaskEvent>, WriteError> {
        while let Some(moment) = self.source.moment() {
            self.moments.push_back(moment);
        }
        while let Some(happening) = self.source.happening() {
            self.happenings.push_back(happening);
        }
        while let Some(moment) = self.moments.pop_front_if(|moment| moment.t_s <= t_s) {
            self.write(out, time_ns(moment.t_s), &moment)?;
            out.objects(&moment);
        }
        let mut happened = Vec::new();
        while let Some(happening) = self.happenings.pop_front_if(|happening| happening.t_s <= t_s) {
            out.message(self.report, time_ns(happening.t_s), &encode(&happening))?;
            happened.push(happening);
        }
        Ok(happened)
    }

    fn write(&mut self, out: &mut SessionSinks, time_ns: u64, objects: &ObjectStates) -> Result<(), WriteError> {
        if self.rings.is_some() || objects.rings.iter().any(Option::is_some) {
            let channel = match self.rings {
                Some(channel) => channel,
                None => *self.rings.insert(rings_channel(out)?),
            };
            out.message(channel, time_ns, &rings(time_ns, &objects.rings).encode_to_vec())?;
        }
        for side in Side::ALL {
            let Some(jaws) = &objects.jaws[side.index()] else { continue };
            let plot = match &mut self.jaws[side.index()] {
                Some(plot) => plot,
                none => none.insert(Plot::of_side(out, side, JAWS_PLOT, &JAWS)?),
            };
            plot.values.extend(numbers(jaws));
            plot.write(out, time_ns, false)?;
        }
        objects.task.as_ref().map_or(Ok(()), |standing| self.stands(out, time_ns, objects.t_s, standing))
    }

    /// Writes the state of the task when it has changed, and at intervals.
    fn stands(
        &mut self,
        out: &mut SessionSinks,
        time_ns: u64,
        t_s: f64,
        standing: &TaskProgress,
    ) -> Result<(), WriteError> {
        let is_due = |(at_s, written): &(f64, TaskProgress)| written != standing || t_s - at_s >= AGAIN_S - 1e-6;
        if !self.standing.as_ref().is_none_or(is_due) {
            return Ok(());
        }
        let plot = match &mut self.task {
            Some(plot) => plot,
            none => none.insert(Plot::new(out, TASK_TOPIC, &TASK)?),
        };
        plot.values.extend(standing_numbers(standing));
        plot.write(out, time_ns, false)?;
        // Write an empty list when the marks were removed.
        if self.marks.is_some() || !standing.marks.is_empty() {
            let channel = match self.marks {
                Some(channel) => channel,
                None => *self.marks.insert(marks_channel(out)?),
            };
            out.message(channel, time_ns, &marks(time_ns, &standing.marks).encode_to_vec())?;
        }
        self.standing = Some((t_s, standing.clone()));
        Ok(())
    }
}

pub(crate) fn happenings_channel(out: &mut SessionSinks) -> Result<SinkChannel, WriteError> {
    out.channel(HAPPENINGS_TOPIC, json_encoding(SCHEMA_NAME, SCHEMA))
}

pub(crate) fn marks_channel(out: &mut SessionSinks) -> Result<SinkChannel, WriteError> {
    out.channel(MARKS_TOPIC, foxglove::encoding::<FrameTransforms>())
}

pub(crate) fn rings_channel(out: &mut SessionSinks) -> Result<SinkChannel, WriteError> {
    out.channel(RINGS_TOPIC, foxglove::encoding::<FrameTransforms>())
}

/// Returns the frames of the rings that are in view.
pub(crate) fn rings(time_ns: u64, rings: &[Option<Isometry3<f64>>]) -> FrameTransforms {
    let timestamp = Some(timestamp(time_ns));
    let frame = |(number, ring): (usize, &Option<Isometry3<f64>>)| {
        let ring = ring.as_ref()?;
        Some(FrameTransform {
            timestamp,
            parent_frame_id: WORLD.to_owned(),
            child_frame_id: format!("{RING}{number}"),
            translation: Some(vector(&ring.translation.vector)),
            rotation: Some(quaternion(&ring.rotation)),
        })
    };
    FrameTransforms { transforms: rings.iter().enumerate().filter_map(frame).collect() }
}

/// Returns the frames of these marks.
pub(crate) fn marks(time_ns: u64, marks: &[LumpMark]) -> FrameTransforms {
    let timestamp = Some(timestamp(time_ns));
    let frame = |(number, mark): (usize, &LumpMark)| FrameTransform {
        timestamp,
        parent_frame_id: WORLD.to_owned(),
        child_frame_id: format!("{}{number}", if mark.is_true { MARK } else { FALSE_MARK }),
        translation: Some(vector(&mark.position_m)),
        rotation: Some(quaternion(&UnitQuaternion::identity())),
    };
    FrameTransforms { transforms: marks.iter().enumerate().map(frame).collect() }
}

/// Returns the marks of a message; other frames are left out.
pub(crate) fn marks_of(message: &[u8]) -> Vec<LumpMark> {
    let frames = FrameTransforms::decode(message).unwrap_or_default().transforms;
    let mark = |FrameTransform { child_frame_id, translation, .. }: FrameTransform| {
        let (number, is_true) = match child_frame_id.strip_prefix(FALSE_MARK) {
            Some(number) => (number, false),
            None => (child_frame_id.strip_prefix(MARK)?, true),
        };
        number.parse::<usize>().ok().filter(|number| *number < MARKS_MAX)?;
        let at = translation?;
        Some(LumpMark { position_m: Vector3::new(at.x, at.y, at.z), is_true })
    };
    frames.into_iter().filter_map(mark).take(MARKS_MAX).collect()
}

/// Returns the rings of a message; other frames are left out.
pub(crate) fn rings_of(message: &[u8]) -> Vec<Option<Isometry3<f64>>> {
    let mut rings = Vec::new();
    for FrameTransform { child_frame_id, translation, rotation, .. } in
        FrameTransforms::decode(message).unwrap_or_default().transforms
    {
        let number = child_frame_id.strip_prefix(RING).and_then(|number| number.parse::<usize>().ok());
        let (Some(number), Some(at), Some(turn)) = (number.filter(|number| *number < RINGS_MAX), translation, rotation)
        else {
            continue;
        };
        let turn = UnitQuaternion::new_unchecked(Quaternion::new(turn.w, turn.x, turn.y, turn.z));
        if rings.len() <= number {
            rings.resize(number + 1, None);
        }
        rings[number] = Some(Isometry3::from_parts(Translation3::new(at.x, at.y, at.z), turn));
    }
    rings
}

fn numbers(jaws: &JawState) -> [f64; JAWS.len()] {
    let JawState { opening_rad, opens_n, force_n, torque_nm, touched } = jaws;
    let mut numbers = [0.0; JAWS.len()];
    [numbers[0], numbers[1]] = [*opening_rad, *opens_n];
    numbers[2..5].copy_from_slice(force_n.as_slice());
    numbers[5..8].copy_from_slice(torque_nm.as_slice());
    numbers[8..].copy_from_slice(&touched.map(|touches| f64::from(u8::from(touches))));
    numbers
}

/// Returns the jaws described by these numbers, in the order of [`JAWS`].
pub(crate) fn jaws_of(numbers: &[f64]) -> Option<JawState> {
    let numbers: &[f64; JAWS.len()] = numbers.try_into().ok()?;
    let touched = [numbers[8], numbers[9], numbers[10], numbers[11]];
    Some(JawState {
        opening_rad: numbers[0],
        opens_n: numbers[1],
        force_n: Vector3::from_column_slice(&numbers[2..5]),
        torque_nm: Vector3::from_column_slice(&numbers[5..8]),
        touched: touched.map(|touches| touches > 0.5),
    })
}

fn standing_numbers(standing: &TaskProgress) -> [f64; TASK.len()] {
    let TaskProgress { ended, fraction, marked, found, touches, passed, placed, dropped, loops, marks: _ } = standing;
    let is = |is: bool| f64::from(u8::from(is));
    let [marked, found, touches] = [marked, found, touches].map(|count| f64::from(*count));
    let [passed, placed, dropped] = [passed, placed, dropped].map(|count| f64::from(*count));
    let [right, left] = Side::ALL.map(|side| loops[side.index()]).map(|one| [is(one.touches), is(one.on_wire)]);
    [is(*ended), *fraction, marked, found, touches, passed, placed, dropped, right[0], right[1], left[0], left[1]]
}

/// Returns the state of a task from its numbers, in the order of [`TASK`]; its marks are in another topic.
pub(crate) fn standing_of(numbers: &[f64]) -> Option<TaskProgress> {
    let numbers: &[f64; TASK.len()] = numbers.try_into().ok()?;
    let [ended, fraction, counts @ .., right, right_on, left, left_on] = *numbers;
    let [marked, found, touches, passed, placed, dropped] = counts.map(|count| count as u32);
    let mut loops = [WireLoop::default(); SIDES];
    for (side, [touches, on_wire]) in Side::ALL.into_iter().zip([[right, right_on], [left, left_on]]) {
        loops[side.index()] = WireLoop { touches: touches > 0.5, on_wire: on_wire > 0.5 };
    }
    let ended = ended > 0.5;
    let marks = Vec::new();
    Some(TaskProgress { ended, fraction, marked, found, touches, passed, placed, dropped, loops, marks })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_and_the_state_of_the_task_come_back_to_the_bit() {
        let mark = |x: f64, is_true| LumpMark { position_m: Vector3::new(x, -0.25, 0.003), is_true };
        let all = [mark(0.1, true), mark(0.2, false), mark(0.3, true)];
        assert_eq!(marks_of(&marks(5, &all).encode_to_vec()), all);
        let mut loops = [WireLoop::default(); SIDES];
        loops[Side::Left.index()] = WireLoop { touches: true, on_wire: true };
        let standing = TaskProgress {
            ended: true,
            fraction: 0.37,
            marked: 4,
            found: 2,
            touches: 7,
            passed: 1,
            placed: 3,
            dropped: 5,
            loops,
            marks: Vec::new(),
        };
        assert_eq!(standing_of(&standing_numbers(&standing)), Some(standing));
        assert_eq!((standing_of(&[1.0]), marks_of(b"something else")), (None, vec![]));
        let foreign = ["ring.0", "mark.x", "mark.64", "false_mark."].map(|name| FrameTransform {
            child_frame_id: name.to_owned(),
            translation: Some(foxglove::Vector3::default()),
            ..FrameTransform::default()
        });
        assert_eq!(marks_of(&FrameTransforms { transforms: foreign.to_vec() }.encode_to_vec()), vec![]);
    }

    #[test]
    fn rings_and_jaws_come_back_to_the_bit() {
        let turn = UnitQuaternion::from_euler_angles(0.3, -1.2, 2.5);
        let ring = Isometry3::from_parts(Translation3::new(0.1, -0.02, 0.3), turn);
        let all = [Some(ring), None, Some(Isometry3::identity()), None];
        let read = rings_of(&rings(5, &all).encode_to_vec());
        assert_eq!(read, all[..3], "the last present ring ends the list");
        let jaws = JawState {
            opening_rad: 0.6,
            opens_n: -1.5,
            force_n: Vector3::new(1.0, 2.0, 3.0),
            torque_nm: Vector3::new(0.1, 0.2, 0.3),
            touched: [true, false, false, true],
        };
        assert_eq!(jaws_of(&numbers(&jaws)), Some(jaws));
        assert_eq!((jaws_of(&[1.0]), rings_of(b"something else")), (None, vec![]));
    }

    #[test]
    fn foreign_frames_are_no_rings() {
        let frame = |name: &str| FrameTransform {
            child_frame_id: name.to_owned(),
            translation: Some(foxglove::Vector3::default()),
            rotation: Some(foxglove::Quaternion::default()),
            ..FrameTransform::default()
        };
        let transforms = ["right.tip", "ring.x", "ring.99999999999", "ring.64"].map(frame).to_vec();
        assert_eq!(rings_of(&FrameTransforms { transforms }.encode_to_vec()), vec![]);
    }
}
