//! Messages of the services that the driver does not use, as far as the emulated arm parses them. Field numbers: the
//! `.proto` files of `Kinovarobotics/ros_kortex`. Angles are in degrees.

use nima_devices::kinova::messages::{JointAngles, KinovaPose};
use prost::Message;

/// A reference to a stored entity: an action (with its type between), a sequence, a user, a protection zone.
#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct EntityHandle {
    #[prost(uint32, tag = "1")]
    pub(super) identifier: u32,
    #[prost(fixed32, tag = "2")]
    pub(super) permission: u32,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct DeviceHandle {
    #[prost(uint32, tag = "1")]
    pub(super) kind: u32,
    #[prost(uint32, tag = "2")]
    pub(super) identifier: u32,
    #[prost(uint32, tag = "3")]
    pub(super) order: u32,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct DeviceHandles {
    #[prost(message, repeated, tag = "1")]
    pub(super) devices: Vec<DeviceHandle>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct MacAddress {
    #[prost(bytes = "vec", tag = "1")]
    pub(super) bytes: Vec<u8>,
}

/// A message of one float in field 1: `TorqueOffset`, `LinearTwist`, `AngularTwist`.
#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Real {
    #[prost(float, tag = "1")]
    pub(super) value: f32,
}

/// A message of one `fixed32` in field 1: `ControlLoop`.
#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct FormBits {
    #[prost(fixed32, tag = "1")]
    pub(super) value: u32,
}

/// Numbers in field 1: `CustomDataSelection`.
#[derive(Clone, PartialEq, Message)]
pub(super) struct FormNumbers {
    #[prost(uint32, repeated, tag = "1")]
    pub(super) values: Vec<u32>,
}

/// Two floats: `AxisOffsets`.
#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Offsets {
    #[prost(float, tag = "1")]
    pub(super) absolute_deg: f32,
    #[prost(float, tag = "2")]
    pub(super) relative_deg: f32,
}

/// `GravityVector` (m/s^2), `Position` (m).
#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct FormVector {
    #[prost(float, tag = "1")]
    pub(super) x: f32,
    #[prost(float, tag = "2")]
    pub(super) y: f32,
    #[prost(float, tag = "3")]
    pub(super) z: f32,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct PayloadForm {
    #[prost(float, tag = "1")]
    pub(super) mass_kg: f32,
    #[prost(message, optional, tag = "2")]
    pub(super) centre: Option<FormVector>,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct FormTool {
    #[prost(message, optional, tag = "1")]
    pub(super) transform: Option<KinovaPose>,
    #[prost(float, tag = "2")]
    pub(super) mass_kg: f32,
    #[prost(message, optional, tag = "3")]
    pub(super) centre: Option<FormVector>,
}

/// `TwistLinearSoftLimit`, `TwistAngularSoftLimit`.
#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct TwistLimit {
    #[prost(uint32, tag = "1")]
    pub(super) mode: u32,
    #[prost(float, tag = "2")]
    pub(super) value: f32,
}

/// `JointSpeedSoftLimits`, `JointAccelerationSoftLimits`.
#[derive(Clone, PartialEq, Message)]
pub(super) struct JointsLimit {
    #[prost(uint32, tag = "1")]
    pub(super) mode: u32,
    #[prost(float, repeated, tag = "2")]
    pub(super) values: Vec<f32>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct KinematicLimits {
    #[prost(uint32, tag = "1")]
    pub(super) mode: u32,
    #[prost(float, tag = "2")]
    pub(super) linear_m_s: f32,
    #[prost(float, tag = "3")]
    pub(super) angular_deg_s: f32,
    #[prost(float, repeated, tag = "4")]
    pub(super) joint_deg_s: Vec<f32>,
    #[prost(float, repeated, tag = "5")]
    pub(super) joint_deg_s2: Vec<f32>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct AllKinematicLimits {
    #[prost(message, repeated, tag = "1")]
    pub(super) limits: Vec<KinematicLimits>,
}

#[derive(Clone, PartialEq, Message)]
#[expect(clippy::struct_field_names, reason = "the units are in the names")]
pub(super) struct DesiredSpeeds {
    #[prost(float, tag = "1")]
    pub(super) linear_m_s: f32,
    #[prost(float, tag = "2")]
    pub(super) angular_deg_s: f32,
    #[prost(float, repeated, tag = "3")]
    pub(super) joint_deg_s: Vec<f32>,
}

/// `ControlConfig.JointSpeeds`.
#[derive(Clone, PartialEq, Message)]
pub(super) struct Reals {
    #[prost(float, repeated, tag = "1")]
    pub(super) values: Vec<f32>,
}

/// `CompleteProductConfiguration`; fields that are left out do not apply to an emulated arm.
#[derive(Clone, PartialEq, Message)]
pub(super) struct Product {
    #[prost(string, tag = "1")]
    pub(super) kin: String,
    #[prost(uint32, tag = "2")]
    pub(super) model: u32,
    #[prost(uint32, tag = "6")]
    pub(super) joints: u32,
    #[prost(uint32, tag = "7")]
    pub(super) base: u32,
    #[prost(uint32, tag = "8")]
    pub(super) end_effector: u32,
    #[prost(uint32, tag = "9")]
    pub(super) vision: u32,
    #[prost(uint32, tag = "10")]
    pub(super) interconnect: u32,
    #[prost(uint32, tag = "12")]
    pub(super) wrist: u32,
}

/// Identifier and settings: `GPIOState` (value), `GPIOConfiguration` (mode, pull, default), `UARTConfiguration`,
/// `EthernetConfiguration`, `I2CConfiguration`.
#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct PortForm {
    #[prost(uint32, tag = "1")]
    pub(super) identifier: u32,
    #[prost(uint32, tag = "2")]
    pub(super) mode: u32,
    #[prost(uint32, tag = "3")]
    pub(super) third: u32,
    #[prost(uint32, tag = "4")]
    pub(super) fourth: u32,
    #[prost(uint32, tag = "5")]
    pub(super) fifth: u32,
    #[prost(uint32, tag = "6")]
    pub(super) sixth: u32,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct BridgeResult {
    #[prost(message, optional, tag = "1")]
    pub(super) bridge: Option<EntityHandle>,
    #[prost(uint32, tag = "2")]
    pub(super) status: u32,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct JointSpeed {
    #[prost(uint32, tag = "1")]
    pub(super) joint: u32,
    #[prost(float, tag = "2")]
    pub(super) value_deg_s: f32,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct JointSpeeds {
    #[prost(message, repeated, tag = "1")]
    pub(super) speeds: Vec<JointSpeed>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct InverseQuestion {
    #[prost(message, optional, tag = "1")]
    pub(super) pose: Option<KinovaPose>,
    #[prost(message, optional, tag = "2")]
    pub(super) guess: Option<JointAngles>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct User {
    #[prost(string, tag = "2")]
    pub(super) name: String,
}

/// `FullUserProfile`: the profile unchanged, and the password, which is not stored.
#[derive(Clone, PartialEq, Message)]
pub(super) struct NewUser {
    #[prost(bytes = "vec", tag = "1")]
    pub(super) profile: Vec<u8>,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct ConfigurationChange {
    #[prost(uint32, tag = "1")]
    pub(super) event: u32,
    #[prost(message, optional, tag = "4")]
    pub(super) sequence: Option<EntityHandle>,
    #[prost(message, optional, tag = "9")]
    pub(super) user: Option<EntityHandle>,
    #[prost(message, optional, tag = "10")]
    pub(super) zone: Option<EntityHandle>,
}
