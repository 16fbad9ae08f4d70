//! Faults of threads and disks on the real clock: a rig that hangs, a screen that hangs, busy cores, a slow disk and a
//! full one.

use std::{
    fs, io,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use nima_core::impedance::Mode;
use nima_devices::Lever;
use nima_files::write_atomically;
use nima_machine::{
    config::{ConfigError, RigConfig},
    messages::{Event, Fault, LoopState, Tick},
    rig::{Inputs, Outputs, Rig, Roster, SIDES},
    runtime::{LoopHandle, LoopStartError, RuntimeSummary},
};
use nima_simulation::{SimulationPlan, Worlds, scene::Scene, start, start_on};
use serde::Serialize;

use super::FaultVerdict;

/// A fault that is not tested on the virtual clock.
#[derive(Clone, Debug, Serialize)]
pub struct Special {
    /// Description of the fault.
    pub what: String,
    pub verdict: FaultVerdict,
    /// The report, or why the fault is harmless.
    #[serde(rename = "told")]
    pub report: String,
    /// Time to detection, ms, if it was measured.
    pub detection_ms: Option<f64>,
    /// Time until the force was removed, ms, if there was one.
    pub zero_ms: Option<f64>,
}

/// Why a fault could not be tested on the real clock.
#[derive(Debug, thiserror::Error)]
pub enum LiveFaultError {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error(transparent)]
    Start(#[from] LoopStartError),
    /// The loop was not engaged within 5 s.
    #[error(
        "the loop on the real clock did not engage within 5 s: other programs use too much processor time; close them"
    )]
    NotEngaged,
    #[error("the loop's thread panicked; start the study again and report this")]
    Died,
    /// The temporary folder could not be created.
    #[error("cannot create the temporary folder")]
    Scratch(#[source] io::Error),
}

/// A rig that hangs once and records when its emergency release was called.
struct HangingRig {
    rig: Worlds,
    /// Loop time at which the rig hangs, s, and duration of the hang.
    at_s: f64,
    length: Duration,
    began: Arc<AtomicU64>,
    pulled: Arc<AtomicU64>,
    clock: Instant,
}

impl Rig for HangingRig {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        if now_s >= self.at_s && self.began.load(Ordering::Relaxed) == 0 {
            self.began.store(nanoseconds(self.clock), Ordering::Relaxed);
            thread::sleep(self.length);
        }
        self.rig.read(now_s)
    }

    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        self.rig.write(now_s, outputs);
    }

    fn levers(&self) -> Vec<Lever> {
        let lever = Lever::default();
        let pulled = Arc::clone(&self.pulled);
        let clock = self.clock;
        lever.attach(move || pulled.store(nanoseconds(clock), Ordering::Relaxed));
        vec![lever]
    }
}

/// Returns the nanoseconds since `clock`, at least 1, because zero means "not yet".
fn nanoseconds(clock: Instant) -> u64 {
    clock.elapsed().as_nanos() as u64 + 1
}

fn plan(rate_hz: f64) -> Result<SimulationPlan, LiveFaultError> {
    let mut rig = RigConfig::load("simulated")?;
    rig.mode = Mode::Dfr;
    rig.rate_hz = rate_hz;
    rig.gates.static_hold = true;
    Ok(SimulationPlan { rig, scene: Scene::load("peg_transfer")?, calibrations: Default::default(), engage: true })
}

fn until(handle: &LoopHandle, good: impl Fn(&Tick) -> bool) -> Result<(), LiveFaultError> {
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_secs(5) {
        let mut found = false;
        handle.drain_ticks(|tick| found |= good(tick));
        if found {
            return Ok(());
        }
        thread::sleep(Duration::from_millis(2));
    }
    Err(LiveFaultError::NotEngaged)
}

pub(super) fn all() -> Result<Vec<Special>, LiveFaultError> {
    let folder = tempfile::tempdir().map_err(LiveFaultError::Scratch)?;
    Ok(vec![
        hang("an exchange with the devices takes 60 ms", Duration::from_millis(60))?,
        hang("an exchange with the devices takes 500 ms", Duration::from_millis(500))?,
        screen_hangs()?,
        beside("a busy thread on each core for 1 s", |stop| {
            let cores = thread::available_parallelism().map_or(2, std::num::NonZero::get);
            thread::scope(|scope| {
                for _ in 0..cores {
                    scope.spawn(|| {
                        while !stop.load(Ordering::Relaxed) {
                            std::hint::black_box((0..10_000_u64).fold(1.0_f64, |sum, k| (sum + k as f64).sqrt()));
                        }
                    });
                }
            });
        })?,
        beside("continuous synchronised disk writes while summaries are saved", |stop| {
            slow_disk(stop, folder.path());
        })?,
        full_disk(folder.path())?,
    ])
}

