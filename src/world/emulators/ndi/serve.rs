//! The unit on real transports.

use std::{
    io,
    net::{TcpListener, TcpStream},
    path::Path,
    sync::atomic::Ordering,
    time::{Duration, Instant},
};

use nima_devices::{
    ndi::command::COMMAND_MAX,
    os,
    transport::{Bytes as _, Tcp},
};
use serialport::{SerialPort as _, TTYPort};

use super::{Answer, Body, Profile, Unit, unit::FIRST_BAUD};
use crate::emulators::{
    EmulatedFault, FaultSwitch, FaultyLine, Serving,
    places::{self, TerminalName},
};

const NAP: Duration = Duration::from_micros(300);
/// From the speed being set to 9600, which stands for a break, to the unit's answer, s: hosts flush in between.
const RESET_S: f64 = 0.300;
/// Bits on the line per byte.
const BITS: f64 = 10.0;

/// Serves on TCP; `port` 0 takes a free one. The newest connection is the one that is answered.
///
/// # Errors
/// I/O errors while listening or creating the thread.
pub fn serve_network(port: u16, profile: Profile, body: impl Body + 'static) -> io::Result<Serving> {
    let listener = places::taken(port, "TCP", TcpListener::bind(("127.0.0.1", port)))?;
    listener.set_nonblocking(true)?;
    let endpoint = listener.local_addr()?.to_string();
    let faults = FaultSwitch::default();
    let mut host = Host::new(profile, true, Box::new(body), faults.clone());
    Serving::start(endpoint, faults, move |stop| {
        let mut client: Option<Tcp> = None;
        while !stop.load(Ordering::Acquire) {
            if let Ok((stream, _)) = listener.accept() {
                client = welcome(stream);
                host.forget();
            }
            if host.faults.get() == EmulatedFault::Disconnect {
                client = None;
            }
            let lost = client.as_mut().is_some_and(|client| host.turn_network(client).is_err());
            if lost {
                client = None;
            }
            std::thread::sleep(NAP);
        }
    })
}

fn welcome(stream: TcpStream) -> Option<Tcp> {
    stream.set_nodelay(true).ok()?;
    Tcp::of(stream).ok()
}

/// Serves on a pseudo-terminal; the endpoint is a link to it that stays the same after a disconnection: `link` where one is given.
///
/// # Errors
/// I/O errors while creating the pseudo-terminal, the link or the thread.
pub fn serve_line(link: Option<&Path>, profile: Profile, body: impl Body + 'static) -> io::Result<Serving> {
    let name = TerminalName::claim(link, "tty")?;
    let first = Line::new(&name)?;
    let faults = FaultSwitch::default();
    let mut host = Host::new(profile, false, Box::new(body), faults.clone());
    Serving::start(name.path(), faults, move |stop| {
        let mut line = Some(first);
        while !stop.load(Ordering::Acquire) {
            if host.faults.get() == EmulatedFault::Disconnect {
                line = None;
                name.cut();
                host.forget();
            } else if line.is_none() {
                line = Line::new(&name).ok();
            }
            let lost = line.as_mut().is_some_and(|line| host.turn_line(line).is_err());
            if lost {
                line = None;
            }
            std::thread::sleep(NAP);
        }
    })
}

/// One pseudo-terminal. The far end stays open here, so that hosts may come and go.
struct Line {
    near: TTYPort,
    bytes: std::fs::File,
    _far: TTYPort,
}

impl Line {
    fn new(name: &TerminalName) -> io::Result<Self> {
        let (near, mut far) = TTYPort::pair()?;
        far.set_baud_rate(FIRST_BAUD)?;
        let bytes = os::bytes_of(&near)?;
        name.lead_to(&far)?;
        Ok(Self { near, bytes, _far: far })
    }
}

/// A unit with what arrives for it and what leaves it.
struct Host {
    unit: Unit,
    body: Box<dyn Body>,
    faults: FaultSwitch,
    passing: FaultyLine,
    begin: Instant,
    line: Vec<u8>,
    /// Speed of the unit's side of a serial line, bit/s.
    baud: u32,
    /// Until when the last reply takes the line, s.
    taken_s: f64,
    /// What the line says once the bytes of the command have had their time.
    due: Option<(f64, Answer)>,
    reset_s: Option<f64>,
}

impl Host {
    fn new(profile: Profile, network: bool, body: Box<dyn Body>, faults: FaultSwitch) -> Self {
        Self {
            unit: Unit::new(profile, network),
            body,
            faults,
            passing: FaultyLine::default(),
            begin: Instant::now(),
            line: Vec::with_capacity(COMMAND_MAX),
            baud: FIRST_BAUD,
            taken_s: 0.0,
            due: None,
            reset_s: None,
        }
    }

    fn now_s(&self) -> f64 {
        self.begin.elapsed().as_secs_f64()
    }

    /// What was half said to the last client.
    fn forget(&mut self) {
        self.line.clear();
        (self.due, self.passing) = (None, FaultyLine::default());
    }

    /// Takes one byte; the answer once it ends a command.
    fn hear(&mut self, byte: u8) -> Option<Answer> {
        if byte != b'\r' {
            // What is too long stays so, and is refused.
            if self.line.len() < COMMAND_MAX {
                self.line.push(byte);
            }
            return None;
        }
        let now_s = self.now_s();
        let answer = self.unit.answer(now_s, &self.line, self.faults.get(), &mut *self.body);
        self.line.clear();
        Some(answer)
    }

