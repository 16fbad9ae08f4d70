//! Updates the state from the loop's ticks, events and device health.

use std::time::Instant;

use nima_core::{frames::WristSample, impedance::SLOTS, statistics::Quantiles};
use nima_machine::{
    messages::{Event, Fault, LoopState, Tick},
    rig::{Gauges, SIDES, Side},
};

use super::{BLOCKS_KEPT, FIGURES_EVERY, LiveState, READINGS_EVERY, RefusedCommand, TRAIL_S, TRAIL_STEP_S, TREND_S};
use crate::{
    activity::Activity,
    loop_connection::{LoopConnection, LoopMessage},
    readings::{DisplayFigures, ShaftTwist, StateEntry},
    rolling::FadingMean,
    signals::signals_of,
};

/// Displayed forces are smoothed with this time constant, s, which calms the last digit.
const SMOOTHING_S: f64 = 0.05;
/// A change larger than this (N) is shown at once: the digits must not contradict the arrow and the bar next to them. About
/// ten times the noise of the sensors.
const JUMP_N: f64 = 0.2;

impl LiveState {
    /// Reads all data that the loop has sent; `each` is called with all of it.
    pub fn take_in(&mut self, door: &LoopConnection, mut each: impl FnMut(&LoopMessage<'_>)) {
        let handle = door.handle();
        if self.roster.len() != handle.roster().len() {
            self.roster.clone_from(handle.roster());
            self.activity = Activity::of(&self.roster);
        }
        if let Some(line) = &mut self.line {
            line.receive();
        }
        if let Some(healths) = handle.healths() {
            self.healths = healths;
        }
        let mut came = false;
        door.take(|news| {
            match news {
                LoopMessage::Event(event) => self.event(event),
                LoopMessage::Gauges(gauges) => self.gauges(gauges),
                LoopMessage::Tick(tick) => {
                    self.tick(tick);
                    came = true;
                }
            }
            each(&news);
        });
        if came {
            self.tick_at = Instant::now();
        }
        self.running = handle.is_running();
        self.refresh_figures();
    }

    /// Adds the content of a recorded session for a tick.
    pub fn replay<'a>(&mut self, events: impl Iterator<Item = &'a Event>, ticks: &[Option<Tick>; SIDES]) {
        events.for_each(|event| self.event(event));
        ticks.iter().flatten().for_each(|tick| self.tick(tick));
    }

    /// Updates the figures from the ticks of a recorded session, which took this time, s.
    pub fn settle(&mut self, seconds: f64) {
        self.refresh_readings();
        self.refresh_others(seconds);
    }

    fn event(&mut self, event: &Event) {
        match *event {
            Event::FaultRaised { t_s, side, fault } => {
                // Both arms may report in the same tick, and the one that only follows the other may come first.
                match self.first_fault {
                    Some((_, first)) if first != Fault::OtherArm || fault == Fault::OtherArm => {}
                    _ => (self.first_fault, self.fault_side) = (Some((t_s, fault)), side),
                }
            }
            Event::StateChanged { t_s, side, from, to, why } => {
                self.changes[side.index()] = Some(StateEntry { t_s, from, why });
                if !matches!(to, LoopState::Faulted(_)) {
                    self.first_fault = None;
                }
            }
            Event::CommandRefused { side, command, why, .. } => {
                self.refusal = Some((Instant::now(), RefusedCommand { side, command, why }));
            }
            Event::Scheduling(scheduling) => self.scheduling = Some(scheduling),
            Event::Device(event) => {
                if let Some(health) = self.healths.devices.get_mut(usize::from(event.device)) {
                    health.standing = event.standing;
                }
                if let Some((_, standing)) = self.devices_then.get_mut(usize::from(event.device)) {
                    *standing = event.standing;
                }
            }
        }
    }

    fn gauges(&mut self, gauges: &Gauges) {
        self.activity.follow(gauges);
        self.blocks.push_back(Box::new(*gauges));
        self.blocks_counted += 1;
        if self.blocks.len() > BLOCKS_KEPT {
            self.blocks.pop_front();
        }
    }

    fn tick(&mut self, tick: &Tick) {
        let before = self.ticks[tick.side.index()].replace(*tick);
        self.follow(tick, before.as_ref());
        if tick.side == Side::Right {
            self.follow_loop(tick, before.as_ref());
        }
    }

