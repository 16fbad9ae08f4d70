//! The common part of every emulator: a thread that opens the wires, receives from clients, advances the time, applies
//! faults, and ends on request.

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
    wires::{ARRIVALS, WireArrival, WireEnd, WirePeer, wait},
};

/// Maximum interval between calls of an emulator that does not report when it is due.
const TICK: Duration = Duration::from_millis(2);
/// Maximum interval between calls of an emulator that reports when it is due, so that faults and the end are handled
/// soon.
const IDLE_TICK: Duration = Duration::from_millis(5);
/// Maximum interval while a fault is active. Not always used, because every unnecessary wake-up takes time from the
/// loop under test.
const FAULTY_TICK: Duration = Duration::from_millis(1);
/// Maximum read at once: the longest datagram.
const BUFFER_BYTES: usize = 65_507;

/// A thread that serves an emulated device. Dropping it stops the thread.
#[derive(Debug)]
pub struct EmulatorThread {
    /// Address for clients: a port, an address, or a path.
    pub endpoint: String,
    pub faults: FaultSwitch,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl EmulatorThread {
    /// Returns whether it is still serving.
    pub fn is_serving(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }
}

impl Drop for EmulatorThread {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

impl dyn Emulator {
    /// Opens its wires and serves them on its own thread, until the result is dropped.
    ///
    /// # Errors
    /// If an endpoint is in use, is not an emulator's, or cannot be opened.
    pub fn serve(self: Box<Self>) -> io::Result<EmulatorThread> {
        let mut ends = self.wires()?;
        ends.iter_mut().try_for_each(|end| end.open())?;
        let endpoint = self.endpoint(&ends.iter().map(|end| end.endpoint()).collect::<Vec<_>>());
        let faults = FaultSwitch::default();
        let stop = Arc::new(AtomicBool::new(false));
        let switch = faults.clone();
        let flag = Arc::clone(&stop);
        let thread =
            Builder::new().name("emulator".to_owned()).spawn(move || Host::new(self, ends, switch).run(&flag))?;
        Ok(EmulatorThread { endpoint, faults, stop, thread: Some(thread) })
    }
}

/// Arguments of an emulator's call, and its output.
pub struct EmulatorTurn<'a> {
    /// Time since the emulator was started, s.
    pub now_s: f64,
    /// The active fault.
    pub fault: EmulatedFault,
    /// The baud rate that the client of a serial port has set, bit/s.
    pub baud: Option<u32>,
    line: &'a mut FaultyLine,
    ends: &'a mut [Box<dyn WireEnd>],
}

impl EmulatorTurn<'_> {
    /// Sends a frame, subject to the active fault.
    pub fn send(&mut self, to: WirePeer, frame: &[u8]) {
        let ends = &mut *self.ends;
        self.line.pass(self.now_s, to, frame, self.fault, &mut |to, bytes| send(ends, to, bytes));
    }

    /// Sends data that are exempt from transmission faults.
    pub fn send_unspoilt(&mut self, to: WirePeer, bytes: &[u8]) {
        send(self.ends, to, bytes);
    }

    /// Closes all connections.
    pub fn hang_up(&mut self) {
        self.ends.iter_mut().for_each(|end| end.hang_up());
    }
}

fn send(ends: &mut [Box<dyn WireEnd>], to: WirePeer, bytes: &[u8]) {
    for end in ends {
        end.send(to, bytes);
    }
}

struct Host {
    emulator: Box<dyn Emulator>,
    ends: Vec<Box<dyn WireEnd>>,
    line: FaultyLine,
    faults: FaultSwitch,
    begin: Instant,
    buffer: Vec<u8>,
}

impl Host {
    fn new(emulator: Box<dyn Emulator>, ends: Vec<Box<dyn WireEnd>>, faults: FaultSwitch) -> Self {
        Self {
            emulator,
            ends,
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
                // If an endpoint cannot be opened now, try again in the next turn.
                self.ends.iter_mut().for_each(|end| drop(end.open()));
            } else if self.cut() {
                self.line.cut();
                self.emulator.lose(WirePeer::Everyone);
            }
            for number in 0..self.ends.len() {
                self.receive(number);
            }
            self.turn(|emulator, turn, _| {
                turn.line.let_late_ones_go(turn.now_s, &mut |to, bytes| send(turn.ends, to, bytes));
                emulator.pass(turn);
            });
            wait(&self.ends, self.rest(), self.emulator.admits());
        }
        self.cut();
    }

    /// Returns how long to wait if nothing arrives.
    fn rest(&self) -> Duration {
        let due_s = self.emulator.due_s();
        let rest_s = due_s.map_or(f64::INFINITY, |due_s| due_s - self.begin.elapsed().as_secs_f64());
        let longest = match (self.faults.get(), due_s) {
            (EmulatedFault::None, None) => TICK,
            (EmulatedFault::None, Some(_)) => IDLE_TICK,
            _ => FAULTY_TICK,
        };
        Duration::from_secs_f64(rest_s.clamp(0.0, longest.as_secs_f64()))
    }

    /// Returns whether anything was open.
    fn cut(&mut self) -> bool {
        self.ends.iter_mut().fold(false, |any, end| end.cut() | any)
    }

    /// Forwards the data that have arrived at an end.
    fn receive(&mut self, number: usize) {
        for _ in 0..ARRIVALS {
            let admits = self.emulator.admits();
            let Some(arrival) = self.ends[number].next(&mut self.buffer, admits) else { return };
            self.turn(|emulator, turn, buffer| match arrival {
                WireArrival::Came(peer, count) => {
                    emulator.meet(peer, turn);
                    emulator.receive(peer, &buffer[..count], turn);
                }
                WireArrival::Heard(peer, count) => emulator.receive(peer, &buffer[..count], turn),
                WireArrival::Gone(peer) => emulator.lose(peer),
            });
        }
    }

    fn turn(&mut self, work: impl FnOnce(&mut dyn Emulator, &mut EmulatorTurn<'_>, &[u8])) {
        let mut turn = EmulatorTurn {
            now_s: self.begin.elapsed().as_secs_f64(),
            fault: self.faults.get(),
            baud: self.ends.iter().find_map(|end| end.baud()),
            line: &mut self.line,
            ends: &mut self.ends,
        };
        work(&mut *self.emulator, &mut turn, &self.buffer);
    }
}
