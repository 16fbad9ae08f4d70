//! A recorded session in the real window: controls do not reach the machine, but a stop does.
#![cfg(target_os = "linux")]

use std::{path::Path, process::Command, thread, time::Duration};

use egui::accesskit::Role;

use crate::{console::Console, same_window::SameWindow, server::Xvfb};

fn record(path: &Path) {
    let arguments = ["run", "--virtual", "--seconds", "20", "--record"];
    let recorded = Command::new(env!("CARGO_BIN_EXE_nima")).args(arguments).arg(path).output().unwrap();
    assert!(recorded.status.success(), "{}", String::from_utf8_lossy(&recorded.stderr));
}

#[test]
fn only_a_stop_reaches_the_machine_while_the_past_is_shown() {
    let _alone = nima_testing::real_time::alone();
    let Some(x) = Xvfb::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("console.json"), r#"{"toured":true}"#).unwrap();
    let session = folder.path().join("session.mcap");
    record(&session);
    let shown = session.clone();
    let mut same = SameWindow::open("peg_transfer", "technician", move |app| app.with_session(&shown));
    let mode = same.button("Direct (DFR)");
    let [gain, timeline] = ["Gain", "Time of the session"].map(|label| same.control(Role::Slider, label));
    let release = same.next_step();
    drop(same);
    let session = session.to_str().unwrap().to_owned();
    let mut console = Console::begin(&x, folder, &["--role", "technician", "--at-rest", "--session", &session]);
    thread::sleep(Duration::from_secs(1));
    for place in [timeline, mode, gain, release] {
        console.click(place);
    }
    console.key("p");
    thread::sleep(Duration::from_secs(1));
    console.key("p");
    console.key("space");
    thread::sleep(Duration::from_millis(800));
    console.click(release);
    console.key("l");
    thread::sleep(Duration::from_millis(1500));
    let screen = console.end()["screen"].clone();
    let states: Vec<&str> = screen["states"].as_array().unwrap().iter().filter_map(|state| state.as_str()).collect();
    assert_eq!(states, ["Idle", "Stopped"], "neither engaged nor released: {screen}");
    assert_eq!(screen["modes"].as_array().unwrap().len(), 1, "{screen}");
}
