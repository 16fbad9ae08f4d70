//! The simulated worlds, with the handle of one side controlled from outside.

use nalgebra::Vector3;
use nima_core::kinematics::HandPose;
use nima_machine::rig::{Inputs, Outputs, Rig, SIDES, Side};
use nima_simulation::{Worlds, scene::LeaderModel};

/// Maximum speed at which a controller moves the handle, m/s: the loop treats faster motion as a jump.
pub(super) const FASTEST_M_S: f64 = 1.0;

/// Controller of the handle.
#[derive(Clone, Copy, Debug)]
pub(super) enum Holder {
    /// The simulated hand of the scene.
    Scene,
    /// A controller that sets the position: the current one, and the target after a number of ticks.
    Placed {
        /// Current position, m.
        position_m: Vector3<f64>,
        /// Target position, m.
        to_m: Vector3<f64>,
        /// Remaining ticks.
        ticks: u32,
    },
    /// A controller that applies a force: the handle moves as the mass of hand and handle under this force and the
    /// motors' force.
    Pushed {
        /// Position, m.
        position_m: Vector3<f64>,
        speed_m_s: Vector3<f64>,
        /// Force of the controller on the handle, N.
        force_n: Vector3<f64>,
    },
}

/// The worlds around that handle.
pub(super) struct HandleWorlds {
    worlds: Worlds,
    side: Side,
    pub(super) holder: Holder,
    leader: Option<LeaderModel>,
    mass_kg: f64,
    period_s: f64,
    motors_n: Vector3<f64>,
    /// The last measurements of this side.
    pub(super) seen: Option<Inputs>,
}

impl HandleWorlds {
    pub(super) const fn new(
        worlds: Worlds,
        side: Side,
        leader: Option<LeaderModel>,
        mass_kg: f64,
        period_s: f64,
    ) -> Self {
        let holder = Holder::Scene;
        let motors_n = Vector3::new(0.0, 0.0, 0.0);
        Self { worlds, side, holder, leader, mass_kg, period_s, motors_n, seen: None }
    }

    /// Returns the position of the handle, m, if a controller has set it.
    pub(super) const fn position_m(&self) -> Option<Vector3<f64>> {
        match self.holder {
            Holder::Scene => None,
            Holder::Placed { position_m, .. } | Holder::Pushed { position_m, .. } => Some(position_m),
        }
    }

    /// Simulates one period of the handle's motion.
    fn go_on(&mut self) {
        let period_s = self.period_s;
        match &mut self.holder {
            Holder::Scene => {}
            Holder::Placed { position_m, to_m, ticks } => {
                let travel_m = (*to_m - *position_m) / f64::from((*ticks).max(1));
                let max_m = FASTEST_M_S * period_s;
                let fraction = if travel_m.norm() > max_m { max_m / travel_m.norm() } else { 1.0 };
                *position_m += travel_m * fraction;
                *ticks = ticks.saturating_sub(1).max(1);
            }
            Holder::Pushed { position_m, speed_m_s, force_n } => {
                // Semi-implicit Euler, like the simulated hand.
                *speed_m_s += (*force_n + self.motors_n) * (period_s / self.mass_kg);
                if speed_m_s.norm() > FASTEST_M_S {
                    *speed_m_s *= FASTEST_M_S / speed_m_s.norm();
                }
                *position_m += *speed_m_s * period_s;
            }
        }
    }

    /// Returns the position as read by the device.
    fn read_m(&self, position_m: Vector3<f64>) -> Vector3<f64> {
        self.leader
            .map_or(position_m, |leader| position_m.map(|x| (x / leader.resolution_m).round() * leader.resolution_m))
    }
}

impl Rig for HandleWorlds {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        let mut inputs = self.worlds.read(now_s);
        self.go_on();
        let read_m = self.position_m().map(|position_m| self.read_m(position_m));
        let here = &mut inputs[self.side.index()];
        if let (Some(here), Some(read_m)) = (here.as_mut(), read_m) {
            here.hand = HandPose::at(read_m);
        }
        self.seen = *here;
        inputs
    }

    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        let asked_n = outputs[self.side.index()].hand_force_n;
        let max_n = self.leader.map_or(f64::INFINITY, |leader| leader.force_max_n);
        self.motors_n = if asked_n.norm() > max_n { asked_n * (max_n / asked_n.norm()) } else { asked_n };
        self.worlds.write(now_s, outputs);
    }
}
