//! Read access to moving objects: their states and their events.

use nalgebra::Vector3;
use nima_core::task::TimedTaskEvent;
use nima_machine::{
    hand_over::{FromLoop, from_loop},
    rig::SIDES,
};
use rtrb::Producer;

pub use crate::physics::RINGS_MAX;
use crate::physics::{InstrumentLoads, RingState};

/// Maximum number of marks in a state.
pub const MARKS_MAX: usize = 32;
/// Capacity for states and events of each reader; more are dropped. States of 5 s: a loop on the virtual clock is at
/// most 2.5 s ahead of its recorder.
const MOMENTS: usize = 512;
const HAPPENINGS: usize = 1024;
/// Maximum number of readers: a screen or a score, a recording, and one more.
const READERS: usize = 3;

/// The objects of a scene at one time, indexed by side where they belong to one.
#[derive(Clone, Copy, Debug)]
pub struct ObjectMoment {
    /// Time of the loop, s.
    pub t_s: f64,
    /// The rings; `None` beyond their number, and for a ring out of view.
    pub rings: [Option<RingState>; RINGS_MAX],
    /// Angle between the fingers of each instrument, rad.
    pub opening_rad: [f64; SIDES],
    /// Forces on each instrument.
    pub loads: [InstrumentLoads; SIDES],
    /// Additional state of a palpation or a wire task.
    pub training: Training,
}

/// Progress of a training task.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Training {
    /// Whether the trial is over.
    pub ended: bool,
    /// The marked positions in their order; `None` beyond their number.
    pub marks: [Option<PlaceMark>; MARKS_MAX],
    /// Number of marks in total, and number of different lumps among them.
    pub marked: u32,
    /// See `marked`. Hidden from the operator during the trial.
    pub found: u32,
    /// The loop of each instrument.
    pub loops: [LoopObservation; SIDES],
    /// Number of contacts between loops and wire.
    pub touches: u32,
    /// Completed fraction of the path to the goal, 0 to 1.
    pub fraction: f64,
    /// Number of rings passed in mid-air, placed on pegs, and dropped, in or out of view.
    pub passed: u32,
    /// See `passed`.
    pub placed: u32,
    /// See `passed`.
    pub dropped: u32,
}

/// A marked position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceMark {
    /// On the tissue at rest, m.
    pub position_m: Vector3<f64>,
    /// Whether there is a lump at the mark. Hidden from the operator during the trial.
    pub is_true: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoopObservation {
    /// Whether it touches the wire.
    pub touches: bool,
    /// Whether the wire passes through it.
    pub on_wire: bool,
}

/// Receives states and events of a simulation without blocking it. Each reader has its own, from [`ObjectFeed::another`].
#[derive(Debug)]
pub struct ObjectFeed {
    moments: FromLoop<ObjectMoment>,
    happenings: FromLoop<TimedTaskEvent>,
    others: Vec<Self>,
}

/// The other end, in the simulation.
#[derive(Debug)]
pub(super) struct ObjectPublisher {
    readers: Vec<(Producer<ObjectMoment>, Producer<TimedTaskEvent>)>,
}

/// A copy of a simulation has no readers: those of the original belong to it.
impl Clone for ObjectPublisher {
    fn clone(&self) -> Self {
        Self { readers: Vec::new() }
    }
}

pub(super) fn ends() -> (ObjectPublisher, ObjectFeed) {
    let (first, mut watched) = reader();
    let mut readers = vec![first];
    for _ in 1..READERS {
        let (to, other) = reader();
        readers.push(to);
        watched.others.push(other);
    }
    (ObjectPublisher { readers }, watched)
}

fn reader() -> ((Producer<ObjectMoment>, Producer<TimedTaskEvent>), ObjectFeed) {
    let (moments, shown) = from_loop(MOMENTS);
    let (happenings, report) = from_loop(HAPPENINGS);
    ((moments, happenings), ObjectFeed { moments: shown, happenings: report, others: Vec::new() })
}

impl ObjectFeed {
    /// Returns another reader, which receives the same data; `None` if there are three already.
    pub fn another(&mut self) -> Option<Self> {
        self.others.pop()
    }

    /// Returns the states since the last call, oldest first.
    pub fn moments(&self) -> impl Iterator<Item = ObjectMoment> + '_ {
        self.moments.try_iter()
    }

    /// Returns the newest state, if there is a new one.
    pub fn newest(&self) -> Option<ObjectMoment> {
        self.moments.try_iter().last()
    }

    /// Returns the events since the last call.
    pub fn happenings(&self) -> impl Iterator<Item = TimedTaskEvent> + '_ {
        self.happenings.try_iter()
    }
}

impl ObjectPublisher {
    pub(super) fn moment(&mut self, moment: &ObjectMoment) {
        for (moments, _) in &mut self.readers {
            moments.push(*moment).ok();
        }
    }

    pub(super) fn happening(&mut self, happening: TimedTaskEvent) {
        for (_, happenings) in &mut self.readers {
            happenings.push(happening).ok();
        }
    }
}

#[cfg(test)]
mod tests {
    use nima_core::task::TaskEvent;

    use super::*;

    #[test]
    fn every_reader_is_told_everything_and_one_who_does_not_read_stops_nobody() {
        let (mut publisher, mut first) = ends();
        let second = first.another().unwrap();
        let third = first.another().unwrap();
        assert!(first.another().is_none());
        let mut moments = [0, 0];
        let mut events = [0, 0];
        let moment = |t_s| ObjectMoment {
            t_s,
            rings: [None; RINGS_MAX],
            opening_rad: [0.0; SIDES],
            loads: [InstrumentLoads::default(); SIDES],
            training: Training::default(),
        };
        for step in 0..2000_u32 {
            let t_s = f64::from(step) * 0.01;
            publisher.moment(&moment(t_s));
            publisher.happening(TimedTaskEvent { t_s, event: TaskEvent::Begun });
            if step % 100 == 99 {
                for (reader, (moments, events)) in
                    [&first, &second].into_iter().zip(moments.iter_mut().zip(&mut events))
                {
                    *moments += reader.moments().count();
                    *events += reader.happenings().count();
                }
            }
        }
        assert_eq!((moments, events), ([2000; 2], [2000; 2]));
        drop(second);
        publisher.moment(&moment(20.0));
        assert!(first.newest().is_some_and(|newest| (newest.t_s - 20.0).abs() < 1e-9));
        assert_eq!((third.moments().count(), third.happenings().count()), (MOMENTS, HAPPENINGS));
    }
}
