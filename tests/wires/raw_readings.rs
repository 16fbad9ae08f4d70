//! Force sensors with an intact connection and clock but faulty numbers, on rigs with an arm: the arm rotates the
//! numbers before the loop uses them, but the force must be removed nevertheless.
#![cfg(target_os = "linux")]
use std::{
    net::UdpSocket,
    path::Path,
    process::{Child, Command as Process, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::JoinHandle,
    time::{Duration, Instant},
};

use nima_core::{
    calibration::gravity::{GravityModel, GravityParameters, GravitySource},
    impedance::Mode,
};
use nima_devices::external::codec::{BYTES_MAX, Datagram};
use nima_emulation::{
    emulated::EmulatedRig,
    emulators::{EmulatedFault, FaultSwitch},
};
use nima_machine::{
    config::RigConfig,
    messages::{Command, Event, LoopState, Tick},
    rig::{RigSettings, SensorPlace, Side},
    runtime::LoopHandle,
    teleop::Calibrations,
};
use nima_simulation::{SimulationPlan, scene::Scene};
use nima_testing::real_time::{alone, judged, too_busy};
use nima_tests::emulated::{at_tip, started_in};

/// Time limit for the force after a sensor has started to repeat itself, s.
const GONE_S: f64 = 0.020;
/// A block of 32 readings is detected when it recurs, s.
const BLOCK_GONE_S: f64 = 0.060;
/// Minimum force in the hand when a fault begins, N.
const FELT_N: f64 = 0.3;
/// By then the sensor's readings have changed for long enough: after 3 s a constant reading is a fault.
const BEFORE: Duration = Duration::from_millis(4500);
const WAIT: Duration = Duration::from_secs(12);
/// The middle of the example sensor's oscillation, N.
const MIDDLE_N: f64 = 1.0;
/// Ticks that the loop may miss during a judgement.
const MISSED_MAX: u64 = 4;

struct Fixture {
    handle: LoopHandle,
    /// For the sensor at the wrist; applied once the sensor is connected.
    calibrations: Option<Calibrations>,
    newest: Option<Tick>,
    ticks: Vec<Tick>,
    raised: Vec<String>,
}

impl Fixture {
    fn new(plan: &SimulationPlan) -> Self {
        let calibrations = Some(plan.calibrations[0].clone()).filter(|known| known.gravity.is_some());
        let handle = nima_simulation::start(plan).unwrap();
        Self { handle, calibrations, newest: None, ticks: Vec::new(), raised: Vec::new() }
    }

    fn look(&mut self) {
        std::thread::sleep(Duration::from_micros(300));
        let newest = &mut self.newest;
        let ticks = &mut self.ticks;
        let raised = &mut self.raised;
        self.handle.drain_ticks(|tick| {
            *newest = Some(*tick);
            ticks.push(*tick);
        });
        self.handle.drain_events(|event| {
            if let Event::FaultRaised { fault, .. } = event {
                raised.push(format!("{fault:?}"));
            }
        });
    }

    fn state(&self) -> LoopState {
        self.newest.map_or(LoopState::Disconnected, |tick| tick.state)
    }

    fn rendered_n(&self) -> f64 {
        self.newest.map_or(0.0, |tick| tick.rendering.rendered_n.norm())
    }

    fn within(&mut self, wait: Duration, good: impl Fn(&Self) -> bool) -> bool {
        let begin = Instant::now();
        while begin.elapsed() < wait {
            self.look();
            if good(self) {
                return true;
            }
        }
        false
    }

    /// Waits until it is engaged for a while, with a force in the hand.
    fn engaged(&mut self) {
        let begin = Instant::now();
        while self.state() != LoopState::Engaged {
            let reports: Vec<_> = self.handle.roster().iter().map(|entry| entry.view.report().trouble).collect();
            assert!(begin.elapsed() < WAIT, "not engaged: {:?}, {:?}, {reports:?}", self.state(), self.raised);
            if self.state().is_latched() {
                self.handle.send(Command::ReleaseStop);
            }
            let change = self.handle.wrist_change(Side::Right);
            if let Some(known) = self.calibrations.as_ref().filter(|_| change.is_there()) {
                self.handle.activate(change, known);
                self.within(Duration::from_millis(20), |_| false);
            }
            self.handle.send(Command::Engage);
            self.within(Duration::from_millis(300), |bench| bench.state() == LoopState::Engaged);
        }
        self.raised.clear();
        self.within(BEFORE, |bench| bench.state() != LoopState::Engaged);
        assert_eq!(self.state(), LoopState::Engaged, "a false alarm: {:?}", self.raised);
        assert!(self.within(WAIT, |bench| bench.rendered_n() > FELT_N), "no force: {:?}", self.state());
    }

    /// Returns for how long there is a force in the hand after `begin`, s, and the fault that is raised.
    fn after(&mut self, begin: impl FnOnce()) -> (f64, String) {
        self.look();
        let (at_s, missed) = self.newest.map(|tick| (tick.t_s, tick.timing.missed)).unwrap();
        self.ticks.clear();
        self.raised.clear();
        begin();
        self.within(Duration::from_secs(2), |bench| bench.state() != LoopState::Engaged);
        self.within(Duration::from_millis(30), |_| false);
        let last =
            self.ticks.iter().filter(|tick| tick.rendering.rendered_n.norm() > 0.0).map(|tick| tick.t_s).next_back();
        if self.newest.unwrap().timing.missed > missed + MISSED_MAX {
            too_busy();
        }
        (last.unwrap_or(at_s) - at_s, self.raised.first().cloned().unwrap_or_default())
    }
}

/// Tests each fault `times` times; prints the results.
fn tried(name: &str, bench: &mut Fixture, times: usize, set: impl Fn(EmulatedFault)) {
    for fault in EmulatedFault::OF_SENSORS {
        let mut gone_ms = Vec::new();
        for _ in 0..times {
            bench.engaged();
            let (gone_s, raised) = bench.after(|| set(fault));
            set(EmulatedFault::None);
            let limit_s = if fault == EmulatedFault::Block { BLOCK_GONE_S } else { GONE_S };
            println!("{name}, {}: {raised}, no force after {:.1} ms", fault.name(), gone_s * 1e3);
            gone_ms.push(gone_s * 1e3);
            // The simulated range may end at a value that the force does not reach for a while.
            let is_late = gone_s > limit_s && fault != EmulatedFault::EndOfRange;
            assert!(raised.contains("Force") && !is_late, "{name}, {}: {raised}, {gone_s} s", fault.name());
        }
        println!("{name}, {}: {gone_ms:.1?} ms", fault.name());
    }
}

fn times() -> usize {
    std::env::var("NIMA_TIMES").ok().and_then(|times| times.parse().ok()).unwrap_or(1)
}

/// Returns the emulated rig, its right arm, with the sensor at this location.
fn emulated(folder: &Path, place: SensorPlace) -> (EmulatedRig, SimulationPlan) {
    let mut devices = at_tip(folder);
    devices = RigSettings { left: None, tissue_sensor: None, tracker: None, endoscope: None, pedal: None, ..devices };
    devices.right.as_mut().unwrap().sensor_at = place;
    devices.right.as_mut().unwrap().servos = None;
    let mut scene = Scene::load(if place == SensorPlace::Tip { "peg_transfer" } else { "palpation" }).unwrap();
    scene.hand.hold_s = 1e4;
    let rig = started_in(&scene, &devices);
    let mut config = RigConfig::load("emulated").unwrap();
    config.devices = Some(devices);
    config.mode = Mode::Dfr;
    config.gates.static_hold = true;
    config.endoscope = None;
    let gravity = (place == SensorPlace::Wrist).then(|| nima_study::validation::experiment::gravity(1).unwrap());
    let calibrations = [Calibrations { gravity, ..Calibrations::default() }, Calibrations::default()];
    (rig, SimulationPlan { rig: config, scene, calibrations, engage: false })
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn an_emulated_sensor_that_repeats_itself_takes_the_force_away() {
    let _alone = alone();
    for (name, place) in [("emulated, tip", SensorPlace::Tip), ("emulated, wrist", SensorPlace::Wrist)] {
        judged(|| {
            let folder = tempfile::tempdir().unwrap();
            let (rig, plan) = emulated(folder.path(), place);
            let mut bench = Fixture::new(&plan);
            tried(name, &mut bench, times(), |fault| assert!(rig.set_fault("right sensor", fault)));
        });
    }
}

/// An example, killed when it is dropped.
struct Example(Child);

impl Example {
    /// Starts the example, compiled into this folder, or interpreted if there is no compiler.
    fn start(name: &str, folder: &Path, ports: &[u16]) -> Self {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/external").join(name);
        let program = folder.join(name);
        let made =
            Process::new("cc").args(["-O2", "-o"]).arg(&program).arg(source.with_extension("c")).arg("-lm").status();
        let mut process = if made.is_ok_and(|status| status.success()) {
            Process::new(program)
        } else {
            let mut python = Process::new("python3");
            python.arg(source.with_extension("py"));
            python
        };
        process.arg("127.0.0.1").args(ports.iter().map(u16::to_string));
        Self(process.stdout(Stdio::null()).spawn().unwrap())
    }
}

impl Drop for Example {
    fn drop(&mut self) {
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

/// Sits between the sensor example and the console, and alters its numbers; stamps, sequence and checksum are correct.
struct Between {
    thread: Option<JoinHandle<()>>,
    ends: Arc<AtomicBool>,
}

impl Between {
    fn start(port: u16, console: u16, faults: FaultSwitch) -> Self {
        let ends = Arc::new(AtomicBool::new(false));
        let [to_device, to_console] = [port, 0].map(|port| UdpSocket::bind(("127.0.0.1", port)).unwrap());
        to_console.connect(("127.0.0.1", console)).unwrap();
        to_console.set_nonblocking(true).unwrap();
        to_device.set_read_timeout(Some(Duration::from_micros(200))).unwrap();
        let stop = Arc::clone(&ends);
        let thread = std::thread::spawn(move || {
            let mut spoiler = Spoiler::default();
            let mut device = None;
            let mut buffer = [0; 2048];
            while !stop.load(Ordering::Acquire) {
                if let Ok((length, from)) = to_device.recv_from(&mut buffer) {
                    device = Some(from);
                    let mut wire = [0; BYTES_MAX];
                    let mut datagram = Datagram::decode(&buffer[..length]).unwrap();
                    spoiler.spoil(&mut datagram, faults.get());
                    let length = datagram.encode(&mut wire);
                    to_console.send(&wire[..length]).ok();
                }
                while let (Ok(length), Some(device)) = (to_console.recv(&mut buffer), device) {
                    to_device.send_to(&buffer[..length], device).ok();
                }
            }
        });
        Self { thread: Some(thread), ends }
    }
}

impl Drop for Between {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Release);
        self.thread.take().unwrap().join().unwrap();
    }
}

/// Reproduces the faults of an emulated sensor for the example.
#[derive(Default)]
struct Spoiler {
    since: Vec<[f64; 13]>,
    count: usize,
}

impl Spoiler {
    fn spoil(&mut self, datagram: &mut Datagram, fault: EmulatedFault) {
        let mut now: [f64; 13] = datagram.numbers[..13].try_into().unwrap();
        if fault == EmulatedFault::None {
            *self = Self::default();
            return;
        }
        if self.since.len() < 32 {
            self.since.push(now);
        }
        match fault {
            EmulatedFault::Repeat => now = self.since[0],
            EmulatedFault::Block => now = self.since[self.count % 32],
            EmulatedFault::EndOfRange => now[2] = now[2].min(MIDDLE_N),
            _ => now[2] += 1.5,
        }
        self.count += 1;
        datagram.numbers[..13].copy_from_slice(&now);
    }
}

/// Returns the guide's rig, on these ports.
fn external(ports: [u16; 3], place: SensorPlace) -> SimulationPlan {
    let guide =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/external-device.md")).unwrap();
    let (_, after) = guide.split_once("```toml\n").unwrap();
    let (text, _) = after.split_once("```").unwrap();
    let mut text = text.to_owned();
    for (written, port) in ["47200", "47201", "47202"].into_iter().zip(ports) {
        text = text.replace(written, &port.to_string());
    }
    let mut rig = RigConfig::parse("docs/external-device.md".as_ref(), &text).unwrap();
    rig.mode = Mode::Dfr;
    rig.gates.static_hold = true;
    rig.devices.as_mut().unwrap().right.as_mut().unwrap().sensor_at = place;
    // The example's sensor carries no tool that could be weighed.
    let parameters = GravityParameters::Physical {
        mass_kg: 0.0,
        s1_from_source_wxyz: [1.0, 0.0, 0.0, 0.0],
        bias_n: [0.0; 3],
        torque: None,
    };
    let gravity = GravityModel { source: GravitySource::Arm, imu_sign: 1, parameters };
    let gravity = (place == SensorPlace::Wrist).then_some(gravity);
    let calibrations = [Calibrations { gravity, ..Calibrations::default() }, Calibrations::default()];
    SimulationPlan { rig, scene: Scene::load("peg_transfer").unwrap(), calibrations, engage: false }
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn an_external_sensor_that_repeats_itself_takes_the_force_away() {
    let _alone = alone();
    for (name, place) in [("external, tip", SensorPlace::Tip), ("external, wrist", SensorPlace::Wrist)] {
        judged(|| {
            let sockets = [(); 4].map(|()| UdpSocket::bind("127.0.0.1:0").unwrap());
            let [handle, arm, sensor, between] = sockets.map(|socket| socket.local_addr().unwrap().port());
            let faults = FaultSwitch::default();
            let _between = Between::start(between, sensor, faults.clone());
            let folder = tempfile::tempdir().unwrap();
            let start = |name: &str, ports: &[u16]| Example::start(name, folder.path(), ports);
            let _running = [start("handle", &[handle]), start("arm_and_sensor", &[arm, between])];
            let mut bench = Fixture::new(&external([handle, arm, sensor], place));
            tried(name, &mut bench, times(), |fault| faults.set(fault));
        });
    }
}
