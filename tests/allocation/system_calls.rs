//! The loop's thread makes no system call that can wait, except its own sleep.

use std::{
    collections::BTreeMap,
    fs::File,
    io::Read as _,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering::Relaxed},
    },
    thread::{sleep, spawn},
    time::{Duration, Instant},
};

use nima_devices::Lever;
use nima_machine::{
    config::{RigConfig, SchedulingClass},
    messages::{Command, LoopState, PeerStatus},
    rig::{DeviceEvent, Gauges, Healths, Inputs, Outputs, Rig, SIDES, Side},
    runtime::{self, Assembly, TapPayload, tap},
};
use nima_simulation::{SimulationPlan, scene::Scene};
use nima_testing::{
    real_time::{alone, judged},
    unjudged::left_out,
};
use nima_tests::emulated::{right_arm, started};

use crate::watched_calls::{prepare, taken, watch};

/// Number of `clock_nanosleep`.
const SLEEP: usize = libc::SYS_clock_nanosleep as usize;
const LENGTH: Duration = Duration::from_secs(2);
const ENGAGED_MAX: Duration = Duration::from_mins(1);

/// A rig whose thread, the loop's, is watched from the beginning of a tick on.
struct WatchedRig {
    rig: Box<dyn Rig>,
    watches: Arc<AtomicBool>,
    is_prepared: bool,
}

impl Rig for WatchedRig {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        self.is_prepared = self.is_prepared || prepare();
        watch(self.watches.load(Relaxed));
        self.rig.read(now_s)
    }

    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        self.rig.write(now_s, outputs);
    }

    fn receive_status(&mut self, now_s: f64, bulletins: &[Option<PeerStatus<'_>>; SIDES]) {
        self.rig.receive_status(now_s, bulletins);
    }

    fn command(&mut self) -> Option<Command> {
        self.rig.command()
    }

    fn event(&mut self) -> Option<DeviceEvent> {
        self.rig.event()
    }

    fn levers(&self) -> Vec<Lever> {
        self.rig.levers()
    }

    fn health(&self) -> Healths {
        self.rig.health()
    }

    fn gauges(&mut self, now_s: f64) -> Option<Gauges> {
        self.rig.gauges(now_s)
    }
}

/// Calls of the loop's thread in some seconds.
struct LoopCalls {
    ticks: u64,
    all: u64,
    /// Those that can wait, by their numbers.
    waits: BTreeMap<usize, u64>,
}

/// Runs the loop of this plan on the real clock, engaged, with a screen and a recorder that read its queues.
fn calls_of(plan: &SimulationPlan) -> LoopCalls {
    let assembly = plan.assembly().unwrap();
    let watches = Arc::new(AtomicBool::new(false));
    let (tap, end) = tap();
    let rig = Box::new(WatchedRig { rig: assembly.rig, watches: Arc::clone(&watches), is_prepared: false });
    let handle = runtime::start(Assembly { rig, tap: Some(tap), ..assembly }).unwrap();
    let mut state = LoopState::Disconnected;
    let mut look = || {
        sleep(Duration::from_millis(3));
        let mut ticks = 0;
        handle.drain_ticks(|tick| {
            state = tick.state;
            ticks += u64::from(tick.side == Side::Right);
        });
        handle.drain_events(|_| {});
        for entry in end.entries.try_iter() {
            if let TapPayload::Stepped(stepped) = entry.passed {
                end.give_back(stepped);
            }
        }
        (state, ticks)
    };
    let began = Instant::now();
    while look().0 != LoopState::Engaged {
        assert!(began.elapsed() <= ENGAGED_MAX, "it never engages");
    }
    taken();
    watches.store(true, Relaxed);
    let began = Instant::now();
    let mut ticks = 0;
    while began.elapsed() < LENGTH {
        handle.send(Command::SetGain(0.5 + 0.1 * began.elapsed().as_secs_f64()));
        let (state, more) = look();
        assert_eq!(state, LoopState::Engaged);
        ticks += more;
    }
    watches.store(false, Relaxed);
    // The loop reads this at its next tick.
    sleep(Duration::from_millis(50));
    let (all, waits) = taken();
    LoopCalls { ticks, all, waits }
}

/// Returns whether the calls of a thread can be watched here.
fn can_be_watched() -> bool {
    let can = spawn(prepare).join().unwrap();
    if !can {
        left_out("the kernel cannot dispatch system calls to a program (Linux 5.11)");
    }
    can
}

#[test]
fn a_call_that_can_wait_is_seen() {
    let _alone = alone();
    if !can_be_watched() {
        return;
    }
    let thread = spawn(|| {
        prepare();
        let mut file = File::open("/proc/self/status").unwrap();
        taken();
        watch(true);
        sleep(Duration::from_millis(1));
        let count = file.read(&mut [0; 8]).unwrap();
        watch(false);
        (count, taken())
    });
    let read = libc::SYS_read as usize;
    assert_eq!(thread.join().unwrap(), (8, (2, BTreeMap::from([(SLEEP, 1), (read, 1)]))));
}

#[test]
fn the_loop_of_a_simulated_rig_makes_no_call_but_its_sleep() {
    let _alone = alone();
    if !can_be_watched() {
        return;
    }
    let rig = RigConfig { scheduling: SchedulingClass::Ordinary, ..RigConfig::load("simulated").unwrap() };
    let scene = Scene::load("bimanual").unwrap();
    let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: true };
    judged(|| {
        let LoopCalls { ticks, all, waits } = calls_of(&plan);
        assert_eq!(waits.keys().collect::<Vec<_>>(), [&SLEEP], "{waits:?}");
        assert_eq!(all, waits[&SLEEP], "{ticks} ticks");
        assert!(all + 100 > ticks && ticks > 100, "{all} of {ticks} ticks");
    });
}

#[test]
fn the_loop_of_a_rig_with_devices_makes_no_call_that_can_wait_but_its_sleep() {
    let _alone = alone();
    if !can_be_watched() {
        return;
    }
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let devices = right_arm(folder.path());
        let _emulated = started(&devices);
        let loaded = RigConfig::load("emulated").unwrap();
        let rig = RigConfig { devices: Some(devices), scheduling: SchedulingClass::Ordinary, ..loaded };
        let scene = Scene::load("peg_transfer").unwrap();
        let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: true };
        let LoopCalls { ticks, all, waits } = calls_of(&plan);
        println!("{all} calls in {ticks} ticks; those that can wait: {waits:?}");
        assert_eq!(waits.keys().collect::<Vec<_>>(), [&SLEEP], "{waits:?}");
        assert!(all > 3 * ticks && ticks > 100, "{all} calls in {ticks} ticks");
    });
}
