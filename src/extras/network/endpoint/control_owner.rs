//! Control of a follower: one console at a time, and another console only with its consent.

use super::{Endpoint, SESSIONS};
use crate::{
    control::{ControlState, FromFollower},
    keys::PublicKey,
};

/// A console requests control from the controlling one.
#[derive(Clone, Copy, Debug)]
struct ControlQuestion {
    by: usize,
    /// Number of the request, 1 to 3, so that an answer to the previous request is not mistaken for an answer to this
    /// one.
    number: u8,
}

/// The open request.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OpenQuestion {
    question: Option<ControlQuestion>,
    last_number: u8,
}

impl OpenQuestion {
    /// Called when the session at this index has ended.
    pub(super) fn forget(&mut self, at: usize) {
        self.question = self.question.filter(|question| question.by != at);
    }
}

impl Endpoint {
    /// Returns the follower's byte for the console at this index.
    pub(super) fn report_to(&self, at: usize) -> FromFollower {
        let standing = match self.active {
            Some(holder) if holder == at => ControlState::Holds,
            Some(_) => ControlState::Waits,
            None => ControlState::Free,
        };
        let question = self.holding.question.filter(|_| standing == ControlState::Holds);
        FromFollower {
            standing,
            asked: question.map_or(0, |question| question.number),
            is_denied: self.sessions[at].as_ref().is_some_and(|session| session.is_denied),
            goodbye: false,
        }
    }

    /// Processes a datagram from the console at this index (follower only).
    pub(super) fn received_console(&mut self, at: usize) {
        let Some(session) = self.sessions[at].as_mut() else { return };
        let is_new = !session.is_confirmed;
        session.is_confirmed = true;
        let peer = session.peer;
        let said = session.from_console;
        if !said.asks {
            session.is_denied = false;
        }
        if said.goodbye {
            self.is_closed |= self.active == Some(at);
            self.end(at);
            return;
        }
        if is_new {
            self.welcome(at, &peer);
        }
        if self.active == Some(at) {
            self.received_s = Some(self.now_s);
        }
    }

    /// Called when a console has confirmed its session. It replaces an older session of the same console, unless that
    /// session has control and is alive: then two consoles have the same key, and the second one waits like any other.
    fn welcome(&mut self, at: usize, peer: &PublicKey) {
        let mut holds = self.active.is_none();
        for old in 0..SESSIONS {
            let is_same = self.sessions[old].as_ref().is_some_and(|s| s.is_confirmed && s.peer == *peer);
            if old == at || !is_same || self.active == Some(old) && !self.is_silent(old) {
                continue;
            }
            holds |= self.active == Some(old);
            self.end(old);
        }
        if holds {
            self.give_to(at);
        }
    }

    /// Gives control to the newest session of the same console once the controlling one is silent: the console has
    /// sought a new session because nothing arrived from this machine, and has left the old one.
    pub(super) fn replace_silent(&mut self) {
        let Some(old) = self.active.filter(|&old| self.is_silent(old)) else { return };
        let Some(peer) = self.sessions[old].as_ref().map(|session| session.peer) else { return };
        let newer = (0..SESSIONS).filter(|&at| at != old && !self.is_silent(at));
        let same = newer.filter(|&at| self.sessions[at].as_ref().is_some_and(|s| s.is_confirmed && s.peer == peer));
        let opened_s = |at: &usize| self.sessions[*at].as_ref().map_or(f64::MIN, |session| session.opened_s);
        if let Some(newest) = same.max_by(|a, b| opened_s(a).total_cmp(&opened_s(b))) {
            self.end(old);
            self.give_to(newest);
        }
    }

    /// Returns whether a session has been silent for so long that the arm is stopped.
    fn is_silent(&self, at: usize) -> bool {
        self.sessions[at].as_ref().is_none_or(|session| self.now_s - session.received_s > self.silent_after_s)
    }

    fn give_to(&mut self, at: usize) {
        self.active = Some(at);
        self.holding.question = None;
        self.is_closed = false;
        self.jumped = None;
        self.received_s = Some(self.now_s);
        if let Some(session) = self.sessions[at].as_mut() {
            session.stream.begin();
        }
    }

    /// Forwards requests and executes answers.
    pub(super) fn hand_over(&mut self) {
        let asks = |this: &Self, at: usize| {
            this.active != Some(at) && this.sessions[at].as_ref().is_some_and(|s| s.is_confirmed && s.from_console.asks)
        };
        let open = self.holding.question.filter(|question| asks(self, question.by));
        self.holding.question = open;
        let Some(holder) = self.active else {
            if let Some(first) = (0..SESSIONS).find(|&at| asks(self, at)) {
                self.give_to(first);
            }
            return;
        };
        let Some(question) = open else {
            let waits = |&at: &usize| asks(self, at) && self.sessions[at].as_ref().is_some_and(|s| !s.is_denied);
            if let Some(by) = (0..SESSIONS).find(waits) {
                self.holding.last_number = self.holding.last_number % 3 + 1;
                self.holding.question = Some(ControlQuestion { by, number: self.holding.last_number });
            }
            return;
        };
        let answer = self.sessions[holder].as_ref().map(|session| session.from_console);
        match answer.filter(|answer| answer.answers == question.number) {
            Some(answer) if answer.consents => self.give_to(question.by),
            Some(_) => {
                if let Some(session) = self.sessions[question.by].as_mut() {
                    session.is_denied = true;
                }
                self.holding.question = None;
            }
            None => {}
        }
    }
}
