//! Named frames and the rotations between them.
//!
//!  name | frame |
//! ---|---|
//!  `world` | base of the follower arm, z up: the workspace frame of this program |
//!  `s1` | force-torque sensor at the wrist; its z axis runs along the instrument's shaft towards the tip |
//!  `shaft` | `s1` turned about the shaft, so that it does not depend on the shaft's roll ([`world_from_shaft`]) |
//!  `imu` | inertial unit inside the wrist sensor |
//!  `m` | optical marker on the base of the instrument |
//!  `c` | tracker camera |
//!  `s2` | force sensor under the tissue |
//!  `base`, `flange` | base and flange of an arm |
//!  `table` | origin and plane that were touched with the tip; z up |
//!  `view` | the endoscope image: x right, y down, z into the image |
//!  `n` | optical marker on the endoscope |
//!  `leader` | the haptic device, from its base |
//!
//! A rotation named `target_from_source` transforms a vector from the source frame to the target frame, so that
//! adjacent names match in a chain: `s1_from_s2 = s1_from_world * world_from_m * m_from_c * c_from_s2`.

use nalgebra::{Rotation3, UnitQuaternion, Vector3};

/// Standard gravity, m/s^2 (ISO 80000-3).
pub const GRAVITY_M_S2: f64 = 9.806_65;

/// Returns the rotation by roll about x, then pitch about y, then yaw about z of the fixed frame (degrees): `Rz Ry Rx`,
/// as in the paper.
///
/// ```
/// use nalgebra::Vector3;
/// use nima_core::frames::{from_roll_pitch_yaw_deg, to_roll_pitch_yaw_deg};
///
/// let turn = from_roll_pitch_yaw_deg(&Vector3::new(0.0, 0.0, 90.0));
/// assert!((turn * Vector3::x() - Vector3::y()).norm() < 1e-12, "yaw turns x into y");
/// assert!((to_roll_pitch_yaw_deg(&turn) - Vector3::new(0.0, 0.0, 90.0)).norm() < 1e-9);
/// ```
pub fn from_roll_pitch_yaw_deg(angles_deg: &Vector3<f64>) -> UnitQuaternion<f64> {
    let [roll, pitch, yaw] = [angles_deg.x, angles_deg.y, angles_deg.z].map(f64::to_radians);
    UnitQuaternion::from_euler_angles(roll, pitch, yaw)
}

/// Returns roll, pitch and yaw (degrees) of a rotation: the inverse of [`from_roll_pitch_yaw_deg`].
pub fn to_roll_pitch_yaw_deg(rotation: &UnitQuaternion<f64>) -> Vector3<f64> {
    // nalgebra's Euler angles are also `Rz Ry Rx`, so both functions use the same convention.
    let (roll, pitch, yaw) = Rotation3::from(*rotation).euler_angles();
    Vector3::new(roll.to_degrees(), pitch.to_degrees(), yaw.to_degrees())
}

/// Returns the frame `shaft` of a wrist sensor: z along the instrument's shaft as in `s1`, and otherwise the shortest
/// rotation from the frame of a shaft that points straight down with its x axis along `world`'s. Undefined for a shaft
/// that points straight up, where x stays.
///
/// The posture of a redundant arm rolls the sensor about the shaft while the instrument does the same work. What the
/// tissue and the body wall do to the instrument does not roll with it.
///
/// ```
/// use nalgebra::{UnitQuaternion, Vector3};
/// use nima_core::frames::world_from_shaft;
///
/// let world_from_s1 = UnitQuaternion::from_euler_angles(2.9, 0.2, 0.4);
/// let rolled = world_from_s1 * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.7);
/// assert!(world_from_shaft(&world_from_s1).angle_to(&world_from_shaft(&rolled)) < 1e-9);
/// ```
pub fn world_from_shaft(world_from_s1: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    // `None` only for opposite directions, where every axis is equally short.
    let tilt = UnitQuaternion::rotation_between(&-Vector3::z(), &(world_from_s1 * Vector3::z()));
    tilt.unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)) * down
}

/// A wrench on a sensor, in that sensor's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force, N; in the sensor's own frame unless stated otherwise.
    pub force_n: Vector3<f64>,
    /// Torque about the sensor's origin, Nm.
    pub torque_nm: Vector3<f64>,
}

