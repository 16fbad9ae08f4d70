//! The simulated world of one arm pair: a hand, a leader device, a follower with lag, tissue, a noisy sensor.
//!
//! Takes the loop's outputs (N on the hand, commanded tip position in m) and returns what a rig would measure, all in
//! the workspace frame (z up). Deterministic for a seed. Parts that the scene does not list are absent and cost
//! nothing. A command that is not finite is ignored; a force that is not finite counts as zero.

mod measuring;

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::noise::Noise;
use nima_machine::rig::{Inputs, Outputs, Prompt};

use crate::{
    Hand, Tissue, Trocar,
    hand_task::HandTaskPart,
    palpation_task::PalpationTask,
    physics::Instrument,
    scene::{FollowerModel, LeaderModel, Scene, Wall},
    simulated_person::Person,
    wrist::Wrist,
};

/// The simulated world of one arm pair: one hand, one leader, one follower, one sensor.
#[derive(Clone, Debug)]
pub struct World {
    period_s: f64,
    time_s: f64,
    /// When the force on the tip was last measured, s.
    measured_s: f64,
    hand: Hand,
    leader: Option<LeaderModel>,
    follower: Option<FollowerModel>,
    tissue: Option<Tissue>,
    walls: Vec<Wall>,
    sensor_noise_n: Option<(f64, Noise)>,
    wrist: Option<Wrist>,
    trocar: Option<Trocar>,
    trocar_m: Vector3<f64>,
    person: Option<Person>,
    prompt: Prompt,
    true_tip_n: Vector3<f64>,
    tip_m: Vector3<f64>,
    tip_velocity_m_s: Vector3<f64>,
    command_m: Vector3<f64>,
    hand_force_n: Vector3<f64>,
    /// Orientation of the wrist, if an arm outside this world determines it.
    carried: Option<UnitQuaternion<f64>>,
    /// Hands of a person outside this world.
    touch: HandForces,
    /// Whether body wall and tissue have been removed.
    aside: bool,
    /// Whether the instrument has jaws.
    jaws: bool,
    /// Forces on the instrument's jaws, or on the loop at its tip.
    loads: crate::physics::InstrumentLoads,
}

/// Activity of a hand among the objects of a scene.
#[derive(Debug)]
pub(super) enum HandActivity {
    /// The parts of its task with jaws; empty for a hand that follows its targets.
    Carrying(Vec<HandTaskPart>),
    /// The parts of its task with a loop.
    Threading(Vec<HandTaskPart>),
    /// Looking for lumps.
    Searching(Option<(Box<PalpationTask>, Vec<HandTaskPart>)>),
}

/// Forces of a person's hands, N (`world`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandForces {
    /// On the tip, which is pushed onto a rigid object.
    pub tip: Vector3<f64>,
    pub tool: Vector3<f64>,
    /// Force on the stand of the tissue, which the tip does not feel.
    pub stand: Vector3<f64>,
}

/// Maximum time simulated in one exchange, s; after a longer stall the remainder is skipped.
const CATCH_UP_MAX_S: f64 = 0.2;
/// A smaller fraction of a period is not simulated until more is due, because times of the loop are rounded.
pub(super) const ROUNDING_PERIODS: f64 = 1e-3;
/// Maximum integration step of the hand's motion, s; keeps it stable in slow loops.
const HAND_STEP_MAX_S: f64 = 1e-3;

