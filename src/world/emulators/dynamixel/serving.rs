//! The emulated bus on a pseudo-terminal, behind a name that stays when the line is cut and comes back.

use std::{
    io::{Read as _, Write as _},
    path::Path,
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use nima_devices::os;
use serialport::{SerialPort as _, TTYPort};

use super::Emulator;
use crate::emulators::{EmulatedFault, FaultSwitch, Serving, places::TerminalName};

/// Between two looks at the line while nothing is due.
const WAIT: Duration = Duration::from_millis(1);
/// Between two looks at what clients left set on the line.
const TIDY_S: f64 = 0.250;

/// Our two ends of the terminal. The client's end stays open here, so that the line outlives its clients.
struct Line {
    ours: TTYPort,
    bytes: std::fs::File,
    theirs: TTYPort,
    lock: std::fs::File,
    tidied_s: f64,
}

impl Line {
    fn open(name: &TerminalName, baud: u32) -> std::io::Result<Self> {
        let (mut ours, mut theirs) = TTYPort::pair()?;
        ours.set_timeout(WAIT)?;
        theirs.set_baud_rate(baud)?;
        name.lead_to(&theirs)?;
        let (bytes, lock) = (os::bytes_of(&ours)?, os::bytes_of(&theirs)?);
        Ok(Self { ours, bytes, theirs, lock, tidied_s: 0.0 })
    }
}

impl Emulator {
    /// Serves on a new pseudo-terminal until the result is dropped. Clients whose line speed is not the servos' are not understood.
    ///
    /// # Errors
    /// I/O errors while creating the pseudo-terminal or the thread.
    pub fn serve(self) -> std::io::Result<Serving> {
        self.serve_at(None)
    }

    /// The same under this name, if one is given.
    ///
    /// # Errors
    /// I/O errors while creating the pseudo-terminal, the link or the thread.
    pub fn serve_at(mut self, link: Option<&Path>) -> std::io::Result<Serving> {
        let name = TerminalName::claim(link, "bus")?;
        let mut line = Some(Line::open(&name, self.baud())?);
        let faults = FaultSwitch::default();
        let switch = faults.clone();
        Serving::start(name.path(), faults, move |stop| {
            let begin = Instant::now();
            while !stop.load(Ordering::Acquire) {
                let fault = switch.get();
                if fault == EmulatedFault::Disconnect {
                    line = None;
                    name.cut();
                    std::thread::sleep(WAIT);
                } else if let Some(line) = &mut line {
                    self.exchange(line, fault, begin, stop);
                } else {
                    line = Line::open(&name, self.baud()).ok();
                }
            }
        })
    }

    /// Takes what is there, waits a moment for more, gives what is due.
    fn exchange(&mut self, line: &mut Line, fault: EmulatedFault, begin: Instant, stop: &AtomicBool) {
        let now_s = || begin.elapsed().as_secs_f64();
        let mut buffer = [0; 1024];
        let count = match self.due_s() {
            // Something is due soon: no waiting for more.
            Some(due_s) => {
                let rest_s = (due_s - now_s()).clamp(0.0, WAIT.as_secs_f64());
                if rest_s > 50e-6 {
                    std::thread::sleep(Duration::from_secs_f64(rest_s - 50e-6));
                }
                line.bytes.read(&mut buffer)
            }
            None => line.ours.read(&mut buffer),
        };
        if let Ok(count) = count
            && count > 0
            && line.theirs.baud_rate().is_ok_and(|baud| baud == self.baud())
        {
            self.receive(now_s(), &buffer[..count]);
        }
        self.send(now_s(), fault, &mut |bytes| {
            // A client that does not read loses bytes, as on a real line.
            line.bytes.write_all(bytes).ok();
        });
        if now_s() - line.tidied_s > TIDY_S && !stop.load(Ordering::Relaxed) {
            // A client that took the terminal for itself alone and is gone leaves it so. This takes a shared lock, which would
            // keep the next client out.
            line.theirs.set_exclusive(false).ok();
            line.lock.unlock().ok();
            line.tidied_s = now_s();
        }
    }
}
