//! `nima emulate force-dimension`: an omega.7 behind the replacement library.
//!
//! The endpoint is the address for `NIMA_EMULATED_HANDLE`, followed by ` library=PATH` if the replacement library was
//! found. `--set`: `serial`, `left_handed`, `motor_limit_n`, `reset`, `port`; for the simulated hand that holds it:
//! `x_m`, `y_m`, `z_m`, `radius_m`, `yaw_rad`, `gripper_rad`, `stiffness_n_m`.

use nima_devices::force_dimension::Kind;
use nima_world::emulators::force_dimension::{Emulator, Held, stand_in};

use super::{Emulated, Settings};

pub(super) const NAME: &str = "force-dimension";

pub(super) fn start(settings: &Settings) -> anyhow::Result<Vec<Emulated>> {
    let (usual, hand) = (Emulator::default(), Held::default());
    let emulator = Emulator {
        serial: settings.get("serial")?.unwrap_or(usual.serial),
        kind: Kind::Omega7 { left_handed: settings.get("left_handed")?.unwrap_or(false) },
        motor_limit_n: settings.get("motor_limit_n")?.unwrap_or(usual.motor_limit_n),
        reset: settings.get("reset")?.unwrap_or(false),
        port: settings.get("port")?.unwrap_or(0),
    };
    let number = |key: &str, usual: f64| -> anyhow::Result<f64> {
        let value = settings.get(key)?.unwrap_or(usual);
        anyhow::ensure!(f64::is_finite(value), "--set {key}={value}: this value cannot be used");
        Ok(value)
    };
    let held = Held {
        rest_m: [number("x_m", hand.rest_m.x)?, number("y_m", hand.rest_m.y)?, number("z_m", hand.rest_m.z)?].into(),
        radius_m: number("radius_m", hand.radius_m)?,
        yaw_rad: number("yaw_rad", hand.yaw_rad)?,
        gripper_rad: number("gripper_rad", hand.gripper_rad)?,
        stiffness_n_m: number("stiffness_n_m", hand.stiffness_n_m)?.max(1.0),
    };
    let mut serving = emulator.serve(held.body())?;
    if let Some(library) = stand_in() {
        serving.endpoint = format!("{} library={}", serving.endpoint, library.display());
    }
    Ok(vec![Emulated::new(NAME, serving)])
}
