//! An instrument as colliding bodies: two fingers and a shaft, all capsules.

use nalgebra::{UnitQuaternion, Vector3};

use crate::physics::{
    contact::ContactPush,
    geometry::Segment,
    instrument::{Instrument, InstrumentContacts, InstrumentLoads, OPENING_MAX_RAD},
    setting::JawSettings,
};

/// Two fingers, then the shaft.
pub(crate) const PARTS: usize = 3;
pub(crate) const SHAFT: usize = 2;
/// Time constant with which the jaws follow their command and yield to opening forces, s.
const FOLLOW_S: f64 = 0.01;
/// The same against an object between them, s: long enough for the longest sub-step.
const MIN_S: f64 = 1.25e-3;
/// Beyond this distance between two steps an instrument is placed again without sweeping through space, m and rad.
const JUMP_M: f64 = 0.03;
const JUMP_RAD: f64 = 0.5;

#[derive(Clone, Debug)]
pub(crate) struct PhysicsTool {
    jaws: JawSettings,
    /// Damping of the jaws, N s/m at the end of a finger.
    damping_n_s_m: f64,
    from: Instrument,
    to: Instrument,
    period_s: f64,
    /// Actual angle between the fingers, rad, and its change, rad/s.
    pub opening_rad: f64,
    opening_rad_s: f64,
    tip_m: Vector3<f64>,
    hinge_m: Vector3<f64>,
    hinge_m_s: Vector3<f64>,
    turning_rad_s: Vector3<f64>,
    /// The axis about which the fingers open.
    about: Vector3<f64>,
    pub parts: [Segment; PARTS],
    pub radii_m: [f64; PARTS],
    /// Sums over the step.
    force_n: Vector3<f64>,
    torque_nm: Vector3<f64>,
    opening_n: f64,
    /// The same for the current sub-step only.
    now_opening_n: f64,
    pub touching: InstrumentContacts,
}

/// `+1` for the finger on the side of x.
const fn side_of(finger: usize) -> f64 {
    if finger == 0 { 1.0 } else { -1.0 }
}

impl PhysicsTool {
    pub(crate) fn new(jaws: &JawSettings, ring_stiffness_n_m: f64, at: &Instrument, period_s: f64) -> Self {
        let opening_rad = at.opening_rad.clamp(0.0, OPENING_MAX_RAD);
        let mut tool = Self {
            jaws: *jaws,
            damping_n_s_m: (jaws.stiffness_n_m * FOLLOW_S).max(ring_stiffness_n_m * MIN_S),
            from: *at,
            to: *at,
            period_s,
            opening_rad,
            opening_rad_s: 0.0,
            tip_m: at.tip_m,
            hinge_m: at.tip_m,
            hinge_m_s: Vector3::zeros(),
            turning_rad_s: Vector3::zeros(),
            about: Vector3::y(),
            parts: [Segment::default(); PARTS],
            radii_m: [jaws.finger_radius_m, jaws.finger_radius_m, jaws.shaft_radius_m],
            force_n: Vector3::zeros(),
            torque_nm: Vector3::zeros(),
            opening_n: 0.0,
            now_opening_n: 0.0,
            touching: InstrumentContacts::default(),
        };
        tool.place(1.0);
        tool
    }

    /// Starts a step at whose end the instrument has this pose.
    pub(crate) fn aim(&mut self, at: &Instrument) {
        self.from = self.to;
        self.to = *at;
        let far = (self.to.tip_m - self.from.tip_m).norm() > JUMP_M;
        let turn = self.to.world_from_jaws * self.from.world_from_jaws.inverse();
        // `w` is the cosine of half the angle; a small angle is twice the vector part.
        let half = turn.vector() * if turn.w < 0.0 { -1.0 } else { 1.0 };
        // `1 - JUMP_RAD^2 / 8` is the cosine of half that angle.
        if far || turn.w.abs() < 1.0 - 0.125 * JUMP_RAD * JUMP_RAD {
            self.from = *at;
            self.turning_rad_s = Vector3::zeros();
        } else {
            self.turning_rad_s = half * (2.0 / self.period_s);
        }
        let hinge_m = |at: &Instrument| at.tip_m - at.world_from_jaws * Vector3::z() * self.jaws.finger_length_m;
        self.hinge_m_s = (hinge_m(&self.to) - hinge_m(&self.from)) / self.period_s;
        self.force_n = Vector3::zeros();
        self.torque_nm = Vector3::zeros();
        self.opening_n = 0.0;
        self.touching = InstrumentContacts::default();
    }

