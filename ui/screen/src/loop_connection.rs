//! Connects the loop to a window that is drawn rarely.
//!
//! While nothing moves, the window is drawn only occasionally. The loop still sends ticks and events, which must neither fill
//! its queue nor be shown late. A thread therefore reads and stores them, and wakes the window when there is something to
//! show. While the window is drawn continuously, the thread is idle.

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use nalgebra::Vector3;
use nima_core::safety::{GATES, Gate};
use nima_machine::{
    messages::{Event, Tick},
    rig::{Gauges, SIDES, Side},
    runtime::{LoopHandle, RuntimeSummary},
};

use crate::activity::Activity;

/// Interval of the thread while the window is idle, short enough not to be noticed.
const LOOK: Duration = Duration::from_millis(50);
/// Maximum number of stored ticks; further ticks wait in the loop's queue, where losses are counted.
const KEPT_MAX: usize = 8192;
/// Maximum number of stored blocks of device readings; newer blocks are dropped.
const BLOCKS_MAX: usize = 40;
/// A longer time without a tick is shown as an alarm.
const SILENCE: Duration = Duration::from_millis(600);
/// A change of the force by this much (N), or of the tip position by this much (m), wakes the window. The changes are
/// computed from means over this many ticks, so that sensor noise does not wake it.
const SEEN_N: f64 = 0.05;
const SEEN_M: f64 = 2e-4;
const MEAN_OVER: usize = 50;

