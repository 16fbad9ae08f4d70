//! Tests of the ready check, item by item: a correct rig passes, and each flaw fails only its own check.

mod bench;
mod sides;

use nalgebra::Vector3;
use nima_devices::Loss;

use self::bench::{Fixture, Flaws, SIDE, state_of, subject};
use super::{CheckSubject, Lacks, PersonRequest, ReadyCause, ReadyPoint, ReadySession, ReadyState};
use crate::{
    config::RigConfig,
    messages::{Command, Fault, ForceSource, LoopState, Refusal, Watchdog},
    rig::{SIDES, checkup::CheckupFinding},
    teleop::{Calibrations, Loop},
};

/// Returns the only check that failed, and the reason.
fn only_failure(session: &ReadySession) -> (ReadyPoint, ReadyCause) {
    let failed = |entry: &super::ReadyEntry| match entry.state {
        ReadyState::Failed(cause) => Some((entry.check, cause)),
        _ => None,
    };
    let failures: Vec<_> = session.list().iter().filter_map(failed).collect();
    let [failure] = failures[..] else { panic!("{failures:?} of {:?}", session.list()) };
    assert!(session.is_finished() && !session.has_passed());
    failure
}

fn failure_of(flaws: Flaws) -> (ReadyPoint, ReadyCause) {
    only_failure(&Fixture::judged(flaws))
}

#[test]
fn a_rig_in_order_passes_within_a_minute_and_nothing_is_left_out_but_what_needs_two_arms() {
    let session = Fixture::judged(Flaws::default());
    assert!(session.has_passed(), "{:?}", session.list());
    assert_eq!(session.list().len(), 13);
    for entry in session.list() {
        if entry.check == ReadyPoint::Own(SIDE) {
            assert_eq!(entry.state, ReadyState::LeftOut(Lacks::OtherArm));
            continue;
        }
        let ReadyState::Passed(figure) = entry.state else { panic!("{entry:?}") };
        println!("{:?}: {figure:?}", entry.check);
        assert!(figure.value <= figure.limit, "{entry:?}");
    }
    assert!(session.took_s() < 60.0, "{} s", session.took_s());
    assert_eq!(session.ask(), PersonRequest::Nothing);
}

#[test]
fn a_device_that_is_missing_is_named() {
    let mut bench = Fixture::new(subject(), Flaws::default());
    bench.standing.lose(Loss::Disconnected);
    bench.run();
    assert_eq!(only_failure(&bench.session), (ReadyPoint::Devices, ReadyCause::Missing { place: 0 }));
}

#[test]
fn a_low_rate_is_found() {
    let (check, cause) = failure_of(Flaws { sensor_hz: 500, ..Flaws::default() });
    assert_eq!(check, ReadyPoint::Rates);
    assert!(
        matches!(cause, ReadyCause::Found { place: 0, finding: CheckupFinding::Rate { nominal_hz: 1000.0, .. } }),
        "{cause:?}"
    );
}

#[test]
fn damaged_frames_are_measured_again_and_more_of_them_are_a_finding() {
    let once = Fixture::judged(Flaws { damaged: |now_s| if now_s > 2.0 { 20 } else { 0 }, ..Flaws::default() });
    assert!(once.has_passed(), "{:?}", once.list());
    let (check, cause) = failure_of(Flaws { damaged: |now_s| (10.0 * now_s) as u64, ..Flaws::default() });
    assert!(
        matches!(
            (check, cause),
            (ReadyPoint::Rates, ReadyCause::Found { finding: CheckupFinding::Damaged { .. }, .. })
        ),
        "{cause:?}"
    );
}

#[test]
fn missed_periods_and_a_wrong_date_are_found() {
    let (check, cause) = failure_of(Flaws { missed_every: 73, ..Flaws::default() });
    assert!(
        matches!((check, cause), (ReadyPoint::Clocks, ReadyCause::Missed { fraction }) if fraction > 0.012),
        "{cause:?}"
    );
    let mut bench = Fixture::new(CheckSubject { is_date_behind: true, ..subject() }, Flaws::default());
    bench.run();
    assert_eq!(only_failure(&bench.session), (ReadyPoint::Clocks, ReadyCause::DateBehind));
}

#[test]
fn a_bias_that_drifted_is_found_with_its_figure() {
    let (check, cause) = failure_of(Flaws { bias_n: Vector3::new(0.4, 0.0, 0.3), ..Flaws::default() });
    assert_eq!(check, ReadyPoint::Bias(SIDE));
    assert!(matches!(cause, ReadyCause::BiasMoved { by_n, limit_n: 0.2 } if (by_n - 0.5).abs() < 0.02), "{cause:?}");
}

