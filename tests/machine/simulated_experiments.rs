//! The simulated experiments: the sensors' readings must correspond to the actions.
use nalgebra::{UnitQuaternion, Vector3};
use nima_core::frames::{GRAVITY_M_S2, WristSample, from_roll_pitch_yaw_deg};
use nima_machine::{
    messages::{Command, ForceSource, LoopState},
    rig::{Outputs, Prompt, SensedForce, Side},
};
use nima_simulation::{
    SimulationPlan, World, run_virtual,
    scene::{Flaw, Scene},
};
use nima_tests::plan;

/// Returns the samples of `scene` with this instruction for some seconds at 1 kHz, with the true force on the tip.
fn samples(world: &mut World, from_s: f64, seconds: f64, prompt: Prompt) -> Vec<(WristSample, Vector3<f64>)> {
    let outputs = Outputs { prompt, ..Outputs::SAFE };
    (1..=(seconds * 1e3) as u32)
        .map(|i| {
            let inputs = world.exchange(from_s + f64::from(i) * 1e-3, &outputs).unwrap();
            match inputs.sensed {
                SensedForce::AtWrist(sample) => (sample, world.true_tip_n()),
                sensed => panic!("a calibration scene without a wrist: {sensed:?}"),
            }
        })
        .collect()
}

fn mean(samples: &[(WristSample, Vector3<f64>)], of: impl Fn(&WristSample) -> Vector3<f64>) -> Vector3<f64> {
    samples.iter().map(|(sample, _)| of(sample)).sum::<Vector3<f64>>() / samples.len() as f64
}

#[test]
fn the_tool_goes_where_it_is_asked_and_its_weight_turns_with_it() {
    let scene = Scene::load("gravity").unwrap();
    let wrist = scene.wrist.clone().unwrap();
    let mut world = World::new(&scene, 1000.0);
    let mut from_s = 0.0;
    for angles in [[0.0, 0.0, 0.0], [90.0, 0.0, 0.0], [0.0, 75.0, 0.0], [180.0, -30.0, 40.0]] {
        let asked = from_roll_pitch_yaw_deg(&angles.into());
        let all = samples(&mut world, from_s, 5.0, Prompt::Hold { world_from_s1: asked });
        from_s += 5.0;
        let still = &all[4000..];
        let there = still[0].0.world_from_s1.unwrap();
        assert!(there.angle_to(&asked) < 0.3, "{angles:?}: off by {} rad", there.angle_to(&asked));
        let weight_n = there.inverse() * Vector3::new(0.0, 0.0, -GRAVITY_M_S2 * wrist.tool_mass_kg);
        let expected_n = weight_n.component_mul(&wrist.gain) + wrist.force_bias_n;
        assert!((mean(still, |s| s.raw.force_n) - expected_n).norm() < 0.01);
        assert!(mean(still, |s| s.acceleration_m_s2.unwrap()).norm() - GRAVITY_M_S2 < 0.2);
    }
}

#[test]
fn pushes_go_where_they_are_asked_and_both_sensors_feel_them() {
    let scene = Scene::load("correspondence").unwrap();
    let mut world = World::new(&scene, 1000.0);
    for (k, asked) in [Vector3::z_axis(), Vector3::x_axis(), -Vector3::y_axis()].into_iter().enumerate() {
        let all = samples(&mut world, 4.0 * k as f64, 4.0, Prompt::Push { direction: asked });
        let (peak, true_n) = all.iter().max_by(|a, b| a.1.norm().total_cmp(&b.1.norm())).unwrap();
        assert!((2.0..=4.0).contains(&true_n.norm()));
        assert!((-true_n).angle(&asked) < 0.4, "{true_n} for {asked:?}");
        assert!((peak.tissue_n.unwrap().norm() - true_n.norm()).abs() < 0.3);
        assert!(peak.insertion_m.is_none(), "no body wall in this experiment");
    }
}

