//! Messages and calls of the Kortex API 2.x that are used here: field numbers, ids, enumerations.
//!
//! Angles are in degrees, as in the protocol. Sources: the `.proto` files in `Kinovarobotics/ros_kortex` (field numbers
//! and `@RPC_ID`s) and the documentation in `Kinovarobotics/Kinova-kortex2_Gen3_G3L`.

use prost::Message;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rpc {
    /// Service (`@PROXY_ID`).
    pub service: u16,
    /// Function in the service (`@RPC_ID`).
    pub function: u16,
}

macro_rules! calls {
    ($($name:ident = $service:literal / $function:literal, $words:literal;)*) => {
        impl Rpc {
            $(
                #[doc = concat!("`", $words, "`.")]
                pub const $name: Self = Self { service: $service, function: $function };
            )*

            /// Returns the name in the manufacturer's documentation.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$name => $words,)*
                    _ => "another call",
                }
            }
        }
    };
}

calls! {
    CREATE_SESSION = 1 / 1, "CreateSession";
    CLOSE_SESSION = 1 / 2, "CloseSession";
    KEEP_ALIVE = 1 / 3, "KeepAlive";
    STOP = 2 / 112, "Stop";
    MEASURED_POSE = 2 / 115, "GetMeasuredCartesianPose";
    SEND_TWIST = 2 / 121, "SendTwistCommand";
    MEASURED_ANGLES = 2 / 126, "GetMeasuredJointAngles";
    EMERGENCY_STOP = 2 / 145, "ApplyEmergencyStop";
    CLEAR_FAULTS = 2 / 146, "ClearFaults";
    SET_SERVOING_MODE = 2 / 152, "SetServoingMode";
    GET_SERVOING_MODE = 2 / 153, "GetServoingMode";
    ACTUATOR_COUNT = 2 / 171, "GetActuatorCount";
    ARM_STATE = 2 / 175, "GetArmState";
    REFRESH = 3 / 1, "Refresh";
    REFRESH_COMMAND = 3 / 2, "RefreshCommand";
    REFRESH_FEEDBACK = 3 / 3, "RefreshFeedback";
    FIRMWARE_VERSION = 9 / 4, "GetFirmwareVersion";
    MODEL_NUMBER = 9 / 6, "GetModelNumber";
    SERIAL_NUMBER = 9 / 8, "GetSerialNumber";
}

/// Control mode of the base (`ServoingMode`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum ServoingMode {
    /// The base plans the motion; twists and actions are accepted. The mode after power-on.
    Single = 2,
    /// The actuators follow cyclic positions; the base checks no limits.
    Low = 3,
}

/// State of the arm (`ArmState`); only some values have names here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArmState(pub u32);

impl ArmState {
    pub const IN_FAULT: Self = Self(4);
    pub const SERVOING_LOW_LEVEL: Self = Self(6);

    /// Returns the text for a message.
    pub const fn words(self) -> &'static str {
        match self.0 {
            2 => "idle",
            3 => "initialisation",
            4 => "fault",
            5 => "maintenance",
            6 => "low-level servoing",
            7 => "ready",
            8 => "playing a sequence",
            9 => "manual control",
            10 => "brake release",
            _ => "unknown",
        }
    }

    /// Returns whether the arm needs a person's action before it can be used.
    pub const fn is_unready(self) -> bool {
        matches!(self.0, 3 | 5 | 10)
    }
}

#[derive(Clone, PartialEq, Message)]
pub struct ErrorInfo {
    #[prost(uint32, tag = "1")]
    pub code: u32,
    #[prost(uint32, tag = "2")]
    pub sub_code: u32,
    #[prost(string, tag = "3")]
    pub text: String,
}

#[derive(Clone, PartialEq, Message)]
pub struct CreateSessionInfo {
    #[prost(string, tag = "1")]
    pub username: String,
    #[prost(uint32, tag = "2")]
    pub session_inactivity_ms: u32,
    #[prost(string, tag = "3")]
    pub password: String,
    #[prost(uint32, tag = "4")]
    pub connection_inactivity_ms: u32,
}

/// A message with one number in field 1: `ServoingModeInformation`, `ArmStateInformation`, `ActuatorInformation`,
/// `FirmwareVersion`.
#[derive(Clone, Copy, PartialEq, Message)]
pub struct KinovaNumber {
    #[prost(uint32, tag = "1")]
    pub value: u32,
}

