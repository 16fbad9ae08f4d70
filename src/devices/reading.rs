//! What devices read, each with the time at the device and the time of arrival.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::frames::Wrench;

/// A reading with its times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamped<T> {
    /// Time on the device's own clock, s, without jumps where the counter wraps; `None` where the device tells none.
    pub device_s: Option<f64>,
    /// When it arrived, on the loop's clock, s.
    pub arrival_s: f64,
    /// The reading as the driver decoded it.
    pub value: T,
}

/// Why a force reading must not be used for control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a bit of the device's own status word")]
pub struct ForceStatus {
    /// The sensor skips measurements because it cannot keep up.
    pub throttled: bool,
    /// Above the calibrated range.
    pub overrange: bool,
    /// Saturated, shorted or open: possibly damaged.
    pub invalid: bool,
    /// Calibration is not applied: the numbers are no newtons.
    pub raw: bool,
}

impl ForceStatus {
    /// The reading may be used.
    pub const fn is_usable(self) -> bool {
        !self.invalid && !self.raw && !self.overrange
    }
}

/// One reading of a force-torque sensor, in its own frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceReading {
    /// Force and torque.
    pub wrench: Wrench,
    /// Accelerometer, m/s^2; at rest it reads the support, opposite to gravity.
    pub acceleration_m_s2: Option<Vector3<f64>>,
    /// Gyroscope, rad/s.
    pub angular_velocity_rad_s: Option<Vector3<f64>>,
    /// Of the sensor's electronics, in degrees Celsius.
    pub temperature_c: f64,
    /// Whether it may be used.
    pub status: ForceStatus,
}

/// Joints of the follower arm.
pub const ARM_JOINTS: usize = 7;

/// One reading of an arm.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the names say it")]
pub struct ArmReading {
    /// Joint angles, rad, unwrapped to the nearest of the last ones.
    pub joint_rad: [f64; ARM_JOINTS],
    pub joint_rad_s: [f64; ARM_JOINTS],
    pub joint_nm: [f64; ARM_JOINTS],
    /// It obeys cyclic commands now.
    pub servoing: bool,
}

/// Servos of one instrument.
pub const SERVOS: usize = 4;

/// One reading of the instrument's servos.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ServoReading {
    /// Angles, rad; zero is the middle of the servo's range.
    pub position_rad: [f64; SERVOS],
    /// Speeds, rad/s.
    pub velocity_rad_s: [f64; SERVOS],
    /// Motor currents, A.
    pub current_a: [f64; SERVOS],
}

/// One reading of a haptic handle, in the device's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandleReading {
    /// In the handle's own frame.
    pub position_m: Vector3<f64>,
    /// Orientation of the handle; `None` where the device has no wrist.
    pub orientation: Option<UnitQuaternion<f64>>,
    /// Opening of the gripper, rad; `None` where there is none.
    pub gripper_rad: Option<f64>,
    /// Velocity, m/s; `None` until it is known.
    pub velocity_m_s: Option<Vector3<f64>>,
    /// Buttons, first in the lowest bit.
    pub buttons: u32,
}

/// Tools that a tracker can follow at once.
pub const TRACKED_TOOLS: usize = 4;

/// Where a tracked tool is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Tracked {
    /// No tool has this place.
    #[default]
    Absent,
    /// The tracker sees the tool.
    Seen {
        /// Orientation of the tool in the camera's frame.
        c_from_tool: UnitQuaternion<f64>,
        /// Its place there, m.
        position_in_c_m: Vector3<f64>,
        /// Root mean square error of the markers, m.
        error_m: f64,
        /// Only part of it is within the volume.
        at_the_edge: bool,
    },
    /// Defined, but not seen.
    Missing {
        /// It is outside of the volume, not hidden.
        out_of_volume: bool,
    },
    /// Switched off.
    Disabled,
}

/// One frame of a tracker.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackerReading {
    /// Number of the frame on the device.
    pub frame: u32,
    /// The tools, in the order of their definition.
    pub tools: [Tracked; TRACKED_TOOLS],
}

/// Foot pedals and other switches; whatever cannot be read counts as released.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PedalReading {
    /// Pressed switches, first in the lowest bit.
    pub pressed: u32,
}

/// Six axes of a desk-top leader such as a `SpaceMouse`, each -1 to 1, right-handed: x right, y away from the user, z up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CapReading {
    /// Push.
    pub translation: Vector3<f64>,
    /// Turn.
    pub rotation: Vector3<f64>,
    /// Buttons, first in the lowest bit.
    pub buttons: u32,
}
