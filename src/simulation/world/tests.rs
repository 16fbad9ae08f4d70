//! The world by itself, in free running.

use nalgebra::Vector3;
use nima_machine::rig::{Inputs, Outputs, SensedForce};

use super::World;
use crate::scene::Scene;

fn force_n(inputs: &Inputs) -> Vector3<f64> {
    match inputs.sensed {
        SensedForce::AtTip(force_n) => force_n,
        sensed => panic!("not at the tip: {sensed:?}"),
    }
}

fn run(scene: &Scene, seconds: f64) -> Vec<Inputs> {
    let mut world = World::new(scene, 1000.0);
    let mut outputs = Outputs::SAFE;
    (0..(seconds * 1000.0) as usize)
        .filter_map(|i| {
            let inputs = world.exchange(i as f64 * 1e-3, &outputs);
            outputs.tip_command_m = inputs.map(|inputs| inputs.hand.position_m);
            inputs
        })
        .collect()
}

#[test]
fn peg_transfer_presses_with_a_few_newtons_and_lets_go() {
    let inputs = run(&Scene::load("peg_transfer").unwrap(), 20.0);
    let peak_n = inputs.iter().map(|i| force_n(i).z).fold(0.0, f64::max);
    assert!((1.0..6.0).contains(&peak_n), "peak {peak_n} N");
    let free = inputs.iter().filter(|i| force_n(i).norm() < 0.1).count();
    assert!(free * 4 > inputs.len(), "a good part of the task is in free space: {free}");
    let travel_m = inputs.iter().map(|i| i.tip_m.x).fold(0.0, f64::max);
    assert!(travel_m > 0.025, "it reaches the far pegs: {travel_m}");
}

#[test]
fn a_seed_repeats_exactly() {
    let scene = Scene::load("peg_transfer").unwrap();
    // Compared as text, exact to the last bit: missing channels are NaN, which equals nothing.
    let [one, other] = [(); 2].map(|()| format!("{:?}", run(&scene, 2.0)));
    assert!(one == other && one.contains("tip_m"));
}

#[test]
fn free_motion_measures_noise_only() {
    let inputs = run(&Scene::load("free_motion").unwrap(), 10.0);
    let mean = inputs.iter().map(force_n).sum::<Vector3<f64>>() / inputs.len() as f64;
    assert!(mean.norm() < 0.002, "{mean}");
}

#[test]
fn without_a_listed_part_the_part_is_ideal() {
    let mut scene = Scene::load("peg_transfer").unwrap();
    scene.tissue = None;
    scene.leader = None;
    scene.follower = None;
    scene.sensor = None;
    let inputs = run(&scene, 5.0);
    assert!(inputs.iter().all(|i| force_n(i) == Vector3::zeros()));
    assert!(inputs.windows(2).all(|pair| pair[1].tip_m == pair[0].hand.position_m));
}

#[test]
fn a_force_on_the_hand_moves_it_and_a_poisoned_one_does_not() {
    let scene = Scene::load("free_motion").unwrap();
    let pushed = |force_n| {
        let mut world = World::new(&scene, 1000.0);
        for i in 0..500 {
            world.exchange(f64::from(i) * 1e-3, &Outputs { hand_force_n: force_n, ..Outputs::SAFE });
        }
        world.hand().position_m()
    };
    let still = pushed(Vector3::zeros());
    let up = pushed(Vector3::z() * 4.0);
    let poisoned = pushed(Vector3::z() * f64::NAN);
    assert!((up.z - still.z) > 0.003, "{}", up.z - still.z);
    assert_eq!(poisoned, still);
}

/// Returns the times of the loop in tenths of a millisecond: most ticks one period apart, some late, some soon after a
/// late one.
fn late_ticks() -> impl Iterator<Item = u32> {
    [10, 10, 14, 6, 32, 8, 45, 5, 10, 19, 1].into_iter().cycle().scan(0, |now, interval| {
        *now += interval;
        Some(*now)
    })
}

#[test]
fn a_late_tick_finds_the_hand_where_it_is_by_then() {
    let scene = Scene::load("peg_transfer").unwrap();
    let outputs = Outputs { hand_force_n: Vector3::new(0.0, 0.5, 1.0), ..Outputs::SAFE };
    let [mut late, mut even] = [(); 2].map(|()| World::new(&scene, 1000.0));
    let at = |ms: u32| {
        even.advance_to(f64::from(ms) * 1e-3, &outputs);
        even.hand().position_m()
    };
    let positions_m: Vec<_> = (0..=4000).map(at).collect();
    let mut fastest_m_s = 0.0_f64;
    for tenth in late_ticks().take_while(|now| *now < 40_000) {
        late.advance_to(f64::from(tenth) * 1e-4, &outputs);
        let [before_m, after_m] = [0, 1].map(|next| positions_m[tenth as usize / 10 + next]);
        let there_m = before_m + (after_m - before_m) * (f64::from(tenth % 10) / 10.0);
        fastest_m_s = fastest_m_s.max((after_m - before_m).norm() / 1e-3);
        let off_m = (late.hand().position_m() - there_m).norm();
        // Half a period of motion is 90 um at the maximum speed; unequal integration steps cause smaller differences.
        assert!(off_m < 2e-5, "at {:.1} ms: {:.1} um", f64::from(tenth) / 10.0, 1e6 * off_m);
    }
    assert!(fastest_m_s > 0.1, "{fastest_m_s} m/s");
}

#[test]
fn a_pause_of_100_ms_takes_the_hand_100_ms_further() {
    let scene = Scene::load("peg_transfer").unwrap();
    let outputs = Outputs { hand_force_n: Vector3::z(), ..Outputs::SAFE };
    let after = |times_ms: &mut dyn Iterator<Item = u32>| {
        let mut world = World::new(&scene, 1000.0);
        times_ms.for_each(|ms| {
            world.advance_to(f64::from(ms) * 1e-3, &outputs);
        });
        world.hand().position_m()
    };
    let without = after(&mut (0..=250));
    let with = after(&mut (0..=150).chain([250]));
    assert!((with - without).norm() < 1e-9, "{without} {with}");
    assert!((after(&mut (0..=150)) - without).norm() > 5e-3, "it moves meanwhile");
}
