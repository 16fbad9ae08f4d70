//! Arms that are not a Gen3 with seven joints, from their descriptions: the example of an external arm as a `UR5e`, and
//! emulated arms on their wires.

use std::cell::Cell;

use nalgebra::{Isometry3, Vector3};
use nima_core::kinematics::{Joints, Rcm, find};
use nima_emulation::emulated::{EmulatedRig, HandFrame, provide_handles};
use nima_machine::{
    config::RigConfig,
    messages::{LoopState, Tick},
    rig::{ArmSet, Side},
};
use nima_simulation::scene::Scene;
use nima_testing::real_time::{alone, judged};

use super::external::{Examples, Fixture, free_ports, here};

/// Maximum distance of the measured shaft from the trocar, m.
const MISS_MAX_M: f64 = 1e-4;
const TICKS: usize = 10_000;

/// Returns the maximum distance of the shaft from the trocar, m, from the measured angles.
fn worst_miss_m(set: &ArmSet, ticks: &[Tick]) -> f64 {
    let arm = set.kinematics().unwrap();
    let sensor = arm.flange_from_s1();
    let base = Isometry3::from_parts(arm.world_from_base().translation, arm.world_from_base().rotation.into());
    let miss_m = |tick: &Tick| {
        let base_from_flange = tick.calibration.frames.base_from_flange?;
        let s1 = base * base_from_flange * Isometry3::from_parts(sensor.translation, sensor.rotation.into());
        let along = s1.rotation * Vector3::z();
        Some((s1.translation.vector - set.rcm.trocar_m).cross(&along).norm())
    };
    ticks.iter().filter_map(miss_m).fold(0.0, f64::max)
}

/// Returns the shipped rig of an emulated arm, on free ports.
fn emulated_ur5e(folder: &std::path::Path) -> String {
    let text = std::fs::read_to_string(here("assets/arms/emulated-ur5e.toml")).unwrap();
    let [handle, arm, _] = free_ports();
    let sensor = folder.join("ttyACM-sensor").display().to_string();
    [
        ("47210", handle.to_string().as_str()),
        ("47211", arm.to_string().as_str()),
        ("ttyACM-ur5e-sensor", sensor.as_str()),
    ]
    .iter()
    .fold(text, |text, (from, to)| {
        assert!(text.contains(from));
        text.replace(from, to)
    })
}

/// Returns the same rig with a Gen3 with six joints, on the wire of its maker.
fn emulated_gen3_six(folder: &std::path::Path) -> String {
    let text = emulated_ur5e(folder);
    let [tcp_port, udp_port, _] = free_ports();
    let (before, after) = text.split_once("make = \"external\"\n").unwrap();
    let (_, after) = after.split_once('\n').unwrap();
    let on_its_wire = format!("{before}host = \"127.0.0.1\"\ntcp_port = {tcp_port}\nudp_port = {udp_port}\n{after}");
    on_its_wire
        .replace("ur5e.urdf", "gen3-6dof.urdf")
        .replace("base_link_inertia", "base_link")
        .replace("tool0", "end_effector_link")
}

/// Engages the emulated rig and lets the simulated hand lead the arm for a while.
fn lead_emulated(name: &str, text: &str) {
    provide_handles();
    let rig = RigConfig::parse(&here("assets/arms/emulated-ur5e.toml"), text).unwrap();
    let set = rig.devices.clone().unwrap().right.unwrap();
    let model = set.model().unwrap();
    let hand = HandFrame::of(&rig.teleoperation.mapping());
    let scene = Scene::load("peg_transfer").unwrap();
    let emulated = EmulatedRig::start(rig.devices.as_ref().unwrap(), &scene, &[hand; 2]).unwrap();
    let mut bench = Fixture::new(rig);
    bench.engage();
    let begin_m = emulated.truth(Side::Right).unwrap().tip_m;
    bench.ticks.clear();
    let [margin_rad, travel_m] = [Cell::new(f64::INFINITY), Cell::new(0.0)];
    bench.until("a while", |bench| {
        let truth = emulated.truth(Side::Right).unwrap();
        margin_rad.set(margin_rad.get().min(model.limit_margin_rad(&Joints::from(truth.joint_rad))));
        travel_m.set(f64::max(travel_m.get(), (truth.tip_m - begin_m).norm()));
        bench.ticks.len() > TICKS || bench.state() != LoopState::Engaged
    });
    let worst_m = worst_miss_m(&set, &bench.ticks);
    println!(
        "{name}: {} ticks, {:?}: the tip moved {} m, the shaft missed the trocar by at most {worst_m} m, {} rad to a limit",
        bench.ticks.len(),
        bench.state(),
        travel_m.get(),
        margin_rad.get()
    );
    assert!(travel_m.get() > 5e-3, "{name}: it hardly moved: {} m", travel_m.get());
    assert!(worst_m > 0.0 && worst_m <= MISS_MAX_M, "{name}: {worst_m} m beside the trocar");
    assert!(margin_rad.get() > 0.0, "{name}: beyond a limit by {} rad", -margin_rad.get());
    assert_eq!(bench.state(), LoopState::Engaged, "{name}");
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn a_gen3_with_six_joints_is_led_through_its_trocar_on_the_wire_of_its_maker() {
    let _alone = alone();
    judged(|| lead_emulated("Gen3 with six joints", &emulated_gen3_six(tempfile::tempdir().unwrap().path())));
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn a_ur5e_on_the_emulated_rig_is_led_through_its_trocar() {
    let _alone = alone();
    judged(|| lead_emulated("UR5e", &emulated_ur5e(tempfile::tempdir().unwrap().path())));
}

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
        assert_eq!(bench.state(), LoopState::Engaged);
        let worst_m = worst_miss_m(&set, &bench.ticks);
        let travel_m = bench.ticks.iter().map(|tick| (tick.positions.tip_m - tip_m).norm()).fold(0.0, f64::max);
        println!("the tip moved {travel_m} m, the shaft missed the trocar by at most {worst_m} m");
        assert!(travel_m > 5e-3, "it hardly moved: {travel_m} m");
        assert!(worst_m <= MISS_MAX_M, "{worst_m} m beside the trocar");
    });
}
