//! Effect of **Apply** on a measured point: the loop then does the work whose time was measured.

use nima_core::{impedance::Mode, limits::GAIN};
use nima_machine::{
    config::{Identification, RigConfig},
    messages::Command,
};
use nima_screen::live::LiveState;
use nima_study::tradeoff::ParameterChoice;

/// Method by which the loop changes to a choice.
#[derive(Clone, Debug)]
pub(super) enum Apply {
    /// By commands to the running loop.
    AtOnce([Command; 3]),
    /// By a restart with this rig, because degree and window cannot change while the loop runs.
    Restart(Box<RigConfig>),
}

impl Apply {
    pub(super) fn of(live: &LiveState, mode: Mode, choice: &ParameterChoice) -> Self {
        if needs_restart(&live.rig.identification, mode, choice) {
            return Self::Restart(Box::new(rig_with(live, mode, choice)));
        }
        // The cost was measured for this mode alone, so the comparison ends.
        Self::AtOnce([Command::Compare(false), Command::SetMode(mode), Command::SetDelay(choice.delay_ms * 1e-3)])
    }
}

fn needs_restart(now: &Identification, mode: Mode, choice: &ParameterChoice) -> bool {
    let degree = choice.degree != now.max_degree;
    let window = (choice.window_ms - now.window_s * 1e3).abs() > 1e-6;
    (mode.has_degrees() && degree) || (mode.has_window() && window)
}

/// Returns the rig with this choice and all settings that the operator has changed since the start; a gain above 1 is
/// reset to 1.
fn rig_with(live: &LiveState, mode: Mode, choice: &ParameterChoice) -> RigConfig {
    let mut rig = live.rig.clone();
    rig.mode = mode;
    rig.identification.compare = false;
    rig.delay_s = choice.delay_ms * 1e-3;
    if mode.has_window() {
        rig.identification.window_s = choice.window_ms * 1e-3;
    }
    if mode.has_degrees() {
        rig.identification.max_degree = choice.degree;
    }
    rig.gates = live.gate_settings();
    rig.gates.gain = live.gain().min(GAIN.max);
    rig
}

#[cfg(test)]
mod tests {
    use std::{sync::atomic::AtomicBool, time::Instant};

    use nima_core::{
        impedance::{Identifier, Sample},
        statistics::Percentiles,
    };
    use nima_machine::{
        messages::LoopState,
        rig::{Outputs, Side},
        teleop::{Calibrations, Loop, Timing},
    };
    use nima_simulation::{World, scene::Scene};
    use nima_study::tradeoff::{Knob, SourceFigures, SweepPoint, TradeoffPlan, TradeoffSource, sweep};

    use super::*;
    use crate::extras::lab::screen::tradeoff::{name, plan};

    const SIDE: Side = Side::Right;
    /// Number of passes, for a cost that other load hardly disturbs.
    const PASSES: usize = 5;

    /// Returns a rig whose settings are not the default ones and that compares all modes when the operator presses
    /// Apply.
    fn live() -> LiveState {
        let mut rig = RigConfig::load("simulated").unwrap();
        rig.identification.compare = true;
        rig.identification.cross_talk = true;
        rig.identification.rest_n = 0.12;
        rig.delay_s = 0.04;
        LiveState::new(rig, Scene::load("peg_transfer").unwrap())
    }

    fn measured(source: &TradeoffSource, plan: &TradeoffPlan) -> SourceFigures {
        sweep(std::slice::from_ref(source), plan, &AtomicBool::new(false), |_, _| {}).unwrap().sources.remove(0)
    }

    /// Returns every point that can be on the front. The measured times decide which of them are.
    fn grid(figures: &SourceFigures) -> Vec<SweepPoint> {
        let curves = figures.curves.iter().filter(|curve| curve.knob == Knob::Grid);
        curves.flat_map(|curve| &curve.points).map(|&index| figures.points[index]).collect()
    }

