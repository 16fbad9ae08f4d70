//! Symbols that exist because clients resolve them while loading. A caller's arguments are ignored, which C's calling
//! conventions on 64-bit Linux, macOS and Windows allow.

use std::ffi::c_int;

use crate::{
    errors::{NOT_IMPLEMENTED, noted},
    handle::{DEFAULT, with},
};

/// Returns -1: with error 5 if no device is open, with 10 otherwise.
pub(crate) fn refused() -> c_int {
    noted(with(DEFAULT, |_| Ok(())).and(Err(NOT_IMPLEMENTED)))
}

macro_rules! refuse {
    ($($name:ident)*) => {$(
        #[unsafe(no_mangle)]
        pub extern "C" fn $name() -> c_int { refused() }
    )*};
}

macro_rules! refuse_number {
    ($($name:ident)*) => {$(
        #[unsafe(no_mangle)]
        pub extern "C" fn $name() -> f64 { f64::from(refused()) }
    )*};
}

macro_rules! deny {
    ($($name:ident)*) => {$(
        #[unsafe(no_mangle)]
        pub extern "C" fn $name() -> bool { refused(); false }
    )*};
}

refuse! {
    dhdCheckControllerMemory dhdConfigAngularVelocity dhdConfigGripperVelocity dhdControllerSetDevice
    dhdDeltaEncoderToPosition dhdDeltaEncodersToJointAngles dhdDeltaForceToMotor dhdDeltaGravityJointTorques
    dhdDeltaJointAnglesToEncoders dhdDeltaJointAnglesToJacobian dhdDeltaJointTorquesExtrema dhdDeltaMotorToForce
    dhdDeltaPositionToEncoder dhdGetAngularVelocityDeg dhdGetAngularVelocityRad dhdGetBaseAngleXDeg
    dhdGetBaseAngleXRad dhdGetBaseAngleZDeg dhdGetBaseAngleZRad dhdGetComponentVersionStr dhdGetDeltaEncoders
    dhdGetDeltaJacobian dhdGetDeltaJointAngles dhdGetDeviceAngleDeg dhdGetDeviceAngleRad dhdGetEnc dhdGetEncRange
    dhdGetEncVelocities dhdGetEncoder dhdGetGripperEncoder dhdGetGripperFingerPos dhdGetGripperThumbPos
    dhdGetJointAngleRange dhdGetJointAngles dhdGetJointVelocities dhdGetSystemRev dhdGetWristEncoders
    dhdGetWristJacobian dhdGetWristJointAngles dhdGripperAngleRadToEncoder dhdGripperEncoderToAngleRad
    dhdGripperEncoderToGap dhdGripperForceToMotor dhdGripperGapToEncoder dhdGripperMotorToForce
    dhdJointAnglesToGravityJointTorques dhdJointAnglesToInertiaMatrix dhdPreloadMot dhdPreset dhdReadConfigFromFile
    dhdReset dhdSetBaseAngleXDeg dhdSetBaseAngleXRad dhdSetBaseAngleZDeg dhdSetBaseAngleZRad dhdSetBrk dhdSetComMode
    dhdSetDeltaJointTorques dhdSetDeltaMotor dhdSetDeviceAngleDeg dhdSetDeviceAngleRad dhdSetForceAndWristJointTorques
    dhdSetForceAndWristJointTorquesAndGripperForce dhdSetGripperMotor dhdSetJointTorques dhdSetMaxTorque dhdSetMot
    dhdSetMotor dhdSetOutput dhdSetVibration dhdSetWristJointTorques dhdSetWristMotor dhdUpdateEncoders
    dhdWaitForReset dhdWristEncoderToOrientation dhdWristEncodersToJointAngles dhdWristGravityJointTorques
    dhdWristJointAnglesToEncoders dhdWristJointAnglesToJacobian dhdWristJointTorquesExtrema dhdWristMotorToTorque
    dhdWristOrientationToEncoder dhdWristTorqueToMotor drdAutoInit drdCheckInit drdEnableFilter drdGetEncMoveParam
    drdGetEncTrackParam drdGetGripMoveParam drdGetGripTrackParam drdGetPosMoveParam drdGetPosTrackParam
    drdGetPositionAndOrientation drdGetPriorities drdGetRotMoveParam drdGetRotTrackParam drdGetVelocity drdHold
    drdLock drdMoveTo drdMoveToAllEnc drdMoveToEnc drdMoveToGrip drdMoveToPos drdMoveToRot drdPrecisionInit
    drdRegulateGrip drdRegulatePos drdRegulateRot drdSetEncDGain drdSetEncIGain drdSetEncMoveParam drdSetEncPGain
    drdSetEncTrackParam drdSetForceAndTorqueAndGripperForce drdSetForceAndWristJointTorquesAndGripperForce
    drdSetGripMoveParam drdSetGripTrackParam drdSetMotRatioMax drdSetPosMoveParam drdSetPosTrackParam drdSetPriorities
    drdSetRotMoveParam drdSetRotTrackParam drdStart drdStop drdTrack drdTrackAllEnc drdTrackEnc drdTrackGrip
    drdTrackPos drdTrackRot
}

refuse_number! {
    dhdGetMaxTorque drdGetCtrlFreq drdGetEncDGain drdGetEncIGain drdGetEncPGain drdGetMotRatioMax
}

deny! {
    drdIsFiltering drdIsMoving drdIsRunning drdIsSupported
}
