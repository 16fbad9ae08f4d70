//! An arm that is not a Gen3, from its description: the example of an external arm as a `UR5e`.

use nalgebra::Isometry3;
use nima_core::kinematics::{Rcm, find};
use nima_machine::{
    config::RigConfig,
    messages::{LoopState, Tick},
};
use nima_testing::real_time::{alone, judged, too_busy};

use super::external::{Examples, Fixture, free_ports, here};

/// Maximum distance of the measured shaft from the trocar, m.
const MISS_MAX_M: f64 = 1e-4;
const TICKS: usize = 10_000;

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn a_ur5e_is_led_through_its_trocar() {
    let _alone = alone();
    judged(|| {
        let ports = free_ports();
        let path = here("assets/arms/ur5e.toml");
        let mut text = std::fs::read_to_string(&path).unwrap();
        for (written, port) in ["47200", "47201", "47202"].into_iter().zip(ports) {
            text = text.replace(written, &port.to_string());
        }
        let rig = RigConfig::parse(&path, &text).unwrap();
        let set = rig.devices.clone().unwrap().right.unwrap();
        let arm = set.kinematics().unwrap();
        let trocar_m = set.rcm.trocar_m;
        let tip_m = trocar_m + set.rcm.inward.normalize() * 0.12;
        let begin_rad = find(&arm, &Rcm::new(&set.rcm).unwrap(), &tip_m).unwrap().joint_rad;
        let begin: Vec<String> =
            std::iter::once("inf".to_owned()).chain(begin_rad.iter().take(6).map(|rad| format!("{rad:.6}"))).collect();
        println!("the joints begin at {}", begin[1..].join(" "));
        let _hand = Examples::Python.start("handle", &ports[..1]);
        let _arm = Examples::Python.start_with("arm_and_sensor", &ports[1..], &begin);
        let mut bench = Fixture::new(rig);
        bench.engage();
        bench.ticks.clear();
        bench.until("a while", |bench| bench.ticks.len() > TICKS || bench.state() != LoopState::Engaged);
        if bench.state() != LoopState::Engaged {
            too_busy();
        }
        let miss_m = |tick: &Tick| {
            let base_from_flange = tick.calibration.frames.base_from_flange?;
            let base = Isometry3::from_parts(arm.world_from_base().translation, arm.world_from_base().rotation.into());
            let sensor = arm.flange_from_s1();
            let s1 = base * base_from_flange * Isometry3::from_parts(sensor.translation, sensor.rotation.into());
            let along = s1.rotation * nalgebra::Vector3::z();
            Some((s1.translation.vector - trocar_m).cross(&along).norm())
        };
        let worst_m = bench.ticks.iter().filter_map(miss_m).fold(0.0, f64::max);
        let travel_m = bench.ticks.iter().map(|tick| (tick.positions.tip_m - tip_m).norm()).fold(0.0, f64::max);
        println!("the tip moved {travel_m} m, the shaft missed the trocar by at most {worst_m} m");
        assert!(travel_m > 5e-3, "it hardly moved: {travel_m} m");
        assert!(worst_m <= MISS_MAX_M, "{worst_m} m beside the trocar");
    });
}
