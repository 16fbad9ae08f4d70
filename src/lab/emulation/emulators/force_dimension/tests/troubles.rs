//! Tests of all errors that can occur when connecting to a device, and when the program exits.

use std::process::{Command, Stdio};

use nima_devices::DeviceError;
use nima_testing::real_time::judged;

use super::*;
use crate::emulators::EmulatedFault;

fn trouble(settings: &ForceDimensionSettings) -> DeviceError {
    open(settings).map(drop).unwrap_err()
}

#[test]
fn a_library_that_is_not_there_is_told_with_where_it_was_looked_for() {
    let settings =
        ForceDimensionSettings { library: Some("/nowhere/libdrd.so.3".into()), ..ForceDimensionSettings::default() };
    let DeviceError::SdkMissing { searched, .. } = trouble(&settings) else { panic!("{:?}", trouble(&settings)) };
    assert_eq!(searched, "/nowhere/libdrd.so.3");
}

#[test]
fn a_real_handle_gets_no_stand_in_even_where_its_file_is_named_or_found() {
    judged(|| {
        let report = trouble(&ForceDimensionSettings { library: Some(library()), ..ForceDimensionSettings::default() });
        assert!(
            matches!(&report, DeviceError::SdkUnusable { reason, .. } if reason.contains("for emulated handles")),
            "{report:?}"
        );
        // Cargo makes the system search its own folders, which contain the stub under the library's name.
        match open(&ForceDimensionSettings::default()) {
            Err(DeviceError::SdkMissing { searched, .. }) => assert!(searched.contains("drd"), "{searched}"),
            // A machine with the real SDK and no device.
            other => assert!(nima_devices::force_dimension::installed_library().is_some(), "{other:?}"),
        }
    });
}

#[test]
fn a_library_that_does_not_fit_is_told_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let text = folder.path().join("libdrd.so.3");
    std::fs::write(&text, "not a library").unwrap();
    let settings = ForceDimensionSettings { library: Some(text), ..ForceDimensionSettings::default() };
    let report = trouble(&settings);
    assert!(matches!(&report, DeviceError::SdkUnusable { .. }), "{report:?}");
    #[cfg(target_os = "linux")]
    {
        // Any other library lacks the symbols.
        let maps = std::fs::read_to_string("/proc/self/maps").unwrap();
        let libc = maps.lines().filter_map(|line| line.split_whitespace().last()).find(|path| path.contains("libc.so"));
        let settings = ForceDimensionSettings { library: libc.map(Into::into), ..ForceDimensionSettings::default() };
        let report = trouble(&settings);
        assert!(
            matches!(&report, DeviceError::SdkUnusable { reason, .. } if reason == "it has no symbol dhdGetSDKVersion"),
            "{report:?}"
        );
    }
}

#[test]
fn devices_that_are_absent_taken_or_others_are_told_apart() {
    judged(|| {
        let (_serving, _hand, settings) =
            rig(EmulatedForceDimension { serial: 7, ..EmulatedForceDimension::default() });
        let DeviceError::Absent { place } = trouble(&ForceDimensionSettings { serial: Some(8), ..settings.clone() })
        else {
            panic!()
        };
        assert_eq!(place, "omega.7 with serial number 8 (1 attached)");
        let nobody = std::net::UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        let no_device = ForceDimensionSettings { emulator: Some(nobody), library: Some(library()), ..settings.clone() };
        assert_eq!(trouble(&no_device), DeviceError::Absent { place: "omega.7 (0 attached)".to_owned() });
        let first = open(&settings).unwrap();
        // A second copy of the library looks like a second program to the device.
        let other = ForceDimensionSettings { library: Some(library()), serial: Some(7), ..settings.clone() };
        assert_eq!(trouble(&other), DeviceError::Busy { place: "omega.7 with serial number 7".to_owned() });
        drop(first);
        drop(open(&other).unwrap());
        let (_sigma, _hand, settings) =
            rig(EmulatedForceDimension { kind: ForceDimensionKind::Other(104), ..EmulatedForceDimension::default() });
        assert!(matches!(trouble(&settings), DeviceError::WrongProduct { found, .. } if found == "sigma.7"));
    });
}

#[test]
fn devices_that_are_not_ready_or_broken_are_told_apart() {
    judged(|| {
        let (_serving, _hand, settings) =
            rig(EmulatedForceDimension { reset: true, ..EmulatedForceDimension::default() });
        assert!(matches!(trouble(&settings), DeviceError::NotReady { mode, .. } if mode.starts_with("reset")));
        let (serving, _hand, settings) = rig(EmulatedForceDimension::default());
        serving.faults.set(EmulatedFault::DeviceFault);
        assert!(matches!(trouble(&settings), DeviceError::DeviceFault { words, .. } if words.contains("code 109")));
        serving.faults.set(EmulatedFault::NotANumber);
        assert!(matches!(trouble(&settings), DeviceError::DeviceFault { .. }));
        serving.faults.set(EmulatedFault::Silence);
        // The emulator checks its faults at intervals.
        std::thread::sleep(Duration::from_millis(20));
        let report = trouble(&settings);
        assert!(
            matches!(report, DeviceError::Absent { .. }),
            "a device that does not answer is not attached: {report:?}"
        );
    });
}

