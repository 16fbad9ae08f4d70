//! Output of the motors, and the settings that protect the hand.

use std::{
    ffi::{c_char, c_int, c_uchar, c_uint},
    sync::atomic::{AtomicBool, Ordering},
    time::Duration,
};

use crate::{
    errors::{EXPERT_MODE_DISABLED, INVALID_PARAMETER, OUTSIDE_RANGE, noted},
    handle::with,
    outputs::{put, put_three},
    wire::ClientOrder,
};

static EXPERT: AtomicBool = AtomicBool::new(false);

#[unsafe(no_mangle)]
pub extern "C" fn dhdEnableForce(on: c_uchar, id: c_char) -> c_int {
    noted(with(id, |handle| handle.order(ClientOrder::EnableForce, u32::from(on != 0))))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdEnableGripperForce(_on: c_uchar, id: c_char) -> c_int {
    // Affects only grippers with a default state.
    noted(with(id, |_| Ok(0)))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdStop(id: c_char) -> c_int {
    noted(with(id, |handle| handle.order(ClientOrder::Brakes, 1)))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdSetBrakes(on: c_int, id: c_char) -> c_int {
    noted(with(id, |handle| handle.order(ClientOrder::Brakes, u32::from(on != 0))))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdSetForce(fx: f64, fy: f64, fz: f64, id: c_char) -> c_int {
    noted(with(id, |handle| handle.force([fx, fy, fz, handle.asked_n[3]])))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdSetForceAndGripperForce(fx: f64, fy: f64, fz: f64, fg: f64, id: c_char) -> c_int {
    noted(with(id, |handle| handle.force([fx, fy, fz, fg])))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdSetForceAndTorque(fx: f64, fy: f64, fz: f64, _tx: f64, _ty: f64, _tz: f64, id: c_char) -> c_int {
    // The wrist is passive, so torques are ignored.
    noted(with(id, |handle| handle.force([fx, fy, fz, handle.asked_n[3]])))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdSetForceAndTorqueAndGripperForce(
    fx: f64,
    fy: f64,
    fz: f64,
    _tx: f64,
    _ty: f64,
    _tz: f64,
    fg: f64,
    id: c_char,
) -> c_int {
    noted(with(id, |handle| handle.force([fx, fy, fz, fg])))
}

/// Writes the last commanded force and torque, and the gripper's force.
///
/// # Safety
/// The pointers are null or valid for writes.
unsafe fn report(force: [*mut f64; 3], torque: Option<[*mut f64; 3]>, gripper: Option<*mut f64>, id: c_char) -> c_int {
    noted(with(id, |handle| {
        let [x, y, z, gripper_n] = handle.asked_n;
        // SAFETY: guaranteed by the caller.
        unsafe {
            put_three(force, [x, y, z])?;
            torque.map_or(Ok(()), |torque| put_three(torque, [0.0; 3]))?;
            gripper.map_or(Ok(()), |gripper| put(gripper, gripper_n))?;
        }
        Ok(0)
    }))
}

macro_rules! force_getters {
    ($($name:ident($([$x:ident $y:ident $z:ident])* $($gripper:ident)?): $force:expr, $torque:expr, $to_gripper:expr;)*) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            $($x: *mut f64, $y: *mut f64, $z: *mut f64,)* $($gripper: *mut f64,)? id: c_char,
        ) -> c_int {
            // SAFETY: guaranteed by the caller (SDK).
            unsafe { report($force, $torque, $to_gripper, id) }
        }
    )*};
}

force_getters! {
    dhdGetForce([fx fy fz]): [fx, fy, fz], None, None;
    dhdGetForceAndTorque([fx fy fz] [tx ty tz]): [fx, fy, fz], Some([tx, ty, tz]), None;
    dhdGetForceAndTorqueAndGripperForce([fx fy fz] [tx ty tz] fg): [fx, fy, fz], Some([tx, ty, tz]), Some(fg);
}

macro_rules! limit {
    ($($set:ident $get:ident $field:ident;)*) => {$(
        /// A negative limit means no limit.
        #[unsafe(no_mangle)]
        pub extern "C" fn $set(limit: f64, id: c_char) -> c_int {
            noted(with(id, |handle| {
                if limit.is_nan() {
                    return Err(INVALID_PARAMETER);
                }
                handle.$field = (limit >= 0.0).then_some(limit);
                Ok(0)
            }))
        }

        #[unsafe(no_mangle)]
        pub extern "C" fn $get(id: c_char) -> f64 {
            with(id, |handle| Ok(handle.$field.unwrap_or(-1.0))).unwrap_or_else(|error| f64::from(noted(Err(error))))
        }
    )*};
}

limit! {
    dhdSetMaxForce dhdGetMaxForce force_max_n;
    dhdSetMaxGripperForce dhdGetMaxGripperForce gripper_max_n;
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdSetGravityCompensation(on: c_int, id: c_char) -> c_int {
    noted(with(id, |handle| {
        handle.gravity = on != 0;
        Ok(0)
    }))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdSetStandardGravity(_gravity: f64, id: c_char) -> c_int {
    noted(with(id, |_| Ok(0)))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdSetEffectorMass(mass_kg: f64, id: c_char) -> c_int {
    noted(with(id, |handle| {
        handle.effector_kg = Some(mass_kg).filter(|mass_kg| *mass_kg >= 0.0).ok_or(INVALID_PARAMETER)?;
        Ok(0)
    }))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn dhdGetEffectorMass(mass_kg: *mut f64, id: c_char) -> c_int {
    // SAFETY: the pointer is null or valid for one value (SDK).
    noted(with(id, |handle| unsafe { put(mass_kg, handle.effector_kg) }.map(|()| 0)))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdEmulateButton(on: c_uchar, id: c_char) -> c_int {
    noted(with(id, |handle| handle.order(ClientOrder::Button, u32::from(on != 0))))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdEnableExpertMode() -> c_int {
    EXPERT.store(true, Ordering::Relaxed);
    noted(Ok(0))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdDisableExpertMode() -> c_int {
    EXPERT.store(false, Ordering::Relaxed);
    noted(Ok(0))
}

/// Watchdog and velocity threshold protect the hand, so weakening them requires expert mode.
fn expert_for(weaker: bool) -> Result<(), c_int> {
    if weaker && !EXPERT.load(Ordering::Relaxed) { Err(EXPERT_MODE_DISABLED) } else { Ok(()) }
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdSetVelocityThreshold(threshold: c_uint, id: c_char) -> c_int {
    noted(with(id, |handle| {
        expert_for(threshold == 0 || threshold > handle.reply.velocity_threshold)?;
        handle.order(ClientOrder::VelocityThreshold, threshold)
    }))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn dhdGetVelocityThreshold(threshold: *mut c_uint, id: c_char) -> c_int {
    // SAFETY: the pointer is null or valid for one value (SDK).
    noted(with(id, |handle| unsafe { put(threshold, handle.reply.velocity_threshold) }.map(|()| 0)))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdSetWatchdog(steps: c_uchar, id: c_char) -> c_int {
    noted(with(id, |handle| handle.order(ClientOrder::Watchdog, u32::from(steps))))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn dhdGetWatchdog(steps: *mut c_uchar, id: c_char) -> c_int {
    noted(with(id, |handle| {
        let value = c_uchar::try_from(handle.reply.watchdog).map_err(|_| OUTSIDE_RANGE)?;
        // SAFETY: the pointer is null or valid for one value (SDK).
        unsafe { put(steps, value) }.map(|()| 0)
    }))
}

#[unsafe(no_mangle)]
pub extern "C" fn dhdSetTimeGuard(guard_us: c_int, id: c_char) -> c_int {
    noted(with(id, |handle| {
        handle.time_guard = match u64::try_from(guard_us) {
            Ok(guard_us) => Duration::from_micros(guard_us),
            Err(_) if guard_us == -1 => Duration::from_micros(250),
            Err(_) => return Err(INVALID_PARAMETER),
        };
        Ok(0)
    }))
}
