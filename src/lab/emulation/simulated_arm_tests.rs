//! A rig with the second arm model: handle and sensor are emulated on real connections, the arm's joints are simulated.

use std::time::{Duration, Instant};

use nalgebra::Vector3;
use nima_core::kinematics::{Rcm, find};
use nima_devices::{ConnectionState, ForceReading, bota, simulated_arm};
use nima_machine::{
    config::RigConfig,
    rig::{DeviceRig, FollowerSettings, Inputs, Outputs, Rig as _, RigSettings, SIDES, SensorSettings},
};
use nima_testing::real_time::judged;

use crate::{
    emulated::provide_handles,
    emulators::{
        EmulatorThread,
        bota::EmulatedBota,
        force_dimension::{EmulatedForceDimension as Handle, EmulatedHand},
    },
};

/// Displacement of the commanded tip position, m, and its speed, m/s.
const TRAVEL_M: Vector3<f64> = Vector3::new(0.005, 0.003, 0.004);
const SPEED_M_S: f64 = 0.02;

/// Returns the handle, the sensor, and the rig file of the emulated rig with a simulated arm.
fn devices(folder: &std::path::Path) -> (RigSettings, [EmulatorThread; 2]) {
    provide_handles();
    let port = folder.join("sensor");
    let sensor = EmulatedBota { baud: None, boot_s: 0.0, link: Some(port.clone()), ..EmulatedBota::default() };
    let serving = [
        Handle { serial: 5151, ..Handle::default() }.with(EmulatedHand::default().body()).serve().unwrap(),
        sensor.with(Box::new(|_| ForceReading::default())).serve().unwrap(),
    ];
    let whole = RigConfig::load("emulated").unwrap().devices.unwrap();
    let mut right = whole.right.unwrap();
    let arm = right.kinematics().unwrap();
    let rcm = Rcm::new(&right.rcm).unwrap();
    let tip_m = right.rcm.trocar_m + right.rcm.inward.normalize() * 0.12;
    let start_rad: [f64; 7] = find(&arm, &rcm, &tip_m).unwrap().joint_rad.into();
    right.arm = FollowerSettings::Simulated(simulated_arm::SimulatedArmSettings::at(start_rad));
    right.servos = None;
    right.sensor = SensorSettings::Bota(bota::BotaSettings::new(bota::Transport::GenA, port.display().to_string()));
    let handle = right.handle.force_dimension_mut().unwrap();
    handle.serial = Some(5151);
    handle.emulator = Some(serving[0].endpoint.parse().unwrap());
    (RigSettings { right: Some(right), ..RigSettings::default() }, serving)
}

/// Runs ticks until `good`, for at most 20 s; returns whether it was reached.
fn until(
    rig: &mut DeviceRig,
    begin: Instant,
    mut led: impl FnMut(&Inputs) -> Outputs,
    good: impl Fn(&Inputs) -> bool,
) -> bool {
    let since = Instant::now();
    let mut outputs = Outputs::SAFE;
    while since.elapsed() < Duration::from_secs(20) {
        let now_s = begin.elapsed().as_secs_f64();
        let inputs = rig.read(now_s)[0];
        if let Some(inputs) = &inputs {
            if good(inputs) {
                return true;
            }
            outputs = led(inputs);
        }
        rig.write(now_s, &[outputs, Outputs::SAFE]);
        std::thread::sleep(Duration::from_millis(1));
    }
    false
}

#[test]
fn a_rig_leads_an_arm_of_another_make_that_its_file_names() {
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let (settings, _serving) = devices(folder.path());
        let (mut rig, roster) = DeviceRig::start(&settings, 1e-3, [false; SIDES]).unwrap();
        let drivers: Vec<_> = roster.iter().map(|entry| (entry.name(), entry.driver.as_str())).collect();
        assert_eq!(drivers[1], ("right arm", "simulated arm"));
        assert!(drivers[0].1.starts_with("Force Dimension omega.7") && drivers[2].1.starts_with("Bota sensor"));
        let begin = Instant::now();
        let mut home_m = None;
        let mut target_m = Vector3::zeros();
        let led = |inputs: &Inputs| {
            let home_m: Vector3<f64> = *home_m.get_or_insert_with(|| {
                target_m = inputs.tip_m;
                inputs.tip_m
            });
            assert_eq!(inputs.obstacle, None);
            // Drives on first, then small steps to the end of the path.
            if inputs.powered {
                target_m += (home_m + TRAVEL_M - target_m).cap_magnitude(SPEED_M_S * 1e-3);
            }
            Outputs { drives: true, tip_command_m: inputs.powered.then_some(target_m), ..Outputs::SAFE }
        };
        let tip_m = settings.right.as_ref().unwrap().rcm.trocar_m
            + settings.right.as_ref().unwrap().rcm.inward.normalize() * 0.12
            + TRAVEL_M;
        assert!(
            until(&mut rig, begin, led, |inputs| inputs.powered && (inputs.tip_m - tip_m).norm() < 5e-4),
            "not led there"
        );
        // Drives off: the arm brakes and no longer follows.
        assert!(until(&mut rig, begin, |_| Outputs::SAFE, |inputs| !inputs.powered), "drives stay on");
        let still = |inputs: &Inputs| (inputs.tip_m - tip_m).norm() < 1e-3;
        assert!(until(&mut rig, begin, |_| Outputs::SAFE, still), "does not rest");
        // The supervisor holds the arm's emergency release, and the arm's health is reported at its index.
        assert_eq!(rig.levers().len(), 2);
        let arm = rig.health().devices[1];
        assert!(arm.standing == ConnectionState::Connected && arm.refused == 0, "{arm:?}");
    });
}
