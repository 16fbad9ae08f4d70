use super::*;

fn tried(sensor: SensorAt, place: Place, kinds: &[Kind]) -> Vec<Outcome> {
    let mut bench = Bench::new(sensor, MODES[0], 3).unwrap();
    bench.prepare(place, 0).unwrap();
    kinds.iter().map(|kind| case::tried(bench.clone(), *kind, sensor, MODES[0], place, 0)).collect()
}

#[test]
fn what_cannot_be_true_is_told_within_20_ms_in_contact_and_the_force_is_gone() {
    let kinds = [
        Kind::ForceFrozen,
        Kind::ForceStep,
        Kind::ForceSign,
        Kind::ForceNan,
        Kind::ClockStops,
        Kind::ClockBackward,
        Kind::LinkSilent,
        Kind::LinkRepeats,
        Kind::HandJump,
        Kind::TipJump,
    ];
    for outcome in tried(SensorAt::Tip, Place::Contact, &kinds) {
        assert_eq!(outcome.verdict, Verdict::Detected, "{outcome:?}");
        assert!(outcome.detection_ms.is_some_and(|ms| ms <= 20.0), "{outcome:?}");
        assert!(outcome.zero_ms.is_some_and(|ms| ms <= 30.0), "{outcome:?}");
        assert!(outcome.most_n <= 4.0 + 1e-9 && outcome.step_n <= 0.5 + 1e-9, "{outcome:?}");
    }
}

#[test]
fn a_spike_is_not_felt_and_a_creeping_bias_is_called_bounded() {
    let outcomes = tried(SensorAt::Tip, Place::Contact, &[Kind::ForceSpike, Kind::ForceDrift]);
    let spike = &outcomes[0];
    let drift = &outcomes[1];
    assert_eq!(spike.verdict, Verdict::Harmless, "{spike:?}");
    assert!(drift.verdict == Verdict::Bounded && drift.peak_error_n > 0.5, "{drift:?}");
}

#[test]
fn without_drives_no_fault_makes_force_or_motion() {
    for place in [Place::Idle, Place::Stopped] {
        for outcome in tried(SensorAt::Wrist, place, &Kind::ALL) {
            assert!(outcome.verdict <= Verdict::Detected && outcome.most_n == 0.0, "{outcome:?}");
        }
    }
}

#[test]
fn a_healthy_machine_is_its_twin() {
    let outcome = tried(SensorAt::Wrist, Place::Contact, &[Kind::LinkDoubles]);
    assert!(outcome[0].verdict == Verdict::Harmless && outcome[0].most_n > 0.5, "{outcome:?}");
}

/// A handle that trembles by itself runs ahead of the hand: whatever the governor does, the hand must not feel a step.
#[test]
fn a_reading_that_trembles_makes_no_step_beyond_the_slew_limit() {
    for outcome in tried(SensorAt::Wrist, Place::Free, &[Kind::HandNoise]) {
        assert!(outcome.step_n > 0.1 && outcome.step_n <= 0.51, "{outcome:?}");
    }
}

/// A sensor's own numbers are judged, even if the arm rotates the loop's inputs.
#[test]
fn on_rigs_with_an_arm_what_a_sensor_repeats_takes_the_force_away_within_20_ms() {
    let kinds = [Kind::ForceFrozen, Kind::ForceAxisFrozen, Kind::ForceStep];
    for sensor in SensorAt::ON_ARMS {
        for outcome in tried(sensor, Place::Contact, &kinds) {
            println!("{outcome:?}");
            assert_eq!(outcome.verdict, Verdict::Detected, "{outcome:?}");
            assert!(outcome.told.as_ref().is_some_and(|told| told.starts_with("Force")), "{outcome:?}");
            assert!(outcome.zero_ms.is_some_and(|ms| ms <= 20.0), "{outcome:?}");
        }
    }
}

#[test]
fn on_rigs_with_an_arm_a_block_that_comes_again_and_a_range_that_ends_are_told() {
    for sensor in SensorAt::ON_ARMS {
        let outcomes = tried(sensor, Place::Contact, &[Kind::ForceBlock, Kind::ForceSaturated, Kind::TipBlock]);
        for outcome in outcomes {
            println!("{outcome:?}");
            assert!(matches!(outcome.verdict, Verdict::Detected | Verdict::Harmless), "{outcome:?}");
        }
    }
}

#[test]
fn on_rigs_with_an_arm_nothing_is_told_without_a_fault() {
    for sensor in SensorAt::ON_ARMS {
        let mut bench = Bench::new(sensor, MODES[0], 5).unwrap();
        bench.obey(nima_machine::messages::Command::Engage);
        for tick in 0..12_000 {
            let raised = bench.step().and_then(|step| step.raised);
            assert_eq!(raised, None, "{sensor:?} at {tick} ms");
        }
        assert_eq!(bench.state(), LoopState::Engaged);
    }
}
