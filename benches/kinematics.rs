//! One step of the inverse kinematics through the trocar, and one forward kinematics: percentiles over a moving target.
//!
//! `cargo bench -p nima --bench kinematics`.
#![expect(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

use std::{hint::black_box, time::Instant};

use nalgebra::Vector3;
use nima_core::kinematics::{Arm, ArmSettings, Inverse, Joints, Rcm, RcmSettings, find};

const STEPS: u32 = 200_000;

fn main() {
    let arm = Arm::new(&ArmSettings {
        base_m: Vector3::zeros(),
        base_deg: Vector3::zeros(),
        sensor_m: Vector3::new(0.0, 0.0, 0.06),
        sensor_deg: Vector3::zeros(),
        shaft_m: 0.42,
    })
    .unwrap();
    let trocar_m = Vector3::new(0.4, 0.0, -0.1);
    let rcm = Rcm::new(&RcmSettings {
        trocar_m,
        inward: -Vector3::z(),
        cone_deg: 20.0,
        insertion_min_m: 0.03,
        insertion_max_m: 0.25,
    })
    .unwrap();
    let middle_m = trocar_m - Vector3::z() * 0.12;
    let search = Instant::now();
    let ready = find(&arm, &rcm, &middle_m).unwrap();
    println!("search of a ready pose: {:.2} s, reaches {:.0} %", search.elapsed().as_secs_f64(), 100.0 * ready.reached);
    let mut inverse = Inverse::new(arm, rcm, 1e-3, &ready.joint_rad).unwrap();
    report("step through the trocar", |k| {
        let t_s = f64::from(k) * 1e-3;
        let travel_m = Vector3::new((3.0 * t_s).sin(), (2.3 * t_s).cos(), (1.7 * t_s).sin()) * 0.04;
        inverse.step(&(middle_m + travel_m)).joint_rad[0]
    });
    report("forward kinematics", |k| arm.pose(&(ready.joint_rad + Joints::repeat(f64::from(k) * 1e-6))).tip_m.x);
}

fn report(name: &str, mut call: impl FnMut(u32) -> f64) {
    let mut times_us: Vec<f64> = (0..STEPS)
        .map(|k| {
            let start = Instant::now();
            black_box(call(black_box(k)));
            1e6 * start.elapsed().as_secs_f64()
        })
        .collect();
    times_us.sort_by(f64::total_cmp);
    let at = |fraction: f64| times_us[(fraction * f64::from(STEPS - 1)) as usize];
    println!("{name}: p50 {:.2} us, p99 {:.2} us, p99.9 {:.2} us", at(0.5), at(0.99), at(0.999));
}
