//! Endings of commands: exit code, results and messages, for every cause.
#![cfg(target_os = "linux")]
use std::{
    fs,
    io::{BufRead as _, BufReader, Read as _},
    path::{Path, PathBuf},
    process::{Child, Command, Output, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use nima_console::shutdown::Leave;
use nima_emulation::{
    emulated::{Truth, provide_handles},
    emulators::force_dimension::FirmwareMode as Motors,
};
use nima_machine::{
    config::RigConfig,
    rig::{RigSettings, Side},
};
use nima_simulation::{SimulationPlan, start};
use nima_testing::real_time::{alone, judged};
use nima_tests::{emulated, plan};
use serde_json::Value;

const TIMEOUT: Duration = Duration::from_mins(1);

fn nima(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nima"));
    command
        .args(arguments)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        // Keep out the calibrations of the user who runs the tests.
        .env("NIMA_DATA_DIR", "/dev/null/no/such/folder")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// A process that ends with the test.
struct Running(Child);

impl Running {
    fn signal(&self, name: &str) {
        assert!(Command::new("kill").args([name, &self.0.id().to_string()]).status().unwrap().success());
    }

    fn ended(&mut self) -> std::process::ExitStatus {
        let began = Instant::now();
        loop {
            if let Some(status) = self.0.try_wait().unwrap() {
                return status;
            }
            assert!(began.elapsed() < TIMEOUT, "it does not end");
            sleep(Duration::from_millis(5));
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

fn until(what: &str, good: impl Fn() -> bool) {
    let began = Instant::now();
    while !good() {
        assert!(began.elapsed() < TIMEOUT, "never: {what}");
        sleep(Duration::from_millis(5));
    }
}

/// The process has a handler for this signal.
fn catches(pid: u32, signal: u32) -> bool {
    let status = fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    caught.is_some_and(|mask| u64::from_str_radix(mask.trim(), 16).unwrap() >> (signal - 1) & 1 == 1)
}

/// Returns the embedded emulated rig changed to missing real devices.
fn absent_rig(folder: &Path) -> PathBuf {
    let text = include_str!("../../../config/rigs/emulated.toml")
        .replace("emulated = true", "emulated = false")
        .replace("emulator = \"127.0.0.1:47130\"\n", "")
        .replace("emulator = \"127.0.0.1:47131\"\n", "")
        .replace("= 471", "= 529")
        .replace(":471", ":529")
        .replace("/tmp/nima-emulated", &folder.display().to_string());
    let path = folder.join("absent.toml");
    fs::write(&path, text).unwrap();
    path
}

#[test]
fn the_figures_contain_the_end_state_of_each_arm() {
    let output = nima(&["run", "--virtual", "--seconds", "1", "--scene", "bimanual", "--json"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&summary["final_state"], &summary["fault"]), (&"engaged".into(), &Value::Null));
    for (arm, side) in [(0, "right"), (1, "left")] {
        let arm = &summary["arms"][arm];
        assert_eq!((&arm["side"], &arm["final_state"]), (&side.into(), &"engaged".into()), "{arm}");
        assert!(arm.as_object().unwrap().contains_key("fault"));
    }
}

#[test]
fn a_run_whose_devices_never_came_fails_and_says_why_all_the_time() {
    let folder = tempfile::tempdir().unwrap();
    let rig = absent_rig(folder.path());
    let run = |more: &[&str]| {
        let output = nima(&["run", "--seconds", "4", "--rig", rig.to_str().unwrap()]).args(more).output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        let report = String::from_utf8(output.stderr).unwrap();
        let last = report.lines().last().unwrap().to_owned();
        assert!(last.starts_with("nima: the right arm ended without a device: right handle: "), "{report}");
        (String::from_utf8(output.stdout).unwrap(), report)
    };
    let (figures, report) = run(&[]);
    let status: Vec<_> = report.lines().filter(|line| line.contains("No device")).collect();
    assert!(status.len() >= 2 && status[1..].iter().all(|line| line.contains("No device: right ")), "{report}");
    assert!(figures.contains("right arm ended: No device") && figures.contains("never connected"), "{figures}");
    let (json, _) = run(&["--json"]);
    let summary: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(summary["final_state"], "disconnected");
    let arm = summary["devices"].as_array().unwrap().iter().find(|device| device["name"] == "right arm").unwrap();
    assert_eq!(arm["trouble"]["cause"], "no response from 127.0.0.1:52900", "{arm}");
    assert!(arm["trouble"]["cure"].is_string() && arm["outages"] == 0, "{arm}");
}

#[test]
fn a_closed_stderr_is_no_reason_to_panic() {
    let folder = tempfile::tempdir().unwrap();
    let rig = absent_rig(folder.path());
    let cases: [&[&str]; 6] = [
        &["fly"],
        &["run", "--rig", "no/such/rig"],
        &["run", "--seconds", "1"],
        &["run", "--seconds", "2", "--rig", rig.to_str().unwrap()],
        &["emulate", "no-such-device"],
        &["console"],
    ];
    for arguments in cases {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let status = nima(arguments).stdout(Stdio::null()).stderr(writer).status().unwrap();
        assert!(status.code().is_some_and(|code| code != 101), "{arguments:?}: {status}");
    }
}

/// Ends a run by this signal once its arm is engaged.
fn ended_by(signal: &str) -> Output {
    let mut run = Running(nima(&["run", "--scene", "free_motion"]).spawn().unwrap());
    let mut report = BufReader::new(run.0.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains("Engaged") {
        line.clear();
        assert!(report.read_line(&mut line).unwrap() > 0, "it ended before it was engaged");
        assert!(!line.contains("Fault"), "{line}");
    }
    run.signal(signal);
    let status = run.ended();
    let mut stdout = Vec::new();
    let mut stderr = Vec::new();
    run.0.stdout.take().unwrap().read_to_end(&mut stdout).unwrap();
    report.read_to_end(&mut stderr).unwrap();
    Output { status, stdout, stderr }
}

#[test]
fn whatever_signal_ends_a_run_its_figures_are_printed() {
    judged(|| {
        for signal in ["-TERM", "-HUP", "-INT"] {
            let output = ended_by(signal);
            let figures = String::from_utf8_lossy(&output.stdout);
            let report = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{signal}: {} {report}", output.status);
            assert!(figures.contains("right arm ended: Engaged") && figures.contains("work us"), "{signal}: {figures}");
            assert!(report.contains("nima: ended on request: force and drives are off"), "{signal}: {report}");
        }
    });
}

#[test]
fn a_run_on_the_virtual_clock_ends_with_its_figures_too() {
    let mut run = Running(nima(&["run", "--virtual", "--seconds", "1e7", "--json"]).spawn().unwrap());
    until("it catches SIGTERM", || catches(run.0.id(), 15));
    sleep(Duration::from_millis(300));
    run.signal("-TERM");
    assert!(run.ended().success());
    let summary: Value = serde_json::from_reader(run.0.stdout.take().unwrap()).unwrap();
    assert_eq!(summary["final_state"], "engaged");
}

#[test]
fn emulators_say_that_their_input_has_ended_and_serve_on_without_one() {
    let served = |run: &mut Running| {
        let mut line = String::new();
        BufReader::new(run.0.stdout.take().unwrap()).read_line(&mut line).unwrap();
        assert!(line.contains("endpoint"), "{line}");
    };
    let mut piped = Running(nima(&["emulate", "ndi"]).stdin(Stdio::piped()).spawn().unwrap());
    served(&mut piped);
    drop(piped.0.stdin.take());
    assert!(piped.ended().success());
    let mut report = String::new();
    piped.0.stderr.take().unwrap().read_to_string(&mut report).unwrap();
    assert!(report.contains("standard input has ended"), "{report}");
    let mut alone = Running(nima(&["emulate", "ndi"]).spawn().unwrap());
    served(&mut alone);
    sleep(Duration::from_millis(500));
    assert!(alone.0.try_wait().unwrap().is_none(), "it serves without an input");
    alone.signal("-TERM");
    assert!(alone.ended().success());
}

/// Processes that this one started.
fn children(pid: u32) -> Vec<u32> {
    let report = fs::read_to_string(format!("/proc/{pid}/task/{pid}/children")).unwrap_or_default();
    report.split_whitespace().filter_map(|pid| pid.parse().ok()).collect()
}

fn is_alive(pid: u32) -> bool {
    let stat = fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    stat.rsplit_once(") ").is_some_and(|(_, rest)| !rest.starts_with('Z'))
}

#[test]
fn an_export_that_is_ended_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let session = at("session.mcap");
    let record = ["run", "--virtual", "--seconds", "60", "--scene", "bimanual", "--record", &session];
    assert!(nima(&record).output().unwrap().status.success());
    let there = || -> Vec<String> {
        let entries = fs::read_dir(folder.path()).unwrap();
        entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect()
    };
    for (out, more) in [("a.mcap", &[][..]), ("b.mcap", &["--anonymous"]), ("c.csv", &["--arm", "left"])] {
        let out = at(out);
        let mut export = Running(nima(&[&["export", &session, "--out", &out], more].concat()).spawn().unwrap());
        until("a file that is being written", || there().len() > 1);
        export.signal("-TERM");
        let status = export.ended();
        let mut report = String::new();
        export.0.stderr.take().unwrap().read_to_string(&mut report).unwrap();
        assert!(
            !status.success() && report.lines().count() == 1 && report.contains("ended on request"),
            "{out}: {report}"
        );
        assert_eq!(there(), ["session.mcap"]);
    }
}

#[test]
fn a_timing_study_that_is_killed_leaves_no_loop_behind() {
    let mut study = Running(nima(&["study", "timing", "--seconds", "50"]).spawn().unwrap());
    let pid = study.0.id();
    until("a separate loop", || children(pid).first().is_some_and(|child| catches(*child, 15)));
    let child = children(pid)[0];
    study.0.kill().unwrap();
    study.ended();
    let killed = Instant::now();
    until("its loop ends", || !is_alive(child));
    assert!(killed.elapsed() < Duration::from_secs(30), "it ran to its own end");
}

/// Programs that do nothing, so that the start script can be tried without a build and without a package.
fn stand_in(path: &Path, text: &str) {
    use std::os::unix::fs::PermissionsExt as _;
    fs::write(path, format!("#!/bin/sh\n{text}\n")).unwrap();
    fs::set_permissions(path, fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn options_without_a_subcommand_reach_the_console_or_the_run_that_stands_for_it() {
    let folder = tempfile::tempdir().unwrap();
    let bin = folder.path().join("bin");
    let release = folder.path().join("target/release");
    fs::create_dir_all(&bin).unwrap();
    fs::create_dir_all(&release).unwrap();
    for (name, text) in [("cargo", ""), ("dpkg-query", "echo installed"), ("apt-get", "exit 1"), ("sudo", "exit 1")] {
        stand_in(&bin.join(name), text);
    }
    stand_in(&release.join("nima"), "echo nima \"$@\"");
    let dev = |display: &str, arguments: &[&str]| {
        let output = Command::new(Path::new(env!("CARGO_MANIFEST_DIR")).join("../dev"))
            .arg("run")
            .args(arguments)
            .env("PATH", format!("{}:{}", bin.display(), std::env::var("PATH").unwrap()))
            .env("CARGO_TARGET_DIR", folder.path().join("target"))
            .env_remove("WAYLAND_DISPLAY")
            .env("DISPLAY", display)
            .output()
            .unwrap();
        String::from_utf8(output.stdout).unwrap().trim().to_owned()
    };
    assert_eq!(dev("", &["--seconds", "5"]), "nima run --seconds 5");
    assert_eq!(dev(":7", &["--seconds", "5"]), "nima console --seconds 5");
    assert_eq!(dev("", &["--rig", "emulated"]), "nima run --rig emulated");
    assert_eq!(dev("", &["console", "--rig", "emulated"]), "nima run --rig emulated");
    assert_eq!(dev("", &["devices", "--json"]), "nima devices --json");
    assert_eq!(dev("", &["--help"]), "nima --help");
    assert_eq!(dev("", &[]), "nima run");
}

/// Names the rig file of the process to end, and the path of its results.
const RIG: &str = "NIMA_TEST_RIG";
const SUMMARY: &str = "NIMA_TEST_SUMMARY";

/// The process that the test below starts and ends.
#[test]
#[ignore = "run by the other test, which ends it"]
fn the_loop_of_another_process() {
    let Ok(rig) = std::env::var(RIG) else { return };
    provide_handles();
    let leave = Leave::on_signals().unwrap();
    let plan = SimulationPlan { rig: RigConfig::load(&rig).unwrap(), ..plan("peg_transfer") };
    let handle = start(&plan).unwrap();
    let ender = handle.ender();
    leave.at_once(move || ender.end());
    while !leave.is_asked() {
        handle.drain_ticks(|_| {});
        handle.drain_events(|_| {});
        sleep(Duration::from_millis(5));
    }
    let summary = handle.stop_and_join().unwrap();
    fs::write(std::env::var(SUMMARY).unwrap(), serde_json::to_vec(&summary).unwrap()).unwrap();
}

/// Returns the right arm of the emulated rig as a file at `path`: it presses on tissue, and the hand feels a steady
/// force.
fn pressing_rig(path: &Path) -> RigSettings {
    let mut file = emulated::rig_file(&emulated::elsewhere(path.parent().unwrap()));
    for part in ["left", "tissue_sensor", "tracker", "endoscope", "pedal"] {
        file.remove(&format!("devices.{part}"));
    }
    file.set("devices.right.sensor_at", "tip");
    file.set("mode", "dfr");
    file.set("gates.static_hold", true);
    file.save(path).unwrap().devices.unwrap()
}

/// Waits until the emulated devices reach this state.
fn come(truth: &dyn Fn() -> Truth, within: Duration, good: impl Fn(&Truth) -> bool) -> bool {
    let began = Instant::now();
    while began.elapsed() < within {
        if good(&truth()) {
            return true;
        }
        sleep(Duration::from_millis(1));
    }
    false
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn an_engaged_arm_is_braked_and_left_by_every_signal() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let rig_file = folder.path().join("rig.toml");
    let rig = emulated::started(&pressing_rig(&rig_file));
    let truth = || rig.truth(Side::Right).unwrap();
    let figures = folder.path().join("summary.json");
    let another_process = || {
        let child = Command::new(std::env::current_exe().unwrap())
            .args(["endings::the_loop_of_another_process", "--exact", "--ignored"])
            .env(RIG, &rig_file)
            .env(SUMMARY, &figures)
            .stdout(Stdio::null())
            .spawn();
        Running(child.unwrap())
    };
    judged(|| {
        for signal in ["-TERM", "-HUP", "-INT"] {
            let mut child = another_process();
            let feels = |truth: &Truth| truth.applied.force_n.norm() > 0.5 && truth.servoing;
            assert!(come(&truth, Duration::from_secs(10), feels), "{signal}: the hand feels nothing: {:?}", truth());
            child.signal(signal);
            assert!(child.ended().success(), "{signal}: it was ended, and did not leave");
            let summary: Value = serde_json::from_slice(&fs::read(&figures).unwrap()).unwrap();
            assert_eq!((&summary["final_state"], &summary["fault"]), (&"engaged".into(), &Value::Null), "{signal}");
            let left = truth();
            assert!(left.applied.mode == Motors::Brake && left.applied.force_n.norm() < 1e-12, "{signal}: {left:?}");
            assert!(!left.servoing, "{signal}: the arm is out of cyclic servoing");
        }
    });
}
