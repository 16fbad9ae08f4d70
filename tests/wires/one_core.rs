//! The loop, the handle's thread above it and the supervisor above both, on a single processor. If one of them spun until
//! a preempted one had finished, the processor would be lost to all, and the force left to the device's watchdog.

use std::{
    fs,
    process::Command as Program,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
    },
    thread,
    time::{Duration, Instant},
};

use nima_machine::{
    config::RigConfig,
    hand_over::from_loop,
    runtime::{self, LoopHandle},
};
use nima_simulation::{SimulationPlan, scene::Scene};
use nima_testing::{
    real_time::{alone, judged, too_busy},
    unjudged,
};
use nima_tests::emulated::{right_arm, started};

/// Above the rate of any handle, so that the threads meet in their queues as often as possible.
const RATE_HZ: f64 = 3000.0;
const LENGTH: Duration = Duration::from_mins(1);
/// Ending a rig closes its devices.
const END_MAX: Duration = Duration::from_secs(10);
/// The kernel takes the processor from real-time threads for 50 ms each second.
const SILENCE_MAX: Duration = Duration::from_secs(2);

/// Runs a program of the system that changes the calling thread, whose number is its last argument.
fn change(program: &str, arguments: &[&str]) -> Result<(), String> {
    let this = fs::read_link("/proc/thread-self").map_err(|error| error.to_string())?;
    let number = this.file_name().ok_or("no thread number")?;
    let output = Program::new(program).args(arguments).arg(number).output();
    let output = output.map_err(|error| format!("{program}: {error}"))?;
    output.status.success().then_some(()).ok_or_else(|| String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Binds the calling thread, and all threads that it creates, to one processor.
fn pin() -> Result<(), String> {
    change("taskset", &["-pc", "0"])
}

/// Also gives the calling thread this real-time priority.
fn pin_with(priority: &str) -> Result<(), String> {
    pin()?;
    change("chrt", &["-f", "-p", priority])
}

#[test]
fn a_queue_is_never_waited_for_by_a_thread_of_higher_priority_on_the_same_processor() {
    const ROUND: usize = 40;
    let _alone = alone();
    let (mut to, from) = from_loop(64);
    // Only the receiver could wait: on a slow machine, its many interruptions may leave the sender hardly any time.
    let [sent, received] = [(); 2].map(|()| Arc::new(AtomicU64::new(0)));
    let ends = Arc::new(AtomicBool::new(false));
    let pinned = Arc::new(AtomicU64::new(0));
    let sender = thread::spawn({
        let sent = Arc::clone(&sent);
        let ends = Arc::clone(&ends);
        let pinned = Arc::clone(&pinned);
        move || {
            pin_with("80")?;
            pinned.fetch_add(1, Relaxed);
            while !ends.load(Relaxed) {
                for value in 0..ROUND {
                    to.push([value; 4]).ok();
                }
                sent.fetch_add(1, Relaxed);
                thread::sleep(Duration::from_micros(20));
            }
            Ok::<_, String>(())
        }
    });
    let receiver = thread::spawn({
        let received = Arc::clone(&received);
        let ends = Arc::clone(&ends);
        let pinned = Arc::clone(&pinned);
        move || {
            pin_with("82")?;
            pinned.fetch_add(1, Relaxed);
            while !ends.load(Relaxed) {
                // Interrupts the other thread anywhere in its operation.
                from.try_iter().take(ROUND).for_each(drop);
                received.fetch_add(1, Relaxed);
                // Waking up can take 30 us of the processor.
                thread::sleep(Duration::from_micros(100));
            }
            Ok::<_, String>(())
        }
    });
    // Starting the threads takes long on a busy machine; that says nothing about the queue.
    while pinned.load(Relaxed) < 2 && !sender.is_finished() && !receiver.is_finished() {
        thread::sleep(Duration::from_millis(1));
    }
    let began = Instant::now();
    let mut newest = (0, began);
    while began.elapsed() < Duration::from_secs(3) && !sender.is_finished() && !receiver.is_finished() {
        thread::sleep(Duration::from_millis(20));
        if received.load(Relaxed) > newest.0 {
            newest = (received.load(Relaxed), Instant::now());
        }
        assert!(newest.1.elapsed() < SILENCE_MAX, "the receiver waits for the sender after {} rounds", newest.0);
    }
    ends.store(true, Relaxed);
    for thread in [sender, receiver] {
        if let Err(why) = thread.join().unwrap() {
            return unjudged::left_out(&why);
        }
    }
    // Without both, nothing was interrupted.
    let [sent, received] = [sent, received].map(|rounds| rounds.load(Relaxed));
    if sent < 10 || received < 10 {
        return unjudged::left_out("one of the two threads got no time");
    }
    println!("sent in {sent} rounds, received in {received}");
}

/// Returns the number of ticks of a run of this length.
fn ticks(handle: &LoopHandle) -> Result<u64, &'static str> {
    let began = Instant::now();
    let mut newest = Instant::now();
    let mut count = 0;
    while began.elapsed() < LENGTH {
        let before = count;
        handle.drain_ticks(|_| count += 1);
        handle.drain_events(|_| {});
        if count > before {
            newest = Instant::now();
        } else if newest.elapsed() > SILENCE_MAX {
            return Err("the loop has stopped");
        }
        thread::sleep(Duration::from_millis(20));
    }
    Ok(count)
}

#[test]
#[ignore = "holds a processor for a minute; ./dev walk runs it"]
fn the_threads_of_a_rig_on_one_processor_do_not_block_each_other() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let devices = right_arm(folder.path());
    judged(|| {
        let started = thread::spawn({
            let devices = devices.clone();
            move || {
                pin()?;
                let rig = started(&devices);
                let config =
                    RigConfig { devices: Some(devices), rate_hz: RATE_HZ, ..RigConfig::load("emulated").unwrap() };
                let scene = Scene::load("peg_transfer").unwrap();
                let plan = SimulationPlan { rig: config, scene, calibrations: Default::default(), engage: true };
                Ok::<_, String>((rig, nima_simulation::start(&plan).unwrap()))
            }
        });
        let (_rig, handle) = match started.join().unwrap() {
            Ok(started) => started,
            Err(why) => return unjudged::left_out(&why),
        };
        let counted = ticks(&handle);
        let ended = counted.is_ok().then(|| {
            let ender = handle.ender();
            ender.end();
            let asked = Instant::now();
            while handle.is_running() && asked.elapsed() < END_MAX {
                thread::sleep(Duration::from_millis(5));
            }
            (!handle.is_running(), asked.elapsed())
        });
        if ended.is_none_or(|(ended, _)| !ended) {
            // Dropping would wait for a thread that never ends.
            std::mem::forget(handle);
            panic!("{counted:?}, ended: {ended:?}");
        }
        let Some(runtime::RuntimeSummary { scheduling, .. }) = handle.stop_and_join() else {
            panic!("the loop failed")
        };
        println!("{counted:?} ticks in {LENGTH:?}, ended after {:?}, {scheduling:?}", ended.unwrap().1);
        if !scheduling.fifo {
            return unjudged::left_out("real-time scheduling is not permitted");
        }
        // With most of the processor taken by other processes, the threads hardly meet.
        if counted.unwrap() < (RATE_HZ * LENGTH.as_secs_f64() * 0.5) as u64 {
            too_busy();
        }
    });
}
