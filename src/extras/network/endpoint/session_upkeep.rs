//! Maintenance of an endpoint's sessions: adopts new ones, keeps them alive, and ends them.

use std::sync::atomic::Ordering::Relaxed;

use super::{
    ALIVE_S, ALIVE_WAITING_S, CONFIRM_S, CONSOLES_MAX, Endpoint, SEEK_AFTER_S, SESSIONS, config::ControlRequest,
    handshake_thread::HandshakeEvent, session::NetworkSession,
};
use crate::{
    control::{FromConsole, FromFollower},
    stream::SendResult,
};

impl Endpoint {
    pub(super) fn take_news(&mut self) {
        for _ in 0..SESSIONS {
            match self.clerk.news() {
                Some(HandshakeEvent::Opened(session)) => self.opened(session),
                Some(HandshakeEvent::Refused(refusal)) => self.refused = Some((self.now_s, refusal)),
                None => return,
            }
        }
    }

    /// Adopts a session after its handshake. A console uses it from now on, a follower once it is confirmed.
    fn opened(&mut self, mut session: Box<NetworkSession>) {
        session.opened_s = self.now_s;
        session.received_s = self.now_s;
        if !self.is_follower {
            if self.session().is_some_and(|old| self.now_s - old.received_s < SEEK_AFTER_S) {
                // The old session has recovered in the meantime and continues.
                drop(self.clerk.free(session));
                return;
            }
            if let Some(old) = self.active {
                self.end(old);
            }
            self.refused = None;
            self.is_closed = false;
            self.answer = None;
            if self.wish == ControlRequest::AsksAgain {
                self.wish = ControlRequest::Asks;
            }
        }
        let free = self.sessions.iter().position(Option::is_none);
        let unconfirmed = |session: &Option<Box<NetworkSession>>| session.as_ref().is_some_and(|s| !s.is_confirmed);
        match free.or_else(|| self.sessions.iter().position(unconfirmed)) {
            Some(at) => {
                self.end(at);
                if self.sessions[at].is_none() {
                    self.sessions[at] = Some(session);
                    if !self.is_follower {
                        self.active = Some(at);
                    }
                }
            }
            // The thread frees it; if the thread is behind, free it here, which only costs time.
            None => drop(self.clerk.free(session)),
        }
    }

    /// Ends a session; its memory is returned to the thread.
    pub(super) fn end(&mut self, at: usize) {
        if self.active == Some(at) {
            self.last_figures = self.figures();
            self.active = None;
        }
        self.holding.forget(at);
        if let Some(session) = self.sessions[at].take() {
            self.sessions[at] = self.clerk.free(session);
        }
    }

    pub(super) fn look_after_sessions(&mut self) {
        for at in 0..SESSIONS {
            let Some(session) = self.sessions[at].as_ref() else { continue };
            let silent_s = self.now_s - session.received_s;
            let is_over = if !self.is_follower {
                self.active != Some(at)
            } else if session.is_confirmed {
                silent_s > self.forget_after_s
            } else {
                self.now_s - session.opened_s > CONFIRM_S
            };
            if is_over {
                self.end(at);
            }
        }
        if self.is_follower {
            self.replace_silent();
            self.hand_over();
            let connected = self.sessions.iter().flatten().filter(|session| session.is_confirmed).count();
            self.clerk.shared.is_full.store(connected >= CONSOLES_MAX, Relaxed);
        }
    }

    pub(super) fn keep_alive(&mut self) {
        for at in 0..SESSIONS {
            let Some(session) = self.sessions[at].as_ref() else { continue };
            let pause_s = if self.active == Some(at) && self.carries() { ALIVE_S } else { ALIVE_WAITING_S };
            // A follower sends nothing in a session that its console has not confirmed.
            if (session.is_confirmed || !self.is_follower) && self.now_s - session.sent_s >= pause_s {
                self.send_to(at, self.now_s, None);
            }
        }
    }

    pub(super) fn send_to(&mut self, at: usize, now_s: f64, payload: Option<&[u8]>) -> SendResult {
        self.send_with(at, now_s, payload, false)
    }

    pub(super) fn send_with(&mut self, at: usize, now_s: f64, payload: Option<&[u8]>, goodbye: bool) -> SendResult {
        let control = self.control_byte(at, goodbye);
        let Some(session) = self.sessions[at].as_mut() else { return SendResult::Held };
        let sent = session.stream.send(now_s, payload, control, &mut self.out);
        if let SendResult::Datagram(len) = sent {
            session.sent_s = now_s;
            if !self.socket.send(&self.out[..len], session.at) {
                self.dropped.unsent += 1;
            }
        }
        sent
    }

    fn control_byte(&self, at: usize, goodbye: bool) -> u8 {
        if self.is_follower {
            return FromFollower { goodbye, ..self.report_to(at) }.byte();
        }
        let (answers, consents) = self.answer.unwrap_or_default();
        FromConsole { asks: self.wish == ControlRequest::Asks, answers, consents, goodbye }.byte()
    }
}
