//! Power and loose grips, tested.

use super::*;

fn tissue() -> TissueModel {
    pressed_tissue().unwrap()
}

#[test]
fn matched_on_the_handles_motion_does_not_drive_the_hand_and_late_reflection_does() {
    for times in [0.4, 1.0, 2.5] {
        let tissue = TissueModel { stiffness: tissue().stiffness * times, ..tissue() };
        for task in PassivityTask::ALL {
            for delay_ms in DELAYS_MS {
                let row =
                    tasked(VirtualClock::PERFECT, (Mode::Matched, OwnMotion::Handle), task, delay_ms, tissue).unwrap();
                assert!(row.power_mw <= 0.0, "{times} times as stiff: {row:?}");
            }
        }
    }
    for task in PassivityTask::ALL {
        let reflected = tasked(VirtualClock::PERFECT, (Mode::Dfr, OwnMotion::Follower), task, 100.0, tissue()).unwrap();
        assert!(reflected.power_mw > 12.0, "{reflected:?}");
    }
}

/// The benefit of the better of two modes must not depend on the tissue, the hand or the delay.
#[test]
fn the_best_of_two_is_never_much_worse_than_anchored() {
    never_much_worse(&[100.0]);
}

#[test]
#[ignore = "half a minute: `./dev figures` runs it"]
fn the_best_of_two_is_never_much_worse_than_anchored_in_the_whole_grid() {
    never_much_worse(&DELAYS_MS);
}

const DELAYS_MS: [f64; 4] = [10.0, 50.0, 100.0, 300.0];

/// Returns the scene's tissue, softer, stiffer, and without friction.
fn tissues() -> [TissueModel; 4] {
    let plain = tissue();
    [
        plain,
        TissueModel { stiffness: plain.stiffness / 3.0, ..plain },
        TissueModel { stiffness: plain.stiffness * 3.0, ..plain },
        TissueModel { friction: 0.0, shear_stiffness_n_m: 0.0, ..plain },
    ]
}

fn never_much_worse(delays_ms: &[f64]) {
    let mut worst = (0.0, String::new());
    for tissue in tissues() {
        for task in PassivityTask::ALL {
            for &delay_ms in delays_ms {
                let error_n = |mode| {
                    tasked(VirtualClock::PERFECT, (mode, OwnMotion::Follower), task, delay_ms, tissue).unwrap().error_n
                };
                let ratio = error_n(Mode::Best) / error_n(Mode::Anchored);
                if ratio > worst.0 {
                    worst = (ratio, format!("{task:?} at {delay_ms} ms, {tissue:?}"));
                }
            }
        }
    }
    println!("{worst:?}");
    assert!(worst.0 <= 1.01, "{worst:?}");
}

/// Returns the stiffness 0.5 to 2 times the usual, surface 2 mm up or down, changing at every touch; one sequence for
/// every `begin`.
fn changing(plain: TissueModel, begin: f64) -> impl Fn(u32) -> TissueModel {
    move |touch| {
        let fraction = |step: f64| (f64::from(touch) * step + begin).fract() * 2.0 - 1.0;
        let surface_z_m = plain.surface_z_m + 0.002 * fraction(0.618_034);
        TissueModel { surface_z_m, stiffness: plain.stiffness * fraction(0.754_878).exp2(), ..plain }
    }
}

#[test]
fn over_tissue_that_changes_at_every_touch_the_best_of_two_is_better_than_reflection() {
    for (task, limit) in [(PassivityTask::PegTransfer, 0.5), (PassivityTask::Withdrawal, 0.45)] {
        let other = changing(tissue(), 0.3);
        let error_n = |mode| {
            tasked_over(VirtualClock::PERFECT, (mode, OwnMotion::Follower), task, 300.0, &other).unwrap().error_n
        };
        let [dfr_n, anchored_n, matched_n, best_n] =
            [Mode::Dfr, Mode::Anchored, Mode::Matched, Mode::Best].map(error_n);
        println!("{task:?}: dfr {dfr_n:.3}, anchored {anchored_n:.3}, matched {matched_n:.3}, best {best_n:.3} N");
        assert!(best_n <= limit * dfr_n, "{task:?}: {best_n} N of {dfr_n} N");
    }
}

