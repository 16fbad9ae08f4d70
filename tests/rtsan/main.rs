//! Runs the whole loop with its simulated world, its tap and every mode under LLVM's `RealtimeSanitizer`, which ends the
//! program with a stack trace at the first allocation, lock or call of the C library in a tick that can block. It does not
//! see `clock_nanosleep`; `tests/allocation/system_calls.rs` does.

use std::{
    hint::black_box,
    sync::Mutex,
    thread::{self, yield_now},
    time::Duration,
};

use nima_core::impedance::Mode;
use nima_machine::{
    config::RigConfig,
    messages::{Command, LoopState},
    rig::Rig as _,
    runtime::{TapPayload, tap},
    teleop::{Calibrations, Loop, Timing},
};
use nima_simulation::{Worlds, scene::Scene};

const TICKS: u32 = 20_000;

unsafe extern "C" {
    fn __rtsan_realtime_enter();
    fn __rtsan_realtime_exit();
}

/// Runs `work` as the sanitizer requires of a tick.
fn in_real_time<T>(work: impl FnOnce() -> T) -> T {
    // SAFETY: both functions only count; they are called in pairs on one thread.
    unsafe { __rtsan_realtime_enter() };
    let result = work();
    // SAFETY: as above.
    unsafe { __rtsan_realtime_exit() };
    result
}

fn main() {
    match std::env::args().nth(1).as_deref() {
        // Each must end the program, to prove that the sanitizer works here.
        Some("allocation") => drop(in_real_time(|| black_box(vec![1_u8; 100]))),
        Some("lock") => wait_for_a_lock(),
        Some("file") => drop(in_real_time(|| std::fs::read("/proc/self/status"))),
        _ => run(),
    }
}

fn wait_for_a_lock() {
    let lock = Mutex::new(());
    thread::scope(|scope| {
        let held = lock.lock();
        scope.spawn(|| in_real_time(|| drop(lock.lock())));
        thread::sleep(Duration::from_millis(100));
        drop(held);
    });
}

fn run() {
    nima_baselines::provide();
    let rig = RigConfig::load("simulated").expect("a built-in rig");
    let calibrations = [Some(Calibrations::default()), Some(Calibrations::default())];
    let mut control = Loop::new(&rig, &calibrations).expect("valid settings");
    let mut world = Worlds::new(&Scene::load("bimanual").expect("a built-in scene"), rig.rate_hz);
    let (mut tap, end) = tap();
    // Disturbs the loop as much as it can.
    let reader = thread::spawn(move || {
        while !end.entries.has_ended() {
            match end.entries.try_recv().map(|entry| entry.passed) {
                Some(TapPayload::Stepped(stepped)) => end.give_back(stepped),
                Some(_) => {}
                None => yield_now(),
            }
        }
    });
    let mut engaged = 0;
    for tick in 0..TICKS {
        let now_s = f64::from(tick) / rig.rate_hz;
        engaged += in_real_time(|| {
            control.clear_events();
            if let Some(command) = command(tick) {
                control.obey(command, now_s);
            }
            // Lost samples, and a silence that raises a fault.
            let is_there = tick % 1000 > 5 && !(9000..9500).contains(&tick);
            let inputs = world.read(now_s).map(|inputs| inputs.filter(|_| is_there));
            let timing = Timing { now_s, ..Timing::default() };
            let (outputs, ticks) = control.step(inputs, &timing);
            world.write(now_s, &outputs);
            tap.tick(control.events(), &timing, &inputs, &outputs, &ticks);
            u32::from(ticks.iter().flatten().all(|tick| tick.state == LoopState::Engaged))
        });
    }
    drop(tap);
    reader.join().expect("the reader ended");
    assert!(engaged > TICKS / 2, "engaged in {engaged} of {TICKS} ticks");
    println!("{TICKS} ticks, {engaged} engaged: no call that can block");
}

/// A command in some of the ticks: engages again after each fault, and changes the mode every second.
fn command(tick: u32) -> Option<Command> {
    let modes = Mode::ALL.into_iter().chain(Mode::BASELINES);
    match tick % 1000 {
        100 => Some(Command::ReleaseStop),
        200 => Some(Command::Engage),
        500 => Some(Command::SetDelay(if tick % 2000 < 1000 { 0.05 } else { 0.3 })),
        700 => modes.cycle().nth(tick as usize / 1000).map(Command::SetMode),
        900 if tick < 1000 => Some(Command::Stop),
        _ => None,
    }
}
