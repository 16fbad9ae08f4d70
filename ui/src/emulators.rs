//! Starts the emulators of an emulated rig in a separate process, which ends with this one.
//!
//! The loop reaches the emulators only through their devices. Their standard input carries the screen's instructions to the
//! simulated technician; their standard output reports ground truth, which only a simulation has.

use std::{
    io::{BufRead as _, BufReader, Write as _},
    path::Path,
    process::{Child, ChildStdin, Command, Stdio},
    sync::{Arc, Mutex, PoisonError, mpsc::Receiver},
    time::Duration,
};

use anyhow::{Context as _, bail};
use nima_machine::rig::{RigSettings, SIDES, Side};

use crate::{console::reader::ScreenReader, extras};

/// Time limit for the emulators, because those of arms search for a start pose first.
const READY_WITHIN: Duration = Duration::from_mins(1);

/// Process of the emulators; dropping this value ends it.
#[derive(Debug)]
pub(crate) struct Emulators {
    child: Child,
    input: Arc<Mutex<Option<ChildStdin>>>,
    report: Option<Receiver<String>>,
}

impl Emulators {
    /// Starts the emulators if the rig of this name is emulated, with the scene of that name, and waits until they serve.
    pub(crate) fn start(rig: &str, scene: &str, devices: Option<&RigSettings>) -> anyhow::Result<Option<Self>> {
        let program = std::env::current_exe().context("cannot find the path of this program")?;
        Self::start_by(&program, rig, scene, devices)
    }

    /// Like [`Emulators::start`], with this program: a test binary is not the program itself.
    pub(crate) fn start_by(
        program: &Path,
        rig: &str,
        scene: &str,
        devices: Option<&RigSettings>,
    ) -> anyhow::Result<Option<Self>> {
        let Some(devices) = devices.filter(|devices| devices.emulated) else { return Ok(None) };
        if !extras::emulates() {
            return Err(extras::not_built("emulated devices", "lab"));
        }
        let mut command = Command::new(program);
        command.args(["emulate", "rig", "--rig", rig, "--scene", scene, "--until-input-ends"]);
        // Ctrl-C goes to the loop only, which shuts down cleanly and then ends the emulators.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child =
            command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().context("cannot start the emulators")?;
        let input = Arc::new(Mutex::new(child.stdin.take()));
        let mut this = Self { child, input, report: None };
        this.wait(count(devices))?;
        Ok(Some(this))
    }

    /// Waits until the emulators serve; each prints its endpoint in one line.
    fn wait(&mut self, devices: usize) -> anyhow::Result<()> {
        let Some(report) = self.child.stdout.take() else { return Ok(()) };
        let (line, lines) = std::sync::mpsc::channel();
        std::thread::spawn(move || {
            // Read until the end, because the emulators would block on a full pipe.
            for text in BufReader::new(report).lines().map_while(Result::ok) {
                line.send(text).ok();
            }
        });
        for served in 0..devices {
            if lines.recv_timeout(READY_WITHIN).is_err() {
                bail!(
                    "only {served} of {devices} emulators of this rig have started; run `nima emulate rig` to \
                     see the cause"
                );
            }
        }
        self.report = Some(lines);
        Ok(())
    }

    /// Returns the simulated technician, who follows the screen.
    pub(crate) fn technician(&self) -> ScreenReader {
        let input = Arc::clone(&self.input);
        ScreenReader::new(move |screen| write(&input, &format!("screen {screen}")))
    }

    /// Requests reports of the true tip forces at this rate.
    pub(crate) fn print_truth(&self, rate_hz: u32) {
        write(&self.input, &format!("truth {rate_hz}"));
    }

    /// Returns the lines reported since the last call.
    pub(crate) fn report(&self) -> impl Iterator<Item = String> {
        self.report.iter().flat_map(Receiver::try_iter)
    }
}

/// Writes a line. An error is ignored: the devices report emulators that have ended.
fn write(input: &Mutex<Option<ChildStdin>>, line: &str) {
    if let Some(input) = &mut *input.lock().unwrap_or_else(PoisonError::into_inner) {
        writeln!(input, "{line}").and_then(|()| input.flush()).ok();
    }
}

impl Drop for Emulators {
    fn drop(&mut self) {
        // The emulators shut down cleanly when their standard input closes.
        drop(self.input.lock().unwrap_or_else(PoisonError::into_inner).take());
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

fn count(devices: &RigSettings) -> usize {
    let of_side = |side| devices.arm(side).map_or(0, |set| 3 + usize::from(set.servos.is_some()));
    let shared = [devices.tissue_sensor.is_some(), devices.tracker.is_some(), devices.pedal.is_some()];
    let sides: [usize; SIDES] = Side::ALL.map(of_side);
    sides.into_iter().sum::<usize>() + shared.into_iter().map(usize::from).sum::<usize>()
}
