//! Nothing gains energy by itself.

use nalgebra::Vector3;

use super::{Scene, at};
use crate::physics::ObjectSettings;

/// Simulates six rings for this long, at rest or `thrown`. The energy may never exceed its earlier value, except for
/// the energy stored in contacts.
fn energy_never_grows(thrown: bool, seconds: u32) {
    let mut scene = Scene::new(&ObjectSettings::default());
    if thrown {
        for ring in 0..6 {
            let i = ring as f64;
            let turn = Vector3::new(1.0, 0.4 - 0.2 * i, 0.3) * 2e-6;
            let velocity_m_s = at(0.02 * i - 0.05, 0.03, 0.1);
            scene.objects.ring_mut(ring).throw(at(0.016 * i - 0.04, 0.013, 0.04), velocity_m_s, turn);
        }
    }
    let mut min_j = scene.objects.energy_j();
    for _ in 0..seconds {
        for _ in 0..1000 {
            scene.objects.step(&[None, None]);
            // Without sleep mode, which would hide a growth of energy.
            (0..6).for_each(|ring| scene.objects.ring_mut(ring).wake());
        }
        let energy_j = scene.objects.energy_j();
        assert!(energy_j < min_j + 2e-7, "from {min_j} J to {energy_j} J");
        min_j = min_j.min(energy_j);
    }
    if thrown {
        let slow = (0..6).all(|ring| scene.objects.ring_mut(ring).velocity_m_s.norm() < 1e-3);
        assert!(slow, "it comes to rest: {:?}", scene.objects.rings());
    }
}

#[test]
fn energy_does_not_grow_at_rest_or_after_a_tumble() {
    energy_never_grows(false, 4);
    energy_never_grows(true, 8);
}

#[test]
#[ignore = "computes for half a minute"]
fn figures_of_energy_over_ten_minutes() {
    energy_never_grows(false, 600);
    energy_never_grows(true, 600);
}
