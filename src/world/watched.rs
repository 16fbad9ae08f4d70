//! What the screen sees of objects that move: where they are, and what happens to them.

use crossbeam_channel::{Receiver, Sender, bounded};
use nalgebra::Vector3;
use nima_machine::rig::SIDES;
use nima_physics::{Loads, RingState};
use nima_score::Happening;

/// Rings of which a moment tells.
pub const RINGS_MAX: usize = 12;
/// Marks of which a moment tells.
pub const MARKS_MAX: usize = 32;
/// Moments and happenings that wait for a screen; what does not fit is left out.
const MOMENTS: usize = 4;
const HAPPENINGS: usize = 1024;

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

/// How far a training task has come that is not one of rings.
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

/// Where moments and happenings of a simulation come out. Nothing in it waits.
#[derive(Clone, Debug)]
pub struct Watched {
    moments: Receiver<Moment>,
    happenings: Receiver<Happening>,
}

/// The other end, in the simulation.
#[derive(Clone, Debug)]
pub(super) struct Teller {
    moments: Sender<Moment>,
    happenings: Sender<Happening>,
}

/// Both ends.
pub(super) fn ends() -> (Teller, Watched) {
    let (moments, shown) = bounded(MOMENTS);
    let (happenings, told) = bounded(HAPPENINGS);
    (Teller { moments, happenings }, Watched { moments: shown, happenings: told })
}

impl Watched {
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
        self.moments.try_send(*moment).ok();
    }

    pub(super) fn happening(&self, happening: Happening) {
        self.happenings.try_send(happening).ok();
    }
}