impl World {
    /// Creates the world of `scene` with `rate_hz` steps per second. The scene must have been validated.
    pub fn new(scene: &Scene, rate_hz: f64) -> Self {
        let hand = Hand::new(scene);
        let start_m = hand.position_m();
        Self {
            period_s: 1.0 / rate_hz,
            time_s: 0.0,
            measured_s: 0.0,
            leader: scene.leader,
            follower: scene.follower,
            tissue: Tissue::of(scene, 1.0 / rate_hz),
            walls: scene.walls.clone(),
            sensor_noise_n: scene.sensor.map(|sensor| (sensor.noise_n, Noise::new(scene.seed ^ 0x5e_50))),
            wrist: scene.wrist.as_ref().map(|wrist| Wrist::new(wrist, scene.tissue_sensor, scene.seed ^ 0x77_51)),
            trocar: scene.trocar.map(|trocar| Trocar::new(trocar, scene.trocar_m)),
            trocar_m: scene.trocar_m,
            person: scene.person.map(|person| Person::new(person, scene)),
            prompt: Prompt::Rest,
            true_tip_n: Vector3::zeros(),
            tip_m: start_m,
            tip_velocity_m_s: Vector3::zeros(),
            command_m: start_m,
            hand_force_n: Vector3::zeros(),
            carried: None,
            touch: HandForces::default(),
            aside: false,
            jaws: false,
            loads: crate::physics::InstrumentLoads::default(),
            hand,
        }
    }

    /// Creates the same among objects that it shares with another world.
    pub(super) fn playing(scene: &Scene, rate_hz: f64, doing: HandActivity) -> Self {
        let jaws = matches!(doing, HandActivity::Carrying(_));
        let mut world = Self { jaws, ..Self::new(scene, rate_hz) };
        let hand = match doing {
            HandActivity::Carrying(task) | HandActivity::Threading(task) if task.is_empty() => None,
            HandActivity::Carrying(task) | HandActivity::Threading(task) => Some(Hand::with_task(scene, task)),
            HandActivity::Searching(found) => found.map(|(search, task)| Hand::searching(scene, task, search)),
        };
        if let Some(hand) = hand {
            world.hand = hand;
            world.tip_m = world.hand.position_m();
            world.command_m = world.hand.position_m();
        }
        world
    }

    pub(super) const fn tip_m(&self) -> Vector3<f64> {
        self.tip_m
    }

