//! The body of every emulator: a thread that opens the wires, hears clients, lets time pass, obeys faults, and ends when it is told to.

use std::{
    io,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{Builder, JoinHandle},
    time::{Duration, Instant},
};

use super::{
    EmulatedFault, Emulator, FaultSwitch,
    faults::FaultyLine,
    wires::{Arrival, End, Peer, Wires},
};

/// Time passes for an emulator at least so often.
const TICK: Duration = Duration::from_millis(1);
/// What is taken from a wire at once: the longest datagram.
const BUFFER_BYTES: usize = 65_507;

/// A thread that serves an emulated device. Dropping it stops the thread.
#[derive(Debug)]
pub struct Serving {
    /// Where clients find it: a port, an address, a path.
    pub endpoint: String,
    /// Its faults.
    pub faults: FaultSwitch,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Serving {
    /// It still serves.
    pub fn is_serving(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }
}

impl Drop for Serving {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

impl dyn Emulator {
    /// Opens its wires and serves them on a thread of its own, until the result is dropped.
    ///
    /// # Errors
    /// When a place is taken, is not an emulator's, or cannot be opened.
    pub fn serve(self: Box<Self>) -> io::Result<Serving> {
        let mut ends = self.wires()?;
        ends.iter_mut().try_for_each(|end| end.open())?;
        let endpoint = self.endpoint(&ends.iter().map(|end| end.endpoint()).collect::<Vec<_>>());
        let (faults, stop) = (FaultSwitch::default(), Arc::new(AtomicBool::new(false)));
        let (switch, flag) = (faults.clone(), Arc::clone(&stop));
        let thread =
            Builder::new().name("emulator".to_owned()).spawn(move || Host::new(self, ends, switch).run(&flag))?;
        Ok(Serving { endpoint, faults, stop, thread: Some(thread) })
    }
}

/// What an emulator is told in a call, and its way out.
pub struct Turn<'a> {
    /// Since it began to serve, s.
    pub now_s: f64,
    /// The fault in force.
    pub fault: EmulatedFault,
    /// The speed that the client of a serial line has set, bit/s.
    pub baud: Option<u32>,
    line: &'a mut FaultyLine,
    wires: &'a mut Wires,
}

impl Turn<'_> {
    /// Sends a frame, as far as the fault in force lets it.
    pub fn send(&mut self, to: Peer, frame: &[u8]) {
        self.line.pass(self.now_s, to, frame, self.fault, &mut |to, bytes| self.wires.send(to, bytes));
    }

    /// Sends what no fault of the line concerns.
    pub fn send_unspoilt(&mut self, to: Peer, bytes: &[u8]) {
        self.wires.send(to, bytes);
    }

    /// Ends a connection.
    pub fn hang_up(&mut self, peer: Peer) {
        self.wires.hang_up(peer);
    }
}

struct Host {
    emulator: Box<dyn Emulator>,
    wires: Wires,
    line: FaultyLine,
    faults: FaultSwitch,
    begin: Instant,
    buffer: Vec<u8>,
}

impl Host {
    fn new(emulator: Box<dyn Emulator>, ends: Vec<Box<dyn End>>, faults: FaultSwitch) -> Self {
        Self {
            emulator,
            wires: Wires::new(ends),
            line: FaultyLine::default(),
            faults,
            begin: Instant::now(),
            buffer: vec![0; BUFFER_BYTES],
        }
    }

    fn run(mut self, stop: &AtomicBool) {
        self.emulator.begin();
        while !stop.load(Ordering::Acquire) {
            if self.faults.get() != EmulatedFault::Disconnect {
                self.wires.open();
            } else if self.wires.cut() {
                self.line.cut();
                self.emulator.lose(Peer::Everyone);
            }
            self.hear();
            self.turn(|emulator, turn, _| {
                turn.line.let_late_ones_go(turn.now_s, &mut |to, bytes| turn.wires.send(to, bytes));
                emulator.pass(turn);
            });
            let rest_s =
                self.emulator.due_s().map_or(f64::INFINITY, |due_s| due_s - self.begin.elapsed().as_secs_f64());
            let rest = Duration::from_secs_f64(rest_s.clamp(0.0, TICK.as_secs_f64()));
            self.wires.wait(rest, self.emulator.admits());
        }
        self.wires.cut();
    }

    /// Hands on what has arrived.
    fn hear(&mut self) {
        self.wires.begin_turn();
        while let Some(arrival) = self.wires.next(&mut self.buffer, self.emulator.admits()) {
            match arrival {
                Arrival::Came(peer, count) => self.turn(|emulator, turn, buffer| {
                    emulator.meet(peer, turn);
                    if count > 0 {
                        emulator.hear(peer, &buffer[..count], turn);
                    }
                }),
                Arrival::Heard(peer, count) => {
                    self.turn(|emulator, turn, buffer| emulator.hear(peer, &buffer[..count], turn));
                }
                Arrival::Gone(peer) => self.emulator.lose(peer),
            }
        }
    }

    fn turn(&mut self, work: impl FnOnce(&mut dyn Emulator, &mut Turn<'_>, &[u8])) {
        let mut turn = Turn {
            now_s: self.begin.elapsed().as_secs_f64(),
            fault: self.faults.get(),
            baud: self.wires.baud(),
            line: &mut self.line,
            wires: &mut self.wires,
        };
        work(&mut *self.emulator, &mut turn, &self.buffer);
    }
}