#[test]
fn without_a_calibration_or_out_of_reach_the_bias_is_not_passed() {
    let mut uncalibrated = subject();
    uncalibrated.arms[SIDE.index()].as_mut().unwrap().gravity = None;
    let mut bench = Fixture::new(uncalibrated, Flaws::default());
    bench.run();
    for check in [ReadyPoint::Bias(SIDE), ReadyPoint::Push(SIDE)] {
        assert_eq!(state_of(&bench.session, check), ReadyState::Failed(ReadyCause::Uncalibrated));
    }
    let stays = Flaws { obeys: |ask| !matches!(ask, PersonRequest::TakeOut(_)), ..Flaws::default() };
    assert!(matches!(failure_of(stays), (ReadyPoint::Bias(SIDE), ReadyCause::BiasUnseen(_))));
}

#[test]
fn a_wrong_sign_a_wrong_axis_and_no_push_are_told_apart() {
    let pushed = |pushed| failure_of(Flaws { pushed, ..Flaws::default() });
    let askew = |by_deg: f64| {
        move |(check, cause): (ReadyPoint, ReadyCause)| {
            assert_eq!(check, ReadyPoint::Push(SIDE));
            assert!(
                matches!(cause, ReadyCause::PushAskew { by_deg: report } if (report - by_deg).abs() < 2.0),
                "{cause:?}"
            );
        }
    };
    askew(180.0)(pushed(|force_n| -force_n));
    askew(90.0)(pushed(|force_n| force_n.yzx()));
    let (check, cause) = pushed(|force_n| force_n * 0.2);
    assert!(
        matches!((check, cause), (ReadyPoint::Push(SIDE), ReadyCause::NoPush { max_n }) if (max_n - 0.4).abs() < 0.1)
    );
}

#[test]
fn a_handle_that_pulls_sticks_or_has_other_axes_is_told() {
    let (check, cause) = failure_of(Flaws { pulls_m_s: 0.02, ..Flaws::default() });
    assert!(
        matches!((check, cause), (ReadyPoint::Handle(SIDE), ReadyCause::HandlePulls { by_m }) if by_m > 1e-3),
        "{cause:?}"
    );
    let moved = |moved| failure_of(Flaws { moved, ..Flaws::default() });
    assert!(
        matches!(moved(|travel_m| travel_m * 0.0), (ReadyPoint::Handle(SIDE), ReadyCause::HandleStuck { by_m }) if by_m < 1e-3)
    );
    let (check, cause) = moved(|travel_m| travel_m.zxy());
    assert!(
        matches!((check, cause), (ReadyPoint::Handle(SIDE), ReadyCause::HandleAskew { by_deg }) if by_deg > 80.0),
        "{cause:?}"
    );
}

#[test]
fn a_trocar_that_moved_is_told_with_its_distance_and_one_far_away_as_missed() {
    let moved = |mm: f64| failure_of(Flaws { trocar_m: Vector3::new(mm * 1e-3, 0.0, 0.0), ..Flaws::default() });
    let (check, cause) = moved(3.0);
    assert_eq!(check, ReadyPoint::Trocar(SIDE));
    assert!(matches!(cause, ReadyCause::TrocarMoved { by_m } if (by_m - 3e-3).abs() < 0.3e-3), "{cause:?}");
    let (check, cause) = moved(12.0);
    assert_eq!(check, ReadyPoint::Trocar(SIDE));
    assert!(matches!(cause, ReadyCause::BesideTrocar { miss_m } if (miss_m - 12e-3).abs() < 0.5e-3), "{cause:?}");
}

#[test]
fn another_ceiling_than_the_rig_file_has_is_told() {
    let mut changed = subject();
    changed.gates_in_file.as_mut().unwrap().ceiling_n = 3.0;
    let mut bench = Fixture::new(changed, Flaws::default());
    bench.run();
    let cause = ReadyCause::OtherCeiling { in_force_n: 4.0, in_file_n: 3.0 };
    assert_eq!(only_failure(&bench.session), (ReadyPoint::Ceiling, cause));
    let mut bench = Fixture::new(CheckSubject { gates_in_file: None, ..subject() }, Flaws::default());
    bench.run();
    assert_eq!(only_failure(&bench.session), (ReadyPoint::Ceiling, ReadyCause::NoRigFile));
}

