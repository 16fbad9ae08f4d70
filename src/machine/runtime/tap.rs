//! A tap in the loop: all that enters the loop, in the order in which it enters, and all that comes out of it.
//!
//! With what the loop was made of ([`Origin`](crate::teleop::Origin)) this is all that it depends on, so that a session
//! can be replayed to the bit. The loop's end of the tap neither waits nor allocates: ticks are copied into boxes that go
//! round between both ends. What finds no room is dropped; entries are numbered, so that the other end sees the hole.

use std::{
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use crossbeam_channel::{Receiver, Sender, TryRecvError, bounded, unbounded};

use crate::{
    messages::{Command, Event, Tick},
    rig::{DeviceEvent, Inputs, Outputs, SIDES, Side},
    teleop::{Calibrations, Timing},
};

/// Ticks for which there is room between the loop and what reads the tap; 2 s at 1 kHz.
pub const TICKS_TAPPED_MAX: usize = 2048;
/// Room for operations and events beside the ticks.
const OTHERS_MAX: usize = 512;
/// How often the other end looks for entries: what watches a loop over a network is told of a tick that much later at most.
const LOOK_EVERY: Duration = Duration::from_millis(3);

/// What is done to the loop between two ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operation {
    /// [`Loop::obey`](crate::teleop::Loop::obey).
    Command {
        /// The command.
        command: Command,
        /// Loop time that is handed in with it, s.
        t_s: f64,
    },
    /// [`Loop::notice`](crate::teleop::Loop::notice).
    Device(DeviceEvent),
    /// [`Loop::suspend_calibrations`](crate::teleop::Loop::suspend_calibrations).
    Suspend(Side),
    /// [`Loop::exchange_force_path`](crate::teleop::Loop::exchange_force_path), with a path made of these calibrations. The
    /// loop refuses it while the drives of the side are on.
    Calibrations {
        /// Its side.
        side: Side,
        /// Number of the calibrations, which [`TapEnd::calibrations`] has.
        number: u64,
    },
    /// [`Loop::notice_stall`](crate::teleop::Loop::notice_stall).
    Stall {
        /// How long the loop was silent, s.
        silent_s: f64,
        /// Loop time, s.
        t_s: f64,
    },
}

/// One tick: what [`Loop::step`](crate::teleop::Loop::step) was given, and what it returned.
#[derive(Clone, Debug)]
pub struct Stepped {
    /// The times that were handed in.
    pub timing: Timing,
    /// The measurements of each side.
    pub inputs: [Option<Inputs>; SIDES],
    /// The commands to each side.
    pub outputs: [Outputs; SIDES],
    /// All that each side shows of the tick.
    pub ticks: [Option<Tick>; SIDES],
}

impl Stepped {
    const NOTHING: Self = Self {
        timing: Timing { now_s: 0.0, wake_s: 0.0, work_s: 0.0, sample_to_force_s: None, missed_now: 0 },
        inputs: [None; SIDES],
        outputs: [Outputs::SAFE; SIDES],
        ticks: [None; SIDES],
    };
}

/// What passed the tap.
#[derive(Debug)]
pub enum Passed {
    /// Something was done to the loop.
    Operation(Operation),
    /// The loop told this in the tick that follows.
    Event(Event),
    /// The loop was stepped. To be given back by [`TapEnd::give_back`].
    Stepped(Box<Stepped>),
}

/// An entry, numbered from 0 without holes as long as nothing is dropped.
#[derive(Debug)]
pub struct Entry {
    /// Its number.
    pub number: u64,
    /// What passed.
    pub passed: Passed,
}

/// The loop's end of the tap.
#[derive(Debug)]
pub struct Tap {
    entries: Sender<Entry>,
    spare: Receiver<Box<Stepped>>,
    /// Boxes that have not been needed yet. Those that go round are taken first: they are still in the processor's caches.
    reserve: Vec<Box<Stepped>>,
    /// A box whose entry found no room: it is kept, because freeing it here would be a call of the allocator.
    kept: Option<Box<Stepped>>,
    offered: Arc<AtomicU64>,
    waits: bool,
    filing: Filing,
}

/// What hands over the calibrations that threads beside the loop prepare for it.
#[derive(Clone, Debug)]
pub(super) struct Filing {
    next: Arc<AtomicU64>,
    calibrations: Sender<(u64, Calibrations)>,
}

/// The other end of the tap.
#[derive(Debug)]
pub struct TapEnd {
    /// What passed, oldest first.
    pub entries: Receiver<Entry>,
    calibrations: Receiver<(u64, Calibrations)>,
    spare: Sender<Box<Stepped>>,
    offered: Arc<AtomicU64>,
}