#[test]
fn through_the_trocar_the_wrist_feels_more_than_the_tip() {
    let contact = |scene: &str, prompt| {
        let scene = Scene::load(scene).unwrap();
        let mut world = World::new(&scene, 1000.0);
        samples(&mut world, 0.0, 30.0, prompt)
    };
    let work = contact("isolation", Prompt::Work);
    let peak_n = work.iter().map(|(_, tip)| tip.norm()).fold(0.0, f64::max);
    assert!((1.5..6.0).contains(&peak_n), "{peak_n} N");
    let touching = work.iter().filter(|(_, tip)| tip.norm() > 0.05).count();
    assert!((0.2..0.8).contains(&(touching as f64 / work.len() as f64)), "{touching} of {}", work.len());
    let free = contact("no_contact", Prompt::WorkFree);
    assert!(free.iter().all(|(_, tip)| tip.norm() < 1e-12));
    let scene = Scene::load("no_contact").unwrap();
    let wrist = scene.wrist.unwrap();
    let friction_n = |(sample, _): &(WristSample, Vector3<f64>)| {
        let weight_n =
            sample.world_from_s1.unwrap().inverse() * Vector3::new(0.0, 0.0, -GRAVITY_M_S2 * wrist.tool_mass_kg);
        (sample.raw.force_n - wrist.force_bias_n - weight_n).z
    };
    let along: Vec<f64> = free.iter().map(friction_n).collect();
    let inwards = along.iter().filter(|f| **f < -0.4).count();
    let outwards = along.iter().filter(|f| **f > 0.4).count();
    assert!(inwards * 10 > along.len() && outwards * 10 > along.len(), "friction both ways: {inwards}, {outwards}");
}

#[test]
fn each_flaw_shows_in_the_data() {
    let flawed = |name: &str, flaw, prompt, seconds| {
        let mut scene = Scene::load(name).unwrap();
        scene.person.as_mut().unwrap().flaw = Some(flaw);
        samples(&mut World::new(&scene, 1000.0), 0.0, seconds, prompt)
    };
    let tilt = Prompt::Hold { world_from_s1: UnitQuaternion::from_euler_angles(1.2, 0.4, 0.0) };
    let spread = |all: &[(WristSample, Vector3<f64>)]| {
        let middle = mean(all, |s| s.raw.force_n);
        (all.iter().map(|(s, _)| (s.raw.force_n - middle).norm_squared()).sum::<f64>() / all.len() as f64).sqrt()
    };
    assert!(spread(&flawed("gravity", Flaw::Touches, tilt, 6.0)[3000..]) > 0.15);
    assert!(spread(&flawed("gravity", Flaw::Trembles, tilt, 6.0)[3000..]) > 0.1);
    let kept = flawed("gravity", Flaw::KeepsOneOrientation, tilt, 4.0);
    assert!(kept[0].0.world_from_s1.unwrap().angle_to(&kept[3999].0.world_from_s1.unwrap()) < 1e-9);
    let sideways = Prompt::Push { direction: Vector3::y_axis() };
    let line = flawed("correspondence", Flaw::PushesOneLine, sideways, 6.0);
    assert!(line.iter().all(|(_, tip)| tip.xy().norm() < 0.25));
    let plane = flawed("correspondence", Flaw::PushesOnePlane, Prompt::Push { direction: Vector3::x_axis() }, 12.0);
    assert!(plane.iter().all(|(_, tip)| tip.y.abs() < 0.2));
    let leaning = flawed("correspondence", Flaw::LeansOnTheStand, sideways, 12.0);
    assert!(leaning.iter().any(|(s, tip)| (s.tissue_n.unwrap().norm() - tip.norm()).abs() > 0.5));
}

#[test]
fn a_prompt_reaches_the_arm_in_idle_only() {
    for (engage, expected) in [(false, Prompt::Wave), (true, Prompt::Rest)] {
        let mut last = Prompt::Rest;
        run_virtual(&SimulationPlan { engage, ..plan("peg_transfer") }, 0.1, |tick| {
            last = tick.guidance.prompt;
            (tick.index == 10).then_some(Command::Prompt(Side::Right, Prompt::Wave))
        })
        .unwrap();
        assert_eq!(last, expected);
    }
}

#[test]
fn an_uncalibrated_wrist_gives_no_force_and_cannot_be_engaged() {
    run_virtual(&SimulationPlan { engage: false, ..plan("palpation") }, 2.0, |tick| {
        assert_eq!(tick.force.source, ForceSource::Uncalibrated);
        assert_eq!(tick.state, LoopState::Idle);
        assert!(tick.rendering.rendered_n.norm() < 1e-12 && tick.measured_n.iter().all(|x| x.is_nan()));
        (tick.index == 500).then_some(Command::Engage)
    })
    .unwrap();
}