    /// Updates the state common to both sides: timing, and the identification of the first.
    fn follow_loop(&mut self, tick: &Tick, before: Option<&Tick>) {
        let dt_s = before.map_or(0.0, |before| (tick.t_s - before.t_s).max(0.0));
        let missed = before.map_or(0, |before| tick.timing.missed.saturating_sub(before.timing.missed));
        self.deadlines.push(tick.t_s, missed);
        self.missed_fraction.push(missed as f64 / (missed as f64 + 1.0), dt_s, 3.0);
        self.degrees.push(tick, dt_s);
        let compares = self.compares();
        self.compare_cost.push(tick, compares);
        // Without a measured force there is no error; zero means that no prediction was judged yet.
        let judged = |error_n: f64| if error_n > 0.0 { error_n } else { f64::NAN };
        let errors_n = tick.known_n().map(|_| tick.identification.horizon_error_n.map(judged));
        if before.is_some_and(|before| before.t_s.floor() < tick.t_s.floor()) {
            self.trend_n.push_back(errors_n.unwrap_or([f64::NAN; SLOTS]));
            if self.trend_n.len() > TREND_S {
                self.trend_n.pop_front();
            }
        }
        if errors_n.is_none() {
            self.horizon = Default::default();
        }
        for (mean, error_n) in self.horizon.iter_mut().zip(errors_n.into_iter().flatten()) {
            if error_n.is_finite() {
                mean.push(error_n, dt_s, 4.0);
            }
        }
        self.wake.record(tick.timing.wake_s);
        self.work.record(tick.timing.work_s);
        if let Some(seconds) = tick.timing.sample_to_force_s {
            self.sample_to_force.record(seconds);
        }
        self.ticks_counted += 1;
    }

    /// Updates the state of each side: forces and trail of the tip.
    fn follow(&mut self, tick: &Tick, before: Option<&Tick>) {
        let side = tick.side.index();
        let dt_s = before.map_or(0.0, |before| (tick.t_s - before.t_s).max(0.0));
        let m = tick.measured_n;
        let r = tick.rendering.rendered_n;
        self.history[side].push(tick.t_s, &signals_of(tick, before.map(|before| (before.t_s, before.positions.tip_m))));
        match tick.known_n() {
            Some(force_n) => follow_force(&mut self.measured[side], force_n.norm(), dt_s),
            None => self.measured[side] = FadingMean::default(),
        }
        follow_force(&mut self.rendered[side], r.norm(), dt_s);
        self.gates[side].push(tick, dt_s);
        self.clouds[side].push(tick.t_s, m, r);
        self.stiffness[side].push(tick.t_s, &tick.positions.tip_m, &m);
        if tick.t_s - self.trail_s[side] >= TRAIL_STEP_S && tick.positions.tip_m.iter().all(|x| x.is_finite()) {
            self.trail_s[side] = tick.t_s;
            self.trails[side].push_back(tick.positions.tip_m.cast());
            if self.trails[side].len() > (TRAIL_S / TRAIL_STEP_S) as usize {
                self.trails[side].pop_front();
            }
        }
    }

    fn refresh_figures(&mut self) {
        let shown = [self.figures.measured_n, self.figures.rendered_n.map(Some)];
        let now = [self.measured, self.rendered].map(|means| means.map(FadingMean::known));
        let jumps = shown.iter().flatten().zip(now.iter().flatten()).any(|(shown_n, now_n)| {
            shown_n.is_some() != now_n.is_some() || shown_n.zip(*now_n).is_some_and(|(a, b)| (a - b).abs() > JUMP_N)
        });
        if jumps || self.readings_at.elapsed() >= READINGS_EVERY {
            self.refresh_readings();
        }
        let since = self.figures_at.elapsed();
        if since >= FIGURES_EVERY {
            self.refresh_others(since.as_secs_f64());
        }
    }

    fn refresh_readings(&mut self) {
        self.figures.measured_n = self.measured.map(FadingMean::known);
        self.figures.rendered_n = self.rendered.map(FadingMean::get);
        self.figures.twist = Side::ALL.map(|side| self.twist(side).unwrap_or_default());
        self.readings_at = Instant::now();
    }

    fn twist(&self, side: Side) -> Option<ShaftTwist> {
        let tick = self.tick_of(side)?;
        let trocar_m = self.scene.of_side(side)?.trocar_m;
        let out = (trocar_m - tick.positions.tip_m).try_normalize(1e-6)?;
        let jaws = self.objects.as_ref().and_then(|objects| objects.jaws[side.index()]);
        let wrist_nm = |sample: &WristSample| Some((sample.world_from_s1? * sample.raw.torque_nm).dot(&out));
        Some(ShaftTwist {
            jaws_nm: jaws.map(|jaws| jaws.torque_nm.dot(&out)),
            wrist_nm: tick.calibration.wrist.as_ref().and_then(wrist_nm),
        })
    }

