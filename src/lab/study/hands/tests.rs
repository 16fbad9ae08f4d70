//! Short version of the study, and a gate that it must detect as unsafe.

use nalgebra::Vector1;
use nima_core::safety::{GovernorOutput, GovernorReading, Reason};

use super::{
    present_hands::{LastGate, PERIOD_S},
    released::released,
    *,
};

const USUAL: HandKind = HandKind::USUAL;

fn clock(name: &str) -> VirtualClock {
    VirtualClock { profile: name.parse().unwrap(), seed: 3 }
}

/// Takes every tick for a period long, and every handle that is faster than friction explains for one that flies.
#[derive(Default)]
struct Naive {
    last_m: Option<f64>,
    last_m_s: f64,
}

impl LastGate<1> for Naive {
    fn step(&mut self, _: f64, reading: GovernorReading<1>, asked_n: Vector1<f64>) -> GovernorOutput<1> {
        let position_m = reading.position_m.x;
        let m_s = (position_m - self.last_m.replace(position_m).unwrap_or(position_m)) / PERIOD_S;
        let m_s2 = (m_s - std::mem::replace(&mut self.last_m_s, m_s)) / PERIOD_S;
        let flies = m_s * asked_n.x > 0.0 && m_s2 * asked_n.x.signum() > 40.0;
        let force_n = if flies { Vector1::new(-30.0 * m_s) } else { asked_n };
        let reason = if flies { Reason::LetGo } else { Reason::Open };
        GovernorOutput { force_n, withheld: f64::from(flies), reason }
    }
}

#[test]
fn a_hand_that_is_there_is_neither_opposed_nor_stepped_on_late_clocks() {
    for name in ["late-5", "busy", "stall-20"] {
        for kind in &HandKind::ALL {
            let options = HandOptions { clocks: Vec::new(), hands: 2, seconds: 2.0, releases: 1, seed: 11 };
            let HeldHands { tally, .. } = options.held(clock(name), kind);
            assert_eq!(tally.hands, 2 * kind.hands() as u64);
            assert!(tally.minutes > 0.06 * kind.hands() as f64, "{name}, {kind:?}: {tally:?}");
            assert_eq!(tally.reversed_ticks, 0, "{name}, {kind:?}: {tally:?}");
            assert!(tally.beyond_slew_n < 1e-9 && tally.hands_gone == 0, "{name}, {kind:?}: {tally:?}");
        }
    }
}

#[test]
fn a_gate_that_assumes_the_period_is_seen_to_oppose_hands() {
    let tallies = (0..4).map(|seed| held::<1, _>(&USUAL, clock("late-5"), seed, 2.0, Naive::default));
    let mut all = HeldTally::default();
    tallies.for_each(|tally| all.add(&tally));
    assert!(all.asked_n_s > 0.5, "hands press: {all:?}");
    assert!(all.alarms > 5 && all.hands_alarmed > 1 && all.reversed_ticks > 5, "{all:?}");
    assert!(all.beyond_slew_n > 0.2, "{all:?}");
}

#[test]
fn a_handle_that_is_let_go_flies_without_a_gate_and_is_caught_with_one() {
    struct Open;
    impl LastGate<1> for Open {
        fn step(&mut self, _: f64, _: GovernorReading<1>, force_n: Vector1<f64>) -> GovernorOutput<1> {
            GovernorOutput { force_n, withheld: 0.0, reason: Reason::Open }
        }
    }
    let open = released(&USUAL, VirtualClock::PERFECT, 1, (0.0, 3.0), Open);
    assert!(open.travel_m > 0.3 && open.energy_j > 0.1 && open.detected_s.is_none(), "{open:?}");
    let caught = releases(&USUAL, VirtualClock::PERFECT, 1, 8, (0.0, 3.0));
    assert!(caught.travel_max_mm < 3.0 && caught.energy_max_mj < 2.0, "{caught:?}");
    assert!(caught.detected_ms.is_some_and(|ms| ms < 50.0) && caught.withheld_before == 0, "{caught:?}");
}
