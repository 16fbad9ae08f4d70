//! Two whole machines on one virtual clock: the console's with the hand, the follower's with arm and tissue, and an
//! impaired link between them.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use nima_core::impedance::{Mode, OwnMotion};
use nima_machine::{
    config::RigConfig,
    messages::{Command, Event, LoopState, Tick},
    remote::{FollowerRig, OperatorRig, RemoteWire as _, at_follower},
    rig::{Inputs, Outputs, Rig, SIDES, Side},
    runtime::{TickTime, TickTimes, VirtualClock, VirtualSupervisor},
    teleop::{Calibrations, Loop, Timing},
};
use nima_network::{
    impairment::ImpairedLine,
    stream::{NetworkStream, StreamSettings},
};
use nima_simulation::{World, scene::Scene};

use super::{NetworkCondition, NetworkError, end::NetworkEnd};
use crate::clocks;

/// Ticks per second.
pub(super) const RATE_HZ: f64 = 1000.0;
/// Seeds of the two directions: the same in every cell, so that cells can be compared.
const SEEDS: [u64; 2] = [1, 2];
/// Tolerance for the rounding of times, s.
const ROUNDING_S: f64 = 1e-9;

/// A simulated workplace. It runs in true time, whatever the clock of its machine shows.
#[derive(Debug)]
pub(super) struct Workplace {
    pub(super) world: World,
    outputs: Outputs,
    ahead_s: f64,
}

impl Workplace {
    fn new(scene: &Scene) -> Self {
        Self { world: World::new(scene, RATE_HZ), outputs: Outputs::SAFE, ahead_s: 0.0 }
    }
}

impl Rig for Workplace {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        let mut inputs = [None; SIDES];
        inputs[Side::Right.index()] = self.world.exchange(now_s - self.ahead_s, &self.outputs);
        inputs
    }

    fn write(&mut self, _: f64, outputs: &[Outputs; SIDES]) {
        self.outputs = outputs[Side::Right.index()];
    }
}

/// Tick times of one machine.
struct BenchPace {
    times: TickTimes,
    /// Period in which the next tick wakes up, and its time since the start of the loop.
    due: u64,
    time: TickTime,
}

impl BenchPace {
    fn new(clock: VirtualClock) -> Self {
        // The first tick is at its deadline, so that both machines begin together.
        Self { times: clock.tick_times(RATE_HZ), due: 0, time: TickTime::default() }
    }

    /// Returns the lateness of the tick of this period, if there is one: the total delay, and the delay within the
    /// period, s.
    fn tick_in(&mut self, period: u32) -> Option<(TickTime, f64)> {
        if self.due != u64::from(period) {
            return None;
        }
        let time = std::mem::replace(&mut self.time, self.times.advance());
        self.due += 1 + self.time.missed;
        Some((time, time.wake_s - time.missed as f64 / RATE_HZ))
    }
}

/// One machine: a loop and its rig.
struct BenchMachine<R> {
    control: Loop,
    rig: R,
    pace: BenchPace,
    supervisor: VirtualSupervisor,
    tick: Option<Tick>,
    /// Raised faults, and their numbers.
    faults: BTreeMap<String, u32>,
}

impl<R: Rig> BenchMachine<R> {
    fn new(rig: &RigConfig, place: R, clock: VirtualClock) -> Result<Self, NetworkError> {
        let control = Loop::new(rig, &[Some(Calibrations::default()), None])?;
        let pace = BenchPace::new(clock);
        let supervisor = VirtualSupervisor::default();
        Ok(Self { control, rig: place, pace, supervisor, tick: None, faults: BTreeMap::new() })
    }

    fn step(&mut self, command: Option<Command>, time: TickTime) {
        let timing = Timing::from(time);
        let now_s = timing.now_s;
        let inputs = self.rig.read(now_s);
        self.control.clear_events();
        if let Some(silent_s) = self.supervisor.stalled_s(&time) {
            self.control.notice_stall(silent_s, now_s);
        }
        for command in command.into_iter().chain(std::iter::from_fn(|| self.rig.command())) {
            self.control.obey(command, now_s);
        }
        let (outputs, ticks) = self.control.step(inputs, &timing);
        self.rig.write(now_s, &outputs);
        self.supervisor.beat(now_s, &outputs);
        self.rig.receive_status(now_s, &self.control.bulletins());
        self.tick = ticks[Side::Right.index()];
        for event in self.control.events() {
            if let Event::FaultRaised { fault, .. } = event {
                *self.faults.entry(format!("{fault:?}")).or_default() += 1;
            }
        }
    }

