//! A simulated person at the arm who follows the instructions of a calibration, correctly or with a deliberate mistake.

mod handling;
mod workspace;

use std::f64::consts::TAU;

use nalgebra::{UnitQuaternion, UnitVector3, Vector3};
use nima_core::noise::Noise;
use nima_machine::rig::Prompt;

use self::{
    handling::{PoseMotion, is_handling},
    workspace::Workspace,
};
use super::{hand_task::HandMove, trocar::shaft, world::HandForces, wrist::along_shaft};
use crate::scene::{Flaw, PersonModel as PersonConfig, Scene};

/// Speed at which the tool is rotated, rad/s, and minimum duration of a rotation, s.
const TURN_RAD_S: f64 = 1.2;
const TURN_MIN_S: f64 = 0.5;
/// One push: durations of rise, hold, fall and pause, s.
const PUSH_S: [f64; 4] = [0.45, 0.5, 0.35, 0.4];
/// Range of the peak force of a push, N.
const PUSH_N: [f64; 2] = [2.0, 4.0];
/// Error of a push's direction, rad (standard deviation).
const PUSH_MISSES_RAD: f64 = 0.08;
/// Range of the height at which the tip is moved, m.
const CARRY_M: [f64; 2] = [0.004, 0.025];
/// Range of the duration of one movement while working, s: slow enough that inertia can be neglected.
const REACH_S: [f64; 2] = [0.5, 1.6];
/// Fraction of the movements that are strokes in and out at the speed of a task; range of their peak speed, m/s, and of
/// the starting height, m; minimum duration, s.
const STROKES: f64 = 0.35;
const STROKE_M_S: [f64; 2] = [0.08, 0.16];
const STROKE_FROM_M: [f64; 2] = [0.020, 0.040];
const STROKE_MIN_S: f64 = 0.25;
/// Peak speed of a minimum-jerk movement over its mean speed.
const PEAK: f64 = 1.875;
/// Time in which the tip is lifted off the tissue when work ends, s.
const LIFT_S: f64 = 0.8;

/// A person who guides the arm and follows each [`Prompt`].
#[derive(Clone, Debug)]
pub struct Person {
    flaw: Option<Flaw>,
    noise: Noise,
    wall_m: Option<Vector3<f64>>,
    surface_z_m: f64,
    workspace: Workspace,
    prompt: Prompt,
    time_s: f64,
    world_from_s1: UnitQuaternion<f64>,
    turn: (UnitQuaternion<f64>, UnitQuaternion<f64>),
    turn_s: f64,
    in_turn_s: f64,
    tip_m: Vector3<f64>,
    velocity_m_s: Vector3<f64>,
    reach: HandMove,
    in_reach_s: f64,
    in_push_s: f64,
    push: Vector3<f64>,
    stand: Vector3<f64>,
    touch_n: Vector3<f64>,
    handling: PoseMotion,
}

impl Person {
    /// Creates a person at the arm of `scene`, holding the tip above the middle of the tissue.
    pub fn new(config: PersonConfig, scene: &Scene) -> Self {
        let mut noise = Noise::new(scene.seed ^ 0x9e_12);
        let surface_z_m = scene.tissue.map_or(0.0, |tissue| tissue.surface_z_m);
        let tip_m = Vector3::new(0.0, 0.0, surface_z_m + CARRY_M[1]);
        let wall_m = scene.trocar.map(|_| scene.trocar_m);
        let down = along_shaft(&wall_m.map_or_else(|| -Vector3::z(), |wall_m| shaft(&wall_m, &tip_m).0));
        let touch_n = Vector3::from_fn(|_, _| noise.gaussian()).normalize();
        let handling = PoseMotion::new(Noise::new(scene.seed ^ 0xf4_a3), tip_m, down);
        Self {
            flaw: config.flaw,
            noise,
            wall_m,
            surface_z_m,
            workspace: Workspace::of(scene),
            prompt: Prompt::Rest,
            time_s: 0.0,
            world_from_s1: down,
            turn: (down, down),
            turn_s: 0.0,
            in_turn_s: 0.0,
            tip_m,
            velocity_m_s: Vector3::zeros(),
            reach: HandMove { from_m: tip_m, to_m: tip_m, seconds: 0.0 },
            in_reach_s: 0.0,
            in_push_s: f64::INFINITY,
            push: Vector3::zeros(),
            stand: Vector3::zeros(),
            touch_n,
            handling,
        }
    }

