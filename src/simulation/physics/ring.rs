//! A ring as a rigid body.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use crate::physics::{
    contact::ContactPush,
    geometry::{Circle, PLACES},
    setting::RingShape,
};

/// Standard acceleration of free fall, m/s^2.
pub(crate) const GRAVITY_M_S2: f64 = 9.806_65;
/// Maximum speed, m/s, and rotation, rad/s, whatever the speed of an arm that hits a ring.
const SPEED_MAX_M_S: f64 = 10.0;
const TURNING_MAX_RAD_S: f64 = 1000.0;
/// A ring that is slower than this (at its middle, and at its rim by rotation), m/s, for this long, s, is at rest.
const REST_M_S: f64 = 2e-3;
const REST_AFTER_S: f64 = 0.2;

/// Pose and motion of a ring, and the forces of the current step.
#[derive(Clone, Debug)]
#[expect(clippy::struct_field_names, reason = "a rotation is named by both of its frames")]
pub(crate) struct Ring {
    pub centre_m: Vector3<f64>,
    pub world_from_ring: UnitQuaternion<f64>,
    pub velocity_m_s: Vector3<f64>,
    /// Angular momentum, N m s, which unlike the angular velocity is constant while no torque acts.
    momentum: Vector3<f64>,
    pub turning_rad_s: Vector3<f64>,
    pub circle: Circle,
    pub places_m: [Vector3<f64>; PLACES],
    pub tube_radius_m: f64,
    pub mass_kg: f64,
    about_axis_kg_m2: f64,
    across_kg_m2: f64,
    pub force_n: Vector3<f64>,
    pub torque_nm: Vector3<f64>,
    /// Time for which the ring has been slow, s.
    slow_s: f64,
    pub asleep: bool,
    /// Out of view, and no longer simulated.
    pub lost: bool,
}

impl Ring {
    pub(crate) fn new(shape: &RingShape, centre_m: Vector3<f64>, directions: &[[f64; 2]; PLACES]) -> Self {
        let RingShape { major_radius_m: major, tube_radius_m: tube, mass_kg } = *shape;
        let circle = Circle { centre_m, across: [Vector3::x(), Vector3::y()], axis: Vector3::z(), radius_m: major };
        Self {
            centre_m,
            world_from_ring: UnitQuaternion::identity(),
            velocity_m_s: Vector3::zeros(),
            momentum: Vector3::zeros(),
            turning_rad_s: Vector3::zeros(),
            circle,
            places_m: circle.places_m(directions),
            tube_radius_m: tube,
            mass_kg,
            // A torus of uniform density.
            about_axis_kg_m2: mass_kg * (major * major + 0.75 * tube * tube),
            across_kg_m2: mass_kg * (0.5 * major * major + 0.625 * tube * tube),
            force_n: Vector3::zeros(),
            torque_nm: Vector3::zeros(),
            slow_s: 0.0,
            asleep: false,
            lost: false,
        }
    }

    /// Returns the distance from its middle to its outermost point, m.
    pub(crate) fn reach_m(&self) -> f64 {
        self.circle.radius_m + self.tube_radius_m
    }

    /// Returns whether it is simulated: neither asleep nor lost.
    pub(crate) const fn moves(&self) -> bool {
        !self.asleep && !self.lost
    }

    pub(crate) fn velocity_at(&self, point_m: &Vector3<f64>) -> Vector3<f64> {
        self.velocity_m_s + self.turning_rad_s.cross(&(point_m - self.centre_m))
    }

    pub(crate) fn push(&mut self, position_m: &Vector3<f64>, push: &ContactPush) {
        self.force_n += push.force_n;
        self.torque_nm += (position_m - self.centre_m).cross(&push.force_n) + push.torque_nm;
    }

