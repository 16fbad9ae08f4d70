//! A run: a rig, and its simulated scene.

use nima_core::impedance::SettingsError;
use nima_machine::{
    config::{RigConfig, SchedulingClass},
    messages::{Command, Tick},
    rig::{DeviceRig, Rig, RigError, Roster, SIDES, Side},
    runtime::{self, Assembly, LoopHandle, LoopStartError, RuntimeClock, RuntimeSummary, VirtualClock},
    teleop::{Calibrations, Loop, LoopOrigin},
};

use crate::{InputDevices, ObjectFeed, Worlds, scene::Scene};

/// Access to the objects of a simulated rig's scene, if there are any.
type ObjectOutput = Option<ObjectFeed>;

#[derive(Clone, Debug)]
pub struct SimulationPlan {
    pub rig: RigConfig,
    pub scene: Scene,
    /// Calibrations of the wrist sensor and tool of each side; may be empty if the force is measured at the tip. They
    /// are not used on a rig with devices, where [`LoopHandle::activate`] sets them once a sensor has reported its
    /// identity.
    pub calibrations: [Calibrations; SIDES],
    /// Engage as soon as every device delivers data. Ignored with real devices ([`RigConfig::is_harmless`]), which a
    /// person engages.
    pub engage: bool,
}

impl SimulationPlan {
    /// Returns whether there is an arm pair on this side.
    pub fn has(&self, side: Side) -> bool {
        self.scene.has(&self.rig, side)
    }

    /// Returns whether the force of this side is measured at the wrist.
    pub fn is_at_wrist(&self, side: Side) -> bool {
        self.scene.measures_at_wrist(&self.rig, side)
    }

    /// Returns whether the rig may be engaged automatically: the force at every tip is known or can become known with
    /// the devices, and the followers can follow. On a simulated rig a person at the arm prevents the arm from
    /// following; on an emulated rig a person comes only for a calibration.
    pub fn may_engage(&self) -> bool {
        let knowable = |side: Side| self.rig.devices.is_some() || self.calibrations[side.index()].gravity.is_some();
        let follows = self.rig.devices.is_some() || self.scene.person.is_none();
        follows && Side::ALL.into_iter().all(|side| !self.is_at_wrist(side) || knowable(side))
    }

    /// Returns the origin of this plan's loop.
    pub fn origin(&self) -> LoopOrigin {
        // Cross-talk is identified only if the scene contains it.
        let mut rig = self.rig.clone();
        rig.identification.cross_talk |= self.scene.cross_talk;
        let calibrations = Side::ALL.map(|side| self.has(side).then(|| self.calibrations[side.index()].clone()));
        LoopOrigin { rig, calibrations, suspended: self.rig.devices.is_some() }
    }

    /// Creates the loop for this plan.
    ///
    /// # Errors
    /// [`SettingsError`] if the settings of the identification are invalid.
    pub fn control(&self) -> Result<Loop, SettingsError> {
        self.origin().control()
    }

    /// Returns the loop of this plan with its rig, ready to start.
    ///
    /// # Errors
    /// [`LoopStartError`] if settings or devices are invalid.
    pub fn assembly(&self) -> Result<Assembly, LoopStartError> {
        Ok(self.watched_assembly()?.0)
    }

    /// Like [`assembly`](Self::assembly), with access to the objects of a simulated rig's scene, if there are any.
    ///
    /// # Errors
    /// As [`assembly`](Self::assembly).
    pub fn watched_assembly(&self) -> Result<(Assembly, Option<ObjectFeed>), LoopStartError> {
        let (rig, roster, watched) = self.rig()?;
        let assembly = self.on(rig, roster)?;
        Ok((Assembly { engage: self.engage && self.rig.is_harmless(), ..assembly }, watched))
    }

    /// Like [`simulated`](Self::simulated), with access to the objects of the scene, if there are any.
    ///
    /// # Errors
    /// As [`simulated`](Self::simulated).
    pub fn watched(&self) -> Result<(Assembly, Option<ObjectFeed>), SettingsError> {
        let (worlds, watched) = Worlds::watched(&self.scene, self.rig.rate_hz);
        Ok((self.on(Box::new(worlds), Roster::new())?, watched))
    }

    /// Returns the loop with the simulated world of this plan instead of its devices.
    ///
    /// # Errors
    /// [`SettingsError`] if the settings of the identification are invalid.
    pub fn simulated(&self) -> Result<Assembly, SettingsError> {
        self.on(Box::new(self.worlds()), Roster::new())
    }

