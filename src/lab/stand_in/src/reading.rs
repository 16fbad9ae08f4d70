//! Pose of the hand.

use std::ffi::{c_char, c_int, c_uint};

use crate::{
    devices::is_left,
    errors::{INVALID_PARAMETER, OUTSIDE_RANGE, TIMED_OUT, noted},
    handle::{StandInHandle, with},
    outputs::{put, put_all, put_three},
    reading_history::wrist_rad,
};

const DEG: f64 = 180.0 / std::f64::consts::PI;
/// Opening at which thumb and finger are 25 mm apart (the workspace of the gripper), rad.
const GRIPPER_OPEN_RAD: f64 = std::f64::consts::FRAC_PI_6;
const GRIPPER_OPEN_M: f64 = 0.025;

/// Reads again, and calls `write` with the result.
fn read(id: c_char, write: impl FnOnce(&mut StandInHandle) -> Result<(), c_int>) -> c_int {
    noted(with(id, |handle| {
        let code = handle.refresh()?;
        write(handle).map(|()| code)
    }))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn dhdGetPosition(px: *mut f64, py: *mut f64, pz: *mut f64, id: c_char) -> c_int {
    // SAFETY: each pointer is null or valid for one value (SDK).
    read(id, |handle| unsafe { put_three([px, py, pz], handle.reply.position_m) })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn dhdGetOrientationFrame(frame: *mut f64, id: c_char) -> c_int {
    // SAFETY: the pointer is null or valid for 3 by 3 values (SDK).
    read(id, |handle| unsafe { put_all(frame, &handle.reply.frame) })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn dhdGetOrientationRad(a: *mut f64, b: *mut f64, g: *mut f64, id: c_char) -> c_int {
    // SAFETY: each pointer is null or valid for one value (SDK).
    read(id, |handle| unsafe { put_three([a, b, g], wrist_rad(&handle.reply.frame)) })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn dhdGetOrientationDeg(a: *mut f64, b: *mut f64, g: *mut f64, id: c_char) -> c_int {
    // SAFETY: each pointer is null or valid for one value (SDK).
    read(id, |handle| unsafe { put_three([a, b, g], wrist_rad(&handle.reply.frame).map(|angle| angle * DEG)) })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn dhdGetPositionAndOrientationFrame(
    px: *mut f64,
    py: *mut f64,
    pz: *mut f64,
    frame: *mut f64,
    id: c_char,
) -> c_int {
    // SAFETY: each pointer is null or valid for one value (SDK).
    read(id, |handle| unsafe {
        put_three([px, py, pz], handle.reply.position_m)?;
        put_all(frame, &handle.reply.frame)
    })
}

/// Writes position and the wrist's angles, times `scale`.
///
/// # Safety
/// The pointers are null or valid for writes.
unsafe fn pose(places: [[*mut f64; 3]; 2], scale: f64, id: c_char) -> c_int {
    // SAFETY: guaranteed by the caller.
    read(id, |handle| unsafe {
        put_three(places[0], handle.reply.position_m)?;
        put_three(places[1], wrist_rad(&handle.reply.frame).map(|angle| angle * scale))
    })
}

macro_rules! pose {
    ($($name:ident: $scale:expr;)*) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            px: *mut f64, py: *mut f64, pz: *mut f64, a: *mut f64, b: *mut f64, g: *mut f64, id: c_char,
        ) -> c_int {
            // SAFETY: guaranteed by the caller (SDK).
            unsafe { pose([[px, py, pz], [a, b, g]], $scale, id) }
        }
    )*};
}

pose! {
    dhdGetPositionAndOrientationRad: 1.0;
    dhdGetPositionAndOrientationDeg: DEG;
}

macro_rules! gripper {
    ($($name:ident: $value:expr;)*) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(out: *mut f64, id: c_char) -> c_int {
            let value: fn(&mut StandInHandle) -> Result<f64, c_int> = $value;
            read(id, |handle| {
                let value = value(handle)?;
                // SAFETY: the pointer is null or valid for one value (SDK).
                unsafe { put(out, value) }
            })
        }
    )*};
}

fn gripper_speed(handle: &mut StandInHandle) -> Result<f64, c_int> {
    handle.history.velocity().map(|(_, speed)| speed).ok_or(TIMED_OUT)
}

gripper! {
    dhdGetGripperAngleRad: |handle| Ok(handle.reply.gripper_rad);
    dhdGetGripperAngleDeg: |handle| Ok(handle.reply.gripper_rad * DEG);
    dhdGetGripperGap: |handle| Ok(handle.reply.gripper_rad.abs() / GRIPPER_OPEN_RAD * GRIPPER_OPEN_M);
    dhdGetGripperAngularVelocityRad: gripper_speed;
    dhdGetGripperAngularVelocityDeg: |handle| Ok(gripper_speed(handle)? * DEG);
    dhdGetGripperLinearVelocity: |handle| {
        let side = if is_left(handle) { -1.0 } else { 1.0 };
        Ok(gripper_speed(handle)? * side / GRIPPER_OPEN_RAD * GRIPPER_OPEN_M)
    };
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn dhdGetLinearVelocity(vx: *mut f64, vy: *mut f64, vz: *mut f64, id: c_char) -> c_int {
    read(id, |handle| {
        let (linear, _) = handle.history.velocity().ok_or(TIMED_OUT)?;
        // SAFETY: each pointer is null or valid for one value (SDK).
        unsafe { put_three([vx, vy, vz], linear) }
    })
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdConfigLinearVelocity(window_ms: c_int, _mode: c_int, id: c_char) -> c_int {
    noted(with(id, |handle| {
        if !(1..=1000).contains(&window_ms) {
            return Err(INVALID_PARAMETER);
        }
        handle.history.window_s = f64::from(window_ms) * 1e-3;
        Ok(0)
    }))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdGetButton(index: c_int, id: c_char) -> c_int {
    noted(with(id, |handle| {
        let index = u32::try_from(index).ok().filter(|index| *index < 16).ok_or(OUTSIDE_RANGE)?;
        handle.refresh()?;
        Ok(c_int::from(handle.reply.buttons >> index & 1 == 1))
    }))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdGetButtonMask(id: c_char) -> c_uint {
    let mask = with(id, |handle| handle.refresh().map(|_| handle.reply.buttons));
    mask.unwrap_or_else(|error| {
        noted(Err(error));
        0
    })
}
