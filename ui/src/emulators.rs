//! Starts the emulators of an emulated rig in a process of their own, which ends with this one.

use std::{
    io::{BufRead as _, BufReader},
    process::{Child, Command, Stdio},
    time::Duration,
};

use anyhow::{Context as _, bail};
use nima_machine::rig::{SIDES, Settings, Side};

/// Before they serve, emulators of arms search a starting pose.
const READY_WITHIN: Duration = Duration::from_mins(1);

/// The process of the emulators; dropping this ends it.
#[derive(Debug)]
pub(crate) struct Emulators {
    child: Child,
}

impl Emulators {
    /// Starts the emulators if the rig of this name is emulated, around the scene of that name, and waits until they serve.
    pub(crate) fn start(rig: &str, scene: &str, devices: Option<&Settings>) -> anyhow::Result<Option<Self>> {
        let Some(devices) = devices.filter(|devices| devices.emulated) else { return Ok(None) };
        let program = std::env::current_exe().context("cannot find the path of this program")?;
        let mut command = Command::new(program);
        command.args(["emulate", "rig", "--rig", rig, "--scene", scene, "--until-input-ends"]);
        // Ctrl-C is for the loop only, which ends in order and then ends the emulators.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let child =
            command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().context("cannot start the emulators")?;
        let mut this = Self { child };
        this.wait(count(devices))?;
        Ok(Some(this))
    }

    /// Each emulator prints its endpoint in one line when it serves.
    fn wait(&mut self, devices: usize) -> anyhow::Result<()> {
        let Some(told) = self.child.stdout.take() else { return Ok(()) };
        let (line, lines) = std::sync::mpsc::channel();
        std::thread::spawn(move || {
            // Continues to read until the end, because the emulators would block on a full pipe.
            for text in BufReader::new(told).lines().map_while(Result::ok) {
                line.send(text).ok();
            }
        });
        for served in 0..devices {
            if lines.recv_timeout(READY_WITHIN).is_err() {
                bail!(
                    "only {served} of {devices} emulators of this rig have started; run `nima emulate rig` to see why"
                );
            }
        }
        Ok(())
    }
}

impl Drop for Emulators {
    fn drop(&mut self) {
        // They end in order when their standard input ends.
        drop(self.child.stdin.take());
        for _ in 0..100 {
            if !matches!(self.child.try_wait(), Ok(None)) {
                return;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

fn count(devices: &Settings) -> usize {
    let of_side = |side| devices.arm(side).map_or(0, |set| 3 + usize::from(set.servos.is_some()));
    let shared = [devices.tissue_sensor.is_some(), devices.tracker.is_some(), devices.pedal.is_some()];
    let sides: [usize; SIDES] = Side::ALL.map(of_side);
    sides.into_iter().sum::<usize>() + shared.into_iter().map(usize::from).sum::<usize>()
}