    /// Returns the pose of the instrument. Its wrist holds the jaws upright.
    pub(super) fn instrument(&self) -> Instrument {
        Instrument {
            tip_m: self.tip_m,
            world_from_jaws: UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI),
            trocar_m: self.trocar_m,
            opening_rad: self.hand.grip_rad(),
        }
    }

    /// Sets the current forces on jaws or loop.
    pub(super) fn feel(&mut self, loads: &crate::physics::InstrumentLoads) {
        self.loads = *loads;
    }

    /// See [`Hand::fraction_pace`].
    pub(super) const fn fraction_pace(&mut self, pace: f64) {
        self.hand.fraction_pace(pace);
    }

    /// Returns the simulated hand, for tests and displays.
    pub const fn hand(&self) -> &Hand {
        &self.hand
    }

    /// Returns the true force on the tip at the last measurement, without sensor errors, N (`world`); known only in a
    /// simulation.
    pub const fn true_tip_n(&self) -> Vector3<f64> {
        self.true_tip_n
    }

    /// Lets an arm outside this world set the orientation of the wrist (`world_from_s1`) from now on. The tip position
    /// is still commanded.
    pub const fn carry(&mut self, world_from_s1: UnitQuaternion<f64>) {
        self.carried = Some(world_from_s1);
    }

    /// Pauses the hand's task, so that the hand follows the tip (true), or resumes it (false).
    pub fn wait(&mut self, waits: bool) {
        // A person at the arm may also guide the handle.
        let beside_m = self.person.as_ref().map_or_else(Vector3::zeros, Person::handle_m);
        self.hand.wait(waits.then_some(self.tip_m + beside_m));
    }

    /// Pauses the hand's task; the hand waits here, m.
    pub fn wait_at(&mut self, position_m: Vector3<f64>) {
        self.hand.wait(Some(position_m));
    }

    /// Sets the touch of a person outside this world from now on, and whether body wall and tissue have been removed. A
    /// seal that is put back is undeformed.
    pub fn touched(&mut self, touch: &HandForces, aside: bool) {
        self.touch = *touch;
        if self.aside && !aside {
            self.trocar.iter_mut().for_each(Trocar::relax);
        }
        self.aside = aside;
    }

    /// Applies the loop's outputs and returns what a rig would measure at loop time `now_s`. Until the follower is
    /// commanded, the hand waits at the tip.
    pub fn exchange(&mut self, now_s: f64, outputs: &Outputs) -> Option<Inputs> {
        self.wait(outputs.tip_command_m.is_none());
        Some(self.advance_to(now_s, outputs))
    }

    /// Like [`exchange`](Self::exchange), but the hand waits only after [`World::wait`].
    pub fn advance_to(&mut self, now_s: f64, outputs: &Outputs) -> Inputs {
        let mut due_s = self.accept(now_s, outputs);
        while due_s > ROUNDING_PERIODS * self.period_s {
            let step_s = due_s.min(self.period_s);
            self.step(step_s);
            due_s -= step_s;
        }
        self.measure()
    }

    /// Takes the loop's outputs; returns the time to be simulated until loop time `now_s`, s. It is exactly the elapsed
    /// time, so that a late tick finds hand and tissue in their current state; whole periods stay whole despite
    /// rounding.
    pub(super) fn accept(&mut self, now_s: f64, outputs: &Outputs) -> f64 {
        self.take(outputs);
        if now_s - self.time_s > CATCH_UP_MAX_S {
            self.time_s = now_s - CATCH_UP_MAX_S;
        }
        let periods = ((now_s - self.time_s) / self.period_s).max(0.0);
        let whole = periods.round();
        self.period_s * if (periods - whole).abs() <= ROUNDING_PERIODS { whole } else { periods }
    }

    fn take(&mut self, outputs: &Outputs) {
        // The force is limited by the leader's motors.
        let max_n = self.leader.map_or(f64::INFINITY, |leader| leader.force_max_n);
        let asked = outputs.hand_force_n;
        let norm = asked.norm();
        self.hand_force_n = if !norm.is_finite() {
            Vector3::zeros()
        } else if norm > max_n {
            asked * (max_n / norm)
        } else {
            asked
        };
        self.command_m = match outputs.tip_command_m {
            Some(command) if command.iter().all(|x| x.is_finite()) => command,
            // Without a command the follower stays where it is.
            _ => self.tip_m,
        };
        self.hand.guide(outputs.guide_m);
        self.hand.let_go(outputs.lets_go);
        self.hand.hold_open(outputs.grip_rad);
        self.prompt = if outputs.prompt.is_finite() { outputs.prompt } else { Prompt::Rest };
    }

    /// Simulates one step of at most a period.
    pub(super) fn step(&mut self, dt_s: f64) {
        let substeps = (dt_s / HAND_STEP_MAX_S).ceil().max(1.0);
        for _ in 0..substeps as u32 {
            self.hand.advance(dt_s / substeps, &self.hand_force_n);
        }
        self.time_s += dt_s;
        match &mut self.person {
            Some(person) => {
                person.advance(&self.prompt, dt_s);
                (self.tip_m, self.tip_velocity_m_s) = person.tip();
            }
            None => self.follow(dt_s),
        }
        if let Some(trocar) = self.trocar.as_mut().filter(|_| !self.aside) {
            trocar.advance(&self.tip_m, dt_s);
        }
    }

    fn follow(&mut self, dt_s: f64) {
        let Some(FollowerModel { bandwidth_hz }) = self.follower else {
            // A command is valid for one period, however soon the next one arrives.
            self.tip_velocity_m_s = (self.command_m - self.tip_m) / dt_s.max(self.period_s);
            self.tip_m = self.command_m;
            return;
        };
        // Critically damped second order, exact over the step for a constant command.
        let omega = std::f64::consts::TAU * bandwidth_hz;
        let offset = self.tip_m - self.command_m;
        let velocity = self.tip_velocity_m_s;
        let decay = (-omega * dt_s).exp();
        let slope = velocity + offset * omega;
        self.tip_m = self.command_m + (offset + slope * dt_s) * decay;
        self.tip_velocity_m_s = (velocity - slope * (omega * dt_s)) * decay;
    }
}

#[cfg(test)]
mod tests;