    /// Updates all other values; the ticks since the last update covered this time, s.
    fn refresh_others(&mut self, seconds: f64) {
        self.figures = DisplayFigures {
            horizon_n: self.horizon.map(FadingMean::known),
            wake_us: self.wake.quantiles(),
            work_us: self.work.quantiles(),
            sample_to_force_us: self.sample_to_force.quantiles(),
            rate_hz: if seconds > 0.0 { self.ticks_counted as f64 / seconds } else { 0.0 },
            frame_ms: {
                let Quantiles { p50, p99, .. } = self.frames.quantiles();
                [p50 * 1e-3, p99 * 1e-3]
            },
            frame_work_ms: self.frame_work.get(),
            ..self.figures
        };
        self.ticks_counted = 0;
        self.figures_at = Instant::now();
    }
}

/// Smooths the noise of a displayed force, but follows a jump at once.
fn follow_force(mean: &mut FadingMean, force_n: f64, dt_s: f64) {
    if mean.known().is_some_and(|mean_n| (mean_n - force_n).abs() > JUMP_N) {
        *mean = FadingMean::default();
    }
    mean.push(force_n, dt_s, SMOOTHING_S);
}

#[cfg(test)]
mod tests {
    use nima_devices::Loss;
    use nima_machine::config::RigConfig;
    use nima_simulation::{SimulationPlan, run_virtual, scene::Scene};

    use super::*;
    use crate::degree_record::DegreeRule;

    #[test]
    fn the_digits_follow_a_jump_of_the_force_at_once() {
        let rig = RigConfig::load("simulated").unwrap();
        let scene = Scene::load("peg_transfer").unwrap();
        let plan =
            SimulationPlan { rig: rig.clone(), scene: scene.clone(), calibrations: Default::default(), engage: true };
        let mut live = LiveState::new(rig, scene);
        let mut farthest_n = 0.0_f64;
        run_virtual(&plan, 2.0, |tick| {
            live.replay([].iter(), &[Some(*tick), None]);
            live.refresh_figures();
            let shown_n = live.figures.measured_n[Side::Right.index()];
            farthest_n = farthest_n.max((shown_n? - tick.known_n()?.norm()).abs());
            None
        })
        .unwrap();
        assert!((0.01..2.0 * JUMP_N).contains(&farthest_n), "{farthest_n} N");
    }

    #[test]
    fn degrees_are_counted_only_while_engaged() {
        for engage in [false, true] {
            let rig = RigConfig::load("simulated").unwrap();
            let scene = Scene::load("peg_transfer").unwrap();
            let plan =
                SimulationPlan { rig: rig.clone(), scene: scene.clone(), calibrations: Default::default(), engage };
            let mut live = LiveState::new(rig, scene);
            run_virtual(&plan, 1.0, |tick| {
                live.replay([].iter(), &[Some(*tick), None]);
                None
            })
            .unwrap();
            assert_eq!(live.degrees.fractions(DegreeRule::Console, false).is_some(), engage);
        }
    }

    #[test]
    fn the_fault_that_is_told_is_the_cause_and_not_what_it_did_to_the_other_arm() {
        let cause = Fault::DeviceLost { device: 4, loss: Loss::Silent };
        let raised = |(side, fault)| Event::FaultRaised { t_s: 2.7, side, fault };
        let follows = (Side::Right, Fault::OtherArm);
        let fails = (Side::Left, cause);
        for order in [[follows, fails, follows], [fails, follows, follows], [follows, follows, fails]] {
            let mut live = LiveState::new(RigConfig::load("simulated").unwrap(), Scene::load("bimanual").unwrap());
            live.replay(order.map(raised).iter(), &[None; SIDES]);
            let signs = live.signs(false, None);
            assert_eq!((signs.first_fault, signs.fault_side), (Some((2.7, cause)), Some(Side::Left)));
        }
        let mut live = LiveState::new(RigConfig::load("simulated").unwrap(), Scene::load("bimanual").unwrap());
        live.replay([raised(follows)].iter(), &[None; SIDES]);
        assert_eq!(live.signs(false, None).first_fault, Some((2.7, Fault::OtherArm)));
    }
}