    fn state(&self) -> LoopState {
        self.tick.map_or(LoopState::Disconnected, |tick| tick.state)
    }
}

/// Both machines and the link.
pub(super) struct NetworkBench {
    console: BenchMachine<OperatorRig<Workplace, NetworkEnd>>,
    follower: BenchMachine<FollowerRig<Workplace, NetworkEnd>>,
    /// From the console to the follower, and back.
    lines: [ImpairedLine; 2],
    condition: NetworkCondition,
    pub(super) rig: RigConfig,
    /// Periods since the line was opened, and until the loops were started.
    pub(super) tick: u32,
    begun: u32,
    /// The operator's command that the console's loop has not executed yet.
    command: Option<Command>,
    /// Tick of the newest command that has reached the follower.
    newest: Option<u32>,
}

/// Observations of one tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct TickObservation {
    /// The console's tick, and whether it belongs to this period.
    pub(super) console: Tick,
    pub(super) is_new: bool,
    pub(super) states: [LoopState; 2],
    /// True positions of hand and tip, m, and true force of the tissue on the tip, N.
    pub(super) hand_m: Vector3<f64>,
    pub(super) tip_m: Vector3<f64>,
    pub(super) tip_n: Vector3<f64>,
    /// Tick of the newest command that has reached the follower.
    pub(super) newest: Option<u32>,
    /// Transmission times of this tick's payloads to the follower and to the console, ticks: sum and number.
    pub(super) under_way: [(u32, u32); 2],
}

impl NetworkBench {
    /// The line has been open for `known_s` when the loops start.
    pub(super) fn new(
        clock: VirtualClock,
        condition: NetworkCondition,
        mode: Mode,
        own_motion: OwnMotion,
        known_s: f64,
    ) -> Result<Self, NetworkError> {
        let mut rig = RigConfig::load("simulated")?;
        rig.mode = mode;
        rig.delay_s = 0.0;
        rig.identification.own_motion = own_motion;
        let scene = Scene::load("peg_transfer")?;
        let (one, other) = NetworkStream::pair(&StreamSettings::of_arms(1))?;
        let [there, back] = condition.lines();
        let mut ends = [NetworkEnd::new(one), NetworkEnd::new(other)];
        let mut lines = [ImpairedLine::new(there, SEEDS[0]), ImpairedLine::new(back, SEEDS[1])];
        let begun = (known_s * RATE_HZ) as u32;
        for tick in 0..begun {
            measure(&mut ends, &mut lines, tick, condition.ahead_s(0.0));
        }
        let [one, other] = ends;
        let console = OperatorRig::new(Workplace::new(&scene), one, RATE_HZ);
        let follower = FollowerRig::new(Workplace::new(&scene), other, RATE_HZ);
        Ok(Self {
            console: BenchMachine::new(&rig, console, clock)?,
            follower: BenchMachine::new(&at_follower(&rig), follower, clocks::of_trial(clock, 1))?,
            lines,
            condition,
            rig,
            tick: begun,
            begun,
            command: None,
            newest: None,
        })
    }

    /// Returns the time since the line was opened, s.
    pub(super) fn now_s(&self) -> f64 {
        f64::from(self.tick) / RATE_HZ
    }

    /// Returns the number of ticks since the loops were started.
    pub(super) const fn ticks(&self) -> u32 {
        self.tick - self.begun
    }

    /// Returns the follower's clock minus the console's, s.
    pub(super) fn ahead_s(&self) -> f64 {
        self.condition.ahead_s(f64::from(self.ticks()) / RATE_HZ)
    }

    /// Returns the ends of the stream: the console's and the follower's.
    pub(super) const fn ends(&self) -> [&NetworkEnd; 2] {
        [self.console.rig.wire(), self.follower.rig.wire()]
    }

    /// Returns the faults raised by the console and the follower.
    pub(super) const fn faults(&self) -> [&BTreeMap<String, u32>; 2] {
        [&self.console.faults, &self.follower.faults]
    }

