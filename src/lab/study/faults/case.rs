//! Runs one case: starts the fault, steps the machine and its fault-free twin, and records the first report, its time,
//! and the error of the force until then.

use std::collections::VecDeque;

use nalgebra::Vector3;
use nima_core::{
    impedance::Mode,
    safety::{Gate, Reason},
};
use nima_machine::messages::Fault;

use super::{
    CaseOutcome, FaultKind, FaultPlace, FaultVerdict, HARMLESS_N, SensorAt,
    bench::{BenchStep, FaultBench},
};

/// Ticks until the second event of a situation: drives switch on, the clutch is released.
const LATER: u32 = 200;
/// Ticks for which a machine is observed after it has latched.
const AFTER_LATCH: u32 = 100;

/// A state that differs from the twin's state for this many ticks counts as reported.
const APART: u32 = 5;
/// If a fault has been invisible for this many ticks, it counts as new when it becomes visible.
const PAUSE: u32 = 20;
/// A force is compared with the twin's forces up to this many ticks before and after, because the age gate accepts data
/// that are 5 ms late.
const SHIFT: usize = 5;

/// The healthy machine predicts over a delay and therefore also has an error. A machine counts as no worse if its mean
/// error, compared with the force at the tip, exceeds its twin's by no more than this, N, and its largest error by no
/// more than [`HARMLESS_N`].
const MEAN_N: f64 = 0.02;

/// Errors relative to the current force at the tip, N.
#[derive(Clone, Copy, Debug, Default)]
struct CaseErrors {
    sum_n: f64,
    max_n: f64,
}

impl CaseErrors {
    /// Adds an error; ignored while the force at the tip is unknown.
    fn add(&mut self, error_n: f64) {
        if error_n.is_finite() {
            self.sum_n += error_n;
            self.max_n = self.max_n.max(error_n);
        }
    }
}

/// A period in which a difference was visible, with interruptions shorter than [`PAUSE`].
#[derive(Clone, Copy, Debug, Default)]
struct DifferencePeriod {
    began: Option<u32>,
    last: u32,
}

impl DifferencePeriod {
    fn look(&mut self, seen: bool, tick: u32) {
        if !seen {
            return;
        }
        if self.began.is_none() || tick > self.last + PAUSE {
            self.began = Some(tick);
        }
        self.last = tick;
    }
}

/// Observations so far.
#[derive(Debug)]
struct CaseWatch {
    shows: DifferencePeriod,
    hints: DifferencePeriod,
    /// The latest pairs of force in the hand and force of the twin, N, newest last.
    forces_n: VecDeque<[Vector3<f64>; 2]>,
    report: Option<(String, u32)>,
    zero: Option<u32>,
    felt: bool,
    moved: bool,
    peak_error_n: f64,
    error_n: f64,
    of_machine: CaseErrors,
    of_twin: CaseErrors,
    ticks: u32,
    max_n: f64,
    step_n: f64,
    last_n: Vector3<f64>,
    /// Ticks for which machine and twin have been in different states.
    apart: u32,
}

/// Applies the fault on a bench prepared for it.
pub(super) fn tried(
    mut bench: FaultBench,
    kind: FaultKind,
    sensor: SensorAt,
    mode: Mode,
    place: FaultPlace,
    moment: u32,
) -> CaseOutcome {
    let mut watch = CaseWatch {
        shows: DifferencePeriod::default(),
        hints: DifferencePeriod::default(),
        forces_n: VecDeque::new(),
        report: None,
        zero: None,
        felt: false,
        moved: false,
        peak_error_n: 0.0,
        error_n: 0.0,
        of_machine: CaseErrors::default(),
        of_twin: CaseErrors::default(),
        ticks: 0,
        max_n: 0.0,
        step_n: 0.0,
        last_n: bench.wanted_n(),
        apart: 0,
    };
    bench.begin(kind);
    let begun_latched = bench.state().is_latched();
    let mut latched = 0;
    for tick in 0..place.ticks() {
        if tick == LATER {
            bench.rig.situation.powered = true;
            bench.rig.situation.clutch = false;
        }
        let Some(step) = bench.step() else { break };
        watch.look(tick, &step);
        // If the fault moved the arm elsewhere, the twin may latch, and is then no longer a valid reference.
        if step.twin.state.is_latched() && !begun_latched {
            break;
        }
        latched += u32::from(step.machine.state.is_latched() && !begun_latched);
        if latched > AFTER_LATCH {
            break;
        }
    }
    watch.outcome(kind, sensor, mode, place, moment)
}

