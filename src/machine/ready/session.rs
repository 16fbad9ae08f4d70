//! The list, one point after the other.

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

/// A stop or a fault that has nothing to do with a point is to be released within this time, s.
const RELEASE_WITHIN_S: f64 = 60.0;

/// A point of the list and where it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    pub check: Check,
    pub state: State,
}

/// The list while it is gone through. A point that failed does not end it: the others are looked at too.
#[derive(Debug)]
pub struct Session {
    subject: Subject,
    list: Vec<Entry>,
    arms: Arms,
    /// The point that is looked at, and since when, s.
    work: Option<(Box<dyn Item>, f64)>,
    /// Since when something is latched that no point expects, s.
    latched_s: Option<f64>,
    /// Why the loop refused the last release.
    not_released: Option<Refusal>,
    began_s: Option<f64>,
    took_s: f64,
}

impl Session {
    /// The whole list for this rig.
    pub fn new(subject: Subject) -> Self {
        let list = subject.list();
        let arms = Arms::of(&subject);
        Self { subject, list, arms, work: None, latched_s: None, not_released: None, began_s: None, took_s: 0.0 }
    }

    /// What is checked.
    pub const fn subject(&self) -> &Subject {
        &self.subject
    }

    /// Every point, in order.
    pub fn list(&self) -> &[Entry] {
        &self.list
    }

    /// Time that it has taken until now or until its end, s.
    pub const fn took_s(&self) -> f64 {
        self.took_s
    }

    fn place(&self) -> Option<usize> {
        self.list.iter().position(|entry| matches!(entry.state, State::Waiting | State::Asking(_)))
    }

    /// Whether every point has its result.
    pub fn is_finished(&self) -> bool {
        self.place().is_none()
    }

    /// Whether it is finished and nothing failed.
    pub fn has_passed(&self) -> bool {
        self.is_finished() && !self.list.iter().any(|entry| matches!(entry.state, State::Failed(_)))
    }

    /// What is needed of a person now.
    pub fn ask(&self) -> Ask {
        match self.place().map(|place| self.list[place].state) {
            Some(State::Asking(ask)) => ask,
            _ => Ask::Nothing,
        }
    }

    /// Looks again at every point that failed.
    pub fn again(&mut self) {
        for entry in self.list.iter_mut().filter(|entry| matches!(entry.state, State::Failed(_))) {
            entry.state = State::Waiting;
        }
        self.work = None;
        self.latched_s = None;
        self.not_released = None;
    }

    /// Adds one tick of any side.
    pub fn tick(&mut self, tick: &Tick) {
        self.arms.tick(tick);
        if let Some((work, _)) = &mut self.work {
            work.tick(tick);
        }
    }

    /// Adds what the devices have delivered.
    pub fn gauges(&mut self, gauges: &Gauges) {
        if let Some((work, _)) = &mut self.work {
            work.gauges(gauges);
        }
    }

    /// Adds the health of the devices.
    pub fn healths(&mut self, healths: &Healths) {
        if let Some((work, _)) = &mut self.work {
            work.healths(healths);
        }
    }

    /// Adds an event of the loop.
    pub fn event(&mut self, event: &Event) {
        let Event::CommandRefused { command, why, .. } = event else { return };
        match (command, &mut self.work) {
            (Command::TestWatchdog(_), Some((work, _))) => work.refused(*why),
            // The other arm needs none.
            (Command::ReleaseStop, _) if matches!(why, Refusal::State(_)) => {}
            (Command::ReleaseStop, _) => self.not_released = Some(*why),
            _ => {}
        }
    }

    /// Goes on at time `now_s` (s, rising); returns a command to be sent to the loop.
    pub fn look(&mut self, now_s: f64) -> Option<Command> {
        let place = self.place()?;
        let began_s = *self.began_s.get_or_insert(now_s - self.took_s);
        self.took_s = now_s - began_s;
        let check = self.list[place].check;
        let (mut work, mut since_s) = self.work.take().unwrap_or_else(|| (begun(check, &self.subject), now_s));
        let in_the_way = self.in_the_way(work.as_ref(), now_s);
        if in_the_way.is_some() {
            // What is waited for costs the point no time.
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
            // Everybody has the same time again, also after a pause before a second look.
            self.began_s = self.began_s.filter(|_| !self.is_finished());
        }
        self.list[place].state = state;
        command
    }

    /// What keeps a point from being looked at: an arm that was engaged, or something latched that it does not expect.
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
