//! What others see of objects that move: where they are, and what happens to them.

use crossbeam_channel::{Receiver, Sender, bounded};
use nalgebra::Vector3;
use nima_core::task::Happening;
use nima_machine::rig::SIDES;

pub use crate::physics::RINGS_MAX;
use crate::physics::{Loads, RingState};

/// Marks of which a moment tells.
pub const MARKS_MAX: usize = 32;
/// Moments and happenings that wait for each reader; what does not fit is left out. Moments of 5 s: a loop on the virtual clock is 2.5 s
/// ahead of its recorder at most.
const MOMENTS: usize = 512;
const HAPPENINGS: usize = 1024;
/// Who can read: a screen or a score, a recording, and one more.
const READERS: usize = 3;

/// The objects of a scene at one time. Sides are indexed as everywhere.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Time of the loop, s.
    pub t_s: f64,
    /// The rings; none beyond their number, and none that is out of view.
    pub rings: [Option<RingState>; RINGS_MAX],
    /// Angle between the fingers of each instrument, rad.
    pub opening_rad: [f64; SIDES],
    /// What acts on each instrument.
    pub loads: [Loads; SIDES],
    /// What there is besides in a palpation, and with a wire.
    pub training: Training,
}

/// How far a training task has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Training {
    /// The trial is over.
    pub ended: bool,
    /// The places that were marked, in their order; none beyond their number.
    pub marks: [Option<Mark>; MARKS_MAX],
    /// How many were marked in all, and how many different lumps are among them.
    pub marked: u32,
    /// See `marked`. Not for the operator's eyes while the trial lasts.
    pub found: u32,
    /// The loop of each instrument.
    pub loops: [LoopSeen; SIDES],
    /// How often loops touched the wire.
    pub touches: u32,
    /// Share of the way to the goal that is done, 0 to 1.
    pub share: f64,
    /// How often rings were handed over in mid-air, put on pegs, and dropped, in view or out of it.
    pub passed: u32,
    /// See `passed`.
    pub placed: u32,
    /// See `passed`.
    pub dropped: u32,
}

/// A place that was marked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Where, on the tissue at rest, m.
    pub at_m: Vector3<f64>,
    /// Whether a lump lies there. Not for the operator's eyes while the trial lasts.
    pub is_true: bool,
}

/// A loop on a wire.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoopSeen {
    /// It touches the wire.
    pub touches: bool,
    /// The wire goes through it.
    pub on_wire: bool,
}

/// Where moments and happenings of a simulation come out. Nothing in it waits. Each reader has its own, with [`Watched::another`].
#[derive(Debug)]
pub struct Watched {
    moments: Receiver<Moment>,
    happenings: Receiver<Happening>,
    others: Vec<Self>,
}

/// The other end, in the simulation.
#[derive(Clone, Debug)]
pub(super) struct Teller {
    readers: Vec<(Sender<Moment>, Sender<Happening>)>,
}

/// Both ends.
pub(super) fn ends() -> (Teller, Watched) {
    let (first, mut watched) = reader();
    let mut readers = vec![first];
    for _ in 1..READERS {
        let (to, other) = reader();
        readers.push(to);
        watched.others.push(other);
    }
    (Teller { readers }, watched)
}

fn reader() -> ((Sender<Moment>, Sender<Happening>), Watched) {
    let (moments, shown) = bounded(MOMENTS);
    let (happenings, told) = bounded(HAPPENINGS);
    ((moments, happenings), Watched { moments: shown, happenings: told, others: Vec::new() })
}

impl Watched {
    /// The same for another reader, who is told everything too; `None` when there are three already.
    pub fn another(&mut self) -> Option<Self> {
        self.others.pop()
    }

    /// The moments since the last call, oldest first.
    pub fn moments(&self) -> impl Iterator<Item = Moment> + '_ {
        self.moments.try_iter()
    }

    /// The newest moment, if there is a new one.
    pub fn newest(&self) -> Option<Moment> {
        self.moments.try_iter().last()
    }

    /// What has happened since the last call.
    pub fn happenings(&self) -> impl Iterator<Item = Happening> + '_ {
        self.happenings.try_iter()
    }
}

impl Teller {
    pub(super) fn moment(&self, moment: &Moment) {
        for (moments, _) in &self.readers {
            moments.try_send(*moment).ok();
        }
    }

    pub(super) fn happening(&self, happening: Happening) {
        for (_, happenings) in &self.readers {
            happenings.try_send(happening).ok();
        }
    }
}

#[cfg(test)]
mod tests {
    use nima_core::task::Event;

    use super::*;

    #[test]
    fn every_reader_is_told_everything_and_one_who_does_not_read_stops_nobody() {
        let (teller, mut first) = ends();
        let second = first.another().unwrap();
        let third = first.another().unwrap();
        assert!(first.another().is_none());
        let mut moments = [0, 0];
        let mut events = [0, 0];
        let moment = |t_s| Moment {
            t_s,
            rings: [None; RINGS_MAX],
            opening_rad: [0.0; SIDES],
            loads: [Loads::default(); SIDES],
            training: Training::default(),
        };
        for step in 0..2000_u32 {
            let t_s = f64::from(step) * 0.01;
            teller.moment(&moment(t_s));
            teller.happening(Happening { t_s, event: Event::Begun });
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
        teller.moment(&moment(20.0));
        assert!(first.newest().is_some_and(|newest| (newest.t_s - 20.0).abs() < 1e-9));
        assert_eq!((third.moments().count(), third.happenings().count()), (MOMENTS, HAPPENINGS));
    }
}