fn hang(what: &str, length: Duration) -> Result<Special, LiveFaultError> {
    let plan = plan(1000.0)?;
    let began = Arc::new(AtomicU64::new(0));
    let pulled = Arc::new(AtomicU64::new(0));
    let rig = HangingRig {
        rig: Worlds::new(&plan.scene, plan.rig.rate_hz),
        at_s: 1.3,
        length,
        began: Arc::clone(&began),
        pulled: Arc::clone(&pulled),
        clock: Instant::now(),
    };
    let handle = start_on(&plan, Box::new(rig), Roster::new())?;
    let faulted = until(&handle, |tick| matches!(tick.state, LoopState::Faulted(_)));
    let mut stalled = false;
    handle.drain_events(|event| {
        stalled |= matches!(event, Event::FaultRaised { fault: Fault::LoopStalled { .. }, .. });
    });
    handle.stop_and_join().ok_or(LiveFaultError::Died)?;
    let [began, pulled] = [began, pulled].map(|at| at.load(Ordering::Relaxed));
    let after_ms = (pulled > began).then(|| (pulled - began) as f64 * 1e-6);
    let verdict =
        if faulted.is_ok() && stalled && after_ms.is_some() { FaultVerdict::Detected } else { FaultVerdict::Silent };
    let report = "supervisor pulls the levers; then LoopStalled".to_owned();
    Ok(Special { what: what.to_owned(), verdict, report, detection_ms: after_ms, zero_ms: after_ms })
}

/// No screen reads the ticks: at 4 kHz the queue of 8192 is full after two seconds.
fn screen_hangs() -> Result<Special, LiveFaultError> {
    let handle = start(&plan(4000.0)?)?;
    thread::sleep(Duration::from_millis(2500));
    let running = handle.is_running();
    let summary = handle.stop_and_join().ok_or(LiveFaultError::Died)?;
    let counted = summary.dropped > 0 && running;
    Ok(Special {
        what: "the screen hangs and reads no ticks".to_owned(),
        verdict: if counted { FaultVerdict::Detected } else { FaultVerdict::Silent },
        report: format!("{} ticks counted as dropped; the loop continued, {}", summary.dropped, timing(&summary)),
        detection_ms: None,
        zero_ms: None,
    })
}

fn timing(summary: &RuntimeSummary) -> String {
    format!("{} of {} periods missed, all counted", summary.missed, summary.missed + summary.ticks)
}

/// Runs the loop for one second under this load.
fn beside(what: &str, load: impl Fn(&AtomicBool) + Send + Sync) -> Result<Special, LiveFaultError> {
    let handle = start(&plan(1000.0)?)?;
    until(&handle, |tick| tick.state == LoopState::Engaged)?;
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| load(&stop));
        thread::sleep(Duration::from_secs(1));
        stop.store(true, Ordering::Relaxed);
    });
    let mut stalled = false;
    handle.drain_events(|event| stalled |= matches!(event, Event::FaultRaised { .. }));
    let summary = handle.stop_and_join().ok_or(LiveFaultError::Died)?;
    let periods = summary.seconds * 1000.0;
    let all_counted = (periods - (summary.ticks + summary.missed) as f64).abs() < 2.0;
    let verdict = match (stalled || summary.missed > 0, all_counted) {
        (_, false) => FaultVerdict::Silent,
        (true, true) => FaultVerdict::Detected,
        (false, true) => FaultVerdict::Harmless,
    };
    let fault = if stalled { "; LoopStalled" } else { "" };
    Ok(Special {
        what: what.to_owned(),
        verdict,
        report: format!("{}{fault}", timing(&summary)),
        detection_ms: None,
        zero_ms: None,
    })
}

/// Writes to the disk with synchronisation, 1 MB at a time, and also writes a result file.
fn slow_disk(stop: &AtomicBool, folder: &Path) {
    let bytes = vec![0x5a_u8; 1 << 20];
    while !stop.load(Ordering::Relaxed) {
        let written = fs::File::create(folder.join("load")).and_then(|mut file| {
            io::Write::write_all(&mut file, &bytes)?;
            file.sync_all()
        });
        let kept = write_atomically(&folder.join("summary.json"), |file| file.write_all(&bytes));
        if written.and(kept).is_err() {
            thread::sleep(Duration::from_millis(10));
        }
    }
}

/// Writes a result to a full disk: the write fails half-way with the error of `/dev/full`.
fn full_disk(folder: &Path) -> Result<Special, LiveFaultError> {
    let path = folder.join("kept.json");
    write_atomically(&path, |file| file.write_all(b"the result before")).map_err(LiveFaultError::Scratch)?;
    let report = write_atomically(&path, |file| {
        file.write_all(b"half of a")?;
        let mut full = fs::OpenOptions::new().write(true).open("/dev/full")?;
        io::Write::write_all(&mut full, b"result")
    });
    let kept = fs::read(&path).is_ok_and(|bytes| bytes == b"the result before");
    let verdict = if report.is_err() && kept { FaultVerdict::Detected } else { FaultVerdict::Silent };
    let report = report.err().map_or_else(String::new, |error| format!("{error}; the previous file is kept"));
    Ok(Special { what: "the disk is full".to_owned(), verdict, report, detection_ms: None, zero_ms: None })
}
