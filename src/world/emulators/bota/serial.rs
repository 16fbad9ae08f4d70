//! An emulated sensor behind a pseudo-terminal. A link of a fixed name leads to it, also after the line was cut and opened again.

use std::{
    fs::File,
    io::{self, ErrorKind, Read as _, Write as _},
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use nima_devices::os;
use serialport::{SerialPort as _, TTYPort};

use super::{Body, Emulated, Wire, frames::Frames};
use crate::emulators::{EmulatedFault, FaultSwitch, Serving, places::TerminalName};

const NAP: Duration = Duration::from_micros(300);

pub(super) fn serve(name: &str, wire: impl Wire, emulated: &Emulated, body: Body) -> io::Result<Serving> {
    let name = TerminalName::claim(emulated.link.as_deref(), name)?;
    let faults = FaultSwitch::default();
    let line = Line::open(&name)?;
    let frames = Frames::new(body, emulated.first_timestamp_us, emulated.status);
    let mut sensor =
        Sensor { wire, frames, baud: emulated.baud, faults: faults.clone(), begin: Instant::now(), present: false };
    Serving::start(name.path(), faults, move |stop| sensor.serve(&name, line, stop))
}

struct Sensor<W> {
    wire: W,
    frames: Frames,
    baud: Option<u32>,
    faults: FaultSwitch,
    begin: Instant,
    /// A client has the line open.
    present: bool,
}

impl<W: Wire> Sensor<W> {
    fn serve(&mut self, name: &TerminalName, line: Line, stop: &AtomicBool) {
        let mut line = Some(line);
        while !stop.load(Ordering::Acquire) {
            let fault = self.faults.get();
            if fault == EmulatedFault::Disconnect {
                (line, self.present) = (None, false);
                name.cut();
            } else if line.is_none() {
                line = Line::open(name).ok();
            } else if let Some(line) = &mut line {
                self.exchange(line, fault);
            }
            std::thread::sleep(NAP);
        }
    }

    fn exchange(&mut self, line: &mut Line, fault: EmulatedFault) {
        let now_s = self.begin.elapsed().as_secs_f64();
        let mut buffer = [0; 256];
        let Some(count) = line.read(&mut buffer) else {
            self.present = false;
            return;
        };
        if !self.present {
            self.present = true;
            self.wire.opened(now_s);
        }
        let understood = self.baud.is_none_or(|baud| line.baud() == Some(baud));
        let mut answer = Vec::new();
        if understood {
            self.wire.hear(&buffer[..count], now_s, &mut answer);
        }
        self.wire.tick(now_s, &mut answer);
        if !answer.is_empty() && fault != EmulatedFault::Silence {
            line.write(&answer, understood);
        }
        self.frames.due(now_s, &self.wire, fault, &mut |bytes| line.write(bytes, understood));
    }
}

/// The sensor's end of the line.
struct Line {
    port: TTYPort,
    bytes: File,
}

impl Line {
    fn open(name: &TerminalName) -> io::Result<Self> {
        let (port, other) = TTYPort::pair().map_err(io::Error::other)?;
        let bytes = os::bytes_of(&port)?;
        name.lead_to(&other)?;
        Ok(Self { port, bytes })
    }

    /// `None` while no client has the line open.
    fn read(&mut self, buffer: &mut [u8]) -> Option<usize> {
        match self.bytes.read(buffer) {
            Ok(count) => Some(count),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => Some(0),
            Err(_) => None,
        }
    }

    /// The speed that the client has set.
    fn baud(&self) -> Option<u32> {
        self.port.baud_rate().ok()
    }

    /// What does not fit is lost, as on a real line that nobody reads; another speed turns bytes into others.
    fn write(&mut self, bytes: &[u8], understood: bool) {
        if understood {
            let _ = self.bytes.write(bytes);
        } else {
            let other: Vec<u8> = bytes.iter().map(|byte| byte.rotate_left(3) ^ 0x5A).collect();
            let _ = self.bytes.write(&other);
        }
    }
}
