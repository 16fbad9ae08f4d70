//! Tests a watchdog: its own fault is raised in time, without force, and a person releases it.

use super::{
    CheckSubject, FigureUnit, PersonRequest, ReadyCause, ReadyFigure,
    arms::Arms,
    item::{Item, PointProgress},
};
use crate::messages::{Command, ForceSource, LoopState, Refusal, Tick, Watchdog as Which};

/// Maximum time until the fault, s on the loop's clock, beyond the link's own delay: the longest limit of a watchdog is
/// 0.1 s, the rest is the command's path to the loop.
const BITES_WITHIN_S: f64 = 0.4;
/// If there is no fault after this time, the watchdog has not tripped, s: longer than [`BITES_WITHIN_S`] and the
/// largest delay of the link (1 s), so that a late fault is still told as late.
const GIVEN_UP_S: f64 = 2.5;

#[derive(Debug)]
pub(super) struct ReadyWatchdog {
    which: Which,
    arms: Arms,
    within_s: f64,
    /// Time at which the command was sent: on the session's clock, and on the loop's.
    sent: Option<(f64, f64)>,
    is_sent: bool,
    refused: Option<Refusal>,
    /// Time of the last arm's fault, s on the loop's clock.
    bitten_s: Option<f64>,
    cause: Option<ReadyCause>,
    /// Reason why an arm had no force to send during the test, and whether any had one.
    unknown: Option<ForceSource>,
    has_force: bool,
}

impl ReadyWatchdog {
    pub(super) fn of(which: Which, subject: &CheckSubject) -> Self {
        let within_s = BITES_WITHIN_S + subject.rig.delay_s;
        let arms = Arms::of(subject);
        Self {
            which,
            arms,
            within_s,
            sent: None,
            is_sent: false,
            refused: None,
            bitten_s: None,
            cause: None,
            unknown: None,
            has_force: false,
        }
    }

    /// Returns why there was no fault. A link without a force to send is always silent, so its silence raises none.
    fn no_bite(&self) -> ReadyCause {
        match self.unknown {
            Some(source) if self.which == Which::Link && !self.has_force => ReadyCause::ForceUnknown(source),
            _ => ReadyCause::NoBite(self.which),
        }
    }
}

impl Item for ReadyWatchdog {
    fn tick(&mut self, tick: &Tick) {
        self.arms.tick(tick);
        if !self.is_sent {
            return;
        }
        if tick.force.source.is_usable() {
            self.has_force = true;
        } else {
            self.unknown.get_or_insert(tick.force.source);
        }
        if tick.rendering.rendered_n.norm() > 0.0 {
            self.cause.get_or_insert(ReadyCause::Force { force_n: tick.rendering.rendered_n.norm() });
        }
        if let LoopState::Faulted(fault) = tick.state
            && !self.which.raises(fault)
        {
            self.cause.get_or_insert(ReadyCause::OtherFault(fault));
        }
        let own = |state| matches!(state, LoopState::Faulted(fault) if self.which.raises(fault));
        if self.arms.all(own) {
            self.bitten_s.get_or_insert(tick.t_s);
        }
    }

    fn refused(&mut self, why: Refusal) {
        self.refused = Some(why);
    }

    fn look(&mut self, now_s: f64) -> PointProgress {
        if let Some(why) = self.refused {
            return PointProgress::Failed(ReadyCause::Refused(why));
        }
        if let Some(cause) = self.cause {
            return PointProgress::Failed(cause);
        }
        let idle = self.arms.all(|state| state == LoopState::Idle);
        let Some((sent_s, sent_loop_s)) = self.sent else {
            if idle {
                self.sent = self.arms.now_s().map(|loop_s| (now_s, loop_s));
            }
            return PointProgress::Asking(PersonRequest::Nothing);
        };
        let Some(bitten_s) = self.bitten_s else {
            let late = now_s - sent_s > GIVEN_UP_S + self.within_s;
            return if late {
                PointProgress::Failed(self.no_bite())
            } else {
                PointProgress::Asking(PersonRequest::Nothing)
            };
        };
        let after_s = bitten_s - sent_loop_s;
        if after_s > self.within_s {
            return PointProgress::Failed(ReadyCause::LateBite { after_s });
        }
        if !idle {
            return PointProgress::Asking(PersonRequest::Release);
        }
        PointProgress::Passed(ReadyFigure { value: after_s, limit: self.within_s, unit: FigureUnit::Second })
    }

    fn late(&self) -> ReadyCause {
        if self.bitten_s.is_some() { ReadyCause::NotReleased(None) } else { self.no_bite() }
    }

    fn command(&mut self) -> Option<Command> {
        if self.sent.is_none() || self.is_sent {
            return None;
        }
        self.is_sent = true;
        Some(Command::TestWatchdog(self.which))
    }

    fn expects_latch(&self) -> bool {
        self.is_sent
    }
}
