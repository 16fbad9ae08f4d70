//! Tests: every flaw produces its finding, and a flawless device produces none.

use super::{AGES, DEVICES_MAX, Gauge, Gauges, RigPart, Side, checkup::*};
use crate::config::RigConfig;

/// Returns a reading of a tilted sensor at rest; `even` is from -1 to 1.
fn at_rest(channel: usize, even: f64) -> f64 {
    match channel {
        0..=2 => 1.0 + 0.05 * even,
        3..=5 => 0.1 + 1e-3 * even,
        6..=8 => 9.806_65 / 3.0_f64.sqrt() + 0.03 * even,
        _ => f64::NAN,
    }
}

struct Fixture {
    part: RigPart,
    rate_hz: u32,
    /// A value of a channel at a time (s).
    value: fn(usize, f64, f64) -> f64,
    /// Age of the newest reading, ticks.
    age: usize,
    change: fn(&mut Gauge),
}

const IN_ORDER: Fixture = Fixture {
    part: RigPart::Sensor(Side::Right),
    rate_hz: 1000,
    value: |channel, even, _| at_rest(channel, even),
    age: 0,
    change: |_| (),
};

impl Fixture {
    fn tested(&self) -> Checkup {
        let rig = RigConfig::load("emulated").unwrap();
        let mut readings = 0_u64;
        let blocks: Vec<Gauges> = (0..BLOCKS as u32)
            .map(|block| {
                let from_s = f64::from(block) * 0.1;
                let mut gauge = Gauge::NONE;
                for _ in 0..self.rate_hz / 10 {
                    readings += 1;
                    let t_s = readings as f64 / f64::from(self.rate_hz);
                    for channel in 0..9 {
                        let even = (readings * readings * (3 + channel as u64) % 9973) as f64 / 4986.5 - 1.0;
                        gauge.channels[channel].add((self.value)(channel, even, t_s));
                    }
                }
                gauge.ages[self.age] = 98;
                gauge.ages[(self.age + 1).min(AGES - 1)] = 2;
                gauge.readings = readings;
                if block > 0 {
                    (self.change)(&mut gauge);
                }
                let mut gauges = Gauges { from_s, to_s: from_s + 0.1, devices: [Gauge::NONE; DEVICES_MAX] };
                gauges.devices[2] = gauge;
                gauges
            })
            .collect();
        let blocks: Vec<&Gauges> = blocks.iter().collect();
        Checkup::of(&TestSubject::of(self.part, 2, &rig, &blocks).unwrap()).unwrap()
    }
}

#[test]
fn a_sensor_in_order_is_fine_and_its_figures_are_right() {
    let checkup = IN_ORDER.tested();
    assert_eq!(checkup.findings, []);
    assert!((checkup.rate_hz - 1000.0).abs() < 1.0 && (checkup.took_s - 2.0).abs() < 1e-9);
    assert_eq!(checkup.age_s, Some([0.0, 1e-3]));
    assert_eq!(checkup.measured.len(), 9);
    // A uniform spread over +-0.05 N.
    let force = checkup.measured[0];
    assert!((force.noise - 0.05 / 3.0_f64.sqrt()).abs() < 2e-3, "{force:?}");
    assert!(force.low > 0.949 && force.high < 1.051 && force.range.is_none());
    let up = checkup.up_m_s2.unwrap();
    assert!((up.norm() - 9.806_65).abs() < 0.02 && (up.x - up.z).abs() < 0.02, "{up}");
}

