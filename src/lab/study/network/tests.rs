use nima_machine::runtime::VirtualClock;

use super::*;
use crate::Findings as _;

fn quick(condition: NetworkCondition, mode: Mode) -> NetworkRow {
    quick_from(OwnMotion::Follower, condition, mode)
}

fn quick_from(own_motion: OwnMotion, condition: NetworkCondition, mode: Mode) -> NetworkRow {
    on(VirtualClock::PERFECT, own_motion, condition, mode)
}

fn on(clock: VirtualClock, own_motion: OwnMotion, condition: NetworkCondition, mode: Mode) -> NetworkRow {
    let options = NetworkOptions { extent: PlanExtent::Quick, clocks: vec![clock], modes: vec![], own_motion };
    measured(clock, condition, mode, runs(&options)).unwrap()
}

#[test]
fn late_ticks_of_both_machines_cost_little_and_stop_nothing() {
    let [perfect, late] = [ClockProfile::Perfect, ClockProfile::Late { percent: 1.0 }].map(|profile| {
        on(VirtualClock { profile, seed: 1 }, OwnMotion::Follower, NetworkCondition::clean(36.0), Mode::Dfr)
    });
    assert_eq!((late.stops, late.resumed, late.ceiling_breaches), (0, 0, 0), "{late:?}");
    // Compares the force requested by the mode: the effect of late ticks on the gates is covered by their own studies.
    assert!((late.asked_error_n / perfect.asked_error_n - 1.0).abs() < 0.1, "{perfect:?} {late:?}");
    assert!(late.error_n.to_bits() != perfect.error_n.to_bits() && late.clock == ClockProfile::Late { percent: 1.0 });
}

#[test]
fn a_pause_of_100_ms_of_a_machine_is_a_latched_stop() {
    let clock = VirtualClock { profile: ClockProfile::Stall { ms: 100 }, seed: 1 };
    let row = on(clock, OwnMotion::Follower, NetworkCondition::clean(36.0), Mode::Dfr);
    assert!(
        row.stops >= 3 && row.console_faults.keys().any(|fault| fault.starts_with("LoopStalled")) && row.resumed == 0,
        "{row:?}"
    );
}

#[test]
fn a_cell_is_the_same_every_time() {
    let condition = plan::judged_line(BASE_MS);
    let own_motion = OwnMotion::Follower;
    let runs = Runs { known_s: [1.0; 2], settle_s: 1.0, learn_s: 1.0, task_s: 2.0, own_motion };
    let clock = VirtualClock { profile: ClockProfile::Busy, seed: 1 };
    let [one, other] = [(); 2].map(|()| format!("{:?}", measured(clock, condition, Mode::Best, runs).unwrap()));
    assert_eq!(one, other);
}

#[test]
fn over_a_perfect_line_the_default_mode_is_far_better_than_reflection() {
    let [best, dfr] = [Mode::Best, Mode::Dfr].map(|mode| quick(NetworkCondition::clean(36.0), mode));
    assert!(best.error_n < 0.4 * dfr.error_n && best.tissue_n > 0.2, "{best:?} {dfr:?}");
    for row in [best, dfr] {
        assert_eq!((row.stops, row.resumed, row.ceiling_breaches, row.slew_breaches), (0, 0, 0, 0), "{row:?}");
        assert!((row.engaged - 1.0).abs() < 1e-9 && row.return_step_mm.is_none(), "{row:?}");
        // The delay of the link plus up to two milliseconds of margin.
        assert!(row.under_way_ms.iter().all(|ms| (36.0..38.1).contains(ms)), "{row:?}");
        assert!((72.0..76.1).contains(&row.round_trip_ms), "{row:?}");
    }
}

#[test]
fn matched_on_the_motion_of_the_handle_gives_the_hand_no_energy() {
    let base = NetworkCondition::clean(36.0);
    for condition in [base, NetworkCondition { happening: LinkEvent::Flap, ..base }] {
        let row = quick_from(OwnMotion::Handle, condition, Mode::Matched);
        assert!(row.injected_mj < row.tissue_injected_mj + 1.0 && row.engaged > 0.9, "{row:?}");
    }
}

#[test]
fn an_outage_is_a_latched_stop_with_its_cause_and_what_comes_back_moves_nothing() {
    let row = quick(NetworkCondition { happening: LinkEvent::Outages, ..NetworkCondition::clean(36.0) }, Mode::Best);
    assert!(row.stops >= 3 && row.resumed == 0, "{row:?}");
    assert_eq!(row.console_faults.keys().collect::<Vec<_>>(), ["LinkSilent"], "{row:?}");
    assert!(row.return_step_mm.is_some_and(|mm| mm < 0.2), "{row:?}");
    assert!(row.force_after_data_ms <= 20.0 && row.engaged < 0.8, "{row:?}");
}

/// The break is too short for a fault of the link; the tip keeps moving in the meantime, which is not a jump.
#[test]
fn a_break_of_50_ms_stops_nothing() {
    let row = quick(NetworkCondition { happening: LinkEvent::Flap, ..NetworkCondition::clean(36.0) }, Mode::Dfr);
    assert_eq!((row.stops, row.force_after_data_ms <= 20.0), (0, true), "{row:?}");
    assert!(row.lost_percent.iter().all(|lost| (3.0..7.0).contains(lost)), "{row:?}");
}

#[test]
fn a_step_of_the_followers_clock_is_named_and_stops() {
    let row =
        quick(NetworkCondition { happening: LinkEvent::ClockForward, ..NetworkCondition::clean(36.0) }, Mode::Best);
    assert!(row.clock_step_named_ms.is_some_and(|ms| ms < 1000.0), "{row:?}");
    assert!(row.follower_faults.contains_key("ClockJumped") && row.resumed == 0, "{row:?}");
}

#[test]
fn every_file_is_whole() {
    let rows = vec![quick(NetworkCondition::clean(36.0), Mode::Dfr)];
    let aims = aims::aims(&rows.iter().collect::<Vec<_>>(), Mode::Dfr);
    let mut report = NetworkReport {
        extent: PlanExtent::Quick,
        judged: Mode::Dfr,
        own_motion: OwnMotion::Follower,
        known_s: [0.0; 2],
        run_s: 15.0,
        judged_s: 10.0,
        aims,
        rows,
    };
    let csv = report.csv();
    let columns: Vec<_> = csv.lines().map(|line| line.split(',').count()).collect();
    assert_eq!(columns, [columns[0]; 2], "{csv}");
    for table in report.markdown().split("\n\n").filter(|table| table.starts_with('|')) {
        let cells = |line: &str| line.matches('|').count();
        assert!(table.lines().all(|line| cells(line) == cells(table.lines().next().unwrap())), "{table}");
    }
    assert!(report.svg().starts_with("<svg"));
    report.aims.iter_mut().for_each(|aim| aim.missed = 0);
    assert_eq!(report.judge(), Ok(()));
    report.aims[0].missed = 1;
    report.aims[0].worst = 3.0;
    assert!(report.judge().unwrap_err().contains("ceiling: 3.000, at most 0"), "{:?}", report.judge());
    assert!(report.markdown().contains("MISSED in 1"));
}
