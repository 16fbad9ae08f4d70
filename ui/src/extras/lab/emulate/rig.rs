//! `nima emulate rig`: every device of a rig file at its address, with one simulated world; `--rig F`, `--scene F`. Lines on
//! standard input: `pedal BITS` presses the pedal's switches (the first in the lowest bit) until the next such line; `screen
//! SIDE TASK PROMPT` shows the content of the screen to the technician at the arms; `truth HZ` prints the true forces at the
//! tips from now on, at this rate.

use std::time::Duration;

use anyhow::{Context as _, bail};
use nima_emulation::emulated::{EmulatedRig, GroundTruth, HandFrame};
use nima_machine::{config::RigConfig, rig::Side};
use nima_report::output;
use nima_screen::stderr::print_line;
use nima_simulation::{scene::Scene, screen::Screen};

use crate::{extras::lab::ground_truth::TrueForce, ground_truth::now_s};

pub(super) fn run(rig: &str, scene: &str, until_input_ends: bool) -> anyhow::Result<()> {
    let rig = RigConfig::load(rig)?;
    let Some(devices) = &rig.devices else {
        bail!("rig \"{}\" has no devices to emulate; choose another one, such as --rig emulated", rig.name);
    };
    if !devices.emulated {
        bail!("rig \"{}\" is for real devices; only a rig with emulated = true can be emulated", rig.name);
    }
    let scene = Scene::load(scene)?;
    let named = || format!("rig \"{}\"", rig.name);
    let mut emulated =
        EmulatedRig::start(devices, &scene, &[HandFrame::of(&rig.teleoperation.mapping()); 2]).with_context(named)?;
    if let Some(endoscope) = &rig.endoscope {
        emulated.show(endoscope, devices, &scene).with_context(named)?;
    }
    let served: Vec<_> = emulated.servings().iter().map(|device| (device.name.as_str(), &device.serving)).collect();
    super::serve(&served, until_input_ends, |line| obey(&emulated, line))
}

/// Handles a line; returns false for an unknown one.
fn obey(emulated: &EmulatedRig, line: &str) -> bool {
    press(emulated, line) || show(emulated, line) || testify(emulated, line)
}

/// Handles `screen SIDE TASK PROMPT`.
fn show(emulated: &EmulatedRig, line: &str) -> bool {
    let Some(shown) = line.strip_prefix("screen ") else { return false };
    match shown.parse::<Screen>() {
        Ok(screen) => emulated.technician().reads(&screen),
        Err(expected) => print_line(format_args!("unknown screen \"{shown}\"; {expected}")),
    }
    true
}

/// Handles `truth HZ`.
fn testify(emulated: &EmulatedRig, line: &str) -> bool {
    let Some(rate) = line.strip_prefix("truth ") else { return false };
    match rate.trim().parse::<u32>() {
        Ok(rate_hz @ 1..=1000) => {
            let witness = emulated.witness();
            std::thread::spawn(move || print_truth(&witness, Duration::from_secs(1) / rate_hz));
        }
        _ => print_line(format_args!("unknown command \"{line}\"; expected: truth HZ, from 1 to 1000")),
    }
    true
}

fn print_truth(witness: &GroundTruth, pause: Duration) {
    loop {
        for side in Side::ALL {
            let at_s = now_s();
            let Some(truth) = witness.truth(side) else { continue };
            let known = TrueForce { truth: side, at_s, tip_n: truth.tip_n.into() };
            let written = serde_json::to_string(&known).map(|line| output::line(&line));
            if !matches!(written, Ok(Ok(()))) {
                return;
            }
        }
        std::thread::sleep(pause);
    }
}

/// Handles `pedal BITS`; returns false for any other line.
fn press(emulated: &EmulatedRig, line: &str) -> bool {
    let Some(switches) = line.strip_prefix("pedal ") else { return false };
    match switches.trim().parse() {
        Ok(switches) => emulated.press(switches),
        Err(_) => print_line(format_args!("unknown command \"{line}\"; expected: pedal BITS, 1 for the first switch")),
    }
    true
}
