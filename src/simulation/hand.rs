//! The surgeon's simulated hand: minimum-jerk movements, tremor, and an elastic grip.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use nima_core::noise::Noise;
use nima_machine::rig::Acts;

use crate::{
    force_response::ForceResponse,
    hand_task::{HandTaskPart, repeated_task},
    palpation_task::PalpationTask,
    scene::{Scene, SceneHand as HandConfig},
};

// Physiological tremor of a hand is at 8 to 12 Hz; three frequencies without a short common period do not repeat
// visibly.
const TREMOR_HZ: [f64; 3] = [8.3, 9.7, 11.6];

/// Maximum speed at which fingers open or close a gripper, rad/s.
const GRIP_RAD_S: f64 = 4.0;
/// Maximum speed, m/s, and acceleration, m/s^2, at which a hand is led from the screen. A hand that moves by itself
/// reaches 4.3 m/s^2 over 30 mm in 0.2 s. Without the limit, a hand that starts in the direction of the force would
/// look like a handle without a hand.
const GUIDE_M_S: f64 = 0.15;
const GUIDE_M_S2: f64 = 2.0;
/// Time constant with which a led hand ends its motion, s.
const ARRIVAL_S: f64 = 0.05;
/// A released handle: its mass, kg, the damping of its bearings, N s/m (an omega.7's, as assumed by the gates), and the
/// limits of its mechanism on each axis, m.
const HANDLE_KG: f64 = 0.25;
const HANDLE_N_S_M: f64 = 0.5;
const HANDLE_STOP_M: f64 = 0.08;
/// Distance from the task's path at which a released hand resumes the task, m.
const CAUGHT_UP_M: f64 = 1e-4;

/// An intended position and its velocity.
#[derive(Clone, Copy, Debug)]
struct Intention {
    position_m: Vector3<f64>,
    velocity_m_s: Vector3<f64>,
}

impl Intention {
    const fn at_rest(position_m: Vector3<f64>) -> Self {
        Self { position_m, velocity_m_s: Vector3::new(0.0, 0.0, 0.0) }
    }

    /// Moves towards `aim`, within the limits of speed and acceleration, so that it ends there without overshoot.
    fn approach(&mut self, aim: Self, dt_s: f64) {
        let travel_m = aim.position_m - self.position_m;
        let distance_m = travel_m.norm();
        // Slow enough to brake within the remaining distance, and to arrive smoothly.
        let speed_m_s = (GUIDE_M_S2 * distance_m).sqrt().min(distance_m / ARRIVAL_S).min(GUIDE_M_S);
        let wanted_m_s = aim.velocity_m_s + travel_m.try_normalize(0.0).unwrap_or_default() * speed_m_s;
        let change_m_s = wanted_m_s - self.velocity_m_s;
        self.velocity_m_s += change_m_s.cap_magnitude(GUIDE_M_S2 * dt_s);
        self.position_m += self.velocity_m_s * dt_s;
    }
}

/// Hand and handle as one mass, connected by a spring and damper to the intended position.
#[derive(Clone, Debug)]
pub struct Hand {
    config: HandConfig,
    task: Vec<HandTaskPart>,
    current: usize,
    in_move_s: f64,
    /// The search that determines its task, in a palpation.
    search: Option<Box<PalpationTask>>,
    /// Response to the force; `None` if it has no force perception.
    feeling: Option<Box<ForceResponse>>,
    /// Pace of its task, and the common pace of both hands if they share a task.
    pace: f64,
    shared_pace: Option<f64>,
    acts: Acts,
    time_s: f64,
    tremor_phase: [[f64; 3]; 3],
    position_m: Vector3<f64>,
    velocity_m_s: Vector3<f64>,
    guide_m: Option<Vector3<f64>>,
    /// Opening of the gripper, rad, and the opening commanded from the screen.
    grip_rad: f64,
    held_open_rad: Option<f64>,
    /// Position at which it waits while the task is paused.
    waits_m: Option<Vector3<f64>>,
    /// Last intention of the hand: its task, or where it is guided.
    intended: Intention,
    /// The hand is guided, or on its way back to the task.
    is_led: bool,
    /// Whether it has released the handle, which then moves freely.
    open: bool,
}

