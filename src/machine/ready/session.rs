//! Runs the list of checks, one after the other.

use super::{
    CheckSubject, PersonRequest, ReadyArm, ReadyCause, ReadyPoint, ReadyState,
    arms::Arms,
    bias::Bias,
    ceiling::ReadyCeiling,
    clocks::ReadyClocks,
    devices::ReadyDevices,
    handle::ReadyHandle,
    item::{Item, PointProgress},
    push::ReadyPush,
    rates::Rates,
    side_check::Own,
    stop::Stop,
    trocar::ReadyTrocar,
    watchdog::ReadyWatchdog,
};
use crate::{
    messages::{Command, Event, LoopState, Refusal, Tick},
    rig::{Gauges, Healths, Side},
};

/// A stop or a fault that is unrelated to a check must be released within this time, s, because the check cannot
/// continue before that, and a person may have to walk to the device first. Design choice.
const RELEASE_WITHIN_S: f64 = 60.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadyEntry {
    pub check: ReadyPoint,
    pub state: ReadyState,
}

/// The list of checks during a run. A failed check does not end the run.
#[derive(Debug)]
pub struct ReadySession {
    subject: CheckSubject,
    list: Vec<ReadyEntry>,
    arms: Arms,
    /// The running check, and its start, s.
    work: Option<(Box<dyn Item>, f64)>,
    /// Time since which a latched state that no check expects has lasted, s.
    latched_s: Option<f64>,
    /// Reason why the loop refused the last release.
    not_released: Option<Refusal>,
    began_s: Option<f64>,
    took_s: f64,
}

impl ReadySession {
    pub fn new(subject: CheckSubject) -> Self {
        let list = subject.list();
        let arms = Arms::of(&subject);
        Self { subject, list, arms, work: None, latched_s: None, not_released: None, began_s: None, took_s: 0.0 }
    }

    pub const fn subject(&self) -> &CheckSubject {
        &self.subject
    }

    pub fn list(&self) -> &[ReadyEntry] {
        &self.list
    }

    /// Returns the duration until now or until the end, s.
    pub const fn took_s(&self) -> f64 {
        self.took_s
    }

    fn place(&self) -> Option<usize> {
        self.list.iter().position(|entry| matches!(entry.state, ReadyState::Waiting | ReadyState::Asking(_)))
    }

    pub fn is_finished(&self) -> bool {
        self.place().is_none()
    }

    pub fn has_passed(&self) -> bool {
        self.is_finished() && !self.list.iter().any(|entry| matches!(entry.state, ReadyState::Failed(_)))
    }

    pub fn ask(&self) -> PersonRequest {
        match self.place().map(|place| self.list[place].state) {
            Some(ReadyState::Asking(ask)) => ask,
            _ => PersonRequest::Nothing,
        }
    }

    pub fn again(&mut self) {
        for entry in self.list.iter_mut().filter(|entry| matches!(entry.state, ReadyState::Failed(_))) {
            entry.state = ReadyState::Waiting;
        }
        self.work = None;
        self.latched_s = None;
        self.not_released = None;
    }

    pub fn tick(&mut self, tick: &Tick) {
        self.arms.tick(tick);
        if let Some((work, _)) = &mut self.work {
            work.tick(tick);
        }
    }

    pub fn gauges(&mut self, gauges: &Gauges) {
        if let Some((work, _)) = &mut self.work {
            work.gauges(gauges);
        }
    }

    pub fn healths(&mut self, healths: &Healths) {
        if let Some((work, _)) = &mut self.work {
            work.healths(healths);
        }
    }

    pub fn event(&mut self, event: &Event) {
        let Event::CommandRefused { command, why, .. } = event else { return };
        match (command, &mut self.work) {
            (Command::TestWatchdog(_), Some((work, _))) => work.refused(*why),
            // The other arm does not need to be released.
            (Command::ReleaseStop, _) if matches!(why, Refusal::State(_)) => {}
            (Command::ReleaseStop, _) => self.not_released = Some(*why),
            _ => {}
        }
    }

    /// Advances to time `now_s` (s, increasing); returns a command to send to the loop.
    pub fn look(&mut self, now_s: f64) -> Option<Command> {
        let place = self.place()?;
        let began_s = *self.began_s.get_or_insert(now_s - self.took_s);
        self.took_s = now_s - began_s;
        let check = self.list[place].check;
        let (mut work, mut since_s) = self.work.take().unwrap_or_else(|| (begun(check, &self.subject), now_s));
        let in_the_way = self.in_the_way(work.as_ref(), now_s);
        if in_the_way.is_some() {
            // The check's time limit does not include waiting.
            since_s = now_s;
        }
        let mut state = in_the_way.unwrap_or_else(|| match work.look(now_s) {
            PointProgress::Asking(ask) => ReadyState::Asking(ask),
            PointProgress::Passed(figure) => ReadyState::Passed(figure),
            PointProgress::Failed(cause) => ReadyState::Failed(cause),
        });
        let command = work.command();
        if matches!(state, ReadyState::Asking(_)) && now_s - since_s > work.patience_s() {
            state = ReadyState::Failed(work.late());
        }
        if matches!(state, ReadyState::Asking(_)) {
            self.work = Some((work, since_s));
        } else {
            let refusal = self.not_released.take();
            if let ReadyState::Failed(ReadyCause::NotReleased(why)) = &mut state {
                *why = refusal;
            }
            // The full time is available again, even after a pause before a repetition.
            self.began_s = self.began_s.filter(|_| !self.is_finished());
        }
        self.list[place].state = state;
        command
    }

    /// Returns the obstacle to the current check: an engaged arm, or a latched state that it does not expect.
    fn in_the_way(&mut self, work: &dyn Item, now_s: f64) -> Option<ReadyState> {
        let engaged = |state: LoopState| state.permits().drives;
        if let Some(tick) = self.arms.find(engaged) {
            return Some(ReadyState::Failed(ReadyCause::Engaged(tick.side)));
        }
        if work.expects_latch() || self.arms.find(LoopState::is_latched).is_none() {
            self.latched_s = None;
            return None;
        }
        let since_s = *self.latched_s.get_or_insert(now_s);
        let late = now_s - since_s > RELEASE_WITHIN_S;
        Some(if late {
            ReadyState::Failed(ReadyCause::NotReleased(None))
        } else {
            ReadyState::Asking(PersonRequest::Release)
        })
    }
}

fn begun(check: ReadyPoint, subject: &CheckSubject) -> Box<dyn Item> {
    let nobody = ReadyArm { at_wrist: false, gravity: None, has_person: false };
    let arm = |side: Side| subject.arms[side.index()].as_ref().unwrap_or(&nobody);
    match check {
        ReadyPoint::Devices => Box::new(ReadyDevices::of(subject)),
        ReadyPoint::Rates => Box::new(Rates::of(subject)),
        ReadyPoint::Clocks => Box::new(ReadyClocks::of(subject)),
        ReadyPoint::Own(side) => Box::new(Own::of(side, subject)),
        ReadyPoint::Bias(side) => Box::new(Bias::of(side, arm(side))),
        ReadyPoint::Push(side) => Box::new(ReadyPush::of(side, arm(side))),
        ReadyPoint::Handle(side) => Box::new(ReadyHandle::of(side, subject)),
        ReadyPoint::Trocar(side) => Box::new(ReadyTrocar::of(side, subject)),
        ReadyPoint::Ceiling => Box::new(ReadyCeiling::of(subject)),
        ReadyPoint::Stop => Box::new(Stop::of(subject)),
        ReadyPoint::Watchdog(which) => Box::new(ReadyWatchdog::of(which, subject)),
    }
}
