//! Messages of the other machine, after decryption: they never give the loop a number that is not finite.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nima_machine::{
    config::RigConfig,
    remote::{FollowerRig, OperatorRig, RemoteWire},
    rig::{Inputs, Rig, SIDES},
};
use nima_simulation::{Worlds, scene::Scene};

/// Delivers the same message in every tick.
struct FuzzedWire<'a>(&'a [u8]);

impl RemoteWire for FuzzedWire<'_> {
    fn send(&mut self, _: f64, _: &[u8]) {}

    fn receive(&mut self, _: f64, take: &mut dyn FnMut(&[u8])) {
        take(self.0);
    }
}

thread_local! {
    static SCENE: (RigConfig, Scene) =
        (RigConfig::load("simulated").expect("a built-in rig"), Scene::load("bimanual").expect("a built-in scene"));
}

fn check(inputs: &[Option<Inputs>; SIDES]) {
    for inputs in inputs.iter().flatten() {
        assert!(inputs.is_finite(), "{inputs:?}");
    }
}

fuzz_target!(|bytes: &[u8]| {
    SCENE.with(|(config, scene)| {
        let worlds = || Worlds::new(scene, config.rate_hz);
        let mut operator = OperatorRig::new(worlds(), FuzzedWire(bytes), config.rate_hz);
        let mut follower = FollowerRig::new(worlds(), FuzzedWire(bytes), config.rate_hz);
        for tick in 1..4 {
            let now_s = f64::from(tick) / config.rate_hz;
            check(&operator.read(now_s));
            check(&follower.read(now_s));
            while operator.command().is_some() || follower.command().is_some() {}
        }
    });
});
