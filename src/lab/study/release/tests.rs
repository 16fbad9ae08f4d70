//! The release, tested.

use nima_core::impedance::Baseline;

use super::*;
use crate::Findings as _;

fn tissue() -> TissueModel {
    Scene::load("peg_transfer").unwrap().tissue.unwrap()
}

#[test]
fn a_late_force_kicks_and_the_governor_takes_the_kick_away() {
    for situation in ReleaseSituation::ALL {
        for (mode, delay_ms) in [(Mode::Dfr, 300.0), (Mode::Dfr, 0.0), (Mode::Anchored, 50.0)] {
            let way = ReleaseStyle {
                clock: VirtualClock::PERFECT,
                situation,
                governor: false,
                mode,
                delay_ms,
                contact_n: 5.0,
            };
            let [without, with] =
                [false, true].map(|governor| let_go(&ReleaseStyle { governor, ..way }, tissue()).unwrap());
            assert!(without.travel_mm > 100.0 && without.energy_mj > 30.0, "{without:?}");
            assert!(with.counts() && with.meets_the_aims(), "{with:?}");
        }
    }
}

#[test]
fn a_handle_that_is_not_the_one_it_is_told_of_is_caught_too() {
    for (kg, coulomb_n) in [(0.2, 0.0), (0.31, 0.15)] {
        let worst =
            worst_of(VirtualClock::PERFECT, 5.0, 30.0, &LoneHandle { kg, coulomb_n, ..LoneHandle::OMEGA }, tissue())
                .unwrap();
        let Worst { travel_mm, peak_m_s, energy_mj, force_after_100_ms_n, .. } = worst;
        assert!(travel_mm <= AIM_MM && peak_m_s <= AIM_M_S && energy_mj <= AIM_MJ, "{worst:?}");
        assert!(force_after_100_ms_n <= AIM_N, "{worst:?}");
    }
}

#[test]
fn the_methods_of_others_are_let_go_of_too() {
    let clock = VirtualClock::PERFECT;
    let situation = ReleaseSituation::Pressing;
    let way = |mode| ReleaseStyle { clock, situation, governor: true, mode, delay_ms: 50.0, contact_n: 5.0 };
    let rows: Vec<ReleaseRow> = methods().map(|mode| let_go(&way(mode), tissue()).unwrap()).collect();
    for baseline in Baseline::ALL {
        let row = rows.iter().find(|row| row.mode == Mode::Baseline(baseline)).unwrap();
        assert!(row.counts() && row.meets_the_aims(), "{row:?}");
    }
    let text = ReleaseReport { rows, worst: Vec::new() }.text();
    for mode in Mode::BASELINES {
        assert_eq!(text.matches(&format!("| 5 | {mode} | on |")).count(), 1, "{text}");
        assert_eq!(text.matches(&format!("\n| {mode} | 50 | on |")).count(), 1, "{text}");
    }
}