#[test]
fn impossible_settings_are_refused() {
    for (settings, wrong) in [
        (ForceDimensionSettings { rate_hz: 5000.0, ..ForceDimensionSettings::default() }, "rate_hz"),
        (ForceDimensionSettings { watchdog_ms: 0.0, ..ForceDimensionSettings::default() }, "watchdog_ms"),
        (ForceDimensionSettings { force_max_n: f64::NAN, ..ForceDimensionSettings::default() }, "force_max_n"),
        (ForceDimensionSettings { gripper_max_n: 8.1, ..ForceDimensionSettings::default() }, "gripper_max_n"),
    ] {
        assert!(matches!(trouble(&settings), DeviceError::Setting { key, .. } if key == wrong));
    }
    assert_eq!(ForceDimensionSettings::default().watchdog_steps(), 160);
    assert!(toml::from_str::<ForceDimensionSettings>("wachdog_ms = 3.0").is_err());
}

/// Runs this test's program again with only one task.
fn child(test: &str, settings: &ForceDimensionSettings, more: (&str, &str)) -> std::process::Child {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", &format!("emulators::force_dimension::tests::troubles::{test}"), "--ignored", "--nocapture"])
        .env("NIMA_TEST_LIBRARY", settings.library.as_ref().unwrap())
        .env(drd::wire::ADDRESS_VARIABLE, settings.emulator.map(|address| address.to_string()).unwrap_or_default())
        .env(more.0, more.1)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

fn of_parent() -> ForceDimensionSettings {
    let emulator = std::env::var(drd::wire::ADDRESS_VARIABLE).ok().and_then(|address| address.parse().ok());
    ForceDimensionSettings {
        library: std::env::var_os("NIMA_TEST_LIBRARY").map(Into::into),
        emulator,
        ..ForceDimensionSettings::default()
    }
}

/// Exits like a program that returns from `main`: on Windows std's own `exit` ends all threads at once.
#[cfg_attr(windows, expect(unsafe_code, reason = "of C's library"))]
fn exit() -> ! {
    #[cfg(windows)]
    {
        unsafe extern "C" {
            fn exit(code: std::ffi::c_int) -> !;
        }
        // SAFETY: it takes any code.
        unsafe { exit(0) }
    }
    #[cfg(not(windows))]
    std::process::exit(0)
}

#[test]
#[ignore = "started by another test"]
fn pushes_and_leaves() {
    // On a busy machine, the handle occasionally answers too late.
    let mut driver = (0..20).find_map(|_| open(&of_parent()).ok()).unwrap();
    turn_on(&mut driver);
    let begin = Instant::now();
    until(&mut driver, |driver, _| {
        driver.set_force(Vector3::new(2.0, 0.0, 0.0), 0.0);
        begin.elapsed() > Duration::from_millis(100)
    });
    match std::env::var("NIMA_TEST_END").unwrap().as_str() {
        "exit" => exit(),
        "abort" => std::process::abort(),
        _ => panic!("ends by a panic"),
    }
}

#[test]
fn every_way_out_of_the_program_leaves_the_brakes_on() {
    judged(|| {
        for (end, cause) in
            [("exit", ForceOffCause::Software), ("panic", ForceOffCause::Software), ("abort", ForceOffCause::Watchdog)]
        {
            let (_serving, hand, settings) = rig(EmulatedForceDimension::default());
            let mut child = child("pushes_and_leaves", &settings, ("NIMA_TEST_END", end));
            let begin = Instant::now();
            let wait = |good: &dyn Fn(MotorOutput) -> bool| {
                while !good(hand.applied()) {
                    assert!(begin.elapsed() < Duration::from_secs(5), "{end}: {:?}", hand.applied());
                    std::thread::sleep(Duration::from_millis(1));
                }
            };
            wait(&|applied| applied.force_n.x == 2.0);
            wait(&|applied| applied.mode == FirmwareMode::Brake);
            assert_eq!((hand.applied().cause, hand.applied().force_n.norm()), (cause, 0.0), "{end}");
            child.wait().unwrap();
        }
    });
}

#[test]
#[ignore = "started by another test"]
fn finds_an_old_library() {
    let report = trouble(&of_parent());
    assert!(
        matches!(report, DeviceError::SdkUnusable { reason, .. } if reason == "its version 3.10.0.0 is older than 3.16")
    );
}

#[test]
fn a_library_that_is_too_old_is_refused() {
    judged(|| {
        let settings = ForceDimensionSettings { library: Some(library()), ..ForceDimensionSettings::default() };
        let mut child = child("finds_an_old_library", &settings, ("NIMA_EMULATED_SDK_VERSION", "3.10.0.0"));
        assert!(child.wait().unwrap().success());
    });
}

#[test]
fn dropping_the_driver_brakes_the_hand() {
    judged(|| {
        let (_serving, hand, settings) = rig(EmulatedForceDimension::default());
        let mut driver = open(&settings).unwrap();
        push(&mut driver, &hand);
        drop(driver);
        let applied = hand.applied();
        assert_eq!(
            (applied.mode, applied.cause, applied.force_n.norm()),
            (FirmwareMode::Brake, ForceOffCause::Software, 0.0)
        );
    });
}
