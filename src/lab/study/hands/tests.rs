//! A slice of the study, and a gate that it must see through.

use nalgebra::Vector1;
use nima_core::safety::{Governed, Reading, Reason};

use super::{
    held::{Gate, PERIOD_S},
    released::released,
    *,
};

const USUAL: Kind = Kind::USUAL;

fn clock(name: &str) -> VirtualClock {
    VirtualClock { profile: name.parse().unwrap(), seed: 3 }
}

/// Takes every tick for a period long, and every handle that is faster than friction explains for one that flies.
#[derive(Default)]
struct Naive {
    last_m: Option<f64>,
    last_m_s: f64,
}

impl Gate<1> for Naive {
    fn step(&mut self, _: f64, reading: Reading<1>, asked_n: Vector1<f64>) -> Governed<1> {
        let at_m = reading.at_m.x;
        let m_s = (at_m - self.last_m.replace(at_m).unwrap_or(at_m)) / PERIOD_S;
        let m_s2 = (m_s - std::mem::replace(&mut self.last_m_s, m_s)) / PERIOD_S;
        let flies = m_s * asked_n.x > 0.0 && m_s2 * asked_n.x.signum() > 40.0;
        let force_n = if flies { Vector1::new(-30.0 * m_s) } else { asked_n };
        let reason = if flies { Reason::LetGo } else { Reason::Open };
        Governed { force_n, withheld: f64::from(flies), reason }
    }
}

#[test]
fn a_hand_that_is_there_is_neither_opposed_nor_stepped_on_late_clocks() {
    for name in ["late-5", "busy", "stall-20"] {
        for kind in &Kind::ALL {
            let options = Options { clocks: Vec::new(), hands: 2, seconds: 2.0, releases: 1, seed: 11 };
            let Held { tally, .. } = options.held(clock(name), kind);
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
    let mut all = Tally::default();
    tallies.for_each(|tally| all.add(&tally));
    assert!(all.asked_n_s > 0.5, "hands press: {all:?}");
    assert!(all.alarms > 5 && all.hands_alarmed > 1 && all.reversed_ticks > 5, "{all:?}");
    assert!(all.beyond_slew_n > 0.2, "{all:?}");
}

#[test]
fn a_handle_that_is_let_go_flies_without_a_gate_and_is_caught_with_one() {
    struct Open;
    impl Gate<1> for Open {
        fn step(&mut self, _: f64, _: Reading<1>, force_n: Vector1<f64>) -> Governed<1> {
            Governed { force_n, withheld: 0.0, reason: Reason::Open }
        }
    }
    let open = released(&USUAL, VirtualClock::PERFECT, 1, (0.0, 3.0), Open);
    assert!(open.travel_m > 0.3 && open.energy_j > 0.1 && open.detected_s.is_none(), "{open:?}");
    let caught = releases(&USUAL, VirtualClock::PERFECT, 1, 8, (0.0, 3.0));
    assert!(caught.travel_max_mm < 3.0 && caught.energy_max_mj < 2.0, "{caught:?}");
    assert!(caught.detected_ms.is_some_and(|ms| ms < 50.0) && caught.withheld_before == 0, "{caught:?}");
}
