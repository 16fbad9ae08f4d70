//! The words for training tasks: which there are, and what happens in a trial besides motion and force.

use serde::{Deserialize, Serialize};

use crate::Side;

/// What is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TaskKind {
    /// Motion and force alone: no objects are known, and no picture.
    Free,
    PegTransfer,
    Palpation,
    WireLoop,
}

/// An event of a trial and its time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Happening {
    /// Time, s, on the clock of the samples.
    pub t_s: f64,
    /// What happened.
    pub event: Event,
}

/// What can happen. Rings, pegs and lumps are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Event {
    /// The trial begins. Everything before it is forgotten.
    Begun,
    /// The task is done: this is the end of the measured time.
    Ended,
    /// The trial is given up.
    Aborted,
    /// An instrument closed on a ring that lay or was on a peg.
    RingGrasped { ring: usize, side: Side },
    /// The ring left its peg.
    RingLifted { ring: usize, side: Side },
    /// The ring went from one instrument to the other in mid-air.
    RingTransferred { ring: usize, to: Side },
    /// The ring is on a peg and was let go.
    RingPlaced { ring: usize, side: Side, peg: usize },
    /// The ring was lost: inside the picture, where it may be picked up again, or outside.
    RingDropped { ring: usize, side: Side, in_view: bool },
    /// A ring that nobody held was pushed off its peg; by an instrument, if known.
    RingKnockedOff { ring: usize, side: Option<Side> },
    /// The operator marked a place as a lump: this one, or none (a false mark).
    LumpMarked { side: Side, lump: Option<usize> },
    /// The loop held by this hand touches the wire.
    WireTouched { side: Side },
    /// The loop left the wire.
    WireLeft { side: Side },
}