/// Before persistent errors were taken into account at once, it was up to 19 % worse here, and more than 2 % worse in a
/// fifth of all cases.
#[test]
fn over_tissue_that_changes_at_every_touch_the_best_of_two_is_hardly_worse_than_anchored() {
    hardly_worse(&[tissue()], &[0.55]);
}

#[test]
#[ignore = "half a minute: `./dev figures` runs it"]
fn over_tissue_that_changes_the_best_of_two_is_hardly_worse_than_anchored_in_the_whole_grid() {
    hardly_worse(&tissues(), &[0.3, 0.55, 0.82]);
}

/// Ratios above 1.02 occur at the first change of a run, before there is evidence that the tissue changes.
fn hardly_worse(tissues: &[TissueModel], begins: &[f64]) {
    let mut worse = Vec::new();
    for delay_ms in DELAYS_MS {
        let mut logs = 0.0;
        let mut cases = 0.0;
        for &begin in begins {
            for (plain, task) in tissues.iter().flat_map(|plain| PassivityTask::ALL.map(|task| (plain, task))) {
                let other = changing(*plain, begin);
                let error_n = |mode| {
                    tasked_over(VirtualClock::PERFECT, (mode, OwnMotion::Follower), task, delay_ms, &other)
                        .unwrap()
                        .error_n
                };
                let ratio = error_n(Mode::Best) / error_n(Mode::Anchored);
                let limit = if delay_ms > 200.0 { 1.11 } else { 1.04 };
                assert!(ratio <= limit, "{ratio} times anchored: {task:?} at {delay_ms} ms, sequence {begin}");
                logs += ratio.ln();
                cases += 1.0;
                if ratio > 1.02 {
                    worse.push((ratio, task, delay_ms, begin));
                }
            }
        }
        println!("{delay_ms} ms: geometric mean {:.3}", (logs / cases).exp());
        assert!(logs <= 0.002 * cases, "worse on the whole at {delay_ms} ms");
    }
    println!("{worse:?}");
    let cases = begins.len() * tissues.len() * PassivityTask::ALL.len() * DELAYS_MS.len();
    assert!(worse.len() * 30 <= cases, "{} of {cases}: {worse:?}", worse.len());
}

#[test]
fn a_loose_grip_holds_still_with_it() {
    for grip_n_m in LOOSE_N_M {
        let held = hold(VirtualClock::PERFECT, (Mode::Matched, OwnMotion::Handle), grip_n_m, 100.0, tissue()).unwrap();
        assert!(held.peak_m_s < STILL_M_S, "{held:?}");
    }
    let reflected =
        hold(VirtualClock::PERFECT, (Mode::Dfr, OwnMotion::Follower), LOOSE_N_M[0], 100.0, tissue()).unwrap();
    assert!(reflected.peak_m_s > STILL_M_S, "{reflected:?}");
}

#[test]
fn on_every_clock_matched_on_the_handles_motion_does_not_drive_the_hand() {
    for profile in [ClockProfile::Quiet, ClockProfile::Busy, ClockProfile::Late { percent: 5.0 }] {
        let clock = VirtualClock { profile, seed: 1 };
        let row =
            tasked(clock, (Mode::Matched, OwnMotion::Handle), PassivityTask::PegTransfer, 100.0, tissue()).unwrap();
        assert!(row.power_mw <= 0.0 && row.error_n.is_finite(), "{row:?}");
        let reflected =
            tasked(clock, (Mode::Dfr, OwnMotion::Follower), PassivityTask::PegTransfer, 100.0, tissue()).unwrap();
        assert!(reflected.power_mw > 12.0, "{reflected:?}");
    }
}
