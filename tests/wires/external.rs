//! Devices of a lab's own design: the examples in C and Python drive the real loop over UDP, and are killed, stopped
//! and restarted.
#![cfg(target_os = "linux")]
use std::{
    net::UdpSocket,
    path::{Path, PathBuf},
    process::{Child, Command as Process, Stdio},
    time::{Duration, Instant},
};

use nima_core::{
    impedance::Mode,
    kinematics::{Arm, Joints, START_MISS_M},
};
use nima_devices::{ConnectionState, DeviceError, Health, Loss};
use nima_machine::{
    config::RigConfig,
    messages::{Command, Event, LoopState, Tick},
    runtime::LoopHandle,
};
use nima_simulation::{SimulationPlan, scene::Scene};
use nima_testing::{
    real_time::{alone, judged},
    unjudged,
};

/// Time limit for the force after a program has died, s.
const GONE_S: f64 = 0.020;
/// Minimum force in the hand before a program is killed, N.
const FELT_N: f64 = 0.3;
const WAIT: Duration = Duration::from_secs(12);

pub(super) fn here(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// Returns the guide's rig, on free ports.
fn rig(ports: [u16; 3]) -> RigConfig {
    let guide = std::fs::read_to_string(here("docs/external-device.md")).unwrap();
    let (_, after) = guide.split_once("```toml\n").unwrap();
    let (text, _) = after.split_once("```").unwrap();
    let mut text = text.to_owned();
    for (written, port) in ["47200", "47201", "47202"].into_iter().zip(ports) {
        assert!(text.contains(written));
        text = text.replace(written, &port.to_string());
    }
    let mut rig = RigConfig::parse("docs/external-device.md".as_ref(), &text).unwrap();
    rig.mode = Mode::Dfr;
    rig.gates.static_hold = true;
    rig
}

pub(super) fn free_ports() -> [u16; 3] {
    let sockets = [(); 3].map(|()| UdpSocket::bind("127.0.0.1:0").unwrap());
    sockets.map(|socket| socket.local_addr().unwrap().port())
}

/// Form of the examples: compiled or interpreted.
pub(super) enum Examples {
    C(PathBuf),
    Python,
}

impl Examples {
    /// Compiles the examples without warnings. `None` if there is no compiler.
    fn in_c(folder: &Path) -> Option<Self> {
        if Process::new("cc").arg("--version").output().is_err() {
            unjudged::left_out("no C compiler (cc) is installed");
            return None;
        }
        for name in ["handle", "arm_and_sensor"] {
            let source = here("assets/external").join(format!("{name}.c"));
            let strict = ["-std=c99", "-O2", "-Wall", "-Wextra", "-pedantic", "-Werror", "-o"];
            let made = Process::new("cc").args(strict).arg(folder.join(name)).arg(source).arg("-lm").output().unwrap();
            assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        }
        Some(Self::C(folder.to_owned()))
    }

    pub(super) fn start(&self, name: &str, ports: &[u16]) -> Running {
        self.start_with(name, ports, &[])
    }

    /// The same with more arguments on its command line.
    pub(super) fn start_with(&self, name: &str, ports: &[u16], more: &[String]) -> Running {
        let mut process = match self {
            Self::C(folder) => Process::new(folder.join(name)),
            Self::Python => {
                let mut python = Process::new("python3");
                python.arg(here("assets/external").join(format!("{name}.py")));
                python
            }
        };
        process.arg("127.0.0.1").args(ports.iter().map(u16::to_string)).args(more);
        Running(Some(process.stdout(Stdio::piped()).spawn().unwrap()))
    }
}

/// A running example, killed when it is dropped.
pub(super) struct Running(Option<Child>);

impl Running {
    #[expect(unsafe_code, reason = "std can only kill")]
    fn signal(&self, signal: i32) {
        let pid = self.0.as_ref().unwrap().id().cast_signed();
        // SAFETY: a signal to our own child, which has not been waited for.
        unsafe { libc::kill(pid, signal) };
    }

    fn kill(&mut self) {
        if let Some(mut child) = self.0.take() {
            child.kill().unwrap();
            child.wait().unwrap();
        }
    }

    /// Ends it regularly; returns its counts.
    fn counted(mut self) -> Vec<serde_json::Value> {
        self.signal(libc::SIGTERM);
        let output = self.0.take().unwrap().wait_with_output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.kill();
    }
}

pub(super) struct Fixture {
    handle: LoopHandle,
    newest: Option<Tick>,
    pub(super) ticks: Vec<Tick>,
    healths: [Health; 3],
    lost: Vec<(usize, Loss)>,
}

impl Fixture {
    pub(super) fn new(rig: RigConfig) -> Self {
        let scene = Scene::load("peg_transfer").unwrap();
        let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: false };
        let handle = nima_simulation::start(&plan).unwrap();
        Self { handle, newest: None, ticks: Vec::new(), healths: [Health::default(); 3], lost: Vec::new() }
    }

    fn look(&mut self) {
        std::thread::sleep(Duration::from_millis(1));
        let newest = &mut self.newest;
        let ticks = &mut self.ticks;
        let lost = &mut self.lost;
        self.handle.drain_ticks(|tick| {
            *newest = Some(*tick);
            ticks.push(*tick);
        });
        self.handle.drain_events(|event| {
            if let Event::Device(event) = event
                && let ConnectionState::Lost(loss) = event.standing
            {
                lost.push((usize::from(event.device), loss));
            }
        });
        if let Some(healths) = self.handle.healths() {
            self.healths.copy_from_slice(&healths.devices[..3]);
        }
    }

    /// Waits for a condition; if it fails, the test is judged only if the machine had time.
    pub(super) fn until(&mut self, what: &str, good: impl Fn(&Self) -> bool) {
        let begin = Instant::now();
        while !good(self) {
            if begin.elapsed() > WAIT {
                let state = self.newest.map(|tick| tick.state);
                let reports: Vec<_> = self.handle.roster().iter().map(|entry| entry.view.report()).collect();
                panic!("never came: {what}; {state:?}, {:?}, {reports:?}", self.healths.map(|health| health.standing));
            }
            self.look();
        }
    }

    pub(super) fn state(&self) -> LoopState {
        self.newest.map_or(LoopState::Idle, |tick| tick.state)
    }

    fn rendered_n(&self) -> f64 {
        self.newest.map_or(0.0, |tick| tick.rendering.rendered_n.norm())
    }

    fn is_faulted(&self) -> bool {
        matches!(self.state(), LoopState::Faulted(_))
    }

    /// Engages by command, and waits until the hand feels the sensor's force.
    pub(super) fn engage(&mut self) {
        // The status may be from before a loss.
        self.healths = [Health::default(); 3];
        self.until("all connected", |bench| bench.healths.iter().all(|h| h.standing == ConnectionState::Connected));
        // A release is refused until the first readings have arrived.
        let begin = Instant::now();
        while self.is_faulted() && begin.elapsed() < WAIT {
            assert!(self.handle.send(Command::ReleaseStop));
            (0..20).for_each(|_| self.look());
        }
        self.until("idle", |bench| bench.state() == LoopState::Idle);
        assert!(self.handle.send(Command::Engage));
        let felt = |bench: &Self| bench.state() == LoopState::Engaged && bench.rendered_n() > FELT_N;
        self.until("a force", |bench| felt(bench) || bench.is_faulted());
        assert!(felt(self), "not engaged: {:?}", self.state());
    }

    /// Returns the effect of `act` on the program of these devices: the cause, and the time until the force is gone, s.
    fn after(&mut self, act: impl FnOnce(), devices: &[usize]) -> (Loss, f64) {
        self.look();
        self.lost.clear();
        let at_s = self.newest.unwrap().t_s;
        assert!(self.rendered_n() > 0.0);
        self.ticks.clear();
        act();
        self.until("a fault", Self::is_faulted);
        self.until("a loss", |bench| bench.lost.iter().any(|(device, _)| devices.contains(device)));
        let last =
            self.ticks.iter().filter(|tick| tick.rendering.rendered_n.norm() > 0.0).map(|tick| tick.t_s).next_back();
        let gone_s = last.unwrap_or(at_s) - at_s;
        let (_, loss) = self.lost.iter().find(|(device, _)| devices.contains(device)).unwrap();
        (*loss, gone_s)
    }
}

