//! Faults on demand: which there are, the switch that sets one, and what those of the bytes do to frames on their way out.

use std::{
    collections::VecDeque,
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
};

use super::wires::Peer;

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
    /// A picture on which there is nothing to see.
    Black,
    /// Pictures whose end is missing.
    Torn,
    /// Pictures leave 400 ms late.
    Late,
    /// Pictures of half the size.
    WrongSize,
    /// Pictures of another format.
    OtherFormat,
    /// Somebody has pushed the endoscope aside.
    Moved,
    /// The same numbers again and again, while the clock of the device goes on.
    Repeat,
    /// A block of 32 readings again and again, while the clock goes on.
    Block,
    /// The numbers are cut off at their present values.
    EndOfRange,
    /// 1.5 N more along z.
    Jump,
}

impl EmulatedFault {
    /// All that concern every device, without `None`.
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
    /// Those that only a camera has.
    pub const OF_PICTURES: [Self; 6] =
        [Self::Black, Self::Torn, Self::Late, Self::WrongSize, Self::OtherFormat, Self::Moved];

    /// Those of a force sensor whose line and clock are sound.
    pub const OF_SENSORS: [Self; 4] = [Self::Repeat, Self::Block, Self::EndOfRange, Self::Jump];

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

    /// Every fault of every device, without `None`.
    pub fn every() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().chain(Self::OF_PICTURES).chain(Self::OF_SENSORS)
    }

    /// By its name.
    pub fn named(name: &str) -> Option<Self> {
        if name == "none" { Some(Self::None) } else { Self::every().find(|fault| fault.name() == name) }
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
        EmulatedFault::every().find(|fault| *fault as u32 == code).unwrap_or_default()
    }
}

/// How late a delayed frame leaves, s.
const DELAY_S: f64 = 0.050;

/// Frames on their way out of an emulator, as the fault in force lets them go.
#[derive(Debug)]
pub(super) struct FaultyLine {
    late: VecDeque<(f64, Peer, Vec<u8>)>,
    held: Option<(Peer, Vec<u8>)>,
    random: fastrand::Rng,
}

impl Default for FaultyLine {
    fn default() -> Self {
        Self { late: VecDeque::new(), held: None, random: fastrand::Rng::with_seed(0x11_fe) }
    }
}

impl FaultyLine {
    /// Takes a frame made at `now_s`; `send` gets what leaves now, in order.
    pub(super) fn pass(
        &mut self,
        now_s: f64,
        to: Peer,
        frame: &[u8],
        fault: EmulatedFault,
        send: &mut dyn FnMut(Peer, &[u8]),
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

    /// Lets go what was delayed until now.
    pub(super) fn let_late_ones_go(&mut self, now_s: f64, send: &mut dyn FnMut(Peer, &[u8])) {
        while let Some((_, to, frame)) = self.late.pop_front_if(|(due_s, ..)| *due_s <= now_s) {
            send(to, &frame);
        }
    }

    /// What was on its way when the line was cut arrives nowhere.
    pub(super) fn cut(&mut self) {
        self.late.clear();
        self.held = None;
    }
}
