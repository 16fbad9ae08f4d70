//! Vocabulary of the training tasks: the kinds of tasks, and the events of a trial other than motion and force.

use serde::{Deserialize, Serialize};

use crate::Side;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TaskKind {
    /// Only motion and force: no known objects, no camera image.
    Free,
    PegTransfer,
    Palpation,
    WireLoop,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimedTaskEvent {
    /// Time, s, on the clock of the samples.
    pub t_s: f64,
    pub event: TaskEvent,
}

/// Events of a trial. Rings, pegs and lumps are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TaskEvent {
    /// The trial starts. Everything before it is discarded.
    Begun,
    /// The task is complete: this is the end of the measured time.
    Ended,
    /// The trial is given up.
    Aborted,
    /// An instrument closed on a ring that lay on the board or was on a peg.
    RingGrasped {
        ring: usize,
        side: Side,
    },
    /// The ring left its peg.
    RingLifted {
        ring: usize,
        side: Side,
    },
    /// The ring passed from one instrument to the other in mid-air.
    RingTransferred {
        ring: usize,
        to: Side,
    },
    /// The ring was released on a peg.
    RingPlaced {
        ring: usize,
        side: Side,
        peg: usize,
    },
    /// The ring was dropped: inside the camera's view, where it may be picked up again, or outside, where it is lost.
    RingDropped {
        ring: usize,
        side: Side,
        in_view: bool,
    },
    /// A ring that no instrument held was pushed off its peg; by this instrument, if known.
    RingKnockedOff {
        ring: usize,
        side: Option<Side>,
    },
    /// The operator marked a point as a lump: this lump, or none for a false mark.
    LumpMarked {
        side: Side,
        lump: Option<usize>,
    },
    /// The loop held by this hand touches the wire.
    WireTouched {
        side: Side,
    },
    WireLeft {
        side: Side,
    },
}