/// Returns the numbers with this name in an example.
fn numbers_in(path: &str, name: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(here(path)).unwrap();
    let (_, after) = text.split_once(name).unwrap();
    let list = after.split(['{', '}', '(', ')']).nth(1).unwrap();
    list.split(',').map(|number| number.trim().parse().unwrap()).collect()
}

#[test]
fn the_arm_of_the_examples_begins_in_the_trocar_of_the_guide() {
    let set = rig([1, 2, 3]).devices.unwrap().right.unwrap();
    let arm = Arm::new(&set.mount).unwrap();
    for (path, name) in
        [("assets/external/arm_and_sensor.c", "gen3_rad[7] ="), ("assets/external/arm_and_sensor.py", "START_RAD =")]
    {
        let begin = Joints::from_iterator(numbers_in(path, name));
        let pose = arm.pose(&begin);
        let miss_m = pose.axis_miss_m(&set.rcm.trocar_m).norm();
        let depth_m = pose.insertion_m(&set.rcm.trocar_m);
        assert!(miss_m < START_MISS_M / 2.0 && (0.05..0.2).contains(&depth_m), "{path}: {miss_m} m, {depth_m} m deep");
    }
}

const HANDLE: &[usize] = &[0];
const ARM_AND_SENSOR: &[usize] = &[1, 2];

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn when_a_program_in_c_dies_or_stands_still_the_force_is_gone_and_the_cause_is_told() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let Some(examples) = Examples::in_c(folder.path()) else { return };
    judged(|| {
        let ports = free_ports();
        let mut hand = examples.start("handle", &ports[..1]);
        let mut arm = examples.start("arm_and_sensor", &ports[1..]);
        let mut bench = Fixture::new(rig(ports));
        bench.engage();
        let names: Vec<_> =
            bench.handle.roster().iter().map(|entry| entry.view.report().identity.unwrap().product).collect();
        assert_eq!(names, ["spring hand", "simulated arm", "pushed sensor"]);
        let judge =
            |bench: &mut Fixture, what: &str, act: &dyn Fn(&mut Running), running: &mut Running, devices: &[usize]| {
                let (loss, gone_s) = bench.after(|| act(running), devices);
                println!("{what}: {loss:?}, no force after {:.1} ms", gone_s * 1e3);
                assert!(gone_s <= GONE_S, "{what}: force for {gone_s} s");
                loss
            };
        let kill: &dyn Fn(&mut Running) = &|running| running.kill();
        let stop: &dyn Fn(&mut Running) = &|running| running.signal(libc::SIGSTOP);

        assert_eq!(judge(&mut bench, "handle killed", kill, &mut hand, HANDLE), Loss::Disconnected);
        bench.until("the cause", |bench| {
            let trouble = bench.handle.roster()[0].view.report().trouble;
            trouble.is_some_and(|trouble| matches!(trouble, DeviceError::NobodySends { .. }))
        });
        hand = examples.start("handle", &ports[..1]);
        bench.engage();

        assert_eq!(judge(&mut bench, "arm and sensor killed", kill, &mut arm, ARM_AND_SENSOR), Loss::Disconnected);
        arm = examples.start("arm_and_sensor", &ports[1..]);
        bench.engage();

        assert_eq!(judge(&mut bench, "sensor stopped", stop, &mut arm, ARM_AND_SENSOR), Loss::Silent);
        std::thread::sleep(Duration::from_millis(300));
        arm.signal(libc::SIGCONT);
        bench.until("connected again", |bench| bench.healths.iter().all(|h| h.standing == ConnectionState::Connected));
        assert!(bench.is_faulted() && bench.rendered_n() == 0.0, "nothing resumes by itself: {:?}", bench.state());
        bench.engage();

        assert_eq!(judge(&mut bench, "handle stopped", stop, &mut hand, HANDLE), Loss::Silent);
        hand.signal(libc::SIGCONT);
        drop(bench);
        let counted = hand.counted();
        println!("{}", counted[0]);
        assert!(counted[0]["with_force"].as_u64().unwrap() > 0 && counted[0]["damaged"] == 0);
        assert!(counted[0]["largest_n"].as_f64().unwrap() <= 4.0);
    });
}

