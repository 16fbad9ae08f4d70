//! Tests of the whole: rings among instruments.

mod cost;
mod energy;
mod forces;
mod hostile;
mod repeats;
mod ring_task;
mod setting;
mod transfer;
mod wire;

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{SIDES, Side, task::TaskEvent};

use crate::physics::{Instrument, InstrumentLoads, ObjectSettings, Objects, RingStart, RingWatch};

pub(crate) const LEFT: usize = Side::Left.index();
pub(crate) const RIGHT: usize = Side::Right.index();
/// Wide enough to reach around a tube, rad.
pub(crate) const OPEN_RAD: f64 = 0.6;

pub(crate) fn at(x_m: f64, y_m: f64, z_m: f64) -> Vector3<f64> {
    Vector3::new(x_m, y_m, z_m)
}

pub(crate) fn downwards() -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
}

/// Returns an instrument that points downwards, through a trocar of the scene `bimanual`.
pub(crate) fn instrument(side: usize, tip_m: Vector3<f64>, opening_rad: f64) -> Instrument {
    let trocar_m = at(if side == LEFT { -0.05 } else { 0.05 }, -0.06, 0.14);
    Instrument { tip_m, world_from_jaws: downwards(), trocar_m, opening_rad }
}

pub(crate) fn one_ring(start: RingStart) -> ObjectSettings {
    ObjectSettings { rings: vec![start], ..ObjectSettings::default() }
}

/// Objects, and two hands that a test controls.
pub(crate) struct Scene {
    pub objects: Objects,
    pub hands: [Option<Instrument>; SIDES],
    pub loads: [InstrumentLoads; SIDES],
    pub events: Vec<TaskEvent>,
    /// Realistic hands: tremor, an aiming error of this size, m, and jaws in line with the shaft.
    pub unsure_m: f64,
    ticks: u32,
    watch: RingWatch,
}

impl Scene {
    pub(crate) fn new(setting: &ObjectSettings) -> Self {
        setting.validate().unwrap();
        let objects = Objects::new(setting, 1e-3);
        let watch = RingWatch::new(&objects);
        Self {
            objects,
            hands: [None; SIDES],
            loads: [InstrumentLoads::default(); SIDES],
            events: Vec::new(),
            unsure_m: 0.0,
            ticks: 0,
            watch,
        }
    }

    pub(crate) fn tick(&mut self) {
        let hands = if self.unsure_m > 0.0 { self.trembling() } else { self.hands };
        self.ticks += 1;
        self.loads = self.objects.step(&hands);
        self.watch.look(&self.objects);
        self.events.extend(std::iter::from_fn(|| self.watch.next_event()));
    }

    /// Returns the hands with 0.1 mm of tremor at 8 to 11 Hz (Elble and Koller 1990), and jaws along the shaft: no
    /// wrist.
    fn trembling(&self) -> [Option<Instrument>; SIDES] {
        let t_s = f64::from(self.ticks) * 1e-3;
        let shakes_m = at(libm::sin(50.0 * t_s), libm::sin(61.0 * t_s), libm::sin(69.0 * t_s)) * 1e-4;
        self.hands.map(|hand| {
            let hand = hand?;
            let tip_m = hand.tip_m + shakes_m;
            let tilt = UnitQuaternion::rotation_between(&-Vector3::z(), &(tip_m - hand.trocar_m))?;
            Some(Instrument { tip_m, world_from_jaws: tilt * downwards(), ..hand })
        })
    }

    /// Returns the error of the next aim, m: every direction in turn.
    pub(crate) fn off_m(&self) -> Vector3<f64> {
        let turn = f64::from(self.ticks);
        at(libm::sin(turn), libm::cos(turn), 0.0) * self.unsure_m
    }

    pub(crate) fn run(&mut self, seconds: f64) {
        (0..(seconds * 1e3).round() as u32).for_each(|_| self.tick());
    }

    /// Moves a tip smoothly along a straight line, at this mean speed.
    pub(crate) fn glide(&mut self, side: usize, to_m: Vector3<f64>, speed_m_s: f64) {
        let from_m = self.hands[side].unwrap().tip_m;
        let ticks = ((to_m - from_m).norm() / speed_m_s * 1e3).ceil().max(1.0) as u32;
        for tick in 1..=ticks {
            let fraction = f64::from(tick) / f64::from(ticks);
            let smooth = fraction * fraction * (3.0 - 2.0 * fraction);
            self.hands[side].as_mut().unwrap().tip_m = from_m + (to_m - from_m) * smooth;
            self.tick();
        }
    }

    /// Opens or closes the jaws within 0.15 s: their ends move at about 30 to 60 mm/s.
    pub(crate) fn jaws(&mut self, side: usize, opening_rad: f64) {
        let from_rad = self.hands[side].unwrap().opening_rad;
        for tick in 1..=150 {
            let fraction = f64::from(tick) / 150.0;
            self.hands[side].as_mut().unwrap().opening_rad = from_rad + (opening_rad - from_rad) * fraction;
            self.tick();
        }
        self.run(0.1);
    }

    pub(crate) fn centre_m(&self, ring: usize) -> Vector3<f64> {
        self.objects.rings()[ring].centre_m
    }

    /// Grasps the rim of a ring from above on the side of `x_sign`.
    pub(crate) fn grasp(&mut self, side: usize, ring: usize, x_sign: f64) {
        let rim_m = self.centre_m(ring) + at(x_sign * 0.00725, 0.0, 0.0) + self.off_m();
        let above_m = rim_m + at(0.0, 0.0, 0.03);
        match &mut self.hands[side] {
            Some(_) => self.glide(side, above_m, 0.1),
            hand @ None => *hand = Some(instrument(side, above_m, OPEN_RAD)),
        }
        self.jaws(side, OPEN_RAD);
        self.glide(side, rim_m - at(0.0, 0.0, 0.001), 0.05);
        self.jaws(side, 0.0);
    }
}
