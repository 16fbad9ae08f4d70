//! A tap in the loop: all inputs of the loop in order, and all outputs.
//!
//! Together with the loop's [`LoopOrigin`](crate::teleop::LoopOrigin) this is everything on which the loop depends, so that a
//! session can be replayed to the bit. The loop's end of the tap neither waits nor allocates: ticks are copied into
//! boxes that circulate between both ends. Entries that find no room are dropped; entries are numbered, so that the
//! other end detects the gap.

use std::{
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
        mpsc::{Receiver, Sender, channel},
    },
    thread,
    time::{Duration, Instant},
};

use rtrb::{Consumer, Producer, PushError};

use super::os;
use crate::{
    hand_over::{FromLoop, ToLoop, from_loop, to_loop},
    messages::{Command, Event, Tick},
    rig::{DeviceEvent, Inputs, Outputs, SIDES, Side},
    teleop::{Calibrations, Timing},
};

/// Capacity in ticks between the loop and the reader of the tap; 2 s at 1 kHz. A disk that pauses for longer loses
/// ticks, because the loop must never wait for it.
pub const TICKS_TAPPED_MAX: usize = 2048;
/// Additional capacity for operations and events.
const OTHERS_MAX: usize = 512;
/// Polling period of the other end: a viewer over a network gets a tick later by this time at most. Polled, because
/// waking a waiting thread would cost the loop more than the rest of the tap.
const LOOK_EVERY: Duration = Duration::from_millis(3);
/// Time after which a loop on the virtual clock looks again for room.
const WAIT: Duration = Duration::from_micros(200);

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operation {
    /// [`Loop::obey`](crate::teleop::Loop::obey).
    Command {
        command: Command,
        /// Loop time of the command, s.
        t_s: f64,
    },
    /// [`Loop::notice`](crate::teleop::Loop::notice).
    Device(DeviceEvent),
    /// [`Loop::suspend_calibrations`](crate::teleop::Loop::suspend_calibrations).
    Suspend(Side),
    /// [`Loop::exchange_force_path`](crate::teleop::Loop::exchange_force_path), with a path created from these
    /// calibrations. The loop refuses it while the drives of the side are on.
    Calibrations {
        side: Side,
        /// Number of the calibrations in [`TapEnd::calibrations`].
        number: u64,
    },
    /// [`Loop::notice_stall`](crate::teleop::Loop::notice_stall).
    Stall { silent_s: f64, t_s: f64 },
}

#[derive(Clone, Debug)]
pub struct TickRecord {
    pub timing: Timing,
    pub inputs: [Option<Inputs>; SIDES],
    pub outputs: [Outputs; SIDES],
    pub ticks: [Option<Tick>; SIDES],
}

impl TickRecord {
    const NOTHING: Self = Self {
        timing: Timing { now_s: 0.0, wake_s: 0.0, work_s: 0.0, sample_to_force_s: None, missed_now: 0 },
        inputs: [None; SIDES],
        outputs: [Outputs::SAFE; SIDES],
        ticks: [None; SIDES],
    };
}

#[derive(Debug)]
pub enum TapPayload {
    Operation(Operation),
    /// An event that the loop reported in the following tick.
    Event(Event),
    /// A tick of the loop. Return it with [`TapEnd::give_back`].
    Stepped(Box<TickRecord>),
}

/// An entry, numbered from 0 without gaps as long as nothing is dropped.
#[derive(Debug)]
pub struct TapEntry {
    pub number: u64,
    pub passed: TapPayload,
}

#[derive(Debug)]
pub struct Tap {
    entries: Producer<TapEntry>,
    spare: Consumer<Box<TickRecord>>,
    /// Boxes that have not been used yet. Circulating boxes are taken first, because they are still in the processor's
    /// caches.
    reserve: Vec<Box<TickRecord>>,
    /// A box whose entry did not fit: it is kept, because freeing it here would call the allocator.
    kept: Option<Box<TickRecord>>,
    offered: Arc<AtomicU64>,
    /// Start of the loop on the monotonic clock, ns; zero before it, and on a virtual clock.
    begun_ns: Arc<AtomicU64>,
    waits: bool,
    filing: CalibrationFiler,
}

/// Passes on the calibrations that other threads prepare for the loop.
#[derive(Clone, Debug)]
pub(super) struct CalibrationFiler {
    next: Arc<AtomicU64>,
    calibrations: Sender<(u64, Calibrations)>,
}

#[derive(Debug)]
pub struct TapEnd {
    pub entries: FromLoop<TapEntry>,
    calibrations: Receiver<(u64, Calibrations)>,
    spare: ToLoop<Box<TickRecord>>,
    offered: Arc<AtomicU64>,
    begun_ns: Arc<AtomicU64>,
}