impl Wrench {
    /// Returns the same wrench in another frame with the same origin.
    #[must_use]
    pub fn turned(&self, target_from_source: &UnitQuaternion<f64>) -> Self {
        Self { force_n: target_from_source * self.force_n, torque_nm: target_from_source * self.torque_nm }
    }

    pub fn is_finite(&self) -> bool {
        self.force_n.iter().chain(self.torque_nm.iter()).all(|x| x.is_finite())
    }
}

/// Measurements at the wrist of one follower in one tick. Quantities that a rig does not measure are `None`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WristSample {
    /// Wrench on the sensor as read: gravity, contact, friction and bias together (`s1`).
    pub raw: Wrench,
    /// Reading of the sensor's accelerometer (`imu`), m/s^2. At rest it points away from the ground (+g upwards).
    pub acceleration_m_s2: Option<Vector3<f64>>,
    /// Orientation of the sensor, from the arm's kinematics.
    pub world_from_s1: Option<UnitQuaternion<f64>>,
    /// Orientation of the optical marker, from the arm's kinematics.
    pub world_from_m: Option<UnitQuaternion<f64>>,
    /// Orientation of the camera relative to the marker, from the tracker.
    /// `None` also where the rig has no such sensor: zero would be a reading.
    pub m_from_c: Option<UnitQuaternion<f64>>,
    /// Insertion depth of the instrument through the trocar, m, from the arm's kinematics.
    pub insertion_m: Option<f64>,
    /// Force on the sensor under the tissue (`s2`), N; only during calibration.
    pub tissue_n: Option<Vector3<f64>>,
}

impl WristSample {
    pub const fn of(raw: Wrench) -> Self {
        Self {
            raw,
            acceleration_m_s2: None,
            world_from_s1: None,
            world_from_m: None,
            m_from_c: None,
            insertion_m: None,
            tissue_n: None,
        }
    }

    /// Returns the known part of the correspondence chain, `s1_from_c = s1_from_world * world_from_m * m_from_c`.
    pub fn s1_from_c(&self) -> Option<UnitQuaternion<f64>> {
        // Any missing link of the chain makes the whole unknown.
        Some(self.world_from_s1?.inverse() * self.world_from_m? * self.m_from_c?)
    }

    pub fn is_finite(&self) -> bool {
        let vectors = [self.acceleration_m_s2, self.tissue_n];
        let rotations = [self.world_from_s1, self.world_from_m, self.m_from_c];
        self.raw.is_finite()
            && vectors.iter().flatten().all(|v| v.iter().all(|x| x.is_finite()))
            && rotations.iter().flatten().all(|q| q.coords.iter().all(|x| x.is_finite()))
            && self.insertion_m.is_none_or(f64::is_finite)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roll_pitch_yaw_is_the_papers_order_and_reads_back() {
        let angles = Vector3::new(20.0, -35.0, 110.0);
        let rotation = from_roll_pitch_yaw_deg(&angles);
        let by_hand = Rotation3::from_axis_angle(&Vector3::z_axis(), 110_f64.to_radians())
            * Rotation3::from_axis_angle(&Vector3::y_axis(), -35_f64.to_radians())
            * Rotation3::from_axis_angle(&Vector3::x_axis(), 20_f64.to_radians());
        assert!(rotation.angle_to(&by_hand.into()) < 1e-12);
        assert!((to_roll_pitch_yaw_deg(&rotation) - angles).norm() < 1e-9);
    }

    #[test]
    fn the_chain_cancels_what_lies_between() {
        let [world_from_s1, world_from_m, world_from_c] =
            [[10.0, 20.0, 30.0], [-40.0, 5.0, 60.0], [170.0, 0.0, -20.0]].map(|a| from_roll_pitch_yaw_deg(&a.into()));
        let sample = WristSample {
            world_from_s1: Some(world_from_s1),
            world_from_m: Some(world_from_m),
            m_from_c: Some(world_from_m.inverse() * world_from_c),
            ..WristSample::of(Wrench::default())
        };
        let expected = world_from_s1.inverse() * world_from_c;
        assert!(sample.s1_from_c().unwrap().angle_to(&expected) < 1e-12);
        assert!(WristSample::of(Wrench::default()).s1_from_c().is_none());
    }

    #[test]
    fn one_poisoned_number_is_seen() {
        let mut sample = WristSample::of(Wrench::default());
        assert!(sample.is_finite());
        sample.insertion_m = Some(f64::NAN);
        assert!(!sample.is_finite());
    }
}
