//! What all emulators share: faults on demand, and a thread that serves until it is told to stop.
//!
//! An emulator speaks the wire of its device and is fed by a simulated world or a test. Faults are set at any time, also while
//! it serves; what concerns bytes is done by [`FaultyLine`], what concerns meaning (checksum, status bits, numbers) by
//! the emulator itself.

pub mod bota;
pub mod dynamixel;
pub mod force_dimension;
#[cfg(target_os = "linux")]
pub mod hid;
pub mod kinova;
#[cfg(unix)]
pub mod ndi;
mod places;

#[cfg(test)]
mod discovery_tests;

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU32, Ordering},
    },
    thread::{Builder, JoinHandle},
};

/// What an emulated device does wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum EmulatedFault {
    /// Nothing.
    #[default]
    None = 0,
    /// A tenth of the frames never leaves.
    Loss,
    /// Everything leaves 50 ms late.
    Delay,
    /// The same reading again and again, with the clock of the device standing still.
    Freeze,
    /// Nothing leaves any more; the line stays open.
    Silence,
    /// Random bytes between and instead of frames.
    Garbage,
    /// Wrong checksums.
    BadChecksum,
    /// Frames of another kind, or of a wrong length.
    WrongFrame,
    /// Neighbouring frames change places.
    Reorder,
    /// The line is closed; it opens again when the fault is taken back.
    Disconnect,
    /// The device's own fault bits are set.
    DeviceFault,
    /// Numbers that are not finite.
    NotANumber,
}

impl EmulatedFault {
    /// All, without `None`.
    pub const ALL: [Self; 11] = [
        Self::Loss,
        Self::Delay,
        Self::Freeze,
        Self::Silence,
        Self::Garbage,
        Self::BadChecksum,
        Self::WrongFrame,
        Self::Reorder,
        Self::Disconnect,
        Self::DeviceFault,
        Self::NotANumber,
    ];

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Loss => "loss",
            Self::Delay => "delay",
            Self::Freeze => "freeze",
            Self::Silence => "silence",
            Self::Garbage => "garbage",
            Self::BadChecksum => "bad-checksum",
            Self::WrongFrame => "wrong-frame",
            Self::Reorder => "reorder",
            Self::Disconnect => "disconnect",
            Self::DeviceFault => "device-fault",
            Self::NotANumber => "not-a-number",
        }
    }

    /// By its name.
    pub fn named(name: &str) -> Option<Self> {
        if name == "none" { Some(Self::None) } else { Self::ALL.into_iter().find(|fault| fault.name() == name) }
    }
}

/// The switch by which a test or a person sets the fault of a running emulator.
#[derive(Clone, Debug, Default)]
pub struct FaultSwitch(Arc<AtomicU32>);

impl FaultSwitch {
    /// Sets the fault; [`EmulatedFault::None`] takes it back.
    pub fn set(&self, fault: EmulatedFault) {
        self.0.store(fault as u32, Ordering::Release);
    }

    /// The fault in force.
    pub fn get(&self) -> EmulatedFault {
        let code = self.0.load(Ordering::Acquire);
        EmulatedFault::ALL.into_iter().find(|fault| *fault as u32 == code).unwrap_or_default()
    }
}

/// A frame on its way out of an emulator, as the fault in force lets it go.
#[derive(Debug, Default)]
pub struct FaultyLine {
    late: std::collections::VecDeque<(f64, Vec<u8>)>,
    held: Option<Vec<u8>>,
    random: Option<fastrand::Rng>,
}

/// How late a delayed frame leaves, s.
pub const EMULATED_DELAY_S: f64 = 0.050;

impl FaultyLine {
    /// Takes a frame made at `now_s`; `send` gets what leaves now, in order. Call with an empty frame to let late ones go.
    pub fn pass(&mut self, now_s: f64, frame: &[u8], fault: EmulatedFault, send: &mut dyn FnMut(&[u8])) {
        let random = self.random.get_or_insert_with(|| fastrand::Rng::with_seed(0x11_fe));
        while self.late.front().is_some_and(|(due_s, _)| *due_s <= now_s) {
            if let Some((_, late)) = self.late.pop_front() {
                send(&late);
            }
        }
        if frame.is_empty() {
            return;
        }
        match fault {
            EmulatedFault::Loss if random.u8(..) < 26 => {}
            EmulatedFault::Silence | EmulatedFault::Disconnect => {}
            EmulatedFault::Delay => self.late.push_back((now_s + EMULATED_DELAY_S, frame.to_vec())),
            EmulatedFault::Garbage => {
                let noise: Vec<u8> = (0..random.usize(1..64)).map(|_| random.u8(..)).collect();
                send(&noise);
                if random.bool() {
                    send(frame);
                }
            }
            EmulatedFault::Reorder => match self.held.take() {
                Some(held) => {
                    send(frame);
                    send(&held);
                }
                None => self.held = Some(frame.to_vec()),
            },
            _ => {
                if let Some(held) = self.held.take() {
                    send(&held);
                }
                send(frame);
            }
        }
    }
}

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
    /// Starts `serve` on a thread; it returns soon after its flag turns true.
    pub fn start(
        endpoint: String,
        faults: FaultSwitch,
        serve: impl FnOnce(&AtomicBool) + Send + 'static,
    ) -> std::io::Result<Self> {
        let stop = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stop);
        let thread = Builder::new().name("emulator".to_owned()).spawn(move || serve(&flag))?;
        Ok(Self { endpoint, faults, stop, thread: Some(thread) })
    }

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