    /// Returns the loop at the simulated peg transfer, engaged, 2 s after its start and after `apply`.
    fn loop_after(live: &LiveState, apply: &Apply) -> Loop {
        let (rig, commands) = match apply {
            Apply::AtOnce(commands) => (&live.rig, &commands[..]),
            Apply::Restart(rig) => (&**rig, &[][..]),
        };
        let mut control = Loop::new(rig, &[Some(Calibrations::default()), None]).unwrap();
        let mut world = World::new(&live.scene, rig.rate_hz);
        let mut outputs = Outputs::SAFE;
        for tick in 0..4000 {
            let now_s = f64::from(tick) / rig.rate_hz;
            match tick {
                100 => control.obey(Command::Engage, now_s),
                2000 => commands.iter().for_each(|&command| control.obey(command, now_s)),
                _ => {}
            }
            let inputs = world.exchange(now_s, &outputs);
            [outputs, _] = control.step([inputs, None], &Timing { now_s, ..Timing::default() }).0;
        }
        assert_eq!(control.pair(SIDE).unwrap().state(), LoopState::Engaged);
        control
    }

    /// After Apply, the loop's identifier is the one whose time was measured: from the same samples it computes the same
    /// results in every tick. Earlier learning is excluded from the comparison.
    #[test]
    fn after_apply_the_loop_does_the_work_that_was_measured() {
        let live = live();
        let source = TradeoffSource::from_scene(&live.scene, live.rig.rate_hz, 4.2);
        let points = grid(&measured(&source, &plan(&live)));
        let mut restarts = 0;
        for point in &points {
            let mode = point.choice.method.mode().unwrap();
            let apply = Apply::of(&live, mode, &point.choice);
            restarts += usize::from(matches!(apply, Apply::Restart(_)));
            let control = loop_after(&live, &apply);
            let mut in_loop = control.pair(SIDE).unwrap().identifier().clone();
            in_loop.reset();
            let mut timed = plan(&live).identifier(&point.choice, source.recording.axes.len()).unwrap().unwrap();
            for sample in &source.recording.samples {
                in_loop.step(sample);
                timed.step(sample);
                assert_eq!(in_loop.report(), timed.report(), "{} at {} s", name(point), sample.t_s);
                assert_eq!(in_loop.parcel(), timed.parcel(), "{} at {} s", name(point), sample.t_s);
            }
            assert!(timed.report().learnt > 500, "{}: it touched nothing", name(point));
        }
        assert!(points.len() > 20 && restarts > 5 && restarts < points.len(), "{restarts} of {}", points.len());
    }

    /// Returns the median time of a tick, us: the lowest of all passes, as in the study.
    fn median_us(identifier: &Identifier, samples: &[Sample], from_s: f64) -> f64 {
        let pass = || {
            let mut identifier = identifier.clone();
            identifier.reset();
            let mut times = Percentiles::new();
            for sample in samples {
                let start = Instant::now();
                identifier.step(sample);
                let spent_s = start.elapsed().as_secs_f64();
                if sample.t_s >= from_s {
                    times.record(spent_s);
                }
            }
            times.quantiles().p50
        };
        (0..PASSES).map(|_| pass()).fold(f64::INFINITY, f64::min)
    }

    /// Prints the times without judging them.
    #[test]
    #[ignore = "prints the times of docs/results/tradeoff.md: `./dev figures` runs it"]
    fn figures_of_what_apply_costs() {
        let rig = RigConfig::load("simulated").unwrap();
        let live = LiveState::new(rig, Scene::load("peg_transfer").unwrap());
        let source = TradeoffSource::from_scene(&live.scene, live.rig.rate_hz, 6.0);
        let figures = measured(&source, &TradeoffPlan { passes: PASSES, ..plan(&live) });
        println!("| row | measured by the study (us) | in the loop (us) | ratio |\n|---|---|---|---|");
        for point in grid(&figures) {
            let mode = point.choice.method.mode().unwrap();
            let control = loop_after(&live, &Apply::of(&live, mode, &point.choice));
            let from_s = figures.judged_from_s + point.choice.delay_ms * 1e-3;
            let in_loop = median_us(control.pair(SIDE).unwrap().identifier(), &source.recording.samples, from_s);
            let studied = point.cost_us.p50;
            let front = if point.pareto { ", on the front" } else { "" };
            println!("| {}{front} | {studied:.2} | {in_loop:.2} | {:.2} |", name(&point), in_loop / studied);
        }
    }
}
