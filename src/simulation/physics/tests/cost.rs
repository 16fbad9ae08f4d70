//! Cost of a step.

use std::time::Instant;

use super::{LEFT, RIGHT, Scene, at, instrument};
use crate::physics::{ObjectSettings, tests::OPEN_RAD};

/// Times `ticks` steps; `before` is called before each step and not timed.
fn report(name: &str, scene: &mut Scene, ticks: u32, mut before: impl FnMut(&mut Scene, u32)) {
    let mut costs_us: Vec<f64> = (0..ticks)
        .map(|tick| {
            before(scene, tick);
            let begin = Instant::now();
            std::hint::black_box(scene.objects.step(&scene.hands));
            begin.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    costs_us.sort_by(f64::total_cmp);
    let at = |fraction: f64| costs_us[((costs_us.len() - 1) as f64 * fraction) as usize];
    println!("{name}: p50 {:.1} us, p99 {:.1} us, p99.9 {:.1} us of {ticks}", at(0.5), at(0.99), at(0.999));
}

fn swing(scene: &mut Scene, tick: u32, height_m: f64) {
    for (side, sign) in [(LEFT, -1.0), (RIGHT, 1.0)] {
        let t_s = f64::from(tick) * 1e-3;
        let tip_m = at(0.03 * sign + 0.02 * libm::sin(2.0 * t_s), 0.03 * libm::sin(1.3 * t_s + sign), height_m);
        scene.hands[side] = Some(instrument(side, tip_m, 0.3));
    }
}

fn throw(scene: &mut Scene) {
    for ring in 0..6 {
        let i = ring as f64;
        let from_m = at(0.012 * i - 0.03, 0.013, 0.03);
        let velocity_m_s = at(0.05, 0.02 * i - 0.05, 0.0);
        scene.objects.ring_mut(ring).throw(from_m, velocity_m_s, at(10.0, 5.0, 3.0) * 6e-8);
    }
}

#[test]
#[ignore = "measures time"]
fn figures_of_a_step() {
    let mut scene = Scene::new(&ObjectSettings { rings: Vec::new(), ..ObjectSettings::default() });
    report("two instruments, no rings", &mut scene, 10_000, |scene, tick| swing(scene, tick, 0.06));
    let mut scene = Scene::new(&ObjectSettings::default());
    scene.run(1.0);
    report("six rings at rest on pegs", &mut scene, 10_000, |scene, tick| swing(scene, tick, 0.06));
    let mut scene = Scene::new(&ObjectSettings::default());
    scene.grasp(LEFT, 0, -1.0);
    let tip_m = scene.hands[LEFT].unwrap().tip_m;
    scene.glide(LEFT, tip_m + at(0.0, 0.0, 0.05), 0.1);
    scene.hands[RIGHT] = Some(instrument(RIGHT, at(0.03, 0.0, 0.05), OPEN_RAD));
    report("one held", &mut scene, 10_000, |scene, tick| {
        scene.hands[LEFT].as_mut().unwrap().tip_m.y += 1e-5 * libm::sin(f64::from(tick) * 2e-3);
    });
    let mut scene = Scene::new(&ObjectSettings::default());
    report("two instruments sweep through all", &mut scene, 10_000, |scene, tick| swing(scene, tick, 0.004));
    let mut scene = Scene::new(&ObjectSettings::default());
    report("all tumbling, two instruments among them", &mut scene, 10_000, |scene, tick| {
        swing(scene, tick, 0.004);
        if tick % 400 == 0 {
            throw(scene);
        }
    });
}
