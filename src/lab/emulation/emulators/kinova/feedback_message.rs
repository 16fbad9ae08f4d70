//! The complete feedback with every field of `BaseCyclic.proto`, written by `prost`; the driver parses it by hand.

use prost::Message;

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct ActuatorFeedback {
    #[prost(fixed32, tag = "1")]
    pub(super) command_id: u32,
    #[prost(fixed32, tag = "2")]
    pub(super) status_flags: u32,
    #[prost(fixed32, tag = "3")]
    pub(super) jitter_us: u32,
    #[prost(float, tag = "4")]
    pub(super) position_deg: f32,
    #[prost(float, tag = "5")]
    pub(super) velocity_deg_s: f32,
    #[prost(float, tag = "6")]
    pub(super) torque_nm: f32,
    #[prost(float, tag = "7")]
    pub(super) current_a: f32,
    #[prost(float, tag = "8")]
    pub(super) voltage: f32,
    #[prost(float, tag = "9")]
    pub(super) temperature_motor: f32,
    #[prost(float, tag = "10")]
    pub(super) temperature_core: f32,
    #[prost(fixed32, tag = "11")]
    pub(super) fault_a: u32,
    #[prost(fixed32, tag = "12")]
    pub(super) fault_b: u32,
    #[prost(fixed32, tag = "13")]
    pub(super) warning_a: u32,
    #[prost(fixed32, tag = "14")]
    pub(super) warning_b: u32,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct BaseFeedback {
    #[prost(uint32, tag = "1")]
    pub(super) connection: u32,
    #[prost(uint32, tag = "2")]
    pub(super) state: u32,
    #[prost(float, tag = "3")]
    pub(super) arm_voltage: f32,
    #[prost(float, tag = "4")]
    pub(super) arm_current: f32,
    #[prost(float, tag = "5")]
    pub(super) temperature_cpu: f32,
    #[prost(float, tag = "6")]
    pub(super) temperature_ambient: f32,
    #[prost(float, tag = "7")]
    pub(super) imu_acceleration_x: f32,
    #[prost(float, tag = "8")]
    pub(super) imu_acceleration_y: f32,
    #[prost(float, tag = "9")]
    pub(super) imu_acceleration_z: f32,
    #[prost(float, tag = "10")]
    pub(super) imu_angular_x: f32,
    #[prost(float, tag = "11")]
    pub(super) imu_angular_y: f32,
    #[prost(float, tag = "12")]
    pub(super) imu_angular_z: f32,
    #[prost(float, tag = "13")]
    pub(super) pose_x: f32,
    #[prost(float, tag = "14")]
    pub(super) pose_y: f32,
    #[prost(float, tag = "15")]
    pub(super) pose_z: f32,
    #[prost(float, tag = "16")]
    pub(super) theta_x: f32,
    #[prost(float, tag = "17")]
    pub(super) theta_y: f32,
    #[prost(float, tag = "18")]
    pub(super) theta_z: f32,
    #[prost(float, tag = "19")]
    pub(super) linear_x: f32,
    #[prost(float, tag = "20")]
    pub(super) linear_y: f32,
    #[prost(float, tag = "21")]
    pub(super) linear_z: f32,
    #[prost(float, tag = "22")]
    pub(super) angular_x: f32,
    #[prost(float, tag = "23")]
    pub(super) angular_y: f32,
    #[prost(float, tag = "24")]
    pub(super) angular_z: f32,
    #[prost(float, tag = "25")]
    pub(super) force_x: f32,
    #[prost(float, tag = "26")]
    pub(super) force_y: f32,
    #[prost(float, tag = "27")]
    pub(super) force_z: f32,
    #[prost(float, tag = "28")]
    pub(super) torque_x: f32,
    #[prost(float, tag = "29")]
    pub(super) torque_y: f32,
    #[prost(float, tag = "30")]
    pub(super) torque_z: f32,
    #[prost(fixed32, tag = "31")]
    pub(super) fault_a: u32,
    #[prost(fixed32, tag = "32")]
    pub(super) fault_b: u32,
    #[prost(fixed32, tag = "33")]
    pub(super) warning_a: u32,
    #[prost(fixed32, tag = "34")]
    pub(super) warning_b: u32,
    #[prost(float, tag = "35")]
    pub(super) commanded_pose_x: f32,
    #[prost(float, tag = "36")]
    pub(super) commanded_pose_y: f32,
    #[prost(float, tag = "37")]
    pub(super) commanded_pose_z: f32,
    #[prost(float, tag = "38")]
    pub(super) commanded_theta_x: f32,
    #[prost(float, tag = "39")]
    pub(super) commanded_theta_y: f32,
    #[prost(float, tag = "40")]
    pub(super) commanded_theta_z: f32,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct FeedbackMessage {
    #[prost(fixed32, tag = "1")]
    pub(super) frame_id: u32,
    #[prost(message, optional, tag = "2")]
    pub(super) base: Option<BaseFeedback>,
    #[prost(message, repeated, tag = "3")]
    pub(super) actuators: Vec<ActuatorFeedback>,
}
