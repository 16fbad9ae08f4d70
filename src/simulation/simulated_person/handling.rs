//! How a person handles the tool for the frame calibrations: holding poses, pivoting in the trocar, touching the table,
//! and moving in the image. Positions in m, `world`.

use std::f64::consts::TAU;

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{calibration::frames::ViewMove as Way, noise::Noise};
use nima_machine::rig::Prompt;

use super::{Person, REACH_S, TURN_RAD_S};
use crate::{hand_task::HandMove, scene::Flaw, trocar::shaft};

/// Duration of holding a pose, s: longer than a session requires.
const HELD_S: f64 = 1.0;
/// Minimum duration of the movement to the next pose, s, and speed of the tip, m/s.
const WAY_MIN_S: f64 = 0.6;
const TRAVEL_M_S: f64 = 0.08;
/// Tilts to all sides, and rotations about the shaft in both directions, rad.
const TILT_RAD: f64 = 25.0 * TAU / 360.0;
const SPIN_RAD: f64 = 50.0 * TAU / 360.0;
/// In the trocar: tilts from the straight line to the middle of the tissue, rad, and depths, m.
const PIVOT_RAD: f64 = 20.0 * TAU / 360.0;
const DEPTH_M: [f64; 2] = [0.07, 0.17];
/// The tip stays this far above the tissue, m.
const CLEAR_M: f64 = 0.004;
/// Space of the poses for the hand-eye calibration: half widths, and heights, m.
const ROOM_M: [f64; 2] = [0.04, 0.04];
const ROOM_Z_M: [f64; 2] = [0.04, 0.10];
/// Touched points of the table, m: the origin, a point along x, a point on the side of y, and further ones.
const TABLE_M: [[f64; 2]; 6] = [[0.0, 0.0], [0.08, 0.0], [0.0, 0.06], [0.07, 0.06], [-0.05, -0.02], [0.05, -0.05]];
/// The tip is lifted by this much between two points, m.
const LIFT_M: f64 = 0.015;
/// A person's errors, per axis: the tip in its dimple, a touch, and the end of a move, m.
const DIMPLE_MISS_M: f64 = 0.05e-3;
const TOUCH_MISS_M: f64 = 0.15e-3;
const WAY_MISS_M: f64 = 1.0e-3;
/// Length of a move in the image, m.
const TRAVEL_M: f64 = 0.03;

/// Position of the tip and orientation of the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::simulated_person) struct ToolPose {
    pub(in crate::simulated_person) tip_m: Vector3<f64>,
    pub(in crate::simulated_person) world_from_s1: UnitQuaternion<f64>,
}

/// The current movement from one pose to the next.
#[derive(Clone, Debug)]
pub(super) struct PoseMotion {
    noise: Noise,
    /// Orientation of the tool in a comfortable grip.
    reference: UnitQuaternion<f64>,
    world_from_view: UnitQuaternion<f64>,
    from: ToolPose,
    to: ToolPose,
    way_s: f64,
    in_way_s: f64,
    lift_m: f64,
    /// Whether a pose was chosen that has not been read by [`Person::chosen`] yet.
    is_new: bool,
    /// Position of the handle, relative to its position when the person arrived, m.
    handle: HandMove,
}

impl PoseMotion {
    pub(super) fn new(noise: Noise, tip_m: Vector3<f64>, world_from_s1: UnitQuaternion<f64>) -> Self {
        let here = ToolPose { tip_m, world_from_s1 };
        let at_rest = HandMove { from_m: Vector3::zeros(), to_m: Vector3::zeros(), seconds: 0.0 };
        Self {
            noise,
            reference: world_from_s1,
            world_from_view: UnitQuaternion::identity(),
            from: here,
            to: here,
            way_s: 0.0,
            in_way_s: 0.0,
            lift_m: 0.0,
            is_new: false,
            handle: at_rest,
        }
    }