    /// Creates the rig and the list of its devices.
    fn rig(&self) -> Result<(Box<dyn Rig>, Roster, ObjectOutput), RigError> {
        let worlds = || Worlds::watched(&self.scene, self.rig.rate_hz);
        if let Some(desk) = &self.rig.desk {
            let (worlds, watched) = worlds();
            let (desk, roster) = InputDevices::start(desk, worlds)?;
            return Ok((Box::new(desk), roster, watched));
        }
        let Some(devices) = &self.rig.devices else {
            let (worlds, watched) = worlds();
            return Ok((Box::new(worlds), Roster::new(), watched));
        };
        let at_wrist = Side::ALL.map(|side| self.is_at_wrist(side));
        let (rig, roster) = DeviceRig::start(devices, 1.0 / self.rig.rate_hz, at_wrist)?;
        Ok((Box::new(rig), roster, None))
    }

    fn worlds(&self) -> Worlds {
        Worlds::new(&self.scene, self.rig.rate_hz)
    }

    /// Combines the loop of this plan with a given rig.
    fn on(&self, rig: Box<dyn Rig>, roster: Roster) -> Result<Assembly, SettingsError> {
        let rate_hz = self.rig.rate_hz;
        let scheduling = self.rig.scheduling;
        let engage = self.engage;
        let control = self.control()?;
        Ok(Assembly { control, rig, roster, rate_hz, clock: RuntimeClock::Real, scheduling, engage, tap: None })
    }
}

/// Starts the loop of this plan in its own thread.
///
/// # Errors
/// [`LoopStartError`] if settings or devices are invalid, or a thread cannot be created.
pub fn start(plan: &SimulationPlan) -> Result<LoopHandle, LoopStartError> {
    runtime::start(plan.assembly()?)
}

/// Like [`start`], with a given rig, for instance one with injected faults.
///
/// # Errors
/// As [`start`].
pub fn start_on(plan: &SimulationPlan, rig: Box<dyn Rig>, roster: Roster) -> Result<LoopHandle, LoopStartError> {
    runtime::start(plan.on(rig, roster)?)
}

/// Starts the loop of this plan in its own thread, with its simulated world and in simulated time, at most `speed`
/// times as fast as real time: a busy computer only makes it slower. The devices of the rig are not used.
///
/// # Errors
/// As [`start`].
pub fn start_simulated(plan: &SimulationPlan, speed: f64) -> Result<LoopHandle, LoopStartError> {
    Ok(start_watched(plan, speed)?.0)
}

/// Like [`start_simulated`], with access to the objects of the scene, if there are any.
///
/// # Errors
/// As [`start`].
pub fn start_watched(plan: &SimulationPlan, speed: f64) -> Result<(LoopHandle, Option<ObjectFeed>), LoopStartError> {
    let (assembly, watched) = plan.watched()?;
    let scheduling = SchedulingClass::Ordinary;
    let handle = runtime::start(Assembly { clock: RuntimeClock::Simulated { speed }, scheduling, ..assembly })?;
    Ok((handle, watched))
}

/// Runs the simulated world of this plan for `seconds` of loop time. `each` is called with every tick of every side; it
/// may return a command for the next tick, and ends the run by returning [`Command::Shutdown`].
///
/// # Errors
/// [`SettingsError`] if the settings of the identification are invalid.
///
/// ```
/// use nima_machine::{config::RigConfig, messages::LoopState};
/// use nima_simulation::{SimulationPlan, run_virtual, scene::Scene};
///
/// let plan = SimulationPlan {
///     rig: RigConfig::load("simulated")?,
///     scene: Scene::load("peg_transfer")?,
///     calibrations: Default::default(),
///     engage: true,
/// };
/// let mut largest_n = 0.0_f64;
/// let summary = run_virtual(&plan, 4.0, |tick| {
///     largest_n = largest_n.max(tick.rendering.rendered_n.norm());
///     None
/// })?;
/// assert_eq!((summary.final_state, summary.missed), (LoopState::Engaged, 0));
/// assert!(largest_n > 0.5 && largest_n <= plan.rig.gates.ceiling_n, "{largest_n} N");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_virtual(
    plan: &SimulationPlan,
    seconds: f64,
    each: impl FnMut(&Tick) -> Option<Command>,
) -> Result<RuntimeSummary, SettingsError> {
    run_virtual_on(plan, VirtualClock::PERFECT, seconds, each)
}