    /// Runs one period of both machines; `None` before both loops have had a tick.
    pub(super) fn step(&mut self, command: Option<Command>) -> Option<TickObservation> {
        let period = self.ticks();
        self.command = command.or(self.command.take());
        let console = self.console.pace.tick_in(period);
        let follower = self.follower.pace.tick_in(period);
        // Step the console and the follower in the order in which they wake up.
        let follower_first =
            console.zip(follower).is_some_and(|((_, console_s), (_, follower_s))| follower_s < console_s);
        if let (Some((time, late_s)), true) = (follower, follower_first) {
            self.step_follower(time, late_s);
        }
        if let Some((time, late_s)) = console {
            self.step_console(time, late_s);
        }
        if let (Some((time, late_s)), false) = (follower, follower_first) {
            self.step_follower(time, late_s);
        }
        let ticked = [follower.is_some(), console.is_some()];
        let console = self.console.rig.wire();
        let follower = self.follower.rig.wire();
        let newest = follower.taken.last().and_then(|number| console.sent.get(*number as usize).copied());
        self.newest = newest.and_then(|tick| tick.checked_sub(self.begun)).or(self.newest);
        let under_way = [
            if ticked[0] { under_way(console, follower) } else { (0, 0) },
            if ticked[1] { under_way(follower, console) } else { (0, 0) },
        ];
        self.tick += 1;
        Some(TickObservation {
            console: self.console.tick?,
            is_new: ticked[1],
            states: [self.console.state(), self.follower.state()],
            hand_m: self.console.rig.local().world.hand().position_m(),
            tip_m: self.follower.rig.measured()[Side::Right.index()]?.tip_m,
            tip_n: self.follower.rig.local().world.true_tip_n(),
            newest: self.newest,
            under_way,
        })
    }

    /// Runs a tick of the console that wakes up this late in the period, s.
    fn step_console(&mut self, time: TickTime, late_s: f64) {
        let now_s = self.now_s() + late_s;
        let [there, back] = &mut self.lines;
        let end = self.console.rig.wire_mut();
        end.tick = self.tick;
        while let Some((came_s, bytes)) = back.receive(now_s + ROUNDING_S) {
            end.arrive(&bytes, came_s);
        }
        self.console.step(self.command.take(), TickTime { now_s, ..time });
        self.console.rig.wire_mut().out.drain(..).for_each(|bytes| there.send(now_s, &bytes));
    }

    /// Runs a tick of the follower, whose clock differs.
    fn step_follower(&mut self, time: TickTime, late_s: f64) {
        let now_s = self.now_s() + late_s;
        let ahead_s = self.ahead_s();
        let [there, back] = &mut self.lines;
        self.follower.rig.local_mut().ahead_s = ahead_s;
        let end = self.follower.rig.wire_mut();
        end.tick = self.tick;
        while let Some((came_s, bytes)) = there.receive(now_s + ROUNDING_S) {
            end.arrive(&bytes, came_s + ahead_s);
        }
        self.follower.step(None, TickTime { now_s: now_s + ahead_s, ..time });
        self.follower.rig.wire_mut().out.drain(..).for_each(|bytes| back.send(now_s, &bytes));
    }
}

/// Runs one tick of the link alone, so that playout delay and redundancy adapt as on a link that has been open for a
/// while.
fn measure([console, follower]: &mut [NetworkEnd; 2], [there, back]: &mut [ImpairedLine; 2], tick: u32, ahead_s: f64) {
    let now_s = f64::from(tick) / RATE_HZ;
    let pass = |end: &mut NetworkEnd, from: &mut ImpairedLine, to: &mut ImpairedLine, ahead_s: f64| {
        end.tick = tick;
        while let Some((came_s, bytes)) = from.receive(now_s + ROUNDING_S) {
            end.arrive(&bytes, came_s + ahead_s);
        }
        end.receive(now_s + ahead_s, &mut |_| {});
        // A typical message from the follower has this length.
        end.send(now_s + ahead_s, &[0xff; 40]);
        end.out.drain(..).for_each(|bytes| to.send(now_s, &bytes));
    };
    pass(console, back, there, 0.0);
    pass(follower, there, back, ahead_s);
}

/// Returns the transmission times of the payloads just delivered by `to`, ticks: sum and number.
fn under_way(from: &NetworkEnd, to: &NetworkEnd) -> (u32, u32) {
    let sent = to.taken.iter().filter_map(|number| from.sent.get(*number as usize));
    sent.fold((0, 0), |(sum, count), sent| (sum + to.tick - sent, count + 1))
}
