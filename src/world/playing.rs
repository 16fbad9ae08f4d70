//! Both instruments of a simulation among the objects that they share.

use nima_machine::rig::{SIDES, Side};
use nima_physics::{Doing, Instrument, Loads, Objects, PegTransfer, Setting, Watch};
use nima_score::{Event, Happening};

use crate::watched::{Moment, RINGS_MAX, Teller};

/// The screen is told of a moment every so many s.
const MOMENT_EVERY_S: f64 = 1.0 / 60.0;

/// The objects, what happens to them, and whether the task is done.
#[derive(Clone, Debug)]
pub(super) struct Playing {
    objects: Objects,
    watch: Watch,
    task: PegTransfer,
    is_done: bool,
    told_s: f64,
    teller: Teller,
}

/// The place of a side among the objects.
const fn place(side: Side) -> usize {
    match side {
        Side::Left => 0,
        Side::Right => 1,
    }
}

impl Playing {
    pub(super) fn new(setting: &Setting, period_s: f64, teller: Teller) -> Self {
        let objects = Objects::new(setting, period_s);
        let (watch, task) = (Watch::new(&objects), PegTransfer::new(setting));
        Self { objects, watch, task, is_done: false, told_s: f64::NEG_INFINITY, teller }
    }

    /// One period, at whose end it is `t_s` by the loop's clock and the instruments are here.
    pub(super) fn step(&mut self, t_s: f64, instruments: &[Option<Instrument>; SIDES]) -> [Loads; SIDES] {
        let mut placed = [None; SIDES];
        for side in Side::ALL {
            placed[place(side)] = instruments[side.index()];
        }
        let felt = self.objects.step(&placed);
        let mut loads = [Loads::default(); SIDES];
        for side in Side::ALL {
            loads[side.index()] = felt[place(side)];
        }
        self.watch.look(&self.objects);
        while let Some(event) = self.watch.next_event() {
            self.teller.happening(Happening { t_s, event });
            self.task.take(event);
        }
        if self.task.is_done() && !self.is_done {
            self.is_done = true;
            self.teller.happening(Happening { t_s, event: Event::Ended });
        }
        if t_s - self.told_s >= MOMENT_EVERY_S {
            self.told_s = t_s;
            self.teller.moment(&self.moment(t_s, loads));
        }
        loads
    }

    fn moment(&self, t_s: f64, loads: [Loads; SIDES]) -> Moment {
        let mut rings = [None; RINGS_MAX];
        for (place, ring) in rings.iter_mut().zip(self.objects.rings()) {
            *place = (ring.doing != Doing::OutOfView).then_some(*ring);
        }
        let mut opening_rad = [0.0; SIDES];
        for side in Side::ALL {
            opening_rad[side.index()] = self.objects.openings_rad()[place(side)].unwrap_or(0.0);
        }
        Moment { t_s, rings, opening_rad, loads }
    }
}
