//! A pseudo-terminal behind a name that persists when the connection is cut and restored.

use std::{
    fs::File,
    io::{self, ErrorKind, Read as _, Write as _},
    os::fd::{AsRawFd as _, RawFd},
    path::Path,
    time::{Duration, Instant},
};

use nima_devices::os;
use serialport::{SerialPort as _, TTYPort};

use super::{WireArrival, WireEnd, WirePeer};
use crate::emulators::addresses::TerminalName;

/// Interval between checks for settings that clients left on a terminal.
const TIDY: Duration = Duration::from_millis(250);

/// Returns a terminal at `link`; without one, at `name` in its own folder. With a baud rate (bit/s), the terminal is
/// set to this rate and outlives its clients; without one, every client that opens it is reported.
pub(in crate::emulators) fn terminal(
    link: Option<&Path>,
    name: &str,
    baud: Option<u32>,
) -> io::Result<Box<dyn WireEnd>> {
    Ok(Box::new(Terminal { name: TerminalName::claim(link, name)?, baud, line: None }))
}

struct Terminal {
    name: TerminalName,
    baud: Option<u32>,
    line: Option<TerminalLine>,
}

struct TerminalLine {
    near: TTYPort,
    bytes: File,
    far: Option<ClientEnd>,
    /// Whether a client has the terminal open, or this process keeps it open for all clients.
    present: bool,
}

/// The clients' end, kept open.
struct ClientEnd {
    port: TTYPort,
    lock: File,
    tidied: Instant,
}

impl ClientEnd {
    /// Removes the lock left by a client that locked and closed the terminal. This takes a shared lock, which would
    /// keep the next client out.
    fn tidy(&mut self) {
        if self.tidied.elapsed() > TIDY {
            self.port.set_exclusive(false).ok();
            self.lock.unlock().ok();
            self.tidied = Instant::now();
        }
    }
}

impl Terminal {
    fn line(&self) -> io::Result<TerminalLine> {
        let (near, mut port) = TTYPort::pair()?;
        let bytes = os::bytes_of(&near)?;
        if let Some(baud) = self.baud {
            port.set_baud_rate(baud)?;
        }
        self.name.lead_to(&port)?;
        if self.baud.is_none() {
            return Ok(TerminalLine { near, bytes, far: None, present: false });
        }
        let lock = os::bytes_of(&port)?;
        Ok(TerminalLine { near, bytes, far: Some(ClientEnd { port, lock, tidied: Instant::now() }), present: true })
    }
}

impl WireEnd for Terminal {
    fn endpoint(&self) -> String {
        self.name.path()
    }

    fn open(&mut self) -> io::Result<()> {
        if self.line.is_none() {
            self.line = Some(self.line()?);
        }
        Ok(())
    }

    fn cut(&mut self) -> bool {
        self.name.cut();
        self.line.take().is_some()
    }

    fn next(&mut self, buffer: &mut [u8], _: bool) -> Option<WireArrival> {
        let line = self.line.as_mut()?;
        if let Some(far) = &mut line.far {
            far.tidy();
        }
        let read = match line.bytes.read(buffer) {
            Ok(count) => Some(count),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => Some(0),
            // No client has the other end open.
            Err(_) => None,
        };
        let before = std::mem::replace(&mut line.present, read.is_some());
        match read {
            Some(count) if !before => Some(WireArrival::Came(WirePeer::Everyone, count)),
            Some(count) if count > 0 => Some(WireArrival::Heard(WirePeer::Everyone, count)),
            None if before => Some(WireArrival::Gone(WirePeer::Everyone)),
            _ => None,
        }
    }

    fn send(&mut self, to: WirePeer, bytes: &[u8]) {
        if let Some(line) = self.line.as_mut().filter(|line| line.present && to == WirePeer::Everyone) {
            // Data that do not fit are lost, as on a real serial port without a reader.
            let _lost = line.bytes.write(bytes);
        }
    }

    fn baud(&self) -> Option<u32> {
        self.line.as_ref()?.near.baud_rate().ok()
    }

    fn watch(&self, _: bool, watched: &mut Vec<RawFd>) {
        watched.extend(self.line.iter().filter(|line| line.present).map(|line| line.bytes.as_raw_fd()));
    }
}