    /// Sets the initial position of the tip (m), through the body wall.
    #[must_use]
    pub fn begins_at(mut self, tip_m: Vector3<f64>) -> Self {
        self.tip_m = tip_m;
        self.lift_off();
        self.reach_on(0.0);
        self
    }

    pub const fn world_from_s1(&self) -> UnitQuaternion<f64> {
        self.world_from_s1
    }

    /// Returns the position (m) and velocity (m/s) of the tip.
    pub const fn tip(&self) -> (Vector3<f64>, Vector3<f64>) {
        (self.tip_m, self.velocity_m_s)
    }

    /// Returns the forces of the person's hands.
    pub fn touch(&self) -> HandForces {
        HandForces { tip: self.push_n(), tool: self.touch_n(), stand: self.stand_n() }
    }

    /// Returns the force on the tip from pushing, N (`world`).
    fn push_n(&self) -> Vector3<f64> {
        self.push * pulse(self.in_push_s)
    }

    /// Returns the force on the tissue's stand that the tip does not feel, N (`world`).
    fn stand_n(&self) -> Vector3<f64> {
        let working = matches!(self.prompt, Prompt::Work);
        let fraction = if working { pulse(PUSH_S[0] * self.in_reach_s / REACH_S[0]) } else { pulse(self.in_push_s) };
        self.stand * fraction
    }

    /// Returns the force of a hand on the tool, N (`world`).
    fn touch_n(&self) -> Vector3<f64> {
        let holds = matches!(self.prompt, Prompt::Hold { .. } | Prompt::Wave);
        if self.flaw == Some(Flaw::Touches) && holds {
            // The force of a resting hand varies.
            return self.touch_n * (1.2 + 0.5 * (0.9 * self.time_s).sin());
        }
        Vector3::zeros()
    }

    /// Advances by `dt_s`, following the instruction.
    pub fn advance(&mut self, prompt: &Prompt, dt_s: f64) {
        self.time_s += dt_s;
        if *prompt != self.prompt {
            self.begin(prompt);
        }
        match self.prompt {
            Prompt::Rest if self.wall_m.is_some() => self.reach_on(dt_s),
            Prompt::Rest | Prompt::Hold { .. } => self.turn(dt_s),
            Prompt::Wave => self.wave(),
            Prompt::Push { direction } => self.push(&direction, dt_s),
            Prompt::Work => self.work(true, dt_s),
            Prompt::WorkFree => self.work(false, dt_s),
            _ => self.handle(dt_s),
        }
    }

    fn begin(&mut self, prompt: &Prompt) {
        let handled = is_handling(&self.prompt);
        self.prompt = *prompt;
        self.push = Vector3::zeros();
        self.stand = Vector3::zeros();
        self.in_push_s = f64::INFINITY;
        self.velocity_m_s = Vector3::zeros();
        self.in_reach_s = f64::INFINITY;
        if handled || is_handling(prompt) {
            self.begin_handling();
        }
        if *prompt == Prompt::Rest && self.wall_m.is_some() {
            self.lift_off();
        }
        if let Prompt::Hold { world_from_s1 } = *prompt
            && self.flaw != Some(Flaw::KeepsOneOrientation)
            && self.wall_m.is_none()
        {
            // A person does not reach an orientation exactly.
            let miss = Vector3::from_fn(|_, _| 0.05 * self.noise.gaussian());
            self.turn_to(world_from_s1 * UnitQuaternion::from_scaled_axis(miss));
        }
    }

