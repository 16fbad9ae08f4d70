//! What the demonstration does when the loop has ended the engagement by itself.
//!
//! It explains the cause, releases the latch, engages, and the chapter restarts: on a rig without any device only, where there is no
//! force in anybody's hand and nothing moves. Everywhere else a person does that. A stop is not a fault: a person wanted it, and only a
//! person ends it, also if it was pressed while a fault was latched.

use nima_core::safety::Why;
use nima_machine::messages::{Command, Fault, LoopState};

use super::pace::PAUSE_S;
use crate::{
    console::{live::Live, outbox::Outbox, text},
    words::Remedy as _,
};

/// Time in which the cause is explained, s: about 30 words, read at 4 words a second.
const EXPLAINED_S: f64 = 8.0;
/// What was refused, because the cause of a fault is still present, is tried again after this time, s.
const AGAIN_S: f64 = 2.0;
/// A stop reaches the loop, and its state the window, within this time, s; nobody releases a stop and engages faster.
const ARRIVES_S: f64 = 0.5;

/// Why the loop ended the engagement.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Trouble {
    Fault(Fault),
    /// The governor found nobody at the handle.
    HandGone,
    /// An engagement did not come about.
    Late,
}

impl Trouble {
    fn of(live: &Live) -> Option<Self> {
        match live.state() {
            LoopState::Faulted(fault) => Some(Self::Fault(live.first_fault().unwrap_or(fault))),
            LoopState::Idle => live.sides().find_map(|side| {
                live.tick_of(side).filter(|tick| tick.state == LoopState::Idle)?;
                match live.changes[side.index()]?.why {
                    Why::Absent => Some(Self::HandGone),
                    Why::Late => Some(Self::Late),
                    Why::Asked | Why::Connected | Why::Disconnected | Why::Agreed | Why::Clutch | Why::Fault => None,
                }
            }),
            LoopState::Disconnected
            | LoopState::Ready
            | LoopState::Engaged
            | LoopState::Clutched
            | LoopState::Stopped => None,
        }
    }
}

/// The way back from a trouble.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recovery {
    trouble: Trouble,
    /// Time for which it has been explained to a viewer, s; a pause between frames explains nothing.
    explained_s: f64,
    /// What the loop was asked for last, and when it is asked again, s of that time.
    asked: Option<(Command, f64)>,
}

impl Recovery {
    /// From the trouble of a loop, if there is one.
    pub(super) fn of(live: &Live) -> Option<Self> {
        Trouble::of(live).map(|trouble| Self { trouble, explained_s: 0.0, asked: None })
    }

    /// Goes on after this time, s.
    pub(super) fn step(&mut self, state: LoopState, passed_s: f64, outbox: &mut Outbox) {
        self.explained_s += passed_s.min(PAUSE_S);
        let command = if state.is_latched() { Command::ReleaseStop } else { Command::Engage };
        let waits = |(asked, again_s)| asked == command && self.explained_s < again_s;
        if self.explained_s >= EXPLAINED_S && !self.asked.is_some_and(waits) {
            self.asked = Some((command, self.explained_s + AGAIN_S));
            outbox.push(command);
        }
    }

    /// What happened, and what happens next.
    pub(super) fn words(&self) -> String {
        let left_s = (EXPLAINED_S - self.explained_s).ceil();
        match self.trouble {
            Trouble::Fault(fault) => text::roles::recovers_from_fault(fault.cause(), left_s),
            Trouble::HandGone => text::roles::recovers(text::roles::HAND_GONE.get(), left_s),
            Trouble::Late => text::roles::recovers(text::roles::NOT_ENGAGED_IN_TIME.get(), left_s),
        }
    }
}

/// Whether a person's stop is in effect.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PersonsStop {
    counted: Option<u64>,
    /// When it was pressed, s on the loop's clock.
    at_s: Option<f64>,
}

impl PersonsStop {
    /// Looks at what a person has asked for until this time, s.
    pub(super) fn notice(&mut self, live: &Live, now_s: f64, outbox: &Outbox) {
        let stops = outbox.stops();
        if self.counted.replace(stops).is_some_and(|before| before != stops) {
            self.at_s = Some(now_s);
        }
        // The loop tells of a stop in its state, but of one under a latched fault only the window knows. A person ends it by engaging again.
        let engaged_s = live.first_tick().filter(|_| live.state() == LoopState::Engaged);
        let engaged_s = engaged_s.and_then(|tick| live.changes[tick.side.index()]).map(|change| change.t_s);
        if let (Some(engaged_s), Some(at_s)) = (engaged_s, self.at_s)
            && engaged_s > at_s + ARRIVES_S
        {
            self.at_s = None;
        }
    }

    pub(super) const fn holds(&self) -> bool {
        self.at_s.is_some()
    }
}
