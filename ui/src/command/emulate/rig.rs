//! `nima emulate rig`: every device of a rig file at its address, with one simulated world; `--rig F`, `--scene F`.
//! `pedal BITS` on standard input presses the pedal's switches (the first in the lowest bit) until the next such line.

use anyhow::{Context as _, bail};
use nima_machine::config::RigConfig;
use nima_world::{
    emulated::{EmulatedRig, HandFrame},
    scene::Scene,
};

use crate::telling::tell;

pub(super) fn run(rig: &str, scene: &str, until_input_ends: bool) -> anyhow::Result<()> {
    let rig = RigConfig::load(rig)?;
    let Some(devices) = &rig.devices else {
        bail!("rig \"{}\" has no devices to emulate; choose another one, such as --rig emulated", rig.name);
    };
    if !devices.emulated {
        bail!("rig \"{}\" is for real devices; only a rig with emulated = true can be emulated", rig.name);
    }
    let scene = Scene::load(scene)?;
    let emulated = EmulatedRig::start(devices, &scene, &[HandFrame::of(&rig.teleoperation.mapping()); 2])
        .with_context(|| format!("rig \"{}\"", rig.name))?;
    let served: Vec<_> = emulated.servings().iter().map(|device| (device.name.as_str(), &device.serving)).collect();
    super::serve(&served, until_input_ends, |line| press(&emulated, line))
}

/// Handles `pedal BITS`; returns false for any other line.
fn press(emulated: &EmulatedRig, line: &str) -> bool {
    let Some(switches) = line.strip_prefix("pedal ") else { return false };
    match switches.trim().parse() {
        Ok(switches) => emulated.press(switches),
        Err(_) => tell(format_args!("unknown command \"{line}\"; expected: pedal BITS, 1 for the first switch")),
    }
    true
}
