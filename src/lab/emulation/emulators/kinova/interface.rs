//! Calls that the emulated arm answers and the driver never makes: ids of the interface (`@PROXY_ID`, `@RPC_ID` in the
//! `.proto` files of `Kinovarobotics/ros_kortex`), sub error codes, and the parsing of payloads.

use nima_devices::kinova::messages::{ERROR_DEVICE, ERROR_SERVER, Rpc, sub};
use prost::Message;

/// Error class and sub error.
pub(super) type InterfaceError = (u8, u16);
/// The payload of an answer.
pub(super) type AnswerPayload = Result<Vec<u8>, InterfaceError>;

pub(super) const UNSUPPORTED_METHOD: InterfaceError = (ERROR_SERVER, sub::UNSUPPORTED_METHOD);
pub(super) const UNSUPPORTED_SERVICE: InterfaceError = (ERROR_SERVER, sub::UNSUPPORTED_SERVICE);
pub(super) const INVALID_PARAM: InterfaceError = (ERROR_DEVICE, 3);
pub(super) const ENTITY_NOT_FOUND: InterfaceError = (ERROR_DEVICE, 17);
pub(super) const NO_MORE_STORAGE: InterfaceError = (ERROR_DEVICE, 20);
pub(super) const UNSUPPORTED_ACTION: InterfaceError = (ERROR_DEVICE, 46);
pub(super) const ABOVE_MAXIMUM: InterfaceError = (ERROR_DEVICE, 48);
pub(super) const DEVICE_DISCONNECTED: InterfaceError = (ERROR_DEVICE, 50);
pub(super) const OUTSIDE_WORKSPACE: InterfaceError = (ERROR_DEVICE, 56);
pub(super) const JOINT_COUNT: InterfaceError = (ERROR_DEVICE, 57);
pub(super) const INVALID_DURATION: InterfaceError = (ERROR_DEVICE, 58);
pub(super) const LARGE_SPEED: InterfaceError = (ERROR_DEVICE, 60);
pub(super) const JOINT_LIMIT: InterfaceError = (ERROR_DEVICE, 65);
pub(super) const USERNAME_TAKEN: InterfaceError = (ERROR_DEVICE, 104);
pub(super) const USERNAME_EMPTY: InterfaceError = (ERROR_DEVICE, 105);
pub(super) const METHOD_TIMEOUT: InterfaceError = (ERROR_DEVICE, 131);

/// Sub errors that end a motion.
pub(super) const MANUAL_STOP: u16 = 55;
pub(super) const MOVEMENT_IN_PROGRESS: u16 = 18;

macro_rules! ids {
    ($($name:ident = $service:literal / $function:literal;)*) => {
        $(pub(super) const $name: Rpc = Rpc { service: $service, function: $function };)*
    };
}

ids! {
    CREATE_USER = 2 / 1;
    READ_USER = 2 / 3;
    DELETE_USER = 2 / 4;
    READ_USERS = 2 / 5;
    CREATE_SEQUENCE = 2 / 8;
    READ_SEQUENCE = 2 / 10;
    DELETE_SEQUENCE = 2 / 11;
    READ_SEQUENCES = 2 / 12;
    PLAY_SEQUENCE = 2 / 15;
    STOP_SEQUENCE = 2 / 17;
    CREATE_ZONE = 2 / 20;
    READ_ZONE = 2 / 22;
    DELETE_ZONE = 2 / 23;
    READ_ZONES = 2 / 24;
    READ_ACTION = 2 / 43;
    READ_ACTIONS = 2 / 44;
    EXECUTE_REFERENCE = 2 / 47;
    EXECUTE_ACTION = 2 / 48;
    STOP_ACTION = 2 / 50;
    UNSUBSCRIBE = 2 / 97;
    CONFIGURATION_TOPIC = 2 / 98;
    SEQUENCE_TOPIC = 2 / 102;
    ACTION_TOPIC = 2 / 106;
    JOINT_SPEEDS = 2 / 132;
    GRIPPER_COMMAND = 2 / 136;
    GRIPPER_MOVEMENT = 2 / 137;
    CONTROL_MODE = 2 / 150;
    SERVOING_TOPIC = 2 / 154;
    ARM_STATE_TOPIC = 2 / 176;
    ENABLE_BRIDGE = 2 / 193;
    PRODUCT = 2 / 198;
    EXECUTE_WAYPOINTS = 2 / 226;
    FORWARD_KINEMATICS = 2 / 233;
    INVERSE_KINEMATICS = 2 / 234;
    VALIDATE_WAYPOINTS = 2 / 235;
    RUN_MODE = 9 / 1;
    DEVICE_TYPE = 9 / 3;
    BOOTLOADER_VERSION = 9 / 5;
    PART_NUMBER = 9 / 7;
    MAC_ADDRESS = 9 / 9;
    PART_REVISION = 9 / 12;
    AXIS_OFFSETS = 10 / 1;
    CLEAR_ACTUATOR_FAULTS = 10 / 25;
    CONTROL_TOPIC = 16 / 7;
    CONTROL_UNSUBSCRIBE = 16 / 8;
    CONTROL_CONFIG_MODE = 16 / 13;
    ALL_DEVICES = 23 / 1;
}

pub(super) fn read<T: Message + Default>(payload: &[u8]) -> Result<T, InterfaceError> {
    T::decode(payload).map_err(|_| (ERROR_SERVER, sub::PAYLOAD_DECODING))
}