#[test]
fn what_is_wrong_with_the_delivery_is_found() {
    let slow = Fixture { rate_hz: 500, ..IN_ORDER }.tested();
    assert!(matches!(slow.findings[..], [CheckupFinding::Rate { nominal_hz: 1000.0, .. }]), "{:?}", slow.findings);
    let arm = Fixture { part: RigPart::Arm(Side::Right), value: |_, _, _| 0.1, ..IN_ORDER };
    assert_eq!(Fixture { rate_hz: 960, ..arm }.tested().findings, [], "the loop missed some periods");
    let missed = Fixture { change: |gauge| gauge.ages[0] = 78, rate_hz: 800, value: |_, _, _| 0.1, ..IN_ORDER };
    let missed = Fixture { part: RigPart::Arm(Side::Right), ..missed };
    assert_eq!(missed.tested().findings, [], "a loop that makes 800 ticks asks 800 times");
    let counted = |change| Fixture { change, ..IN_ORDER }.tested().findings;
    assert_eq!(counted(|gauge| gauge.damaged = 3), [CheckupFinding::Damaged { count: 3 }]);
    assert_eq!(counted(|gauge| gauge.damaged = 1), [], "one is no reason to look");
    assert_eq!(counted(|gauge| gauge.refused = 1), [CheckupFinding::Refused { count: 1 }]);
    assert_eq!(counted(|gauge| gauge.lost = 40), [CheckupFinding::Lost { count: 40 }]);
    assert_eq!(counted(|gauge| gauge.lost = 2), [], "one in a thousand is no reason to look");
    assert_eq!(counted(|gauge| gauge.readings = 5), [CheckupFinding::Reopened]);
    assert_eq!(counted(|gauge| gauge.readings = 100), [CheckupFinding::Silent]);
    let late = Fixture { age: 8, ..IN_ORDER }.tested();
    assert!(
        matches!(late.findings[..], [CheckupFinding::Late { p99_s, .. }] if (p99_s - 9e-3).abs() < 1e-9),
        "{late:?}"
    );
    let never = Fixture { age: AGES - 1, ..IN_ORDER }.tested();
    assert_eq!(never.age_s, None);
}

#[test]
fn what_is_wrong_with_the_readings_is_found() {
    let valued = |value| Fixture { value, ..IN_ORDER }.tested().findings;
    let noisy = valued(|channel, even, _| if channel == 1 { 0.5 * even } else { at_rest(channel, even) });
    assert!(matches!(noisy[..], [CheckupFinding::Noisy { channel: 1, .. }]), "{noisy:?}");
    assert_eq!(valued(|channel, _, _| at_rest(channel, 0.0)), [CheckupFinding::Frozen]);
    let halved = valued(|channel, even, _| at_rest(channel, even) * if channel > 5 { 0.5 } else { 1.0 });
    assert!(
        matches!(halved[..], [CheckupFinding::Gravity { size_m_s2 }] if (size_m_s2 - 4.9).abs() < 0.1),
        "{halved:?}"
    );
    // While it is pushed, its noise is not evaluated.
    let pushed = valued(|channel, even, t_s| at_rest(channel, 9.0 * even) + if channel == 2 { 3.0 * t_s } else { 0.0 });
    assert_eq!(pushed, [CheckupFinding::Moved { channel: 2 }]);
}

#[test]
fn ends_of_ranges_and_hidden_markers_are_found() {
    let arm = Fixture {
        part: RigPart::Arm(Side::Left),
        value: |channel, _, _| if channel == 3 { -2.5 } else { 0.1 },
        ..IN_ORDER
    };
    let findings = arm.tested().findings;
    assert!(matches!(findings[..], [CheckupFinding::AtTheEnd { channel: 3, value: -2.5, .. }]), "{findings:?}");
    let tracker = Fixture {
        part: RigPart::Tracker,
        rate_hz: 60,
        value: |channel, _, t_s| if (3..6).contains(&channel) && t_s > 1.0 { f64::NAN } else { 0.5 },
        age: 8,
        ..IN_ORDER
    };
    let findings = tracker.tested().findings;
    assert!(
        matches!(findings[..], [CheckupFinding::Hidden { tool: 1, fraction }] if fraction > 0.3 && fraction < 0.6),
        "{findings:?}"
    );
}

#[test]
fn a_pedal_that_nobody_presses_is_fine() {
    let pedal = Fixture { part: RigPart::Pedal, value: |_, _, _| 0.0, age: AGES - 1, ..IN_ORDER };
    let pedal = Fixture { change: |gauge| gauge.readings = 10, rate_hz: 100, ..pedal };
    assert_eq!(pedal.tested().findings, []);
}
