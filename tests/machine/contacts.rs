//! Effects of real contacts on the force at a tip from sample to sample, and the loop's response.

use std::sync::{Arc, Mutex};

use nalgebra::Vector3;
use nima_core::impedance::Mode;
use nima_machine::{
    messages::{Command, Fault, LoopState},
    rig::{Inputs, Outputs, Rig, SIDES, SensedForce, Side},
    runtime::{self, Assembly},
};
use nima_tests::plan;

/// Force at the tip, N, and its position, m.
type Sample = (Vector3<f64>, Vector3<f64>);

/// Stores a rig's measurements.
struct Measurements {
    rig: Box<dyn Rig>,
    kept: Arc<Mutex<[Vec<Sample>; SIDES]>>,
}

impl Rig for Measurements {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        let inputs = self.rig.read(now_s);
        let mut kept = self.kept.lock().unwrap();
        for (kept, inputs) in kept.iter_mut().zip(&inputs) {
            if let Some(Inputs { sensed: SensedForce::AtTip(force_n), tip_m, .. }) = inputs {
                kept.push((*force_n, *tip_m));
            }
        }
        inputs
    }

    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        self.rig.write(now_s, outputs);
    }
}

/// End of a run, and its measurements.
struct RunResult {
    seconds: f64,
    fault: Option<Fault>,
    samples: [Vec<Sample>; SIDES],
}

/// Two hands without force perception, with their own pace and tremor, or the single hand of another scene.
fn run(scene: &str, (mode, gain, delay_s): (Mode, f64, f64), seed: u64, seconds: f64) -> RunResult {
    let mut plan = plan(scene);
    plan.rig.mode = mode;
    plan.rig.gates.gain = gain;
    plan.rig.delay_s = delay_s;
    let mut lot = fastrand::Rng::with_seed(seed);
    plan.scene.seed = seed;
    plan.scene.hand.pace = 0.7 + 0.5 * lot.f64();
    plan.scene.hand.tremor_m = 5e-5 + 1e-4 * lot.f64();
    let assembly = plan.simulated().unwrap();
    let kept = Arc::new(Mutex::new([Vec::new(), Vec::new()]));
    let rig = Box::new(Measurements { rig: assembly.rig, kept: Arc::clone(&kept) });
    let mut fault = None;
    let mut after = 0;
    let summary = runtime::run_virtual(Assembly { rig, ..assembly }, seconds, |tick| {
        if let LoopState::Faulted(found) = tick.state {
            fault.get_or_insert(found);
            after += 1;
        }
        (after > 16).then_some(Command::Shutdown)
    });
    let samples = std::mem::take(&mut *kept.lock().unwrap());
    RunResult { seconds: summary.seconds, fault, samples }
}

/// Returns where the force changes by more than half a newton plus 5 N for each millimetre of the tip's travel: the
/// change, and the forces around it, N.
fn leaps(samples: &[Sample]) -> Vec<(usize, Vec<f64>)> {
    let travel_m = |k: usize| (samples[k].1 - samples[k - 1].1).norm();
    let mut found: Vec<(usize, Vec<f64>)> = Vec::new();
    for k in 10..samples.len().saturating_sub(8) {
        let max_n = 0.5 + 5e3 * (k - 3..=k).map(travel_m).fold(0.0, f64::max);
        let is_new = found.last().is_none_or(|(before, _)| k > before + 12);
        if is_new && (samples[k].0 - samples[k - 3].0).norm() > max_n + 0.3 {
            found.push((k, (k - 5..k + 8).map(|k| samples[k].0.norm()).collect()));
        }
    }
    found
}

/// The left jaws press a ring until it snaps away, 80 s after the start: 2 N vanish within 4 ms.
#[test]
fn a_ring_that_snaps_out_of_the_jaws_is_no_fault() {
    let ran = run("rings", (Mode::Dfr, 0.4, 0.3), 3, 90.0);
    assert_eq!(ran.fault, None, "after {} s", ran.seconds);
    let snaps = leaps(&ran.samples[Side::Left.index()]);
    let fast = |sizes_n: &[f64]| sizes_n.windows(5).any(|five| five[0] > 1.5 && five[4] < 0.5);
    assert!(snaps.iter().any(|(_, sizes_n)| fast(sizes_n)), "a ring snaps: {snaps:?}");
}

/// The left hand holds a ring still and trembles; the right one closes its jaws on it and pulls, after 5.5 s and 7.4 s.
#[test]
fn a_hand_that_stands_while_the_other_one_pulls_at_its_ring_is_no_fault() {
    for (seed, seconds) in [(6, 6.0), (2, 8.0)] {
        let ran = run("rings", (Mode::Matched, 1.0, 0.3), seed, seconds);
        assert_eq!(ran.fault, None, "after {} s", ran.seconds);
        let felt_n = ran.samples[Side::Left.index()].iter().map(|(force_n, _)| force_n.norm()).fold(0.0, f64::max);
        assert!(felt_n > 1.0, "it pulls: {felt_n} N");
    }
}

#[test]
#[ignore = "figures"]
fn figures_of_leaps() {
    let of = |scene: &str, asked: (Mode, f64, f64), seed: u64, seconds: f64| {
        let ran = run(scene, asked, seed, seconds);
        println!("{scene} {asked:?} seed {seed}: {:.1} s {:?}", ran.seconds, ran.fault);
        for samples in &ran.samples {
            let found = leaps(samples);
            println!("  {} leaps", found.len());
            found.iter().rev().take(3).for_each(|(k, sizes_n)| println!("    {k}: {sizes_n:.2?}"));
        }
    };
    for delay_s in [0.0, 0.01, 0.02, 0.05, 0.1, 0.3] {
        for mode in [Mode::Best, Mode::Anchored, Mode::Dfr] {
            of("rings", (mode, 1.0, delay_s), 7, 60.0);
        }
        of("rings", (Mode::Best, 0.25, delay_s), 7, 60.0);
    }
    for scene in ["wire", "find_lumps", "lumps", "peg_transfer", "bimanual"] {
        of(scene, (Mode::Best, 1.0, 0.05), 3, 30.0);
    }
}

#[test]
#[ignore = "figures"]
fn figures_of_trials_that_end_in_a_fault() {
    let conditions = [
        (Mode::Dfr, 0.2),
        (Mode::Dfr, 0.3),
        (Mode::Dfr, 0.4),
        (Mode::Matched, 0.5),
        (Mode::Matched, 1.0),
        (Mode::Dfr, 0.0),
    ];
    for (mode, gain) in conditions {
        let faults: Vec<Fault> =
            (1..=12).filter_map(|seed| run("rings", (mode, gain, 0.3), seed, 150.0).fault).collect();
        println!("{mode:?} gain {gain}: {} of 12 {faults:?}", faults.len());
    }
}
