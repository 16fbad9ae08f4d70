//! A simulated person with force perception: forces and pace depend on the loop's rendering.

use nima_core::{impedance::Mode, task::TaskEvent};
use nima_machine::{messages::LoopState, rig::Side, runtime};
use nima_tests::plan;

/// Returns the force at the tip while it presses on the tissue, N: its peak, its mean; and the number of presses in
/// half a minute.
fn pressed(gain: f64, intended_n: Option<f64>) -> (f64, f64, u32) {
    let mut plan = plan("peg_transfer");
    plan.rig.mode = Mode::Matched;
    plan.rig.delay_s = 0.02;
    plan.rig.gates.gain = gain;
    plan.scene.hand.intended_n = intended_n;
    let mut peak_n = 0.0_f64;
    let mut sum_n = 0.0;
    let mut ticks = 0_u32;
    let mut presses = 0;
    let mut touches = false;
    nima_simulation::run_virtual(&plan, 30.0, |tick| {
        let force_n = tick.measured_n.norm();
        presses += u32::from(!touches && force_n > 0.5);
        touches = force_n > if touches { 0.2 } else { 0.5 };
        if touches {
            peak_n = peak_n.max(force_n);
            sum_n += force_n;
            ticks += 1;
        }
        None
    })
    .unwrap();
    (peak_n, sum_n / f64::from(ticks), presses)
}

#[test]
fn with_force_a_person_presses_less_and_is_slower_and_without_it_feeling_is_no_matter() {
    let [felt, blind, without] = [pressed(1.0, Some(1.0)), pressed(1.0, None), pressed(0.0, Some(1.0))];
    println!("felt {felt:?}, blind {blind:?}, without force {without:?}");
    assert_eq!(without, pressed(0.0, None));
    // The peak occurs within the reaction time, so only the hand's impedance makes it lower than without force.
    assert!(felt.1 < 0.95 * blind.1, "the mean falls: {felt:?}, {blind:?}");
    assert!(felt.0 < 0.75 * without.0 && felt.1 < 0.67 * without.1, "{felt:?}, {without:?}");
    assert!(felt.2 < blind.2 && blind.2 == without.2, "slower where more is felt: {felt:?}, {blind:?}, {without:?}");
}

#[test]
fn both_hands_of_a_person_who_feels_keep_in_step() {
    let mut plan = plan("rings");
    plan.rig.mode = Mode::Matched;
    plan.scene.hand.intended_n = Some(0.8);
    let (assembly, watched) = plan.watched().unwrap();
    let watched = watched.unwrap();
    let mut events = Vec::new();
    let summary = runtime::run_virtual(assembly, 50.0, |tick| {
        if tick.side == Side::Left {
            events.extend(watched.happenings().map(|happening| happening.event));
        }
        None
    });
    assert_eq!(summary.final_state, LoopState::Engaged);
    let count = |wanted: fn(&TaskEvent) -> bool| events.iter().filter(|event| wanted(event)).count();
    let transferred = count(|event| matches!(event, TaskEvent::RingTransferred { .. }));
    let lost = count(|event| matches!(event, TaskEvent::RingDropped { .. } | TaskEvent::RingKnockedOff { .. }));
    assert!(transferred >= 3 && lost == 0, "{events:?}");
}