    fn white(&mut self, sigma: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| sigma * self.noise.gaussian())
    }

    fn between(&mut self, [from, to]: [f64; 2]) -> f64 {
        from + (to - from) * self.noise.uniform()
    }

    /// Returns a random horizontal axis times a random angle up to `max_rad`.
    fn tilt(&mut self, max_rad: f64) -> UnitQuaternion<f64> {
        let angle = max_rad * self.noise.uniform().sqrt();
        let side = TAU * self.noise.uniform();
        UnitQuaternion::from_scaled_axis(Vector3::new(side.cos(), side.sin(), 0.0) * angle)
    }

    fn turned(&mut self) -> UnitQuaternion<f64> {
        let spin = SPIN_RAD * (2.0 * self.noise.uniform() - 1.0);
        self.tilt(TILT_RAD) * self.reference * UnitQuaternion::from_scaled_axis(Vector3::z() * spin)
    }

    fn go_to(&mut self, to: ToolPose, lift_m: f64) {
        self.to = to;
        let turn_s = self.from.world_from_s1.angle_to(&to.world_from_s1) / TURN_RAD_S;
        let way_s = (to.tip_m - self.from.tip_m).norm() / TRAVEL_M_S;
        self.way_s = turn_s.max(way_s).max(WAY_MIN_S);
        self.in_way_s = 0.0;
        self.lift_m = lift_m;
        self.is_new = true;
    }

    fn now(&self) -> ToolPose {
        let s = (self.in_way_s / self.way_s.max(1e-9)).min(1.0);
        let fraction = s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
        let from = &self.from;
        let to = &self.to;
        let lift = Vector3::z() * (self.lift_m * (std::f64::consts::PI * fraction).sin());
        let turn = from.world_from_s1.try_slerp(&to.world_from_s1, fraction, 1e-9).unwrap_or(to.world_from_s1);
        ToolPose { tip_m: from.tip_m + (to.tip_m - from.tip_m) * fraction + lift, world_from_s1: turn }
    }
}

/// Returns whether this file carries out the instruction.
pub(super) const fn is_handling(prompt: &Prompt) -> bool {
    matches!(
        prompt,
        Prompt::PivotInDimple
            | Prompt::Turn
            | Prompt::PivotInTrocar
            | Prompt::Touch { .. }
            | Prompt::MoveTip(_)
            | Prompt::MoveHandle(_)
    )
}

impl Person {
    /// Sets the comfortable orientation of the tool and the orientation of the image.
    #[must_use]
    pub fn turned(mut self, world_from_s1: UnitQuaternion<f64>, world_from_view: UnitQuaternion<f64>) -> Self {
        self.world_from_s1 = world_from_s1;
        self.turn = (world_from_s1, world_from_s1);
        let noise = self.handling.noise.clone();
        self.handling = PoseMotion { world_from_view, ..PoseMotion::new(noise, self.tip_m, world_from_s1) };
        self
    }

    /// Returns the pose chosen since the last call.
    pub fn chosen(&mut self) -> Option<(Vector3<f64>, UnitQuaternion<f64>)> {
        let ToolPose { tip_m, world_from_s1 } = self.handling.to;
        std::mem::take(&mut self.handling.is_new).then_some((tip_m, world_from_s1))
    }

    /// Chooses another pose, because the arm cannot reach the chosen one.
    pub fn choose_again(&mut self) {
        self.choose();
    }

    /// Returns the position of the handle, relative to its position when the person arrived, m (`world`).
    pub fn handle_m(&self) -> Vector3<f64> {
        self.handling.handle.at(self.handling.in_way_s).0
    }

    /// Begins with an instruction from the current pose of the tool.
    pub(super) fn begin_handling(&mut self) {
        self.turn = (self.world_from_s1, self.world_from_s1);
        let handle_m = self.handle_m();
        self.handling.handle = HandMove { from_m: handle_m, to_m: handle_m, seconds: 0.0 };
        self.handling.from = ToolPose { tip_m: self.tip_m, world_from_s1: self.world_from_s1 };
        self.handling.to = self.handling.from;
        self.handling.way_s = 0.0;
        self.handling.in_way_s = 0.0;
        match self.prompt {
            Prompt::Touch { point } => self.touch_point(point),
            Prompt::MoveTip(way) => {
                let to_m = self.tip_m + self.travel_m(way);
                self.handling.go_to(ToolPose { tip_m: to_m, ..self.handling.from }, 0.0);
            }
            Prompt::MoveHandle(way) => {
                self.handling.go_to(self.handling.from, 0.0);
                let to_m = handle_m + self.travel_m(way);
                self.handling.handle = HandMove { from_m: handle_m, to_m, seconds: self.handling.way_s };
            }
            // Start with the requested pose at once.
            _ => self.handling.in_way_s = HELD_S,
        }
    }

