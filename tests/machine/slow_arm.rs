//! An arm that its own limits hold back behind a quick hand.

use std::sync::{Arc, Mutex};

use nalgebra::Vector3;
use nima_machine::{
    messages::{Fault, LoopState},
    rig::{Inputs, Outputs, PlannedTip, Rig, SIDES},
    runtime::{Assembly, run_virtual},
};
use nima_simulation::SimulationPlan;

/// Maximum travel of the plan in a tick, m: 5 mm/s.
const STEP_MAX_M: f64 = 5e-6;
const RUN_S: f64 = 6.0;

/// The simulated arms behind a plan that moves slowly; `reports` the plan as a real arm does.
struct SlowArm {
    arms: Box<dyn Rig>,
    planned_m: [Option<Vector3<f64>>; SIDES],
    reports: bool,
    /// Largest distance by which a command led the plan, m.
    ahead_m: Arc<Mutex<f64>>,
}

impl Rig for SlowArm {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        let mut inputs = self.arms.read(now_s);
        for (inputs, planned_m) in inputs.iter_mut().zip(self.planned_m) {
            if let Some(inputs) = inputs {
                inputs.planned = PlannedTip(planned_m.filter(|_| self.reports));
            }
        }
        inputs
    }

    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        let mut outputs = *outputs;
        for (outputs, planned_m) in outputs.iter_mut().zip(&mut self.planned_m) {
            *planned_m = outputs.tip_command_m.map(|command_m| {
                let from_m = planned_m.unwrap_or(command_m);
                let path_m = command_m - from_m;
                let mut ahead_m = self.ahead_m.lock().unwrap();
                *ahead_m = ahead_m.max(path_m.norm());
                from_m + path_m * (STEP_MAX_M / path_m.norm().max(STEP_MAX_M))
            });
            outputs.tip_command_m = *planned_m;
        }
        self.arms.write(now_s, &outputs);
    }
}

/// Returns the last state, and the largest distance by which a command led the plan, m.
fn led(reports: bool) -> (LoopState, f64) {
    let plan = SimulationPlan { engage: true, ..nima_tests::plan("peg_transfer") };
    let (assembly, _) = plan.watched().unwrap();
    let ahead_m = Arc::default();
    let rig = SlowArm { arms: assembly.rig, planned_m: [None; SIDES], reports, ahead_m: Arc::clone(&ahead_m) };
    let summary = run_virtual(Assembly { rig: Box::new(rig), ..assembly }, RUN_S, |_| None);
    let ahead_m = *ahead_m.lock().unwrap();
    (summary.final_state, ahead_m)
}

#[test]
fn an_arm_that_its_limits_hold_back_follows_later_and_the_command_waits_for_it() {
    let (state, ahead_m) = led(true);
    assert_eq!(state, LoopState::Engaged);
    assert!((0.009..0.0101).contains(&ahead_m), "{ahead_m} m");
}

#[test]
fn an_arm_that_is_far_from_its_command_for_no_known_reason_is_astray() {
    let (state, ahead_m) = led(false);
    assert!(matches!(state, LoopState::Faulted(Fault::Implausible { .. })), "{state:?}");
    assert!(ahead_m > 0.015, "{ahead_m} m");
}