#[test]
fn a_dead_stop_fails_and_a_second_look_after_its_repair_keeps_the_rest() {
    let mut bench =
        Fixture::new(subject(), Flaws { obeys: |ask| *ask != PersonRequest::PressStop, ..Flaws::default() });
    bench.run();
    assert_eq!(only_failure(&bench.session), (ReadyPoint::Stop, ReadyCause::NoStop));
    let before = bench.session.list().to_vec();
    bench.flaws = Flaws::default();
    bench.session.again();
    assert!(!bench.session.is_finished());
    bench.run();
    assert!(bench.session.has_passed());
    let kept = before.iter().zip(bench.session.list()).filter(|(before, now)| before == now).count();
    assert_eq!(kept, before.len() - 1, "only the stop was checked again");
}

#[test]
fn a_stop_that_the_loop_does_not_release_fails_with_its_reason() {
    let late = Flaws { silent_when_stopped: true, obeys: |ask| *ask != PersonRequest::Release, ..Flaws::default() };
    let mut bench = Fixture::new(subject(), late);
    while bench.session.ask() != PersonRequest::Release {
        bench.step();
    }
    // Run until the loop detects that the force is no longer measured.
    (0..500).for_each(|_| bench.step());
    bench.flaws.obeys = |_| true;
    bench.run();
    let cause = ReadyCause::NotReleased(Some(Refusal::StillPresent(Fault::SourceSilent)));
    assert_eq!(state_of(&bench.session, ReadyPoint::Stop), ReadyState::Failed(cause));
}

#[test]
fn a_watchdog_that_does_not_bite_fails() {
    let cause = ReadyCause::NoBite(Watchdog::Loop);
    assert_eq!(
        failure_of(Flaws { supervised: false, ..Flaws::default() }),
        (ReadyPoint::Watchdog(Watchdog::Loop), cause)
    );
}

#[test]
fn the_watchdog_of_the_link_cannot_be_tested_without_a_force() {
    let mut bench = Fixture::new(subject(), Flaws::default());
    bench.control = Loop::new(&subject().rig, &[Some(Calibrations::default()), None]).unwrap();
    bench.run();
    let cause = ReadyCause::ForceUnknown(ForceSource::Uncalibrated);
    assert_eq!(state_of(&bench.session, ReadyPoint::Watchdog(Watchdog::Link)), ReadyState::Failed(cause));
}

#[test]
fn a_fault_that_is_not_released_is_waited_for_and_then_told() {
    let mut bench = Fixture::new(subject(), Flaws::default());
    (0..50).for_each(|_| bench.step());
    bench.control.obey(Command::Stop, bench.now_s());
    (0..50).for_each(|_| bench.step());
    // The person has released it meanwhile.
    bench.run();
    assert!(bench.session.has_passed(), "{:?}", bench.session.list());
    let mut bench = Fixture::new(subject(), Flaws { obeys: |ask| *ask != PersonRequest::Release, ..Flaws::default() });
    (0..50).for_each(|_| bench.step());
    bench.control.obey(Command::Stop, bench.now_s());
    bench.run();
    assert_eq!(state_of(&bench.session, ReadyPoint::Devices), ReadyState::Failed(ReadyCause::NotReleased(None)));
}

#[test]
fn who_engages_meanwhile_fails_what_was_looked_at() {
    let mut bench = Fixture::new(subject(), Flaws { obeys: |_| false, ..Flaws::default() });
    (0..100).for_each(|_| bench.step());
    bench.control.obey(Command::Engage, bench.now_s());
    (0..20).for_each(|_| bench.step());
    assert_eq!(bench.control.pair(SIDE).unwrap().state(), LoopState::Engaged);
    assert_eq!(state_of(&bench.session, ReadyPoint::Devices), ReadyState::Failed(ReadyCause::Engaged(SIDE)));
}

#[test]
fn what_a_simulated_rig_lacks_is_left_out_and_told() {
    let rig = RigConfig::load("simulated").unwrap();
    let arm = super::ReadyArm { at_wrist: false, gravity: None, has_person: false };
    let gates_in_file = Some(rig.gates);
    let arms: [Option<super::ReadyArm>; SIDES] = [Some(arm), None];
    let session =
        ReadySession::new(CheckSubject { rig, arms, parts: Vec::new(), gates_in_file, is_date_behind: false });
    let left_out = |check| match state_of(&session, check) {
        ReadyState::LeftOut(lacks) => Some(lacks),
        _ => None,
    };
    assert_eq!(left_out(ReadyPoint::Rates), Some(Lacks::Devices));
    assert_eq!(left_out(ReadyPoint::Bias(SIDE)), Some(Lacks::WristSensor));
    assert_eq!(left_out(ReadyPoint::Push(SIDE)), Some(Lacks::Person));
    assert_eq!(left_out(ReadyPoint::Stop), None);
    assert!(!session.has_passed(), "the stop is still to be seen");
}