impl Hand {
    /// Creates the hand of `scene`, at rest above its first target.
    pub fn new(scene: &Scene) -> Self {
        Self::with_task(scene, repeated_task(&scene.hand, &scene.targets_m))
    }

    /// Creates the hand of `scene` with this task, which it repeats.
    pub(super) fn with_task(scene: &Scene, mut task: Vec<HandTaskPart>) -> Self {
        for part in &mut task {
            part.way.seconds /= scene.hand.pace;
        }
        let mut noise = Noise::new(scene.seed);
        let tremor_phase = std::array::from_fn(|_| std::array::from_fn(|_| TAU * noise.uniform()));
        let position_m = task.first().map_or_else(Vector3::zeros, |first| first.way.from_m);
        Self {
            config: scene.hand,
            task,
            current: 0,
            in_move_s: 0.0,
            search: None,
            feeling: scene.hand.intended_n.map(|intended_n| Box::new(ForceResponse::new(intended_n, scene.seed))),
            pace: 1.0,
            shared_pace: None,
            acts: Acts::NONE,
            time_s: 0.0,
            tremor_phase,
            position_m,
            velocity_m_s: Vector3::zeros(),
            guide_m: None,
            grip_rad: 0.0,
            held_open_rad: None,
            waits_m: None,
            intended: Intention::at_rest(position_m),
            is_led: false,
            open: false,
        }
    }

    /// Creates the hand of `scene` with a task that depends on the forces that the hand feels.
    pub(super) fn searching(scene: &Scene, task: Vec<HandTaskPart>, search: Box<PalpationTask>) -> Self {
        Self { search: Some(search), ..Self::with_task(scene, task) }
    }

    /// Returns the actions done so far, other than movements.
    pub(super) const fn acts(&self) -> Acts {
        self.acts
    }

    /// Opens the hand (true), or closes it around the handle at the handle's current position (false) and resumes the
    /// task.
    pub fn let_go(&mut self, lets_go: bool) {
        if self.open && !lets_go {
            self.intended = Intention::at_rest(self.position_m);
            self.is_led = true;
            self.velocity_m_s = Vector3::zeros();
        }
        self.open = lets_go;
    }

    /// Leads the hand to this position instead of its task; `None` resumes the task. The intended position is
    /// continuous in both cases.
    pub fn guide(&mut self, guide_m: Option<Vector3<f64>>) {
        self.guide_m = guide_m.filter(|position_m| position_m.iter().all(|x| x.is_finite()));
        self.is_led |= self.guide_m.is_some();
    }

    /// Holds the gripper at this opening, rad; `None` follows the task, or keeps the opening while the hand is led.
    pub(super) fn hold_open(&mut self, grip_rad: Option<f64>) {
        self.held_open_rad = grip_rad.filter(|rad| rad.is_finite());
    }

    pub(super) const fn grip_rad(&self) -> f64 {
        self.grip_rad
    }

    /// Makes the hand wait at this position instead of performing its task; `None` resumes the task. The intended
    /// position is continuous in both cases.
    pub(super) fn wait(&mut self, waits_m: Option<Vector3<f64>>) {
        self.waits_m = waits_m;
        self.is_led |= waits_m.is_some();
    }

    /// Returns the position to which the hand is led, or at which it waits; leading takes precedence.
    fn aside_m(&self) -> Option<Vector3<f64>> {
        self.guide_m.or(self.waits_m)
    }

    /// Advances what the hand intends: its task, or where it is guided.
    fn intend(&mut self, dt_s: f64) -> Intention {
        let (task_m, task_m_s) = self.task[self.current].way.at(self.in_move_s);
        let offset_m = self.feeling.as_ref().map_or_else(Vector3::zeros, |feeling| feeling.offset_m());
        let task = Intention { position_m: task_m + offset_m, velocity_m_s: task_m_s * self.pace };
        if self.is_led {
            let aside_m = self.aside_m();
            let aim = aside_m.map_or(task, Intention::at_rest);
            self.intended.approach(aim, dt_s);
            self.is_led = aside_m.is_some() || (aim.position_m - self.intended.position_m).norm() > CAUGHT_UP_M;
            return self.intended;
        }
        self.intended = task;
        Intention { position_m: task.position_m + self.tremor_m(), ..task }
    }

    /// Returns the position of hand and handle, m.
    pub const fn position_m(&self) -> Vector3<f64> {
        self.position_m
    }