/// An unknown program on the same computer that sends more than the handle: its data are ignored, and no tick is late
/// because of it.
#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn nobody_else_is_heard_beside_the_first_program_and_its_double_waits() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let Some(examples) = Examples::in_c(folder.path()) else { return };
    judged(|| {
        let ports = free_ports();
        let hand = examples.start("handle", &ports[..1]);
        let arm = examples.start("arm_and_sensor", &ports[1..]);
        let mut bench = Fixture::new(rig(ports));
        bench.engage();
        let double = examples.start("handle", &ports[..1]);
        let stranger = UdpSocket::bind("127.0.0.1:0").unwrap();
        let begin = Instant::now();
        let before = bench.healths[0];
        while begin.elapsed() < Duration::from_secs(1) {
            for _ in 0..100 {
                stranger.send_to(&[0x4E; 180], ("127.0.0.1", ports[0])).ok();
            }
            bench.look();
        }
        assert_eq!(bench.state(), LoopState::Engaged, "a flood that is not the device's must not end it");
        let after = bench.healths[0];
        assert_eq!((after.damaged, after.refused), (before.damaged, before.refused), "{after:?}");
        assert!(after.readings > before.readings + 500, "{after:?}");
        assert_eq!(double.counted()[0]["taken"], 0);
        drop((hand, arm));
    });
}

