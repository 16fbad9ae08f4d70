//! Tests: the same calls give bit-identical results.

use super::{LEFT, RIGHT, Scene, at, instrument};
use crate::physics::{ObjectSettings, Objects};

/// Ten seconds in which both hands grasp, shove and cross.
fn digest(period_s: f64) -> u64 {
    let mut scene = Scene::new(&ObjectSettings::default());
    scene.objects = Objects::new(&ObjectSettings::default(), period_s);
    let mut digest = 0xcbf2_9ce4_8422_2325_u64;
    let mut mix = |x: f64| digest = (digest ^ x.to_bits()).wrapping_mul(0x0100_0000_01b3);
    let ticks = (10.0 / period_s) as u32;
    for tick in 0..ticks {
        let t_s = f64::from(tick) * period_s;
        let wave = |rate: f64, phase: f64| libm::sin(rate * t_s + phase);
        let tip_m = |side: f64| {
            at(
                side * 0.025 + 0.035 * wave(2.1 + 0.3 * side, side),
                0.035 * wave(1.3, 2.0 * side),
                0.012 + 0.014 * wave(3.7, side),
            )
        };
        let opening_rad = |side: f64| (0.5 * wave(4.0, side)).max(0.0);
        scene.hands[LEFT] = Some(instrument(LEFT, tip_m(-1.0), opening_rad(-1.0)));
        scene.hands[RIGHT] = (tick % 4000 > 20).then(|| instrument(RIGHT, tip_m(1.0), opening_rad(1.0)));
        scene.tick();
        for loads in [LEFT, RIGHT].map(|side| scene.loads[side]) {
            loads.tip_n.iter().chain(loads.torque_nm.iter()).for_each(|x| mix(*x));
            mix(loads.opening_n);
        }
    }
    for ring in scene.objects.rings() {
        ring.centre_m.iter().chain(ring.world_from_ring.coords.iter()).for_each(|x| mix(*x));
    }
    mix(scene.events.len() as f64);
    digest
}

#[test]
fn ten_seconds_repeat_to_the_last_bit_in_every_build() {
    let first = digest(1e-3);
    assert_eq!(first, digest(1e-3));
    assert_eq!(first, 0xe141_2aee_caa3_272d, "a build, a processor or a law has changed: {first:#018x}");
}

#[test]
fn other_rates_run_too() {
    for period_s in [2.5e-4, 4e-3, f64::NAN, -1.0] {
        let mut objects = Objects::new(&ObjectSettings::default(), period_s);
        for _ in 0..200 {
            objects.step(&[None, None]);
        }
        assert!(
            objects.rings().iter().enumerate().all(|(i, ring)| ring.doing == crate::physics::RingActivity::OnPeg(i))
        );
    }
}