impl CaseWatch {
    fn look(&mut self, tick: u32, step: &BenchStep) {
        if self.report.is_none() {
            self.shows.look(step.shows, tick);
            self.hints.look(step.hints, tick);
        }
        self.apart = if step.machine.state == step.twin.state { 0 } else { self.apart + 1 };
        if self.report.is_none() {
            let state = || format!("state {}", step.machine.state.word().to_lowercase());
            self.report = report(step).map(|what| (what, tick));
            // Differing states for only a tick or two do not count.
            if self.report.is_none() && self.apart == APART {
                self.report = Some((state(), tick));
            }
        }
        let applied_n = step.applied.hand_force_n;
        let wanted_n = step.wanted.hand_force_n;
        self.felt |= applied_n.norm() > 0.0;
        self.moved |= step.wanted.tip_command_m.is_some();
        let gone = applied_n.norm() == 0.0;
        if self.report.is_some() && self.felt && gone && self.zero.is_none() {
            self.zero = Some(tick);
        }
        // Outputs take effect in the next tick, on this rig and on the twin's, so compare with the twin's previous
        // output.
        if self.zero.is_none() {
            self.peak_error_n = self.peak_error_n.max((applied_n - step.twin_before_n).norm());
            self.compare(applied_n, step.twin_before_n);
            self.of_machine.add((applied_n - step.tip_before_n).norm());
            self.of_twin.add((step.twin_before_n - step.tip_before_n).norm());
            self.ticks += 1;
        }
        self.max_n = self.max_n.max(wanted_n.norm());
        if wanted_n.norm() > 0.0 {
            self.step_n = self.step_n.max((wanted_n - self.last_n).norm());
        }
        self.last_n = wanted_n;
    }

    fn compare(&mut self, applied_n: Vector3<f64>, twin_n: Vector3<f64>) {
        self.forces_n.push_back([applied_n, twin_n]);
        if self.forces_n.len() <= 2 * SHIFT {
            return;
        }
        let [applied_n, _] = self.forces_n[SHIFT];
        let nearest_n =
            self.forces_n.iter().map(|[_, twin_n]| (applied_n - twin_n).norm()).fold(f64::INFINITY, f64::min);
        self.error_n = self.error_n.max(nearest_n);
        self.forces_n.pop_front();
    }

    fn is_no_worse(&self) -> bool {
        let mean_n = |errors: &CaseErrors| errors.sum_n / f64::from(self.ticks.max(1));
        self.of_machine.max_n <= self.of_twin.max_n + HARMLESS_N
            && mean_n(&self.of_machine) <= mean_n(&self.of_twin) + MEAN_N
    }

    fn outcome(self, kind: FaultKind, sensor: SensorAt, mode: Mode, place: FaultPlace, moment: u32) -> CaseOutcome {
        let reported_at = self.report.as_ref().map(|(_, tick)| *tick);
        // If no difference was visible when the fault was reported, the report is timed from the first small force
        // difference, or from the start of the fault.
        let on = |stretch: &DifferencePeriod| {
            stretch.began.filter(|_| reported_at.is_none_or(|report| report <= stretch.last + PAUSE))
        };
        let origin = on(&self.shows).or(on(&self.hints)).unwrap_or(0);
        let since_ms = |tick: u32| f64::from(tick - origin.min(tick)) + 1.0;
        let verdict = if reported_at.is_some() {
            FaultVerdict::Detected
        } else if !self.felt && !self.moved {
            FaultVerdict::NoForce
        } else if self.error_n <= HARMLESS_N {
            FaultVerdict::Harmless
        } else if kind.untellable().is_some() {
            FaultVerdict::Bounded
        } else if self.is_no_worse() {
            FaultVerdict::Harmless
        } else if kind.passes_as_fresh().is_some() {
            FaultVerdict::Bounded
        } else {
            FaultVerdict::Silent
        };
        CaseOutcome {
            kind,
            part: kind.part(),
            sensor,
            mode,
            place,
            moment,
            verdict,
            report: self.report.map(|(what, _)| what),
            detection_ms: reported_at.map(since_ms),
            zero_ms: self.zero.map(since_ms),
            peak_error_n: self.peak_error_n,
            error_n: self.error_n,
            max_n: self.max_n,
            step_n: self.step_n,
        }
    }
}

/// Returns the report of the machine in this tick, if its twin does not report the same.
fn report(step: &BenchStep) -> Option<String> {
    let machine = &step.machine;
    let twin = &step.twin;
    if let Some(fault) = step.raised {
        return Some(fault_word(fault));
    }
    if step.device_lost {
        return Some("device lost".to_owned());
    }
    if machine.timing.missed > twin.timing.missed {
        return Some("missed periods counted".to_owned());
    }
    if step.refused {
        return Some("command refused".to_owned());
    }
    if !machine.force.source.is_usable() && twin.force.source.is_usable() {
        return Some("force unknown".to_owned());
    }
    [Gate::Validity, Gate::Age].into_iter().find_map(|gate| {
        let new = machine.gates.reason(gate) != Reason::Open && twin.gates.reason(gate) == Reason::Open;
        new.then(|| format!("gate {}", gate.name()))
    })
}

fn fault_word(fault: Fault) -> String {
    match fault {
        Fault::Implausible { what } => format!("{what:?}"),
        Fault::DeviceLost { .. } => "DeviceLost".to_owned(),
        Fault::LoopStalled { .. } => "LoopStalled".to_owned(),
        _ => format!("{fault:?}"),
    }
}