    /// Continues by `dt_s`.
    pub(super) fn handle(&mut self, dt_s: f64) {
        self.handling.in_way_s += dt_s;
        if self.prompt == Prompt::PivotInTrocar {
            return self.pivot_in_trocar(dt_s);
        }
        if self.handling.in_way_s >= self.handling.way_s + HELD_S {
            self.choose();
        }
        let before_m = self.tip_m;
        ToolPose { tip_m: self.tip_m, world_from_s1: self.world_from_s1 } = self.handling.now();
        self.velocity_m_s = (self.tip_m - before_m) / dt_s;
        if self.flaw == Some(Flaw::Trembles) {
            let shake = Vector3::new((TAU * 2.3 * self.time_s).sin(), (TAU * 3.1 * self.time_s).cos(), 0.0) * 0.02;
            self.world_from_s1 *= UnitQuaternion::from_scaled_axis(shake);
        }
    }

    /// Chooses the next pose of an instruction with several poses.
    fn choose(&mut self) {
        let stays = self.flaw == Some(Flaw::KeepsOneOrientation);
        self.handling.from = self.handling.now();
        let turned = if stays { self.handling.reference } else { self.handling.turned() };
        match self.prompt {
            Prompt::PivotInDimple => {
                let dimple_m = Vector3::new(0.0, 0.0, self.surface_z_m) + self.handling.white(DIMPLE_MISS_M);
                self.handling.go_to(ToolPose { tip_m: dimple_m, world_from_s1: turned }, 0.0);
            }
            Prompt::Turn => {
                let [x_m, y_m] = ROOM_M.map(|half_m| self.handling.between([-half_m, half_m]));
                let tip_m = Vector3::new(x_m, y_m, self.surface_z_m + self.handling.between(ROOM_Z_M));
                self.handling.go_to(ToolPose { tip_m, world_from_s1: turned }, 0.0);
            }
            _ => {}
        }
    }

    fn touch_point(&mut self, point: u8) {
        let at = usize::from(point);
        let [x_m, y_m] = TABLE_M[if at < TABLE_M.len() { at } else { 3 + at % 3 }];
        let tip_m = Vector3::new(x_m, y_m, 0.0) + self.handling.white(TOUCH_MISS_M);
        let world_from_s1 = self.handling.reference;
        self.handling.go_to(ToolPose { tip_m, world_from_s1 }, LIFT_M);
    }

    fn travel_m(&mut self, way: Way) -> Vector3<f64> {
        self.handling.world_from_view * way.in_view() * TRAVEL_M + self.handling.white(WAY_MISS_M)
    }

    /// Moves continuously between positions beyond the trocar; the shaft always points through it.
    fn pivot_in_trocar(&mut self, dt_s: f64) {
        let Some(wall_m) = self.wall_m else { return };
        self.in_reach_s += dt_s;
        if self.in_reach_s >= self.reach.seconds {
            let to_m = self.beyond(&wall_m);
            let seconds = self.between(REACH_S).max((to_m - self.tip_m).norm() / TRAVEL_M_S);
            self.reach = HandMove { from_m: self.tip_m, to_m, seconds };
            self.in_reach_s = 0.0;
        }
        self.reach_on(0.0);
    }

    /// Returns a position of the tip beyond the trocar and above the tissue.
    fn beyond(&mut self, wall_m: &Vector3<f64>) -> Vector3<f64> {
        let middle = shaft(wall_m, &Vector3::new(0.0, 0.0, self.surface_z_m)).0;
        let max_rad = if self.flaw == Some(Flaw::WorksInOnePlace) { 0.1 * PIVOT_RAD } else { PIVOT_RAD };
        for _ in 0..20 {
            let to_m = wall_m + self.handling.tilt(max_rad) * middle * self.handling.between(DEPTH_M);
            if to_m.z >= self.surface_z_m + CLEAR_M {
                return to_m;
            }
        }
        self.tip_m
    }
}
