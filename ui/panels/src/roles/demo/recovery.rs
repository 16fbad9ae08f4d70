//! Recovery of the demonstration after the loop ended the engagement.
//!
//! It explains the cause, releases the latch, engages, and restarts the chapter, but only on a rig without any device, where
//! no hand feels a force and nothing moves. On every other rig a person does that. A stop is not a fault: a person requested
//! it, and only a person ends it, even if it was pressed while a fault was latched.

use nima_core::safety::TransitionCause;
use nima_machine::messages::{Command, Fault, LoopState};
use nima_screen::{live::LiveState, outbox::Outbox};
use nima_words::{report_text::Remedy as _, text};

use super::chapter_time::PAUSE_S;

/// Time in which the cause is explained, s: about 30 words, read at 4 words per second.
const EXPLAINED_S: f64 = 8.0;
/// A command refused because the cause of a fault is still present is repeated after this time, s.
const AGAIN_S: f64 = 2.0;
/// A stop reaches the loop, and its state the window, within this time, s; a person cannot release a stop and engage faster.
const ARRIVES_S: f64 = 0.5;

/// Reason why the loop ended the engagement.
#[derive(Clone, Copy, Debug, PartialEq)]
enum EngagementEnd {
    Fault(Fault),
    /// The governor found no hand at the handle.
    HandGone,
    /// An engagement did not finish in time.
    Late,
}

impl EngagementEnd {
    fn of(live: &LiveState) -> Option<Self> {
        match live.state() {
            LoopState::Faulted(fault) => Some(Self::Fault(live.first_fault().unwrap_or(fault))),
            LoopState::Idle => live.sides().find_map(|side| {
                live.tick_of(side).filter(|tick| tick.state == LoopState::Idle)?;
                match live.changes[side.index()]?.why {
                    TransitionCause::Absent => Some(Self::HandGone),
                    TransitionCause::Late => Some(Self::Late),
                    TransitionCause::Asked
                    | TransitionCause::Connected
                    | TransitionCause::Disconnected
                    | TransitionCause::Agreed
                    | TransitionCause::Clutch
                    | TransitionCause::Fault => None,
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

/// Recovery from the end of an engagement.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recovery {
    trouble: EngagementEnd,
    /// Time for which the cause has been explained to a viewer, s; a pause between frames does not count.
    explained_s: f64,
    /// Last requested command, and the time of its next repetition, s.
    asked: Option<(Command, f64)>,
}

impl Recovery {
    /// `None` if the loop has no problem.
    pub(super) fn of(live: &LiveState) -> Option<Self> {
        EngagementEnd::of(live).map(|trouble| Self { trouble, explained_s: 0.0, asked: None })
    }

    /// Continues after this time, s.
    pub(super) fn step(&mut self, state: LoopState, passed_s: f64, outbox: &mut Outbox) {
        self.explained_s += passed_s.min(PAUSE_S);
        let command = if state.is_latched() { Command::ReleaseStop } else { Command::Engage };
        let waits = |(asked, again_s)| asked == command && self.explained_s < again_s;
        if self.explained_s >= EXPLAINED_S && !self.asked.is_some_and(waits) {
            self.asked = Some((command, self.explained_s + AGAIN_S));
            outbox.push(command);
        }
    }

    /// Returns the text about the cause and the next step.
    pub(super) fn words(&self) -> String {
        let left_s = (EXPLAINED_S - self.explained_s).ceil();
        match self.trouble {
            EngagementEnd::Fault(fault) => text::roles::recovers_from_fault(fault.cause(), left_s),
            EngagementEnd::HandGone => text::roles::recovers(text::roles::HAND_GONE.get(), left_s),
            EngagementEnd::Late => text::roles::recovers(text::roles::NOT_ENGAGED_IN_TIME.get(), left_s),
        }
    }
}

/// Whether a person's stop is in effect.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PersonsStop {
    counted: Option<u64>,
    /// Time at which the stop was pressed, s on the loop's clock.
    at_s: Option<f64>,
}

impl PersonsStop {
    /// Checks the person's commands up to this time, s.
    pub(super) fn notice(&mut self, live: &LiveState, now_s: f64, outbox: &Outbox) {
        let stops = outbox.stops();
        if self.counted.replace(stops).is_some_and(|before| before != stops) {
            self.at_s = Some(now_s);
        }
        // The loop reports a stop only in its state, but the window also stops while a fault is latched. A person ends
        // the stop by engaging again.
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
