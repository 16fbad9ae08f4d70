//! `nima emulate force-dimension`: an omega.7 behind the stub library.
//!
//! The endpoint is the address for `NIMA_EMULATED_HANDLE`, followed by ` library=PATH` if the stub library was found.
//! Settings: `serial`, `left_handed`, `motor_limit_n`, `reset`, `port`; of the hand that holds it `x_m`, `y_m`, `z_m`,
//! `radius_m`, `yaw_rad`, `gripper_rad`, `stiffness_n_m`.

use std::io::Result;

use nima_devices::force_dimension::ForceDimensionKind;

use super::{EmulatedForceDimension, EmulatedHand, ForceDimensionMachine, stand_in};
use crate::emulators::{Emulator, EmulatorSettings, standalone::unusable};

pub(in crate::emulators) fn handle(settings: &EmulatorSettings) -> Result<Box<dyn Emulator>> {
    let usual = EmulatedForceDimension::default();
    let hand = EmulatedHand::default();
    let emulated = EmulatedForceDimension {
        serial: settings.get_or("serial", usual.serial)?,
        kind: ForceDimensionKind::Omega7 { left_handed: settings.get_or("left_handed", false)? },
        motor_limit_n: settings.get_or("motor_limit_n", usual.motor_limit_n)?,
        reset: settings.get_or("reset", false)?,
        port: settings.get_or("port", 0)?,
    };
    let number = |key: &str, usual: f64| {
        let value = settings.get_or(key, usual)?;
        if f64::is_finite(value) { Ok(value) } else { Err(unusable(key, value, "this value cannot be used")) }
    };
    let held = EmulatedHand {
        rest_m: [number("x_m", hand.rest_m.x)?, number("y_m", hand.rest_m.y)?, number("z_m", hand.rest_m.z)?].into(),
        radius_m: number("radius_m", hand.radius_m)?,
        yaw_rad: number("yaw_rad", hand.yaw_rad)?,
        gripper_rad: number("gripper_rad", hand.gripper_rad)?,
        stiffness_n_m: number("stiffness_n_m", hand.stiffness_n_m)?.max(1.0),
    };
    Ok(Box::new(ForceDimensionMachine::new(emulated, Box::new(held.body()), stand_in())))
}