    /// Lifts the tip off the tissue, because a person does not rest with the tip in it.
    fn lift_off(&mut self) {
        let clear_z_m = self.surface_z_m + CARRY_M[0];
        let to_m = Vector3::new(self.tip_m.x, self.tip_m.y, self.tip_m.z.max(clear_z_m));
        self.reach = HandMove { from_m: self.tip_m, to_m, seconds: LIFT_S };
        self.in_reach_s = 0.0;
    }

    fn turn_to(&mut self, target: UnitQuaternion<f64>) {
        self.turn = (self.world_from_s1, target);
        self.turn_s = (self.world_from_s1.angle_to(&target) / TURN_RAD_S).max(TURN_MIN_S);
        self.in_turn_s = 0.0;
    }

    fn turn(&mut self, dt_s: f64) {
        self.in_turn_s = (self.in_turn_s + dt_s).min(self.turn_s);
        let s = if self.turn_s > 0.0 { self.in_turn_s / self.turn_s } else { 1.0 };
        let fraction = s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
        let (from, to) = self.turn;
        // For a half turn the shortest rotation is undefined; any rotation will do.
        self.world_from_s1 = from.try_slerp(&to, fraction, 1e-9).unwrap_or(to);
        if self.flaw == Some(Flaw::Trembles) && matches!(self.prompt, Prompt::Hold { .. }) {
            let shake = Vector3::new((TAU * 2.3 * self.time_s).sin(), (TAU * 3.1 * self.time_s).cos(), 0.0) * 0.06;
            self.world_from_s1 = to * UnitQuaternion::from_scaled_axis(shake);
        }
    }

    /// A slow periodic motion through many tilts.
    fn wave(&mut self) {
        let t = self.time_s;
        let tilt = Vector3::new(1.1 * (0.9 * t).sin(), 1.0 * (0.67 * t + 0.4).sin(), 0.8 * (0.41 * t).sin());
        let target = along_shaft(&-Vector3::z()) * UnitQuaternion::from_scaled_axis(tilt);
        // Approach the target from the current orientation without a jump.
        self.world_from_s1 = self.world_from_s1.try_slerp(&target, 0.004, 1e-9).unwrap_or(target);
        self.turn = (self.world_from_s1, self.world_from_s1);
    }

    fn push(&mut self, direction: &UnitVector3<f64>, dt_s: f64) {
        self.in_push_s += dt_s;
        if self.in_push_s > PUSH_S.iter().sum() {
            self.in_push_s = 0.0;
            let asked = match self.flaw {
                Some(Flaw::PushesOneLine) => -Vector3::z(),
                Some(Flaw::PushesOnePlane) => Vector3::new(direction.x, 0.0, direction.z),
                _ => direction.into_inner(),
            };
            let misses_rad = if self.flaw == Some(Flaw::PushesOneLine) { 0.01 } else { PUSH_MISSES_RAD };
            let mut miss = Vector3::from_fn(|_, _| misses_rad * self.noise.gaussian());
            if self.flaw == Some(Flaw::PushesOnePlane) {
                miss.y *= 0.1;
            }
            // If the target is out of that plane, this person pushes in some direction within it.
            let asked = if asked.norm() < 0.1 { self.somewhere_down() } else { asked.normalize() };
            self.push = -(asked + miss).normalize() * self.between(PUSH_N);
            if self.flaw == Some(Flaw::LeansOnTheStand) {
                self.lean();
            }
            // The tool is held at a slightly different tilt in each push.
            let tilt = Vector3::from_fn(|_, _| 0.25 * self.noise.gaussian());
            self.turn_to(along_shaft(&-Vector3::z()) * UnitQuaternion::from_scaled_axis(tilt));
        }
        self.turn(dt_s);
    }

    /// Supports itself on the tissue's frame in about every other push; the others are correct.
    fn lean(&mut self) {
        let leans_n = if self.noise.uniform() < 0.5 { 1.2 } else { 0.0 };
        self.stand = Vector3::from_fn(|_, _| leans_n * self.noise.gaussian());
    }

