//! The command line as a user types it, and the pages and sources that must match it.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod anonymous;
mod bridges;
mod calibrate_camera;
mod calibrate_correspondence;
mod calibrate_gravity;
mod calibrate_rig;
mod cases;
mod check_rig;
mod devices;
mod docs;
mod endings;
mod every_command;
mod export;
mod hostile_files;
mod identify;
mod installed;
mod languages;
mod packages;
mod paper_rig;
mod replay;
mod report;
mod report_text;
mod results;
mod rings;
mod score;
mod sessions;
mod study;
mod two_machines;
mod user_study;
mod view;

/// Returns the one line of a failed command.
fn one_line(output: &std::process::Output) -> String {
    let text = String::from_utf8(output.stderr.clone()).unwrap();
    assert!(!output.status.success());
    assert_eq!(text.lines().count(), 1, "{text}");
    text
}