/// A message with one string in field 1: `SerialNumber`, `ModelNumber`.
#[derive(Clone, PartialEq, Message)]
pub struct KinovaText {
    #[prost(string, tag = "1")]
    pub value: String,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub struct KinovaTwist {
    #[prost(float, tag = "1")]
    pub linear_x: f32,
    #[prost(float, tag = "2")]
    pub linear_y: f32,
    #[prost(float, tag = "3")]
    pub linear_z: f32,
    #[prost(float, tag = "4")]
    pub angular_x: f32,
    #[prost(float, tag = "5")]
    pub angular_y: f32,
    #[prost(float, tag = "6")]
    pub angular_z: f32,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub struct TwistCommand {
    #[prost(uint32, tag = "1")]
    pub reference_frame: u32,
    #[prost(message, optional, tag = "2")]
    pub twist: Option<KinovaTwist>,
    #[prost(uint32, tag = "3")]
    pub duration: u32,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub struct ActuatorCommand {
    #[prost(fixed32, tag = "1")]
    pub command_id: u32,
    #[prost(fixed32, tag = "2")]
    pub flags: u32,
    #[prost(float, tag = "3")]
    pub position_deg: f32,
    #[prost(float, tag = "4")]
    pub velocity_deg_s: f32,
    #[prost(float, tag = "5")]
    pub torque_nm: f32,
    #[prost(float, tag = "6")]
    pub current_a: f32,
}

/// `ActuatorCommand.flags`: the servo is on.
pub(super) const SERVO_ENABLE: u32 = 1;

#[derive(Clone, PartialEq, Message)]
pub struct KinovaCommand {
    #[prost(fixed32, tag = "1")]
    pub frame_id: u32,
    #[prost(message, repeated, tag = "2")]
    pub actuators: Vec<ActuatorCommand>,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub struct JointAngle {
    #[prost(uint32, tag = "1")]
    pub joint: u32,
    #[prost(float, tag = "2")]
    pub value_deg: f32,
}

#[derive(Clone, PartialEq, Message)]
pub struct JointAngles {
    #[prost(message, repeated, tag = "1")]
    pub angles: Vec<JointAngle>,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub struct KinovaPose {
    #[prost(float, tag = "1")]
    pub x: f32,
    #[prost(float, tag = "2")]
    pub y: f32,
    #[prost(float, tag = "3")]
    pub z: f32,
    #[prost(float, tag = "4")]
    pub theta_x: f32,
    #[prost(float, tag = "5")]
    pub theta_y: f32,
    #[prost(float, tag = "6")]
    pub theta_z: f32,
}

/// Error code of the device's own errors (`ERROR_DEVICE`).
pub const ERROR_DEVICE: u8 = 3;
/// Error code of the server's protocol (`ERROR_PROTOCOL_SERVER`).
pub const ERROR_SERVER: u8 = 1;

/// Sub error codes that are handled or explained here.
pub mod sub {
    pub const UNSUPPORTED_SERVICE: u16 = 4;
    pub const UNSUPPORTED_METHOD: u16 = 5;
    pub const UNSUPPORTED_FRAME: u16 = 10;
    /// The session does not exist or has timed out.
    pub const INVALID_SESSION: u16 = 12;
    pub const PAYLOAD_DECODING: u16 = 13;
    pub const INVALID_PASSWORD: u16 = 15;
    pub const USER_NOT_FOUND: u16 = 16;
    pub const IN_FAULT: u16 = 22;
    pub const EMERGENCY_STOP: u16 = 25;
    /// Not possible in this servoing mode.
    pub const WRONG_SERVOING_MODE: u16 = 75;
    /// Another session has control of the arm.
    pub const NOT_IN_CONTROL: u16 = 130;

    /// Returns the text for a message.
    pub const fn words(code: u16) -> &'static str {
        match code {
            1 => "the call failed",
            2 => "not implemented",
            3 => "invalid parameter",
            UNSUPPORTED_SERVICE => "unknown service",
            UNSUPPORTED_METHOD => "unknown function",
            8 => "invalid frame",
            9 => "different version of the protocol",
            UNSUPPORTED_FRAME => "unsupported type of frame",
            INVALID_SESSION => "no valid session",
            PAYLOAD_DECODING => "invalid message",
            INVALID_PASSWORD => "wrong password",
            USER_NOT_FOUND => "unknown user",
            17 => "no such entity",
            18 => "a movement is in progress",
            19 => "the arm does not move",
            20 => "no space left",
            21 => "not ready",
            IN_FAULT => "the arm is in fault",
            23 => "in maintenance",
            24 => "in update",
            EMERGENCY_STOP => "emergency stop",
            26 => "in single-level servoing",
            27 => "in low-level servoing",
            46 => "action not supported",
            48 => "above the maximum",
            50 => "the device is not connected",
            53 => "a safety threshold is reached",
            54 => "not permitted for this user",
            55 => "stopped by a client",
            56 => "outside the workspace",
            57 => "wrong number of joints",
            58 => "not possible within this time",
            60 => "too fast",
            65 => "beyond a joint's limit",
            WRONG_SERVOING_MODE => "wrong servoing mode",
            104 => "the user already exists",
            105 => "a user needs a name",
            NOT_IN_CONTROL => "another session has control of the arm",
            131 => "no answer in time",
            _ => "unnamed error",
        }
    }
}