    /// Places the capsules at this fraction of the step.
    pub(crate) fn place(&mut self, fraction: f64) {
        let from = self.from.world_from_jaws.into_inner();
        let to = self.to.world_from_jaws.into_inner();
        // `q` and `-q` are the same rotation; this is the shorter way.
        let to = if from.dot(&to) < 0.0 { -to } else { to };
        // For the small rotation of one step this is close to a rotation at constant speed.
        let world_from_jaws = UnitQuaternion::new_normalize(from * (1.0 - fraction) + to * fraction);
        let between = |from: &Vector3<f64>, to: &Vector3<f64>| from * (1.0 - fraction) + to * fraction;
        self.tip_m = between(&self.from.tip_m, &self.to.tip_m);
        let x = world_from_jaws * Vector3::x();
        let z = world_from_jaws * Vector3::z();
        self.about = world_from_jaws * Vector3::y();
        self.hinge_m = self.tip_m - z * self.jaws.finger_length_m;
        let (sin, cos) = libm::sincos(0.5 * self.opening_rad);
        for finger in 0..SHAFT {
            let side = side_of(finger);
            // When closed, the fingers are side by side: the middle of each is one radius from the hinge.
            let out = x * cos - z * (side * sin);
            let along = z * cos + x * (side * sin);
            let from_m = self.hinge_m + out * (side * self.jaws.finger_radius_m);
            self.parts[finger] = Segment { from_m, to_m: from_m + along * self.jaws.finger_length_m };
        }
        self.parts[SHAFT] = Segment { from_m: between(&self.from.trocar_m, &self.to.trocar_m), to_m: self.hinge_m };
    }

    /// Returns the height of the lowest point of a part, m.
    pub(crate) fn lowest_m(&self, part: usize) -> f64 {
        self.parts[part].from_m.z.min(self.parts[part].to_m.z) - self.radii_m[part]
    }

    /// Returns the velocity of a point of a finger per rate of its half of the opening, m/rad.
    fn opens(&self, finger: usize, point_m: &Vector3<f64>) -> Vector3<f64> {
        self.about.cross(&(point_m - self.hinge_m)) * side_of(finger)
    }

    /// Returns the velocity of a point of a part, m/s.
    pub(crate) fn velocity_at(&self, part: usize, point_m: &Vector3<f64>) -> Vector3<f64> {
        if part == SHAFT {
            // The trocar does not move.
            let shaft = self.parts[SHAFT];
            // Finite even with the hinge in the trocar.
            let length_m = (shaft.to_m - shaft.from_m).norm().max(1e-6);
            return self.hinge_m_s * ((point_m - shaft.from_m).norm() / length_m).min(1.0);
        }
        let rigid = self.hinge_m_s + self.turning_rad_s.cross(&(point_m - self.hinge_m));
        rigid + self.opens(part, point_m) * (0.5 * self.opening_rad_s)
    }

    /// Returns the rotation of a part about a direction, rad/s.
    pub(crate) fn spin_about(&self, part: usize, direction: &Vector3<f64>) -> f64 {
        if part == SHAFT { 0.0 } else { self.turning_rad_s.dot(direction) }
    }

    /// Applies a push to a part at a point.
    pub(crate) fn push(&mut self, part: usize, position_m: &Vector3<f64>, push: &ContactPush) {
        self.force_n += push.force_n;
        self.torque_nm += (position_m - self.tip_m).cross(&push.force_n) + push.torque_nm;
        if part != SHAFT {
            // Each finger moves by half the opening, so half of its work counts.
            self.now_opening_n += 0.5 * push.force_n.dot(&self.opens(part, position_m)) / self.jaws.finger_length_m;
        }
    }

    /// Advances the jaws by `step_s`: a spring of limited force towards the command, and the opening forces, against a
    /// damper.
    pub(crate) fn drive(&mut self, step_s: f64) {
        let JawSettings { finger_length_m, stiffness_n_m, force_max_n, .. } = self.jaws;
        let commanded_rad = self.to.opening_rad.clamp(0.0, OPENING_MAX_RAD);
        let wide_m = finger_length_m * (self.opening_rad - commanded_rad);
        let closing_n = (stiffness_n_m * wide_m).clamp(-force_max_n, force_max_n);
        let before_rad = self.opening_rad;
        let rate_rad_s = (self.now_opening_n - closing_n) / (self.damping_n_s_m * finger_length_m);
        self.opening_rad = (before_rad + rate_rad_s * step_s).clamp(0.0, OPENING_MAX_RAD);
        // From the clamped angle, so that jaws at their stop have no speed.
        self.opening_rad_s = (self.opening_rad - before_rad) / step_s;
        self.opening_n += self.now_opening_n;
        self.now_opening_n = 0.0;
    }

    /// Returns the means over the step.
    pub(crate) fn loads(&self, substeps: f64) -> InstrumentLoads {
        InstrumentLoads {
            tip_n: self.force_n / substeps,
            torque_nm: self.torque_nm / substeps,
            opening_n: self.opening_n / substeps,
            touching: self.touching,
        }
    }
}