    /// Lets a reply leave, as the fault in force allows; each in one write.
    fn say(&mut self, reply: &[u8], mut send: impl FnMut(&[u8]) -> bool) -> io::Result<()> {
        let now_s = self.now_s();
        let mut good = true;
        // What reorder means for a unit that is asked is done by the unit: an older frame.
        let fault = match self.faults.get() {
            EmulatedFault::Reorder => EmulatedFault::None,
            fault => fault,
        };
        self.passing.pass(now_s, reply, fault, &mut |bytes| good &= send(bytes));
        if good { Ok(()) } else { Err(io::ErrorKind::BrokenPipe.into()) }
    }

    fn turn_network(&mut self, client: &mut Tcp) -> io::Result<()> {
        let gone = |_| io::Error::from(io::ErrorKind::BrokenPipe);
        let mut arrived = [0; 512];
        let count = client.receive(&mut arrived).map_err(gone)?;
        for byte in &arrived[..count] {
            if let Some(answer) = self.hear(*byte) {
                self.say(&answer.bytes, |bytes| client.send(bytes).is_ok())?;
            }
        }
        self.say(&[], |bytes| client.send(bytes).is_ok())
    }

    fn turn_line(&mut self, line: &mut Line) -> io::Result<()> {
        use std::io::{ErrorKind, Read as _, Write as _};
        let now_s = self.now_s();
        let same = line.near.baud_rate().is_ok_and(|baud| baud == self.baud);
        self.watch_break(now_s, line.near.baud_rate().ok());
        let mut arrived = [0; 512];
        let count = match line.bytes.read(&mut arrived) {
            Ok(count) => count,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => 0,
            Err(error) => return Err(error),
        };
        // At another speed the bytes are none for the unit.
        for byte in arrived[..count].iter().filter(|_| same) {
            // The unit speaks or listens: what comes before its reply is out is lost, so that no flood of questions takes the line for long.
            if self.due.is_some() {
                break;
            }
            let length = self.line.len() + 1;
            if let Some(answer) = self.hear(*byte) {
                let took_s = |bytes: usize| bytes as f64 * BITS / f64::from(self.baud);
                // The reply is written at once when its first byte would come; the line is taken until its last one has passed.
                let due_s = now_s.max(self.taken_s) + took_s(length);
                self.taken_s = due_s + took_s(answer.bytes.len());
                self.due = Some((due_s, answer));
            }
        }
        let Some((_, answer)) = self.due.take_if(|(due_s, _)| *due_s <= now_s) else {
            return self.say(&[], |bytes| line.bytes.write_all(bytes).is_ok());
        };
        // A host that does not read fills the line; then bytes are lost, as on a real one.
        self.say(&answer.bytes, |bytes| {
            line.bytes.write(bytes).is_ok_and(|_| true) || line.near.bytes_to_write().is_ok()
        })?;
        self.baud = answer.then_baud.unwrap_or(self.baud);
        Ok(())
    }

    /// A pseudo-terminal carries no break: the host's speed falling to the first one stands for it.
    fn watch_break(&mut self, now_s: f64, host: Option<u32>) {
        if self.baud == FIRST_BAUD || host != Some(FIRST_BAUD) {
            self.reset_s = None;
        } else if now_s - *self.reset_s.get_or_insert(now_s) >= RESET_S {
            let answer = self.unit.reset();
            self.line.clear();
            self.baud = FIRST_BAUD;
            self.due = Some((now_s, answer));
            self.reset_s = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use nima_devices::transport::{Serial, SerialSettings};

    use super::{super::wandering, *};

    /// At the line's first speed each reply to nothing takes 15 ms: twenty thousand would keep the unit speaking for minutes.
    #[test]
    fn a_flood_of_empty_commands_takes_the_line_for_no_longer_than_a_reply() {
        let serving = serve_line(None, Profile::default(), wandering).unwrap();
        let mut line = Serial::open(&SerialSettings { port: serving.endpoint.clone(), baud: FIRST_BAUD }).unwrap();
        let begin = Instant::now();
        let mut rest = 20_000_usize;
        while rest > 0 && begin.elapsed() < Duration::from_mins(1) {
            // A full line takes none.
            let flood = [b'\r'; 64];
            rest = rest.saturating_sub(if line.send(&flood).is_ok() { flood.len() } else { 0 });
            line.receive(&mut [0; 4096]).unwrap();
            std::thread::sleep(Duration::from_micros(100));
        }
        assert_eq!(rest, 0, "a busy machine had the line full for a minute");
        let (begin, mut heard) = (Instant::now(), Vec::new());
        while !String::from_utf8_lossy(&heard).contains("Polaris Vega") {
            assert!(begin.elapsed() < Duration::from_secs(30), "{}", String::from_utf8_lossy(&heard));
            // What is asked while the unit speaks is lost.
            line.send(b"VER 0\r").unwrap();
            for _ in 0..500 {
                let mut buffer = [0; 4096];
                let count = line.receive(&mut buffer).unwrap();
                heard.extend(&buffer[..count]);
                std::thread::sleep(Duration::from_millis(1));
            }
        }
    }
}
