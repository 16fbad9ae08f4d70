//! The simulated worlds, with the handle of one side controlled from outside.

use nalgebra::Vector3;
use nima_core::kinematics::Hand;
use nima_machine::rig::{Inputs, Outputs, Rig, SIDES, Side};
use nima_simulation::{Worlds, scene::Leader};

/// Maximum speed at which a controller moves the handle, m/s: the loop treats faster motion as a jump.
pub(super) const FASTEST_M_S: f64 = 1.0;

/// Who controls the handle.
#[derive(Clone, Copy, Debug)]
pub(super) enum Holder {
    /// The simulated hand of the scene.
    Scene,
    /// A controller that sets the position: the current one, and the target after a number of ticks.
    Placed {
        /// Current position, m.
        at_m: Vector3<f64>,
        /// Target position, m.
        to_m: Vector3<f64>,
        /// Remaining ticks.
        ticks: u32,
    },
    /// A controller that applies a force: the handle moves as the mass of hand and handle under this force and the
    /// motors' force.
    Pushed {
        /// Position, m.
        at_m: Vector3<f64>,
        speed_m_s: Vector3<f64>,
        /// Force of the controller on the handle, N.
        force_n: Vector3<f64>,
    },
}

/// The worlds around that handle.
pub(super) struct Handled {
    worlds: Worlds,
    side: Side,
    pub(super) holder: Holder,
    leader: Option<Leader>,
    mass_kg: f64,
    period_s: f64,
    motors_n: Vector3<f64>,
    /// The last measurements of this side.
    pub(super) seen: Option<Inputs>,
}

impl Handled {
    pub(super) const fn new(worlds: Worlds, side: Side, leader: Option<Leader>, mass_kg: f64, period_s: f64) -> Self {
        let holder = Holder::Scene;
        let motors_n = Vector3::new(0.0, 0.0, 0.0);
        Self { worlds, side, holder, leader, mass_kg, period_s, motors_n, seen: None }
    }

    /// Position of the handle, m, if a controller has it.
    pub(super) const fn at_m(&self) -> Option<Vector3<f64>> {
        match self.holder {
            Holder::Scene => None,
            Holder::Placed { at_m, .. } | Holder::Pushed { at_m, .. } => Some(at_m),
        }
    }

    /// Simulates one period of the handle's motion.
    fn go_on(&mut self) {
        let period_s = self.period_s;
        match &mut self.holder {
            Holder::Scene => {}
            Holder::Placed { at_m, to_m, ticks } => {
                let way_m = (*to_m - *at_m) / f64::from((*ticks).max(1));
                let most_m = FASTEST_M_S * period_s;
                let share = if way_m.norm() > most_m { most_m / way_m.norm() } else { 1.0 };
                *at_m += way_m * share;
                *ticks = ticks.saturating_sub(1).max(1);
            }
            Holder::Pushed { at_m, speed_m_s, force_n } => {
                // Semi-implicit Euler, like the simulated hand.
                *speed_m_s += (*force_n + self.motors_n) * (period_s / self.mass_kg);
                if speed_m_s.norm() > FASTEST_M_S {
                    *speed_m_s *= FASTEST_M_S / speed_m_s.norm();
                }
                *at_m += *speed_m_s * period_s;
            }
        }
    }

    /// Returns the position as read by the device.
    fn read_m(&self, at_m: Vector3<f64>) -> Vector3<f64> {
        self.leader.map_or(at_m, |leader| at_m.map(|x| (x / leader.resolution_m).round() * leader.resolution_m))
    }
}

impl Rig for Handled {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        let mut inputs = self.worlds.read(now_s);
        self.go_on();
        let read_m = self.at_m().map(|at_m| self.read_m(at_m));
        let here = &mut inputs[self.side.index()];
        if let (Some(here), Some(read_m)) = (here.as_mut(), read_m) {
            here.hand = Hand::at(read_m);
        }
        self.seen = *here;
        inputs
    }

    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        let asked_n = outputs[self.side.index()].hand_force_n;
        let most_n = self.leader.map_or(f64::INFINITY, |leader| leader.force_max_n);
        self.motors_n = if asked_n.norm() > most_n { asked_n * (most_n / asked_n.norm()) } else { asked_n };
        self.worlds.write(now_s, outputs);
    }
}