    /// Advances by `dt_s` with this force (N) of the handle on the hand.
    pub fn advance(&mut self, dt_s: f64, force_n: &Vector3<f64>) {
        self.time_s += dt_s;
        if self.open {
            return self.fly(dt_s, force_n);
        }
        let felt = self.feel(dt_s, force_n);
        self.pace = self.shared_pace.unwrap_or(felt);
        if self.aside_m().is_none() {
            self.in_move_s += dt_s * self.pace;
            if let Some(search) = &mut self.search {
                search.feel(self.current, &self.position_m, force_n);
            }
        }
        if self.in_move_s >= self.task[self.current].way.seconds {
            self.go_on();
        }
        let task_rad = if self.is_led { self.grip_rad } else { self.task[self.current].grip_rad_at(self.in_move_s) };
        let step_rad = GRIP_RAD_S * dt_s;
        self.grip_rad += (self.held_open_rad.unwrap_or(task_rad) - self.grip_rad).clamp(-step_rad, step_rad);
        let intended = self.intend(dt_s);
        let HandConfig { mass_kg, grip_stiffness_n_m, grip_damping_n_s_m, .. } = self.config;
        let grip_n = (intended.position_m - self.position_m) * grip_stiffness_n_m
            + (intended.velocity_m_s - self.velocity_m_s) * grip_damping_n_s_m;
        // Semi-implicit Euler: stable for these stiffnesses at 1 ms.
        self.velocity_m_s += (grip_n + force_n) * (dt_s / mass_kg);
        self.position_m += self.velocity_m_s * dt_s;
    }

    /// Returns the pace that its force perception permits.
    pub(super) fn felt_pace(&self) -> f64 {
        self.feeling.as_ref().map_or(1.0, |feeling| feeling.pace())
    }

    /// Sets the pace shared with the other hand: in a task of both hands, neither may run ahead.
    pub(super) const fn fraction_pace(&mut self, pace: f64) {
        self.shared_pace = Some(pace);
    }

    /// Processes this force (N); returns the pace of the task.
    fn feel(&mut self, dt_s: f64, force_n: &Vector3<f64>) -> f64 {
        let Some(feeling) = &mut self.feeling else { return 1.0 };
        let pace = feeling.feel(force_n, dt_s);
        if !self.is_led {
            return pace;
        }
        feeling.rest();
        1.0
    }

    /// Advances to the next part of the task.
    fn go_on(&mut self) {
        if let Some(act) = self.task[self.current].then {
            self.acts.note(act);
        }
        self.in_move_s = 0.0;
        if let Some(feeling) = &mut self.feeling {
            feeling.judge_anew();
        }
        self.current = (self.current + 1) % self.task.len();
        if let Some(search) = &mut self.search {
            self.current = search.onward(self.current, &mut self.task);
        }
    }

    /// Moves the free handle, up to the end of its mechanism.
    fn fly(&mut self, dt_s: f64, force_n: &Vector3<f64>) {
        self.velocity_m_s += (force_n - self.velocity_m_s * HANDLE_N_S_M) * (dt_s / HANDLE_KG);
        let free_m = self.position_m + self.velocity_m_s * dt_s;
        self.position_m = free_m.map(|x| x.clamp(-HANDLE_STOP_M, HANDLE_STOP_M));
        // A handle does not bounce off its stop.
        self.velocity_m_s.zip_apply(&(self.position_m - free_m), |speed, beyond| {
            if beyond != 0.0 {
                *speed = 0.0;
            }
        });
    }