/// Data from the loop.
#[derive(Clone, Copy, Debug)]
pub enum LoopMessage<'a> {
    Event(&'a Event),
    Tick(&'a Tick),
    /// Device readings of a block of time.
    Gauges(&'a Gauges),
}

/// The window's side of the connection to the loop.
#[derive(Debug)]
pub struct LoopConnection {
    shared: Arc<DoorShared>,
    keeper: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct DoorShared {
    handle: LoopHandle,
    kept: Mutex<UnsentCommand>,
    /// The window is drawn rarely.
    calm: AtomicBool,
    /// The window shows which devices are moved.
    shows_devices: AtomicBool,
    end: AtomicBool,
}

#[derive(Debug)]
struct UnsentCommand {
    ticks: Vec<Tick>,
    events: Vec<Event>,
    gauges: Vec<Gauges>,
    activity: Activity,
    /// The state of each side that the window shows.
    shown: [Option<VisibleState>; SIDES],
    /// Arrival time of the last tick.
    came: Instant,
    /// Problems at the last check: silence, end of the loop.
    wrong: [bool; 2],
    /// The window was woken and has not been drawn since.
    woken: bool,
}

impl LoopConnection {
    /// Connects to this loop; `wake` is called from another thread when there is something to show. If that thread cannot be
    /// created, the window is updated later but still correctly.
    pub fn new(handle: LoopHandle, wake: impl Fn() + Send + 'static) -> Self {
        let kept = UnsentCommand {
            ticks: Vec::new(),
            events: Vec::new(),
            gauges: Vec::new(),
            activity: Activity::of(handle.roster()),
            shown: [None; SIDES],
            came: Instant::now(),
            wrong: [false; 2],
            woken: false,
        };
        let [calm, shows_devices, end] = [false; 3].map(AtomicBool::new);
        let shared = Arc::new(DoorShared { handle, kept: Mutex::new(kept), calm, shows_devices, end });
        let keeper = {
            let shared = Arc::clone(&shared);
            thread::Builder::new().name("door".to_owned()).spawn(move || shared.look_after(&wake)).ok()
        };
        Self { shared, keeper }
    }

    /// Returns the loop's handle, for everything except ticks and events.
    pub fn handle(&self) -> &LoopHandle {
        &self.shared.handle
    }

    /// Passes every waiting event, then the device readings, then every waiting tick, each oldest first.
    pub fn take(&self, mut each: impl FnMut(LoopMessage<'_>)) {
        let mut kept = self.shared.lock();
        self.shared.bring_in(&mut kept);
        kept.events.iter().for_each(|event| each(LoopMessage::Event(event)));
        kept.events.clear();
        kept.gauges.iter().for_each(|gauges| each(LoopMessage::Gauges(gauges)));
        kept.gauges.clear();
        kept.ticks.iter().for_each(|tick| each(LoopMessage::Tick(tick)));
        for side in Side::ALL {
            kept.shown[side.index()] = VisibleState::of(&kept.ticks, side).or(kept.shown[side.index()]);
        }
        kept.ticks.clear();
        kept.woken = false;
    }

    /// Returns whether the window was woken and has not read the data yet.
    pub fn has_woken(&self) -> bool {
        self.shared.lock().woken
    }

    /// Returns the arrival time of the last tick, as of the last check.
    pub fn last_came(&self) -> Instant {
        self.shared.lock().came
    }

    /// Sets whether the window is drawn rarely from now on.
    pub fn rest(&self, calm: bool) {
        if self.shared.calm.swap(calm, Ordering::Relaxed) != calm
            && let Some(keeper) = &self.keeper
        {
            keeper.thread().unpark();
        }
    }

    /// Sets whether the window shows which devices are moved: if so, it is woken when another device is moved.
    pub fn show_devices(&self, shown: bool) {
        self.shared.shows_devices.store(shown, Ordering::Relaxed);
    }

    /// Ends the loop and returns its results; `None` if its thread has panicked.
    pub fn stop_and_join(mut self) -> Option<RuntimeSummary> {
        self.dismiss();
        let unused = Arc::clone(&self.shared);
        drop(self);
        // The handle has one owner again once the thread has ended.
        Arc::into_inner(unused)?.handle.stop_and_join()
    }

    fn dismiss(&mut self) {
        self.shared.end.store(true, Ordering::Relaxed);
        if let Some(keeper) = self.keeper.take() {
            keeper.thread().unpark();
            keeper.join().ok();
        }
    }
}

impl Drop for LoopConnection {
    fn drop(&mut self) {
        self.dismiss();
    }
}

impl DoorShared {
    fn lock(&self) -> MutexGuard<'_, UnsentCommand> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn look_after(&self, wake: &dyn Fn()) {
        while !self.end.load(Ordering::Relaxed) {
            if !self.calm.load(Ordering::Relaxed) {
                // `rest` and `dismiss` wake the thread.
                thread::park();
                continue;
            }
            thread::park_timeout(LOOK);
            let mut kept = self.lock();
            let seen = self.bring_in(&mut kept);
            if seen && !std::mem::replace(&mut kept.woken, true) {
                // Released first, because the window locks it at once.
                drop(kept);
                wake();
            }
        }
    }

    /// Reads the loop's queues; returns true if something visible has changed.
    fn bring_in(&self, kept: &mut UnsentCommand) -> bool {
        let before = (kept.ticks.len(), kept.events.len());
        self.handle.drain_events(|event| kept.events.push(*event));
        if kept.ticks.len() < KEPT_MAX {
            let ticks = &mut kept.ticks;
            self.handle.drain_ticks(|tick| ticks.push(*tick));
        }
        let mut lights = false;
        for gauges in self.handle.gauges() {
            lights |= kept.activity.follow(&gauges);
            if kept.gauges.len() < BLOCKS_MAX {
                kept.gauges.push(gauges);
            }
        }
        let lights = lights && self.shows_devices.load(Ordering::Relaxed);
        if kept.ticks.len() > before.0 {
            kept.came = Instant::now();
        }
        let wrong = [kept.came.elapsed() > SILENCE, !self.handle.is_running()];
        let turned = std::mem::replace(&mut kept.wrong, wrong) != wrong;
        let news = Side::ALL.into_iter().any(|side| {
            let now = VisibleState::of(&kept.ticks[before.0..], side);
            now.is_some_and(|now| kept.shown[side.index()].is_none_or(|shown| shown.differs(&now)))
        });
        turned || lights || kept.events.len() > before.1 || news
    }
}

#[derive(Clone, Copy, Debug)]
struct VisibleState {
    last: Tick,
    /// Gates that acted in most of these ticks.
    gates: [bool; GATES],
    measured_n: Vector3<f64>,
    rendered_n: Vector3<f64>,
    tip_m: Vector3<f64>,
}

impl VisibleState {
    /// `None` without ticks of this side.
    fn of(ticks: &[Tick], side: Side) -> Option<Self> {
        let ticks = || ticks.iter().rev().filter(|tick| tick.side == side).take(MEAN_OVER);
        let last = *ticks().next()?;
        let count = ticks().count();
        let mean = |of: fn(&Tick) -> Vector3<f64>| ticks().map(of).sum::<Vector3<f64>>() / count as f64;
        Some(Self {
            last,
            gates: Gate::ALL.map(|gate| 2 * ticks().filter(|tick| tick.gates.acted(gate)).count() > count),
            measured_n: mean(|tick| tick.measured_n),
            rendered_n: mean(|tick| tick.rendering.rendered_n),
            tip_m: mean(|tick| tick.positions.tip_m),
        })
    }

    /// Returns whether the difference would be visible.
    fn differs(&self, now: &Self) -> bool {
        // A non-finite value differs only from a finite one.
        let moved = |a: &Vector3<f64>, b: &Vector3<f64>, min: f64| {
            let by = (a - b).norm();
            by > min || (by.is_nan() && a.norm().is_nan() != b.norm().is_nan())
        };
        self.last.state != now.last.state
            || self.last.mode != now.last.mode
            || self.last.guidance.prompt != now.last.guidance.prompt
            || self.gates != now.gates
            || moved(&self.measured_n, &now.measured_n, SEEN_N)
            || moved(&self.rendered_n, &now.rendered_n, SEEN_N)
            || moved(&self.tip_m, &now.tip_m, SEEN_M)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use nima_machine::{
        config::RigConfig,
        messages::{Command, LoopState},
    };
    use nima_simulation::{SimulationPlan, scene::Scene, start};

    use super::*;

    /// Returns an idle loop, its connection, and a channel that reports when the window is woken.
    fn at_rest() -> (LoopConnection, mpsc::Receiver<()>) {
        let rig = RigConfig::load("simulated").unwrap();
        let scene = Scene::load("peg_transfer").unwrap();
        let calibrations = Default::default();
        let handle = start(&SimulationPlan { rig, scene, calibrations, engage: false }).unwrap();
        let (woken, wakes) = mpsc::channel();
        (LoopConnection::new(handle, move || woken.send(()).unwrap_or(())), wakes)
    }

    fn wait_for(door: &LoopConnection, good: impl Fn(&Tick) -> bool) -> Vec<Tick> {
        let began = Instant::now();
        let mut ticks = Vec::new();
        while !ticks.last().is_some_and(&good) {
            assert!(began.elapsed() < Duration::from_mins(2));
            thread::sleep(Duration::from_millis(5));
            door.take(|news| {
                if let LoopMessage::Tick(tick) = news {
                    ticks.push(*tick);
                }
            });
        }
        ticks
    }

    #[test]
    fn a_sleeping_window_misses_no_tick_and_is_woken_by_a_change_of_state() {
        let (door, wakes) = at_rest();
        wait_for(&door, |tick| tick.state == LoopState::Idle);
        door.rest(true);
        thread::sleep(Duration::from_millis(300));
        let before = wait_for(&door, |tick| tick.state == LoopState::Idle);
        while wakes.try_recv().is_ok() {}
        assert!(door.handle().send(Command::Stop));
        wakes.recv_timeout(Duration::from_secs(20)).unwrap();
        let after = wait_for(&door, |tick| tick.state == LoopState::Stopped);
        assert_eq!(after[0].index, before.last().unwrap().index + 1);
        assert!(after.windows(2).all(|pair| pair[1].index == pair[0].index + 1), "in order and without a gap");
    }

    #[test]
    fn the_end_of_the_loop_wakes_the_window() {
        let (door, wakes) = at_rest();
        wait_for(&door, |tick| tick.state == LoopState::Idle);
        door.rest(true);
        assert!(door.handle().send(Command::Shutdown));
        // Woken once for the first data, and again because they have been read since.
        wakes.recv_timeout(Duration::from_secs(20)).unwrap();
        door.take(|_| {});
        if door.handle().is_running() {
            wakes.recv_timeout(Duration::from_secs(20)).unwrap();
        }
        assert!(door.stop_and_join().is_some());
    }

    #[test]
    fn what_cannot_be_seen_is_no_news() {
        let (door, _) = at_rest();
        let tick = *wait_for(&door, |tick| tick.state == LoopState::Idle).last().unwrap();
        let glance = |ticks: &[Tick]| VisibleState::of(ticks, tick.side).unwrap();
        let shown = glance(&vec![tick; 20]);
        let noisy: Vec<Tick> = (0..40)
            .map(|i| {
                let mut noisy = tick;
                noisy.index = tick.index + i;
                noisy.timing.wake_s = 1e-3;
                noisy.measured_n = tick.measured_n.add_scalar(if i % 2 == 0 { 0.2 } else { -0.2 });
                noisy
            })
            .collect();
        assert!(!shown.differs(&glance(&noisy)));
        let unknown = glance(&[Tick { measured_n: Vector3::repeat(f64::NAN), ..tick }]);
        assert!(shown.differs(&unknown) && !unknown.differs(&unknown));
        let pushed = Tick { measured_n: tick.measured_n.add_scalar(0.1), ..tick };
        let mut moved = tick;
        moved.positions.tip_m.x += 1e-3;
        let stopped = Tick { state: LoopState::Stopped, ..tick };
        assert!([pushed, moved, stopped].iter().all(|now| shown.differs(&glance(&[*now]))));
        assert!(VisibleState::of(&[], tick.side).is_none());
    }
}
