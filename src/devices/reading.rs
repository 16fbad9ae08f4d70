//! Readings of the devices, each with the time at the device and the time of arrival.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::frames::Wrench;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedReading<T> {
    /// Time on the device's own clock, s, unwrapped when its counter overflows; `None` if the device sends no time.
    pub device_s: Option<f64>,
    /// Time of arrival on the loop's clock, s.
    pub arrival_s: f64,
    pub value: T,
}

/// Reasons why a force reading must not be used for control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a bit of the device's own status word")]
pub struct ForceStatus {
    /// The sensor skips measurements because it cannot keep up.
    pub throttled: bool,
    /// Above the calibrated range.
    pub overrange: bool,
    /// Saturated, shorted or open: possibly damaged.
    pub invalid: bool,
    /// Calibration is not applied: the numbers are not in newtons.
    pub raw: bool,
}

impl ForceStatus {
    /// Returns whether the reading may be used for control.
    pub const fn is_usable(self) -> bool {
        !self.invalid && !self.raw && !self.overrange
    }
}

/// One reading of a force-torque sensor, in its own frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceReading {
    pub wrench: Wrench,
    /// Accelerometer, m/s^2; at rest it points away from the ground (+g upwards).
    pub acceleration_m_s2: Option<Vector3<f64>>,
    /// Gyroscope, rad/s.
    pub angular_velocity_rad_s: Option<Vector3<f64>>,
    /// Temperature of the sensor's electronics, degrees Celsius.
    pub temperature_c: f64,
    pub status: ForceStatus,
}

/// Number of joints of the follower arm.
pub const ARM_JOINTS: usize = 7;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmReading {
    /// Joint angles, rad, unwrapped: continuous from reading to reading.
    pub joint_rad: [f64; ARM_JOINTS],
    pub joint_rad_s: [f64; ARM_JOINTS],
    pub joint_nm: [f64; ARM_JOINTS],
    /// Whether the arm follows cyclic commands now.
    pub servoing: bool,
}

/// Number of servos of one instrument.
pub const SERVOS: usize = 4;

/// One reading of the instrument's servos.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ServoReading {
    /// Angles, rad; zero is the middle of the servo's range.
    pub position_rad: [f64; SERVOS],
    pub velocity_rad_s: [f64; SERVOS],
    /// Motor currents, A; not a number for a servo that does not measure its current.
    pub current_a: [f64; SERVOS],
}

/// One reading of a haptic handle, in the device's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandleReading {
    /// Position in the handle's own frame, m.
    pub position_m: Vector3<f64>,
    /// Orientation of the handle; `None` if the device has no wrist.
    pub orientation: Option<UnitQuaternion<f64>>,
    /// Opening of the gripper, rad; `None` if there is no gripper.
    pub gripper_rad: Option<f64>,
    /// Velocity, m/s; `None` until two positions are known.
    pub velocity_m_s: Option<Vector3<f64>>,
    /// Pressed buttons, one per bit, the first button in the lowest bit.
    pub buttons: u32,
}

/// Number of tools that a tracker can follow at once.
pub const TRACKED_TOOLS: usize = 4;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TrackedTool {
    /// No tool is assigned to this index.
    #[default]
    Absent,
    Seen {
        /// Orientation of the tool in the camera's frame.
        c_from_tool: UnitQuaternion<f64>,
        /// Position of the tool in the camera's frame, m.
        position_in_c_m: Vector3<f64>,
        /// Root mean square error of the fit to the markers, m.
        error_m: f64,
        /// Whether the tool is only partly within the measurement volume.
        at_the_edge: bool,
    },
    /// Defined, but not visible.
    Missing {
        /// Whether the tool is outside the measurement volume; otherwise it is hidden from view.
        out_of_volume: bool,
    },
    Disabled,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackerReading {
    pub frame: u32,
    /// The tools, in the order of their definition.
    pub tools: [TrackedTool; TRACKED_TOOLS],
}

/// State of a foot pedal or of other switches; a switch that cannot be read counts as released.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PedalReading {
    /// Pressed switches, one per bit, the first switch in the lowest bit.
    pub pressed: u32,
}

/// Six axes of a 3-D mouse such as a `SpaceMouse`, each -1 to 1, right-handed: x right, y away from the user, z up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CapReading {
    pub translation: Vector3<f64>,
    pub rotation: Vector3<f64>,
    /// Pressed buttons, one per bit, the first button in the lowest bit.
    pub buttons: u32,
}
