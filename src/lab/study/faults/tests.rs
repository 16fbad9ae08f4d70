use super::*;

fn tried(sensor: SensorAt, place: FaultPlace, kinds: &[FaultKind]) -> Vec<CaseOutcome> {
    let mut bench = FaultBench::new(sensor, MODES[0], 3).unwrap();
    bench.prepare(place, 0).unwrap();
    kinds.iter().map(|kind| case::tried(bench.clone(), *kind, sensor, MODES[0], place, 0)).collect()
}

#[test]
fn what_cannot_be_true_is_told_within_20_ms_in_contact_and_the_force_is_gone() {
    let kinds = [
        FaultKind::ForceFrozen,
        FaultKind::ForceStep,
        FaultKind::ForceSign,
        FaultKind::ForceNan,
        FaultKind::ClockStops,
        FaultKind::ClockBackward,
        FaultKind::LinkSilent,
        FaultKind::LinkRepeats,
        FaultKind::HandJump,
        FaultKind::TipJump,
    ];
    for outcome in tried(SensorAt::Tip, FaultPlace::Contact, &kinds) {
        assert_eq!(outcome.verdict, FaultVerdict::Detected, "{outcome:?}");
        assert!(outcome.detection_ms.is_some_and(|ms| ms <= 20.0), "{outcome:?}");
        assert!(outcome.zero_ms.is_some_and(|ms| ms <= 30.0), "{outcome:?}");
        assert!(outcome.max_n <= 4.0 + 1e-9 && outcome.step_n <= 0.5 + 1e-9, "{outcome:?}");
    }
}

#[test]
fn a_spike_is_not_felt_and_a_creeping_bias_is_called_bounded() {
    let outcomes = tried(SensorAt::Tip, FaultPlace::Contact, &[FaultKind::ForceSpike, FaultKind::ForceDrift]);
    let spike = &outcomes[0];
    let drift = &outcomes[1];
    assert_eq!(spike.verdict, FaultVerdict::Harmless, "{spike:?}");
    assert!(drift.verdict == FaultVerdict::Bounded && drift.peak_error_n > 0.5, "{drift:?}");
}

#[test]
fn without_drives_no_fault_makes_force_or_motion() {
    for place in [FaultPlace::Idle, FaultPlace::Stopped] {
        for outcome in tried(SensorAt::Wrist, place, &FaultKind::ALL) {
            assert!(outcome.verdict <= FaultVerdict::Detected && outcome.max_n == 0.0, "{outcome:?}");
        }
    }
}

#[test]
fn a_healthy_machine_is_its_twin() {
    let outcome = tried(SensorAt::Wrist, FaultPlace::Contact, &[FaultKind::LinkDoubles]);
    assert!(outcome[0].verdict == FaultVerdict::Harmless && outcome[0].max_n > 0.5, "{outcome:?}");
}

/// A reading that trembles runs ahead of the hand: whatever the governor does, the hand must not feel a step.
#[test]
fn a_reading_that_trembles_makes_no_step_beyond_the_slew_limit() {
    for outcome in tried(SensorAt::Wrist, FaultPlace::Free, &[FaultKind::HandNoise]) {
        assert!(outcome.step_n > 0.1 && outcome.step_n <= 0.51, "{outcome:?}");
    }
}

/// The sensor's own numbers are checked, even if the arm rotates the loop's inputs.
#[test]
fn on_rigs_with_an_arm_what_a_sensor_repeats_takes_the_force_away_within_20_ms() {
    let kinds = [FaultKind::ForceFrozen, FaultKind::ForceAxisFrozen, FaultKind::ForceStep];
    for sensor in SensorAt::ON_ARMS {
        for outcome in tried(sensor, FaultPlace::Contact, &kinds) {
            println!("{outcome:?}");
            assert_eq!(outcome.verdict, FaultVerdict::Detected, "{outcome:?}");
            assert!(outcome.report.as_ref().is_some_and(|report| report.starts_with("Force")), "{outcome:?}");
            assert!(outcome.zero_ms.is_some_and(|ms| ms <= 20.0), "{outcome:?}");
        }
    }
}

#[test]
fn on_rigs_with_an_arm_a_block_that_comes_again_and_a_range_that_ends_are_told() {
    for sensor in SensorAt::ON_ARMS {
        let outcomes = tried(
            sensor,
            FaultPlace::Contact,
            &[FaultKind::ForceBlock, FaultKind::ForceSaturated, FaultKind::TipBlock],
        );
        for outcome in outcomes {
            println!("{outcome:?}");
            assert!(matches!(outcome.verdict, FaultVerdict::Detected | FaultVerdict::Harmless), "{outcome:?}");
        }
    }
}

#[test]
fn on_rigs_with_an_arm_nothing_is_told_without_a_fault() {
    for sensor in SensorAt::ON_ARMS {
        let mut bench = FaultBench::new(sensor, MODES[0], 5).unwrap();
        bench.obey(nima_machine::messages::Command::Engage);
        for tick in 0..12_000 {
            let raised = bench.step().and_then(|step| step.raised);
            assert_eq!(raised, None, "{sensor:?} at {tick} ms");
        }
        assert_eq!(bench.state(), LoopState::Engaged);
    }
}
