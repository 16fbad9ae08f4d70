//! The virtual clock by itself.

use super::*;

const RATE_HZ: f64 = 1000.0;
const SECONDS: usize = 100;

fn times(profile: ClockProfile, seed: u64) -> Vec<TickTime> {
    let mut times = TickTimes::new(profile, seed, RATE_HZ);
    (0..SECONDS * 1000).map(|_| times.advance()).collect()
}

/// Returns the fraction of ticks that woke more than this late.
fn later_than(times: &[TickTime], limit_s: f64) -> f64 {
    times.iter().filter(|time| time.wake_s > limit_s).count() as f64 / times.len() as f64
}

#[test]
fn on_a_perfect_clock_every_tick_is_at_its_deadline_to_the_last_bit() {
    for (index, time) in times(ClockProfile::Perfect, 3).into_iter().enumerate() {
        assert_eq!(time, TickTime::from(index as f64 * (1.0 / RATE_HZ)));
    }
}

#[test]
fn time_advances_and_every_period_is_a_tick_or_missed() {
    for profile in ClockProfile::ALL {
        let mut clock = TickTimes::new(profile, 5, RATE_HZ);
        let mut last_s = f64::NEG_INFINITY;
        let mut deadline_s = 0.0;
        for _ in 0..50_000 {
            let time = clock.advance();
            assert!(time.now_s > last_s, "{profile}: {last_s} s, then {time:?}");
            let rest_s = time.now_s - deadline_s - time.missed as f64 / RATE_HZ;
            assert!((-1e-9..1.0 / RATE_HZ).contains(&rest_s), "{profile}: {rest_s} s");
            assert!((time.wake_s - rest_s - time.missed as f64 / RATE_HZ).abs() < 1e-6, "{profile}: {time:?}");
            last_s = time.now_s;
            deadline_s = clock.periods() as f64 / RATE_HZ;
        }
    }
}

#[test]
fn a_seed_repeats_and_another_one_differs() {
    for profile in ClockProfile::ALL.into_iter().filter(|profile| *profile != ClockProfile::Perfect) {
        assert_eq!(times(profile, 1), times(profile, 1), "{profile}");
        assert_ne!(times(profile, 1), times(profile, 2), "{profile}");
    }
}

#[test]
fn late_ticks_are_as_many_and_as_late_as_named() {
    for percent in [0.1, 1.0, 5.0] {
        let times = times(ClockProfile::Late { percent }, 1);
        let late = 100.0 * later_than(&times, 0.0);
        assert!((late / percent - 1.0).abs() < 0.25, "{late} % of {percent} %");
        let range = times.iter().map(|time| time.wake_s).filter(|late_s| *late_s > 0.0);
        assert!(range.clone().all(|late_s| (0.5e-3..4e-3).contains(&late_s)), "{percent} %");
    }
}

#[test]
fn recorded_clocks_are_as_late_as_the_recordings() {
    // Percentage of ticks later than half a millisecond, and of missed periods.
    for (profile, late, missed) in
        [(ClockProfile::Quiet, 0.1..0.3, 0.1..0.35), (ClockProfile::Busy, 4.0..6.0, 3.5..7.0)]
    {
        let all: Vec<TickTime> = (0..10).flat_map(|seed| times(profile, seed)).collect();
        let [late_percent, missed_percent] = [
            100.0 * later_than(&all, 0.5e-3),
            100.0 * all.iter().map(|time| time.missed).sum::<u64>() as f64 / all.len() as f64,
        ];
        assert!(late.contains(&late_percent), "{profile}: {late_percent} % late");
        assert!(missed.contains(&missed_percent), "{profile}: {missed_percent} % missed");
        // Late ticks cluster: after one, another is likely within 20 ticks.
        let is_late = |time: &TickTime| time.wake_s > 0.5e-3;
        let after_late: Vec<_> = all.windows(21).filter(|window| is_late(&window[0])).collect();
        let (again, count) =
            (after_late.iter().filter(|window| window[1..].iter().any(is_late)).count(), after_late.len());
        assert!(again * 2 > count, "{profile}: {again} of {count}");
    }
}

#[test]
fn a_stalled_loop_pauses_about_once_a_second_for_the_named_time() {
    for ms in [5, 20, 100] {
        let times = times(ClockProfile::Stall { ms }, 1);
        let pauses: Vec<f64> = times.iter().map(|time| 1e3 * time.wake_s).filter(|late_ms| *late_ms > 0.0).collect();
        assert!((SECONDS * 3 / 4..SECONDS * 5 / 4).contains(&pauses.len()), "{} pauses of {ms} ms", pauses.len());
        let range = f64::from(ms) - 1.0..=f64::from(ms);
        assert!(pauses.iter().all(|pause_ms| range.contains(pause_ms)), "{ms} ms: {pauses:?}");
    }
}

#[test]
fn a_text_that_names_no_profile_is_refused_with_those_that_there_are() {
    for text in ["", "late", "late-0", "late--1", "late-51", "late-NaN", "stall-0", "stall-1001", "stall-5.5", "Busy"] {
        let report = text.parse::<ClockProfile>().unwrap_err().to_string();
        assert!(report.contains(&format!("\"{text}\"")) && report.contains("stall-MS (1 to 1000)"), "{report}");
    }
}
