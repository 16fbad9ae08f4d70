//! A stub of the handle's library (`emulators/omega`), linked into this program so that emulated handles need no
//! separate file.
//!
//! The driver calls it through the same table of C functions that it fills from the manufacturer's library. Only
//! handles with [`emulator`](force_dimension::ForceDimensionSettings::emulator) use it, which only rigs with `emulated = true` may
//! have.

use drd::{devices, errors, motors, reading};
use nima_devices::force_dimension::{self, Sdk, SdkFunctions};

static STAND_IN: Sdk = Sdk::linked(
    "(the stand-in within this program)",
    SdkFunctions {
        sdk_version: devices::dhdGetSDKVersion,
        last_error: errors::dhdErrorGetLast,
        device_count: devices::dhdGetDeviceCount,
        open_any: devices::dhdOpen,
        open_serial: devices::dhdOpenSerial,
        close: devices::dhdClose,
        stop: motors::dhdStop,
        serial: devices::dhdGetSerialNumber,
        kind: devices::dhdGetSystemType,
        name: devices::dhdGetSystemName,
        firmware: devices::dhdGetVersion,
        status: devices::dhdGetStatus,
        enable_force: motors::dhdEnableForce,
        brakes: motors::dhdSetBrakes,
        gravity: motors::dhdSetGravityCompensation,
        watchdog: motors::dhdSetWatchdog,
        force_max: motors::dhdSetMaxForce,
        velocity_threshold: motors::dhdGetVelocityThreshold,
        pose: reading::dhdGetPositionAndOrientationFrame,
        gripper: reading::dhdGetGripperAngleRad,
        velocity: reading::dhdGetLinearVelocity,
        buttons: reading::dhdGetButtonMask,
        emulate_button: motors::dhdEmulateButton,
        force: motors::dhdSetForceAndTorqueAndGripperForce,
        emulate_handle: Some(devices::nimaEmulateHandle),
    },
);

/// Lets drivers in this program reach emulated handles without a library file. Call it once, before opening any.
pub fn provide_handles() {
    force_dimension::provide_stand_in(&STAND_IN);
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use nalgebra::Vector3;
    use nima_devices::{Device as _, force_dimension::ForceDimensionSettings};

    use nima_testing::real_time::judged;

    use super::*;
    use crate::emulators::force_dimension::{EmulatedForceDimension, EmulatedHand};

    #[test]
    fn an_emulated_handle_is_reached_without_a_library_file() {
        judged(|| {
            provide_handles();
            let held = EmulatedHand { radius_m: 0.0, rest_m: Vector3::new(0.03, 0.0, 0.0), ..EmulatedHand::default() };
            let serving = EmulatedForceDimension { serial: 4321, ..EmulatedForceDimension::default() }
                .with(held.body())
                .serve()
                .unwrap();
            let emulator = Some(serving.endpoint.parse().unwrap());
            let mut driver = force_dimension::open(&ForceDimensionSettings {
                serial: Some(4321),
                emulator,
                ..ForceDimensionSettings::default()
            })
            .unwrap();
            assert_eq!((driver.identity().product.as_str(), driver.identity().serial.as_str()), ("omega.7", "4321"));
            driver.enable_force();
            // The hand yields to the force like a spring of 500 N/m.
            let begin = Instant::now();
            let mut pushed_m = 0.0;
            while pushed_m < 0.001 && begin.elapsed() < Duration::from_secs(10) {
                driver.set_force(Vector3::y(), 0.0);
                let reading = driver.poll(begin.elapsed().as_secs_f64());
                pushed_m = reading.map_or(pushed_m, |reading| reading.value.position_m.y);
                std::thread::sleep(Duration::from_millis(1));
            }
            assert!(pushed_m >= 0.001, "{pushed_m} m, {:?}", driver.health());
        });
    }

    /// A manufacturer's library that is loaded later calls its own functions by name. If the program exported functions
    /// of the same names, the library would call those instead.
    #[test]
    #[cfg(unix)]
    #[expect(unsafe_code, reason = "looking a symbol up")]
    fn the_linked_stand_in_is_seen_by_no_library() {
        provide_handles();
        let this = libloading::os::unix::Library::this();
        for symbol in ["dhdOpen", "drdOpen", "nimaEmulateHandle"] {
            // SAFETY: the symbol is looked up and not called.
            let found = unsafe { this.get::<extern "C" fn()>(symbol) };
            assert!(found.is_err(), "{symbol} is exported");
        }
    }
}