/// Creates both ends of a tap. All memory is allocated and touched here.
pub fn tap() -> (Tap, TapEnd) {
    let (mut entries, entries_out) = from_loop(TICKS_TAPPED_MAX + OTHERS_MAX);
    // One more than in the queue, because the loop may hold one.
    let (spare, spare_out) = to_loop(TICKS_TAPPED_MAX + 1);
    let reserve = (0..TICKS_TAPPED_MAX).map(|_| Box::new(TickRecord::NOTHING)).collect();
    touch(&mut entries, &entries_out);
    let [offered, begun_ns] = [(); 2].map(|()| Arc::<AtomicU64>::default());
    let (file, filed) = channel();
    let filing = CalibrationFiler { next: Arc::default(), calibrations: file };
    let tap = Tap {
        entries,
        spare: spare_out,
        reserve,
        kept: None,
        offered: Arc::clone(&offered),
        begun_ns: Arc::clone(&begun_ns),
        waits: false,
        filing,
    };
    (tap, TapEnd { entries: entries_out, calibrations: filed, spare, offered, begun_ns })
}

/// Writes once to every slot of the queue, so that no tick causes a page fault.
fn touch(into: &mut Producer<TapEntry>, out: &FromLoop<TapEntry>) {
    let nothing = || Operation::Suspend(Side::Right);
    while into.push(TapEntry { number: 0, passed: TapPayload::Operation(nothing()) }).is_ok() {}
    out.try_iter().for_each(drop);
}

impl Tap {
    /// Creates the loop wait while there is no room; for the virtual clock, on which a wait makes nothing late.
    #[must_use]
    pub(super) fn waiting(self) -> Self {
        Self { waits: true, ..self }
    }

    /// Called before the first tick of a loop in real time, with the start of its clock.
    pub(super) fn begin(&self, start_ns: u64) {
        self.begun_ns.store(start_ns, Ordering::Release);
    }

    pub(super) fn filing(&self) -> CalibrationFiler {
        self.filing.clone()
    }

    pub(super) fn operation(&mut self, operation: Operation) {
        self.offer(TapPayload::Operation(operation));
    }

    pub fn tick<'a>(
        &mut self,
        events: impl Iterator<Item = &'a Event>,
        timing: &Timing,
        inputs: &[Option<Inputs>; SIDES],
        outputs: &[Outputs; SIDES],
        ticks: &[Option<Tick>; SIDES],
    ) {
        for event in events {
            self.offer(TapPayload::Event(*event));
        }
        let Some(mut stepped) = self.spare() else {
            // Skip the number of the dropped tick, so that the reader notices the gap.
            self.number();
            return;
        };
        stepped.timing = *timing;
        stepped.inputs = *inputs;
        stepped.outputs = *outputs;
        stepped.ticks = *ticks;
        self.offer(TapPayload::Stepped(stepped));
    }

    fn spare(&mut self) -> Option<Box<TickRecord>> {
        loop {
            let spare = self.kept.take().or_else(|| self.spare.pop().ok()).or_else(|| self.reserve.pop());
            if spare.is_some() || !self.waits || self.spare.is_abandoned() {
                return spare;
            }
            thread::sleep(WAIT);
        }
    }

    fn number(&self) -> u64 {
        // Only this thread increments it.
        self.offered.fetch_add(1, Ordering::Release)
    }

    fn offer(&mut self, passed: TapPayload) {
        let number = self.number();
        let mut entry = TapEntry { number, passed };
        while let Err(PushError::Full(back)) = self.entries.push(entry) {
            if !self.waits || self.entries.is_abandoned() {
                if let TapPayload::Stepped(stepped) = back.passed {
                    self.kept = Some(stepped);
                }
                return;
            }
            thread::sleep(WAIT);
            entry = back;
        }
    }
}

impl CalibrationFiler {
    /// Passes on these calibrations; returns their number.
    pub(super) fn file(&self, calibrations: &Calibrations) -> u64 {
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        // Fails only if the reader of the tap was dropped.
        self.calibrations.send((number, calibrations.clone())).ok();
        number
    }
}

#[derive(Debug)]
pub enum TapItem {
    Entry(TapEntry),
    Nothing,
    End,
}

impl TapEnd {
    /// Returns the next entry, or nothing if none arrives within this time.
    ///
    /// Polls now and then. A thread that slept until the next entry would have to be woken by the loop, which costs a
    /// tick more than all the rest of the tap.
    pub fn next(&self, patience: Duration) -> TapItem {
        let begin = Instant::now();
        loop {
            match self.entries.try_recv() {
                Some(entry) => return TapItem::Entry(entry),
                None if self.entries.has_ended() => return TapItem::End,
                None if begin.elapsed() >= patience => return TapItem::Nothing,
                None => thread::sleep(LOOK_EVERY),
            }
        }
    }

    pub fn give_back(&self, stepped: Box<TickRecord>) {
        self.spare.try_send(stepped).ok();
    }

    /// Returns the calibrations passed on since the last call, with their numbers. Calibrations to which an operation
    /// refers arrive before it.
    pub fn calibrations(&self) -> impl Iterator<Item = (u64, Calibrations)> {
        self.calibrations.try_iter()
    }

    /// Returns the time 0 of the loop, ns since 1970 (UTC), as the two clocks relate now: the system's clock may have been
    /// set in the meantime. `None` before the loop has started, and on a virtual clock.
    pub fn utc_start_ns(&self) -> Option<u64> {
        match self.begun_ns.load(Ordering::Acquire) {
            0 => None,
            begun_ns => begun_ns.checked_add_signed(os::utc_offset_ns()?),
        }
    }

    /// Returns the number of entries that the loop has offered so far, including dropped ones.
    pub fn offered(&self) -> u64 {
        self.offered.load(Ordering::Acquire)
    }
}
