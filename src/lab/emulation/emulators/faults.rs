//! Fault injection: the list of faults, the switch that sets one, and the effect of transmission faults on outgoing
//! frames.

use std::{
    collections::VecDeque,
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
};

use super::wires::WirePeer;

/// A fault of an emulated device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum EmulatedFault {
    #[default]
    None = 0,
    /// A tenth of the frames is dropped.
    Loss,
    /// All data are sent 50 ms late.
    Delay,
    /// The same reading is repeated, and the device's clock is stopped.
    Freeze,
    /// Nothing is sent; the connection stays open.
    Silence,
    /// Random bytes are sent between and instead of frames.
    Garbage,
    /// Checksums are wrong.
    BadChecksum,
    /// Frames have another type, or a wrong length.
    WrongFrame,
    /// Neighbouring frames are swapped.
    Reorder,
    /// The connection is closed; it is reopened when the fault is removed.
    Disconnect,
    /// The device's own fault bits are set.
    DeviceFault,
    /// Numbers are not finite.
    NotANumber,
    /// The image is black.
    Black,
    /// The ends of images are missing.
    Torn,
    /// Images are sent 400 ms late.
    Late,
    /// Images have half the size.
    WrongSize,
    /// Images have another format.
    OtherFormat,
    /// The endoscope has been pushed aside.
    Moved,
    /// The same numbers are repeated, while the device's clock runs.
    Repeat,
    /// A block of 32 readings is repeated, while the clock runs.
    Block,
    /// The numbers are clipped at their current values.
    EndOfRange,
    /// Adds 1.5 N along z.
    Jump,
}

impl EmulatedFault {
    /// Faults that apply to every device, without `None`.
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
    /// Faults that apply only to cameras.
    pub const OF_IMAGES: [Self; 6] =
        [Self::Black, Self::Torn, Self::Late, Self::WrongSize, Self::OtherFormat, Self::Moved];

    /// Faults of a force sensor whose connection and clock are intact.
    pub const OF_SENSORS: [Self; 4] = [Self::Repeat, Self::Block, Self::EndOfRange, Self::Jump];

    /// Returns its name on the command line.
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
            Self::Black => "black",
            Self::Torn => "torn",
            Self::Late => "late",
            Self::WrongSize => "wrong-size",
            Self::OtherFormat => "other-format",
            Self::Moved => "moved",
            Self::Repeat => "repeat",
            Self::Block => "block",
            Self::EndOfRange => "end-of-range",
            Self::Jump => "jump",
        }
    }

    /// Returns every fault of every device, without `None`.
    pub fn every() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().chain(Self::OF_IMAGES).chain(Self::OF_SENSORS)
    }

    /// Returns the fault with this name.
    pub fn named(name: &str) -> Option<Self> {
        if name == "none" { Some(Self::None) } else { Self::every().find(|fault| fault.name() == name) }
    }
}

/// Sets the fault of a running emulator, from a test or by a person.
#[derive(Clone, Debug, Default)]
pub struct FaultSwitch(Arc<AtomicU32>);

impl FaultSwitch {
    /// Sets the fault; [`EmulatedFault::None`] removes it.
    pub fn set(&self, fault: EmulatedFault) {
        self.0.store(fault as u32, Ordering::Release);
    }

    /// Returns the active fault.
    pub fn get(&self) -> EmulatedFault {
        let code = self.0.load(Ordering::Acquire);
        EmulatedFault::every().find(|fault| *fault as u32 == code).unwrap_or_default()
    }
}

/// Delay of a delayed frame, s.
const DELAY_S: f64 = 0.050;

/// Outgoing frames of an emulator, subject to the active fault.
#[derive(Debug)]
pub(super) struct FaultyLine {
    late: VecDeque<(f64, WirePeer, Vec<u8>)>,
    held: Option<(WirePeer, Vec<u8>)>,
    random: fastrand::Rng,
}

impl Default for FaultyLine {
    fn default() -> Self {
        Self { late: VecDeque::new(), held: None, random: fastrand::Rng::with_seed(0x11_fe) }
    }
}

impl FaultyLine {
    /// Processes a frame created at `now_s`; `send` gets the frames to be sent now, in order.
    pub(super) fn pass(
        &mut self,
        now_s: f64,
        to: WirePeer,
        frame: &[u8],
        fault: EmulatedFault,
        send: &mut dyn FnMut(WirePeer, &[u8]),
    ) {
        self.let_late_ones_go(now_s, send);
        match fault {
            EmulatedFault::Loss if self.random.u8(..) < 26 => {}
            EmulatedFault::Silence | EmulatedFault::Disconnect => {}
            EmulatedFault::Delay => self.late.push_back((now_s + DELAY_S, to, frame.to_vec())),
            EmulatedFault::Garbage => {
                let noise: Vec<u8> = (0..self.random.usize(1..64)).map(|_| self.random.u8(..)).collect();
                send(to, &noise);
                if self.random.bool() {
                    send(to, frame);
                }
            }
            EmulatedFault::Reorder => match self.held.take() {
                Some((earlier, held)) => {
                    send(to, frame);
                    send(earlier, &held);
                }
                None => self.held = Some((to, frame.to_vec())),
            },
            _ => {
                if let Some((earlier, held)) = self.held.take() {
                    send(earlier, &held);
                }
                send(to, frame);
            }
        }
    }

    /// Sends the frames whose delay has passed.
    pub(super) fn let_late_ones_go(&mut self, now_s: f64, send: &mut dyn FnMut(WirePeer, &[u8])) {
        while let Some((_, to, frame)) = self.late.pop_front_if(|(due_s, ..)| *due_s <= now_s) {
            send(to, &frame);
        }
    }

    /// Drops the frames in transit when the connection is cut.
    pub(super) fn cut(&mut self) {
        self.late.clear();
        self.held = None;
    }
}