/// Both ends of a tap. All memory is allocated, and touched, here.
pub fn tap() -> (Tap, TapEnd) {
    let (entries, entries_out) = bounded(TICKS_TAPPED_MAX + OTHERS_MAX);
    // The loop may hold one more box.
    let (spare, spare_out) = bounded(TICKS_TAPPED_MAX + 1);
    let reserve = (0..TICKS_TAPPED_MAX).map(|_| Box::new(Stepped::NOTHING)).collect();
    touch(&entries, &entries_out);
    let offered = Arc::<AtomicU64>::default();
    let (file, filed) = unbounded();
    let filing = Filing { next: Arc::default(), calibrations: file };
    let tap =
        Tap { entries, spare: spare_out, reserve, kept: None, offered: Arc::clone(&offered), waits: false, filing };
    (tap, TapEnd { entries: entries_out, calibrations: filed, spare, offered })
}

/// Writes once to every place of the queue, so that no tick meets a page that is not there yet.
fn touch(into: &Sender<Entry>, out: &Receiver<Entry>) {
    let nothing = || Operation::Suspend(Side::Right);
    while into.try_send(Entry { number: 0, passed: Passed::Operation(nothing()) }).is_ok() {}
    out.try_iter().for_each(drop);
}

impl Tap {
    /// From now on the loop waits while there is no room: for the virtual clock, on which nothing is late.
    #[must_use]
    pub(super) fn waiting(self) -> Self {
        Self { waits: true, ..self }
    }

    pub(super) fn filing(&self) -> Filing {
        self.filing.clone()
    }

    /// Tells of an operation.
    pub(super) fn operation(&mut self, operation: Operation) {
        self.offer(Passed::Operation(operation));
    }

    /// Tells of one tick and of the events in it.
    pub fn tick<'a>(
        &mut self,
        events: impl Iterator<Item = &'a Event>,
        timing: &Timing,
        inputs: &[Option<Inputs>; SIDES],
        outputs: &[Outputs; SIDES],
        ticks: &[Option<Tick>; SIDES],
    ) {
        for event in events {
            self.offer(Passed::Event(*event));
        }
        let Some(mut stepped) = self.spare() else {
            // Dropped: the number is used up.
            self.number();
            return;
        };
        stepped.timing = *timing;
        stepped.inputs = *inputs;
        stepped.outputs = *outputs;
        stepped.ticks = *ticks;
        self.offer(Passed::Stepped(stepped));
    }

    fn spare(&mut self) -> Option<Box<Stepped>> {
        let spare = self.kept.take().or_else(|| self.spare.try_recv().ok()).or_else(|| self.reserve.pop());
        spare.or_else(|| if self.waits { self.spare.recv().ok() } else { None })
    }

    fn number(&self) -> u64 {
        // Only this thread counts.
        self.offered.fetch_add(1, Ordering::Release)
    }

    fn offer(&mut self, passed: Passed) {
        let entry = Entry { number: self.number(), passed };
        let back = if self.waits {
            self.entries.send(entry).err().map(|error| error.0)
        } else {
            self.entries.try_send(entry).err().map(crossbeam_channel::TrySendError::into_inner)
        };
        if let Some(Entry { passed: Passed::Stepped(stepped), .. }) = back {
            self.kept = Some(stepped);
        }
    }
}

impl Filing {
    /// Hands these calibrations over; returns their number.
    pub(super) fn file(&self, calibrations: &Calibrations) -> u64 {
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        // Fails only when nobody reads the tap any more.
        self.calibrations.send((number, calibrations.clone())).ok();
        number
    }
}

/// What comes out of a tap.
#[derive(Debug)]
pub enum Next {
    /// An entry.
    Entry(Entry),
    /// The loop rests.
    Nothing,
    /// The loop has ended.
    End,
}

impl TapEnd {
    /// The next entry; nothing if none comes for this time.
    ///
    /// Looks for it now and then. A thread that slept until one comes would have to be woken by the loop, which costs a tick more
    /// than all the rest of the tap.
    pub fn next(&self, patience: Duration) -> Next {
        let begin = Instant::now();
        loop {
            match self.entries.try_recv() {
                Ok(entry) => return Next::Entry(entry),
                Err(TryRecvError::Disconnected) => return Next::End,
                Err(TryRecvError::Empty) if begin.elapsed() >= patience => return Next::Nothing,
                Err(TryRecvError::Empty) => thread::sleep(LOOK_EVERY),
            }
        }
    }

    /// Gives a tick's box back to the loop.
    pub fn give_back(&self, stepped: Box<Stepped>) {
        self.spare.try_send(stepped).ok();
    }

    /// Calibrations that were handed over since the last call, with their numbers. Those that an operation names are there
    /// before it.
    pub fn calibrations(&self) -> impl Iterator<Item = (u64, Calibrations)> {
        self.calibrations.try_iter()
    }

    /// Entries that the loop has offered so far, with those that were dropped.
    pub fn offered(&self) -> u64 {
        self.offered.load(Ordering::Acquire)
    }
}