/// The guide's measurements: a minute at 1 kHz.
fn minute(examples: &Examples, seconds: u64) {
    let ports = free_ports();
    let hand = examples.start("handle", &ports[..1]);
    let arm = examples.start("arm_and_sensor", &ports[1..]);
    let mut bench = Fixture::new(rig(ports));
    bench.engage();
    let begin = Instant::now();
    let before = bench.healths;
    let first = bench.newest.unwrap();
    let mut rates_hz = Vec::new();
    bench.ticks.clear();
    while begin.elapsed() < Duration::from_secs(seconds) && bench.state() == LoopState::Engaged {
        bench.look();
        // The first rate is available half a second after opening.
        if begin.elapsed() > Duration::from_secs(1) {
            rates_hz.push(bench.healths.map(|health| health.rate_hz));
        }
    }
    let last = bench.newest.unwrap();
    let after = bench.healths;
    let mut ages_s: Vec<f64> = bench.ticks.iter().filter_map(|tick| tick.timing.sample_to_force_s).collect();
    ages_s.sort_by(f64::total_cmp);
    let at = |fraction: f64| ages_s[((ages_s.len() - 1) as f64 * fraction) as usize] * 1e3;
    println!(
        "{} s, {:?} at the end, {} ticks, {} missed",
        last.t_s - first.t_s,
        bench.state(),
        bench.ticks.len(),
        last.timing.missed - first.timing.missed
    );
    println!(
        "oldest reading to force: p50 {:.3} ms, p99 {:.3} ms, p99.9 {:.3} ms, max {:.3} ms",
        at(0.5),
        at(0.99),
        at(0.999),
        at(1.0)
    );
    for (place, name) in ["handle", "arm", "sensor"].into_iter().enumerate() {
        let before = &before[place];
        let after = &after[place];
        let lowest_hz = rates_hz.iter().map(|rates| rates[place]).fold(f64::INFINITY, f64::min);
        println!(
            "{name}: {} readings, lowest rate of half a second {lowest_hz:.0} Hz, lost {}, late or twice {}, damaged {}, refused {}",
            after.readings - before.readings,
            after.lost - before.lost,
            after.out_of_order - before.out_of_order,
            after.damaged - before.damaged,
            after.refused - before.refused,
        );
    }
    drop(bench);
    hand.counted().into_iter().chain(arm.counted()).for_each(|line| println!("{line}"));
}

#[test]
#[ignore = "a minute each, for the figures of docs/results/external-device.md"]
fn figures_of_a_minute_in_c() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    if let Some(examples) = Examples::in_c(folder.path()) {
        minute(&examples, 60);
    }
}

#[test]
#[ignore = "a minute each, for the figures of docs/results/external-device.md"]
fn figures_of_a_minute_in_python() {
    let _alone = alone();
    minute(&Examples::Python, 60);
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn the_examples_in_python_lead_the_loop_too() {
    let _alone = alone();
    judged(|| {
        let ports = free_ports();
        let hand = Examples::Python.start("handle", &ports[..1]);
        let arm = Examples::Python.start("arm_and_sensor", &ports[1..]);
        let mut bench = Fixture::new(rig(ports));
        bench.engage();
        bench.ticks.clear();
        bench.until("a while", |bench| bench.ticks.len() > 300);
        drop(bench);
        for line in hand.counted().into_iter().chain(arm.counted()) {
            assert!(line["taken"].as_u64().unwrap() > 100 && line["damaged"] == 0, "{line}");
        }
    });
}
