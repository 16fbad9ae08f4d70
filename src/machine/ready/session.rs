//! Runs the list of checks, one after the other.

use super::{
    Arm, Ask, Cause, Check, State, Subject,
    arms::Arms,
    bias::Bias,
    ceiling::Ceiling,
    clocks::Clocks,
    devices::Devices,
    handle::Handle,
    item::{Item, Progress},
    own::Own,
    push::Push,
    rates::Rates,
    stop::Stop,
    trocar::Trocar,
    watchdog::Watchdog,
};
use crate::{
    messages::{Command, Event, LoopState, Refusal, Tick},
    rig::{Gauges, Healths, Side},
};

/// A stop or a fault that is unrelated to a check must be released within this time, s, because the check cannot go on
/// before, and a person may have to go to the device first. Chosen.
const RELEASE_WITHIN_S: f64 = 60.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    pub check: Check,
    pub state: State,
}

/// The list during its run. A failed check does not end the run: the others follow.
#[derive(Debug)]
pub struct Session {
    subject: Subject,
    list: Vec<Entry>,
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

impl Session {
    pub fn new(subject: Subject) -> Self {
        let list = subject.list();
        let arms = Arms::of(&subject);
        Self { subject, list, arms, work: None, latched_s: None, not_released: None, began_s: None, took_s: 0.0 }
    }

    pub const fn subject(&self) -> &Subject {
        &self.subject
    }

    pub fn list(&self) -> &[Entry] {
        &self.list
    }

    /// Returns the duration until now or until the end, s.
    pub const fn took_s(&self) -> f64 {
        self.took_s
    }

    fn place(&self) -> Option<usize> {
        self.list.iter().position(|entry| matches!(entry.state, State::Waiting | State::Asking(_)))
    }

    pub fn is_finished(&self) -> bool {
        self.place().is_none()
    }

    pub fn has_passed(&self) -> bool {
        self.is_finished() && !self.list.iter().any(|entry| matches!(entry.state, State::Failed(_)))
    }

    pub fn ask(&self) -> Ask {
        match self.place().map(|place| self.list[place].state) {
            Some(State::Asking(ask)) => ask,
            _ => Ask::Nothing,
        }
    }

    pub fn again(&mut self) {
        for entry in self.list.iter_mut().filter(|entry| matches!(entry.state, State::Failed(_))) {
            entry.state = State::Waiting;
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
            // The other arm does not need the release.
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
            // Waiting does not count against the check's time.
            since_s = now_s;
        }
        let mut state = in_the_way.unwrap_or_else(|| match work.look(now_s) {
            Progress::Asking(ask) => State::Asking(ask),
            Progress::Passed(figure) => State::Passed(figure),
            Progress::Failed(cause) => State::Failed(cause),
        });
        let command = work.command();
        if matches!(state, State::Asking(_)) && now_s - since_s > work.patience_s() {
            state = State::Failed(work.late());
        }
        if matches!(state, State::Asking(_)) {
            self.work = Some((work, since_s));
        } else {
            let refusal = self.not_released.take();
            if let State::Failed(Cause::NotReleased(why)) = &mut state {
                *why = refusal;
            }
            // The full time is available again, also after a pause before a repetition.
            self.began_s = self.began_s.filter(|_| !self.is_finished());
        }
        self.list[place].state = state;
        command
    }

    /// Returns the obstacle to the current check: an engaged arm, or a latched state that it does not expect.
    fn in_the_way(&mut self, work: &dyn Item, now_s: f64) -> Option<State> {
        let engaged = |state: LoopState| state.permits().drives;
        if let Some(tick) = self.arms.find(engaged) {
            return Some(State::Failed(Cause::Engaged(tick.side)));
        }
        if work.expects_latch() || self.arms.find(LoopState::is_latched).is_none() {
            self.latched_s = None;
            return None;
        }
        let since_s = *self.latched_s.get_or_insert(now_s);
        let late = now_s - since_s > RELEASE_WITHIN_S;
        Some(if late { State::Failed(Cause::NotReleased(None)) } else { State::Asking(Ask::Release) })
    }
}

fn begun(check: Check, subject: &Subject) -> Box<dyn Item> {
    let nobody = Arm { at_wrist: false, gravity: None, has_person: false };
    let arm = |side: Side| subject.arms[side.index()].as_ref().unwrap_or(&nobody);
    match check {
        Check::Devices => Box::new(Devices::of(subject)),
        Check::Rates => Box::new(Rates::of(subject)),
        Check::Clocks => Box::new(Clocks::of(subject)),
        Check::Own(side) => Box::new(Own::of(side, subject)),
        Check::Bias(side) => Box::new(Bias::of(side, arm(side))),
        Check::Push(side) => Box::new(Push::of(side, arm(side))),
        Check::Handle(side) => Box::new(Handle::of(side, subject)),
        Check::Trocar(side) => Box::new(Trocar::of(side, subject)),
        Check::Ceiling => Box::new(Ceiling::of(subject)),
        Check::Stop => Box::new(Stop::of(subject)),
        Check::Watchdog(which) => Box::new(Watchdog::of(which, subject)),
    }
}
