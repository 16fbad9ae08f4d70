//! Handles: attached and open devices, and one exchange with a device.

use std::{
    ffi::{c_char, c_int},
    net::{SocketAddr, UdpSocket},
    sync::{Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use crate::{
    errors::{COMMUNICATION, IN_USE, NO_DEVICE, OUTSIDE_RANGE, TIMED_OUT},
    reading_history::ReadingHistory,
    wire::{ADDRESS_VARIABLE, ClientOrder, DeviceReply, DeviceRequest, FRESH, SATURATED, TAKEN},
};

/// Maximum number of open devices.
const HANDLES: usize = 16;
/// An exchange without an answer fails after this time, because an emulator shares its processor with other programs.
const EXCHANGE: Duration = Duration::from_millis(2);
/// Interval between two checks for an answer.
const LOOK: Duration = Duration::from_micros(30);
/// The same as [`EXCHANGE`], when searching for devices.
const GREETING: Duration = Duration::from_millis(80);
/// `DHD_TIMEGUARD`: nothing newer was available.
pub(crate) const TIMEGUARD: c_int = 1;
/// `DHD_MOTOR_SATURATED`: the force was scaled down.
pub(crate) const MOTOR_SATURATED: c_int = 2;

pub(crate) struct StandInHandle {
    socket: UdpSocket,
    client: u64,
    sequence: u32,
    exchanged: Instant,
    pub(crate) time_guard: Duration,
    pub(crate) reply: DeviceReply,
    pub(crate) history: ReadingHistory,
    /// Last command: force, gripper force, N.
    pub(crate) asked_n: [f64; 4],
    pub(crate) force_max_n: Option<f64>,
    pub(crate) gripper_max_n: Option<f64>,
    pub(crate) gravity: bool,
    pub(crate) effector_kg: f64,
    /// Start of the current second, force calls in it, calls per millisecond in the previous second.
    rate: (Instant, u32, f64),
}

static OPEN: [Mutex<Option<StandInHandle>>; HANDLES] = [const { Mutex::new(None) }; HANDLES];
static REGISTRY: Mutex<Registry> = Mutex::new(Registry { report: Vec::new(), default: None, clients: 0 });

struct Registry {
    report: Vec<SocketAddr>,
    default: Option<usize>,
    clients: u64,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Adds a device at an address given by the program; returns false if it is not an address.
pub(crate) fn report(address: &str) -> bool {
    let Ok(address) = address.trim().parse() else { return false };
    let mut registry = locked(&REGISTRY);
    if !registry.report.contains(&address) {
        registry.report.push(address);
    }
    true
}

/// Returns all addresses from the environment and from the program.
fn addresses() -> Vec<SocketAddr> {
    let report = std::env::var(ADDRESS_VARIABLE).unwrap_or_default();
    let mut all: Vec<SocketAddr> = report.split(',').filter_map(|one| one.trim().parse().ok()).collect();
    all.extend(locked(&REGISTRY).report.iter().filter(|one| !report.contains(&one.to_string())));
    all
}

impl StandInHandle {
    fn reach(address: SocketAddr) -> Option<Self> {
        let socket = UdpSocket::bind(("127.0.0.1", 0)).ok()?;
        socket.connect(address).ok()?;
        socket.set_nonblocking(true).ok()?;
        let mut registry = locked(&REGISTRY);
        registry.clients += 1;
        let client = u64::from(std::process::id()) << 32 | registry.clients;
        drop(registry);
        let reply = DeviceReply::default();
        let now = Instant::now();
        let mut handle = Self {
            socket,
            client,
            sequence: 0,
            exchanged: now,
            time_guard: Duration::from_micros(250),
            reply,
            history: ReadingHistory::default(),
            asked_n: [0.0; 4],
            force_max_n: None,
            gripper_max_n: None,
            gravity: false,
            effector_kg: 0.0,
            rate: (now, 0, 0.0),
        };
        handle.exchange(ClientOrder::Hello, 0, [0.0; 4], GREETING).ok()?;
        Some(handle)
    }

    /// Sends one request and returns its reply. Replies to older requests and damaged ones are skipped.
    fn exchange(
        &mut self,
        order: ClientOrder,
        argument: u32,
        values: [f64; 4],
        timeout: Duration,
    ) -> Result<(), c_int> {
        self.sequence = self.sequence.wrapping_add(1);
        let request = DeviceRequest { client: self.client, sequence: self.sequence, order, argument, values };
        let gone = |error: std::io::Error| match error.kind() {
            std::io::ErrorKind::ConnectionRefused => NO_DEVICE,
            _ => COMMUNICATION,
        };
        self.socket.send(&request.encode()).map_err(gone)?;
        let begin = Instant::now();
        let mut damaged = false;
        let mut buffer = [0; 512];
        loop {
            let count = match self.socket.recv(&mut buffer) {
                Ok(count) => count,
                Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => {
                    if begin.elapsed() > timeout {
                        return Err(if damaged { COMMUNICATION } else { TIMED_OUT });
                    }
                    // A socket timeout is rounded up to the kernel's tick, several milliseconds.
                    std::thread::sleep(LOOK);
                    continue;
                }
                Err(error) => return Err(gone(error)),
            };
            match DeviceReply::decode(&buffer[..count]) {
                Some(reply) if (reply.client, reply.sequence) == (self.client, self.sequence) => {
                    self.reply = reply;
                    self.exchanged = begin;
                    return if reply.error == 0 { Ok(()) } else { Err(reply.error.cast_signed()) };
                }
                Some(_) => {}
                None => damaged = true,
            }
        }
    }

    /// Changes a setting of the device.
    pub(crate) fn order(&mut self, order: ClientOrder, argument: u32) -> Result<c_int, c_int> {
        self.exchange(order, argument, [0.0; 4], EXCHANGE).map(|()| 0)
    }

    /// Reads again, unless the last exchange is within the time guard.
    pub(crate) fn refresh(&mut self) -> Result<c_int, c_int> {
        if self.exchanged.elapsed() < self.time_guard {
            return Ok(TIMEGUARD);
        }
        self.exchange(ClientOrder::Read, 0, [0.0; 4], EXCHANGE)?;
        if self.reply.flags & FRESH == 0 {
            return Ok(TIMEGUARD);
        }
        self.history.note(self.exchanged, &self.reply);
        Ok(0)
    }

    /// Sets force (N) and gripper force (N), within the limits set by the program.
    pub(crate) fn force(&mut self, mut asked_n: [f64; 4]) -> Result<c_int, c_int> {
        if asked_n.iter().any(|value| !value.is_finite()) {
            return Err(crate::errors::INVALID_PARAMETER);
        }
        let size_n = asked_n[..3].iter().map(|value| value * value).sum::<f64>().sqrt();
        if let Some(max_n) = self.force_max_n.filter(|max_n| size_n > *max_n) {
            asked_n[..3].iter_mut().for_each(|value| *value *= max_n / size_n);
        }
        if let Some(max_n) = self.gripper_max_n {
            asked_n[3] = asked_n[3].clamp(-max_n, max_n);
        }
        self.exchange(ClientOrder::Force, 0, asked_n, EXCHANGE)?;
        self.asked_n = asked_n;
        self.rate.1 += 1;
        let elapsed_s = self.rate.0.elapsed().as_secs_f64();
        if elapsed_s >= 0.25 {
            self.rate = (Instant::now(), 0, f64::from(self.rate.1) / elapsed_s * 1e-3);
        }
        Ok(if self.reply.flags & SATURATED == 0 { 0 } else { MOTOR_SATURATED })
    }

    /// Returns the number of calls per millisecond that set a force; 0 before it is known and after they end.
    pub(crate) fn com_khz(&self) -> f64 {
        if self.rate.0.elapsed() > Duration::from_secs(1) { 0.0 } else { self.rate.2 }
    }
}

fn index(id: c_char) -> Option<usize> {
    if id == DEFAULT { locked(&REGISTRY).default } else { usize::try_from(id).ok() }
}

/// The default device. C's char is signed on some processors only.
pub(crate) const DEFAULT: c_char = c_char::from_ne_bytes([0xff]);

/// Calls `work` with an open device; returns error 5 if there is none.
pub(crate) fn with<T>(id: c_char, work: impl FnOnce(&mut StandInHandle) -> Result<T, c_int>) -> Result<T, c_int> {
    let place = index(id).and_then(|index| OPEN.get(index)).ok_or(NO_DEVICE)?;
    work(locked(place).as_mut().ok_or(NO_DEVICE)?)
}

/// Returns the devices that answer.
pub(crate) fn attached() -> Vec<(SocketAddr, DeviceReply)> {
    addresses().into_iter().filter_map(|address| Some((address, StandInHandle::reach(address)?.reply))).collect()
}

/// Returns whether a program has it open.
pub(crate) const fn is_taken(reply: &DeviceReply) -> bool {
    reply.flags & TAKEN != 0
}

/// Opens the first free device that matches; returns its number.
pub(crate) fn open(fits: impl Fn(usize, &DeviceReply) -> bool) -> Result<c_int, c_int> {
    let mut error = NO_DEVICE;
    for (number, address) in addresses().into_iter().enumerate() {
        let Some(mut handle) = StandInHandle::reach(address) else { continue };
        if !fits(number, &handle.reply) {
            continue;
        }
        if let Err(refused) = handle.exchange(ClientOrder::Open, 0, [0.0; 4], GREETING) {
            error = refused;
            continue;
        }
        // The thread that opened the device owns it: no other entry of the table can hold it.
        for (id, place) in OPEN.iter().enumerate() {
            let mut place = locked(place);
            if place.is_none() {
                *place = Some(handle);
                locked(&REGISTRY).default = Some(id);
                return c_int::try_from(id).map_err(|_| OUTSIDE_RANGE);
            }
        }
        handle.order(ClientOrder::Close, 0)?;
        return Err(IN_USE);
    }
    Err(error)
}

/// Closes a device, which then brakes.
pub(crate) fn close(id: c_char) -> Result<c_int, c_int> {
    let place = index(id).and_then(|index| OPEN.get(index)).ok_or(NO_DEVICE)?;
    let mut handle = locked(place).take().ok_or(NO_DEVICE)?;
    handle.order(ClientOrder::Close, 0).or(Ok(0))
}

/// Makes an open device the default one.
pub(crate) fn choose(id: c_char) -> Result<c_int, c_int> {
    with(id, |_| Ok(0))?;
    locked(&REGISTRY).default = index(id);
    Ok(0)
}

/// Returns the default device.
pub(crate) fn chosen() -> Result<c_int, c_int> {
    let default = locked(&REGISTRY).default.ok_or(NO_DEVICE)?;
    c_int::try_from(default).map_err(|_| OUTSIDE_RANGE)
}