    /// Returns a random direction in the lower half of the x-z plane.
    fn somewhere_down(&mut self) -> Vector3<f64> {
        let angle = self.between([0.0, std::f64::consts::PI]);
        Vector3::new(angle.cos(), 0.0, -angle.sin())
    }

    fn between(&mut self, [from, to]: [f64; 2]) -> f64 {
        from + (to - from) * self.noise.uniform()
    }

    /// Moves from place to place; with contact, more than half of them are in the tissue.
    fn work(&mut self, contact: bool, dt_s: f64) {
        self.in_reach_s += dt_s;
        if self.in_reach_s >= self.reach.seconds {
            if self.flaw == Some(Flaw::LeansOnTheStand) {
                self.lean();
            }
            let stroke = self.flaw != Some(Flaw::WorksInOnePlace) && self.noise.uniform() < STROKES;
            self.reach = if stroke { self.stroke(contact) } else { self.reach(contact) };
            self.in_reach_s = 0.0;
        }
        self.reach_on(0.0);
    }

    /// Starts a slow movement to another position.
    fn reach(&mut self, contact: bool) -> HandMove {
        let z_m = if contact && self.noise.uniform() < 0.6 { self.pressed_m() } else { self.between(CARRY_M) };
        // Pause at times, so that static friction of the seal is recorded too.
        let stay = self.noise.uniform() < 0.2;
        let reach = if self.flaw == Some(Flaw::WorksInOnePlace) { 0.1 } else { 1.0 };
        let [x_m, y_m] = self.workspace.across_m.map(|[low_m, high_m]| {
            f64::midpoint(low_m, high_m) + reach * (high_m - low_m) * (self.noise.uniform() - 0.5)
        });
        let to_m = if stay { self.tip_m } else { Vector3::new(x_m, y_m, self.surface_z_m + z_m) };
        HandMove { from_m: self.tip_m, to_m, seconds: self.between(REACH_S) }
    }

    /// Starts a fast stroke at this position: down from a height, or up from below.
    fn stroke(&mut self, contact: bool) -> HandMove {
        let is_up = self.tip_m.z - self.surface_z_m > 0.5 * (CARRY_M[0] + CARRY_M[1]);
        let z_m = match (is_up, contact) {
            (false, _) => self.between(STROKE_FROM_M),
            (true, true) => self.pressed_m(),
            (true, false) => CARRY_M[0],
        };
        let to_m = Vector3::new(self.tip_m.x, self.tip_m.y, self.surface_z_m + z_m);
        let seconds = (PEAK * (to_m - self.tip_m).norm() / self.between(STROKE_M_S)).max(STROKE_MIN_S);
        HandMove { from_m: self.tip_m, to_m, seconds }
    }

    /// Returns the height of a press into the tissue, m.
    fn pressed_m(&mut self) -> f64 {
        -self.between(self.workspace.press_m)
    }

    /// Continues the current movement; the shaft always points through the trocar.
    fn reach_on(&mut self, dt_s: f64) {
        self.in_reach_s += dt_s;
        (self.tip_m, self.velocity_m_s) = self.reach.at(self.in_reach_s);
        if let Some(wall_m) = self.wall_m {
            self.world_from_s1 = along_shaft(&shaft(&wall_m, &self.tip_m).0);
        }
    }
}

/// Returns the force of a push over its duration: 0 to 1 to 0 (raised cosines).
fn pulse(t_s: f64) -> f64 {
    let [rise_s, hold_s, fall_s, _] = PUSH_S;
    let smooth = |s: f64| 0.5 - 0.5 * (std::f64::consts::PI * s).cos();
    match t_s {
        t if t < rise_s => smooth(t / rise_s),
        t if t < rise_s + hold_s => 1.0,
        t if t < rise_s + hold_s + fall_s => 1.0 - smooth((t - rise_s - hold_s) / fall_s),
        _ => 0.0,
    }
}