    fn tremor_m(&self) -> Vector3<f64> {
        if self.config.tremor_m == 0.0 {
            return Vector3::zeros();
        }
        // The three waves together have the mean square of one wave of this amplitude.
        let amplitude_m = self.config.tremor_m / (TREMOR_HZ.len() as f64).sqrt();
        Vector3::from_fn(|axis, _| {
            let waves = TREMOR_HZ.iter().zip(&self.tremor_phase[axis]);
            amplitude_m * waves.map(|(hz, phase)| (TAU * hz * self.time_s + phase).sin()).sum::<f64>()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand_task::CARRY_HEIGHT_M;

    #[test]
    fn a_led_hand_goes_where_it_is_led_and_back_to_its_task_without_a_jump() {
        let mut hand = Hand::new(&Scene::load("free_motion").unwrap());
        let mut last_m = hand.position_m();
        let mut fastest_m_s = 0.0_f64;
        let aim_m = Vector3::new(0.04, -0.03, 0.01);
        for tick in 0..6000 {
            hand.guide((1000..3000).contains(&tick).then_some(aim_m));
            hand.advance(1e-3, &Vector3::zeros());
            fastest_m_s = fastest_m_s.max((hand.position_m() - last_m).norm() / 1e-3);
            last_m = hand.position_m();
            assert!(tick != 2999 || (last_m - aim_m).norm() < 1e-3, "{last_m}");
        }
        assert!(fastest_m_s < 0.4, "{fastest_m_s} m/s");
        assert!(!hand.is_led, "it has taken up its task");
    }

    /// With 8 m/s^2 and more, the governor would take such a hand for a released handle.
    #[test]
    fn a_hand_that_presses_does_not_yield_when_it_begins_to_be_led() {
        for (aim_m, guided) in [(0.04, true), (-0.04, true), (0.0, false)] {
            let mut scene = Scene::load("free_motion").unwrap();
            scene.hand.press_depth_m = -CARRY_HEIGHT_M;
            scene.hand.press_s = 100.0;
            let mut hand = Hand::new(&scene);
            let force_n = Vector3::new(0.0, 0.0, 3.0);
            for _ in 0..2000 {
                hand.advance(1e-3, &force_n);
            }
            let mut worst_m_s2 = 0.0_f64;
            for _ in 0..500 {
                let aim_m = hand.position_m() + Vector3::z() * aim_m;
                if guided {
                    hand.guide(Some(aim_m));
                } else {
                    hand.wait(Some(aim_m));
                }
                let before_m_s = hand.velocity_m_s;
                hand.advance(1e-3, &force_n);
                worst_m_s2 = worst_m_s2.max((hand.velocity_m_s - before_m_s).norm() / 1e-3);
            }
            assert!(worst_m_s2 < 4.3, "{worst_m_s2} m/s^2 towards {aim_m} m");
        }
    }

    #[test]
    fn twice_the_pace_takes_half_the_time() {
        let mut scene = Scene::load("free_motion").unwrap();
        scene.hand.tremor_m = 0.0;
        let slow = Hand::new(&scene);
        scene.hand.pace = 2.0;
        let fast = Hand::new(&scene);
        let seconds = |hand: &Hand| hand.task.iter().map(|part| part.way.seconds).sum::<f64>();
        assert!(seconds(&slow) > 1.0 && (seconds(&slow) / seconds(&fast) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_person_who_feels_more_than_intended_slows_down_and_gives_way() {
        let mut scene = Scene::load("free_motion").unwrap();
        scene.hand.tremor_m = 0.0;
        scene.hand.press_s = 2.0;
        let mut after = |intended_n: Option<f64>, force_n: f64| {
            scene.hand.intended_n = intended_n;
            let mut hand = Hand::new(&scene);
            for _ in 0..2100 {
                hand.advance(1e-3, &Vector3::new(0.0, 0.0, force_n));
            }
            (hand.current, hand.position_m().z)
        };
        let blind = after(None, 3.0);
        let feeling = after(Some(1.0), 3.0);
        assert_eq!((blind.0, feeling.0), (1, 0), "slower than the task");
        assert!(feeling.1 > blind.1 + 0.005, "higher: {feeling:?} and {blind:?}");
        assert_eq!(after(Some(1.0), 0.5), after(None, 0.5), "a force below the intended one has no effect");
    }

    #[test]
    fn the_grip_gives_way_by_force_over_stiffness() {
        let mut scene = Scene::load("free_motion").unwrap();
        scene.hand.tremor_m = 0.0;
        scene.hand.press_s = 100.0;
        scene.hand.press_depth_m = -CARRY_HEIGHT_M;
        let mut hand = Hand::new(&scene);
        let start = hand.position_m();
        for _ in 0..3000 {
            hand.advance(1e-3, &Vector3::new(0.0, 0.0, 3.0));
        }
        let given_m = hand.position_m().z - start.z;
        assert!((given_m - 3.0 / scene.hand.grip_stiffness_n_m).abs() < 1e-5, "{given_m}");
    }
}