/// Like [`run_virtual`], with the late ticks of this clock.
///
/// # Errors
/// As [`run_virtual`].
pub fn run_virtual_on(
    plan: &SimulationPlan,
    clock: VirtualClock,
    seconds: f64,
    each: impl FnMut(&Tick) -> Option<Command>,
) -> Result<RuntimeSummary, SettingsError> {
    Ok(runtime::run_virtual_on(clock, plan.simulated()?, seconds, each))
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use nima_core::impedance::Mode;
    use nima_machine::{
        messages::{Event, Fault, LoopState, Refusal},
        rig::{Inputs, Outputs},
        runtime::{ClockProfile, TICKS_WAITING_MAX},
    };
    use nima_testing::real_time::judged;

    use super::*;

    fn plan() -> SimulationPlan {
        SimulationPlan {
            rig: RigConfig::load("simulated").unwrap(),
            scene: Scene::load("peg_transfer").unwrap(),
            calibrations: Default::default(),
            engage: true,
        }
    }

    /// Waits until a tick satisfies `good`; returns that tick.
    fn wait_for(handle: &LoopHandle, good: impl Fn(&Tick) -> bool) -> Option<Tick> {
        let until = Instant::now() + Duration::from_secs(10);
        let mut found = None;
        while found.is_none() && Instant::now() < until {
            handle.drain_ticks(|tick| {
                if found.is_none() && good(tick) {
                    found = Some(*tick);
                }
            });
            std::thread::sleep(Duration::from_millis(2));
        }
        found
    }

    #[test]
    fn the_loop_runs_obeys_and_ends() {
        let handle = start(&plan()).unwrap();
        assert!(wait_for(&handle, |tick| tick.state == LoopState::Engaged).is_some());
        assert!(handle.send(Command::SetMode(Mode::Dfr)));
        assert!(wait_for(&handle, |tick| tick.mode == Mode::Dfr).is_some());
        assert!(handle.send(Command::Stop));
        let stopped = wait_for(&handle, |tick| tick.state == LoopState::Stopped).unwrap();
        assert!(stopped.rendering.rendered_n.norm() < f64::EPSILON);
        assert!(handle.send(Command::Engage));
        assert!(handle.send(Command::ReleaseStop));
        assert!(wait_for(&handle, |tick| tick.state == LoopState::Idle).is_some(), "engaging out of a stop is refused");
        let mut refused = None;
        handle.drain_events(|event| {
            if let Event::CommandRefused { command: Command::Engage, why, .. } = *event {
                refused = Some(why);
            }
        });
        assert_eq!(refused, Some(Refusal::State(LoopState::Stopped)));
        let summary = handle.stop_and_join().unwrap();
        assert!(summary.ticks > 0);
        let periods = summary.seconds * 1000.0;
        assert!(
            (periods - (summary.ticks + summary.missed) as f64).abs() < 1.5,
            "every period is a tick or counted as missed"
        );
    }

    #[test]
    fn late_ticks_are_no_fault_and_a_pause_of_the_whole_loop_is_one() {
        let busy = ClockProfile::Busy;
        let late = ClockProfile::Late { percent: 5.0 };
        let stall = |ms| ClockProfile::Stall { ms };
        for (profile, is_fault) in
            [(busy, false), (late, false), (stall(5), false), (stall(20), true), (stall(100), true)]
        {
            let mut last_s = 0.0;
            let mut longest_s = 0.0_f64;
            let summary = run_virtual_on(&plan(), VirtualClock { profile, seed: 1 }, 5.0, |tick| {
                longest_s = longest_s.max(tick.t_s - last_s);
                last_s = tick.t_s;
                None
            });
            let summary = summary.unwrap();
            let stalled = matches!(summary.final_state, LoopState::Faulted(Fault::LoopStalled { .. }));
            assert_eq!(stalled, is_fault, "{profile}: {:?}", summary.final_state);
            assert!(stalled || summary.final_state == LoopState::Engaged, "{profile}: {:?}", summary.final_state);
            let periods = (1e3 * summary.seconds).round() as u64;
            assert_eq!(summary.ticks + summary.missed, periods, "{profile}: every period is a tick or missed");
            assert!(summary.missed > 0 && longest_s > 2e-3, "{profile}: {longest_s} s");
        }
    }

    /// A world that is delayed once, much longer than the longest allowed stall.
    struct HeldUp(Worlds);

    impl Rig for HeldUp {
        fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
            if (now_s - 1.0).abs() < 1e-4 {
                std::thread::sleep(Duration::from_millis(150));
            }
            self.0.read(now_s)
        }

        fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
            self.0.write(now_s, outputs);
        }
    }

    #[test]
    fn in_simulated_time_a_loop_that_was_held_up_is_later_and_nothing_else() {
        let plan = plan();
        let assembly = plan.on(Box::new(HeldUp(plan.worlds())), Roster::new()).unwrap();
        let handle = runtime::start(Assembly { clock: RuntimeClock::Simulated { speed: 20.0 }, ..assembly }).unwrap();
        let tick = wait_for(&handle, |tick| tick.t_s > 1.5).unwrap();
        assert_eq!(tick.state, LoopState::Engaged);
        let summary = handle.stop_and_join().unwrap();
        assert_eq!((summary.missed, (summary.seconds * 1e3).round() as u64), (0, summary.ticks));
    }

    #[test]
    fn a_full_screen_queue_is_counted_and_never_waited_for() {
        // At 4 kHz the queue is full after two seconds.
        let mut plan = plan();
        plan.rig.rate_hz = 4000.0;
        judged(|| {
            let handle = start(&plan).unwrap();
            std::thread::sleep(Duration::from_millis(2500));
            let summary = handle.stop_and_join().unwrap();
            assert_eq!(summary.dropped, summary.ticks.saturating_sub(TICKS_WAITING_MAX as u64));
            assert!(summary.dropped > 0);
        });
    }
}