    /// Advances by `step_s` under gravity and the forces of this step, and clears the forces (semi-implicit Euler).
    pub(crate) fn advance(&mut self, step_s: f64, directions: &[[f64; 2]; PLACES]) {
        let weight_n = Vector3::z() * (-GRAVITY_M_S2 * self.mass_kg);
        // The position uses the new velocity, so that the energy of a contact's spring stays bounded.
        self.velocity_m_s += (self.force_n + weight_n) * (step_s / self.mass_kg);
        self.momentum += self.torque_nm * step_s;
        self.clear_forces();
        self.velocity_m_s = at_most(self.velocity_m_s, SPEED_MAX_M_S);
        self.momentum = at_most(self.momentum, TURNING_MAX_RAD_S * self.across_kg_m2);
        self.turn();
        self.centre_m += self.velocity_m_s * step_s;
        // The rate of a quaternion is half the angular velocity times the quaternion.
        let half = self.turning_rad_s * (0.5 * step_s);
        let turned = Quaternion::new(0.0, half.x, half.y, half.z) * self.world_from_ring.quaternion();
        self.world_from_ring = UnitQuaternion::new_normalize(self.world_from_ring.into_inner() + turned);
        // One NaN would spread to everything that the ring touches.
        let sane = self.centre_m.iter().chain(self.world_from_ring.coords.iter()).all(|x| x.is_finite());
        if !sane {
            self.lose();
            return;
        }
        self.place(directions);
        // The axis has turned, and the same momentum means another velocity about it.
        self.turn();
    }

    /// Computes the angular velocity from the momentum.
    fn turn(&mut self) {
        let axis = self.circle.axis;
        let along = axis * axis.dot(&self.momentum);
        self.turning_rad_s = along / self.about_axis_kg_m2 + (self.momentum - along) / self.across_kg_m2;
    }

    fn place(&mut self, directions: &[[f64; 2]; PLACES]) {
        let frame: Matrix3<f64> = self.world_from_ring.to_rotation_matrix().into_inner();
        let column = |i: usize| Vector3::new(frame[(0, i)], frame[(1, i)], frame[(2, i)]);
        self.circle.centre_m = self.centre_m;
        self.circle.across = [column(0), column(1)];
        self.circle.axis = column(2);
        self.places_m = self.circle.places_m(directions);
    }

    pub(crate) fn clear_forces(&mut self) {
        self.force_n = Vector3::zeros();
        self.torque_nm = Vector3::zeros();
    }

    /// Called at the end of a tick; `free` if no instrument touches it.
    pub(crate) fn settle(&mut self, free: bool, period_s: f64) {
        let rim_m_s = self.turning_rad_s.norm() * self.circle.radius_m;
        let slow = free && self.velocity_m_s.norm() < REST_M_S && rim_m_s < REST_M_S;
        self.slow_s = if slow { self.slow_s + period_s } else { 0.0 };
    }

    /// Returns whether it has been slow for a while.
    pub(crate) fn quiet(&self) -> bool {
        self.slow_s >= REST_AFTER_S
    }

    /// Stops the simulation of the ring until something touches it.
    pub(crate) fn sleep(&mut self) {
        self.asleep = true;
        self.stop();
    }

    pub(crate) const fn wake(&mut self) {
        self.asleep = false;
        self.slow_s = 0.0;
    }

    pub(crate) fn lose(&mut self) {
        self.lost = true;
        self.stop();
    }

    fn stop(&mut self) {
        self.velocity_m_s = Vector3::zeros();
        self.momentum = Vector3::zeros();
        self.turning_rad_s = Vector3::zeros();
        self.clear_forces();
    }

    /// Returns the kinetic and potential energy, J.
    #[cfg(test)]
    pub(crate) fn energy_j(&self) -> f64 {
        0.5 * self.mass_kg * self.velocity_m_s.norm_squared()
            + 0.5 * self.momentum.dot(&self.turning_rad_s)
            + self.mass_kg * GRAVITY_M_S2 * self.centre_m.z
    }

    #[cfg(test)]
    pub(crate) fn throw(&mut self, centre_m: Vector3<f64>, velocity_m_s: Vector3<f64>, momentum: Vector3<f64>) {
        self.centre_m = centre_m;
        self.velocity_m_s = velocity_m_s;
        self.momentum = momentum;
        self.wake();
        self.place(&crate::physics::geometry::directions());
        self.turn();
    }
}

fn at_most(vector: Vector3<f64>, max: f64) -> Vector3<f64> {
    let size = vector.norm();
    if size > max { vector * (max / size) } else { vector }
}
