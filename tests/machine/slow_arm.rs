//! An arm that its own limits hold back behind a quick hand.

use std::sync::{Arc, Mutex};

use nalgebra::Vector3;
use nima_core::safety::Implausible;
use nima_machine::{
    messages::{Fault, LoopState},
    rig::{Inputs, Outputs, PlannedTip, Rig, SIDES},
    runtime::{Assembly, run_virtual},
};
use nima_simulation::SimulationPlan;

/// Maximum travel of the plan in a tick, m: 5 mm/s.
const STEP_MAX_M: f64 = 5e-6;
const RUN_S: f64 = 6.0;

/// Faults of the arms.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Flaw {
    /// The plan moves slowly, and is reported as real arms do.
    Slow,
    SlowAndSilent,
    /// The plan follows the hand, but the arms creep.
    Astray,
}

/// The simulated arms behind a plan.
struct SlowArm {
    arms: Box<dyn Rig>,
    flaw: Flaw,
    /// Position to which the arms go, m.
    slow_m: [Option<Vector3<f64>>; SIDES],
    planned_m: [Option<Vector3<f64>>; SIDES],
    /// Largest distance by which a command led the arms, m.
    ahead_m: Arc<Mutex<f64>>,
}

impl Rig for SlowArm {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        let mut inputs = self.arms.read(now_s);
        for (inputs, planned_m) in inputs.iter_mut().zip(self.planned_m) {
            if let Some(inputs) = inputs {
                inputs.planned = PlannedTip(planned_m);
            }
        }
        inputs
    }

    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        let mut slow = *outputs;
        for (outputs, slow_m) in slow.iter_mut().zip(&mut self.slow_m) {
            *slow_m = outputs.tip_command_m.map(|command_m| {
                let from_m = slow_m.unwrap_or(command_m);
                let path_m = command_m - from_m;
                let mut ahead_m = self.ahead_m.lock().unwrap();
                *ahead_m = ahead_m.max(path_m.norm());
                from_m + path_m * (STEP_MAX_M / path_m.norm().max(STEP_MAX_M))
            });
            outputs.tip_command_m = *slow_m;
        }
        self.planned_m = match self.flaw {
            Flaw::Slow => self.slow_m,
            Flaw::SlowAndSilent => [None; SIDES],
            Flaw::Astray => outputs.map(|outputs| outputs.tip_command_m),
        };
        self.arms.write(now_s, &slow);
    }
}

/// Returns the last state, and the largest distance by which a command led the arms, m.
fn led(flaw: Flaw) -> (LoopState, f64) {
    let plan = SimulationPlan { engage: true, ..nima_tests::plan("peg_transfer") };
    let (assembly, _) = plan.watched().unwrap();
    let ahead_m = Arc::default();
    let nowhere = [None; SIDES];
    let rig = SlowArm { arms: assembly.rig, flaw, slow_m: nowhere, planned_m: nowhere, ahead_m: Arc::clone(&ahead_m) };
    let summary = run_virtual(Assembly { rig: Box::new(rig), ..assembly }, RUN_S, |_| None);
    let ahead_m = *ahead_m.lock().unwrap();
    (summary.final_state, ahead_m)
}

#[test]
fn an_arm_that_its_limits_hold_back_follows_later_and_the_command_waits_for_it() {
    let (state, ahead_m) = led(Flaw::Slow);
    assert_eq!(state, LoopState::Engaged);
    assert!((0.009..0.0101).contains(&ahead_m), "{ahead_m} m");
}

#[test]
fn an_arm_that_is_far_from_its_plan_or_for_no_known_reason_from_its_command_is_astray() {
    for flaw in [Flaw::SlowAndSilent, Flaw::Astray] {
        let (state, ahead_m) = led(flaw);
        let is_astray = matches!(state, LoopState::Faulted(Fault::Implausible { what: Implausible::ArmAstray }));
        assert!(is_astray, "{state:?}");
        assert!((0.019..0.022).contains(&ahead_m), "{ahead_m} m");
    }
}
