//! Simulated studies with known truth.
//!
//! Level and power of Wilcoxon's test depend on the number of participants, because the exact test has few p-values:
//! with 19 differences its level is 0.0494, near the requested 0.05.

use super::near;
use crate::power::{MinimumSample, MixedStudy, PairedTest, Population, PowerSimulation};

const RUNS: PowerSimulation = PowerSimulation { runs: 1000, seed: 7, level: 0.05 };

#[test]
fn wilcoxons_test_has_its_power_and_its_level() {
    let normal = Population::Normal { sd: 1.0 };
    let power = RUNS.paired(&normal, EFFECT, 19, PairedTest::Wilcoxon).unwrap();
    assert!((power.fraction - 0.80).abs() < 0.03 && power.interval.contains(0.80), "{power:?}");
    let level = RUNS.paired(&normal, 0.0, 19, PairedTest::Wilcoxon).unwrap();
    assert!((level.fraction - 0.05).abs() < 0.01 && level.interval.contains(0.05), "{level:?}");
}

/// Power 0.80 with 19 participants (0.800 in 400 000 studies that `NumPy` simulated), in standard deviations of the differences.
const EFFECT: f64 = 0.695;

#[test]
fn the_t_test_has_the_power_of_its_formula() {
    // dz = 0.8, n = 15: 0.8213 by the noncentral t.
    let power = RUNS.paired(&Population::Normal { sd: 2.0 }, 1.6, 15, PairedTest::T).unwrap();
    assert!(power.interval.contains(0.8213), "{power:?}");
}

#[test]
fn the_mixed_model_has_the_power_of_its_formula() {
    // Two conditions, four trials each, ten participants: F with 1 and 69 degrees of freedom.
    let study = MixedStudy { effects: vec![0.6], trials: 4, participant_variance: 2.0, residual_variance: 1.0 };
    let simulation = PowerSimulation { runs: 400, ..RUNS };
    let power = simulation.mixed(&study, 10).unwrap();
    assert!(power.interval.contains(MIXED_POWER) && power.refused == 0, "{power:?}");
    let level = simulation.mixed(&MixedStudy { effects: vec![0.0, 0.0], ..study }, 6).unwrap();
    assert!(level.interval.contains(0.05), "{level:?}");
}

const MIXED_POWER: f64 = 0.7536;

#[test]
fn a_pilot_without_effect_gives_the_level() {
    let pilot = [0.9, 0.6, -0.1, 2.2, 0.5, 1.1, 0.4, 1.7, 0.2, 1.4];
    let population = Population::from_pilot(&pilot).unwrap();
    let level = RUNS.paired(&population, 0.0, 19, PairedTest::Wilcoxon).unwrap();
    assert!(level.fraction < 0.075, "{level:?}");
    assert!(RUNS.paired(&population, 0.8, 19, PairedTest::Wilcoxon).unwrap().fraction > level.fraction);
}

#[test]
fn the_least_number_is_that_of_the_formula() {
    // dz = 1: ten participants have 0.8031 by the noncentral t, nine 0.7482.
    let simulation = PowerSimulation { runs: 4000, ..RUNS };
    let min =
        MinimumSample::of(0.8, 5, 100, |n| simulation.paired(&Population::Normal { sd: 1.0 }, 1.0, n, PairedTest::T))
            .unwrap();
    assert!((9..=11).contains(&min.participants), "{min:?}");
    near(min.power.fraction, 0.80, 0.05);
}

#[test]
fn the_same_seed_gives_the_same_studies() {
    let power = |seed| {
        PowerSimulation { runs: 100, seed, level: 0.05 }
            .paired(&Population::Normal { sd: 1.0 }, 0.5, 12, PairedTest::Wilcoxon)
            .unwrap()
    };
    assert_eq!(power(4), power(4));
    assert_ne!(power(4).fraction.to_bits(), power(5).fraction.to_bits());
}
