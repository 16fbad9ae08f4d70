//! An arm that is not a Gen3, in the 3-D view.

use std::path::Path;

use nima_devices::{ARM_JOINTS, ArmReading};
use nima_machine::{
    config::RigConfig,
    rig::{DEVICES_MAX, DeviceRig, Gauge, Gauges, RigPart, SIDES, Side},
};
use nima_screen::live::LiveState;
use nima_simulation::scene::Scene;

/// Base, joints, flange and sensor are as far apart as in the data sheet: 162.5, 425, 392.2 and 133.3, 99.7, 99.6 mm. The
/// first two joints of the arm, and its last joint and flange, are at one place.
#[test]
fn the_links_of_a_ur5e_have_their_lengths() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/arms/emulated-ur5e.toml");
    let config = RigConfig::load(path.to_str().unwrap()).unwrap();
    // Only the order of the devices is used; none is connected.
    let (_rig, roster) = DeviceRig::start(config.devices.as_ref().unwrap(), 1e-3, [false; SIDES]).unwrap();
    let place = roster.iter().position(|entry| entry.part == Some(RigPart::Arm(Side::Right))).unwrap();
    let mut live = LiveState::new(config, Scene::load("peg_transfer").unwrap());
    live.roster = roster;
    assert!(live.links_m(Side::Right).is_empty(), "its angles are unknown");
    for joint_rad in [[0.0; ARM_JOINTS], [0.3, -1.2, 1.5, -0.4, 0.8, 0.1, 0.0]] {
        let reading =
            ArmReading { joint_rad, joint_rad_s: [0.0; ARM_JOINTS], joint_nm: [0.0; ARM_JOINTS], servoing: true };
        let mut gauges = Gauges { from_s: 0.0, to_s: 0.1, devices: [Gauge::NONE; DEVICES_MAX] };
        gauges.devices[place].arm(&reading, 6);
        live.blocks.push_back(Box::new(gauges));
        let links_m = live.links_m(Side::Right);
        let lengths_mm: Vec<f32> = links_m.windows(2).map(|ends| (ends[1] - ends[0]).norm() * 1e3).collect();
        let sensor_mm = 60.0;
        let expected = [162.5, 0.0, 425.0, 392.2_f32.hypot(133.3), 99.7, 99.6, 0.0, sensor_mm];
        assert_eq!(lengths_mm.len(), expected.len(), "{lengths_mm:?}");
        for (length_mm, expected_mm) in lengths_mm.iter().zip(expected) {
            assert!((length_mm - expected_mm).abs() < 0.1, "{lengths_mm:?}");
        }
    }
}
