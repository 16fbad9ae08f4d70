//! Processing of received datagrams at an endpoint.

use super::{Endpoint, RECEIVE_MAX, config::ControlRequest, session::NetworkSession};
use crate::{
    control::{ControlState, FromConsole, FromFollower},
    socket::DatagramArrival,
    stream::DropCause,
    wire::{self, DATAGRAM_MAX, DatagramKind, Unreadable},
};

impl Endpoint {
    pub(super) fn receive(&mut self) {
        let before = self.dropped().total();
        for _ in 0..RECEIVE_MAX {
            let Some(arrival) = self.socket.receive(&mut self.buffer) else { return };
            self.take(arrival);
        }
        if self.dropped().total() - before > RECEIVE_MAX as u64 / 2 {
            self.flooded_s = Some(self.now_s);
        }
    }

    fn take(&mut self, arrival: DatagramArrival) {
        let Some(datagram) = self.buffer.get(..arrival.len).filter(|datagram| datagram.len() <= DATAGRAM_MAX) else {
            self.dropped.malformed += 1;
            return;
        };
        match wire::kind(datagram) {
            Ok(DatagramKind::Data) => self.take_data(arrival),
            Ok(DatagramKind::Pairing) | Err(Unreadable::Malformed) => self.dropped.malformed += 1,
            Err(Unreadable::ForeignData(_)) => self.dropped.foreign_version += 1,
            // The thread answers a foreign version.
            Ok(_) | Err(Unreadable::ForeignVersion(_)) => {
                if !self.clerk.give(datagram, arrival.from) {
                    self.dropped.flooded += 1;
                }
            }
        }
    }

    fn take_data(&mut self, arrival: DatagramArrival) {
        let datagram = &self.buffer[..arrival.len];
        let number = wire::open_outer(datagram).map(|(session, ..)| session);
        let is_it = |session: &Option<Box<NetworkSession>>| session.as_ref().is_some_and(|s| Some(s.ours) == number);
        let Some(at) = self.sessions.iter().position(is_it) else {
            self.dropped.unknown_session += 1;
            return;
        };
        let Some(session) = self.sessions[at].as_mut() else { return };
        let accepted = match session.stream.receive(datagram, arrival.came_s(self.now_s, self.looked)) {
            Ok(accepted) => accepted,
            Err(cause) => {
                *match cause {
                    DropCause::Forged => &mut self.dropped.forged,
                    DropCause::Replayed => &mut self.dropped.replayed,
                    DropCause::Old => &mut self.dropped.old,
                    DropCause::Malformed => &mut self.dropped.malformed,
                } += 1;
                return;
            }
        };
        if let Some(step) = accepted.step.filter(|_| self.active == Some(at)) {
            self.jumped = Some((self.now_s, step.by_s));
        }
        if !accepted.is_newest {
            return;
        }
        session.received_s = self.now_s;
        session.at = arrival.from;
        if self.is_follower {
            if let Some(control) = accepted.control {
                session.from_console = FromConsole::from_byte(control);
            }
            self.received_console(at);
        } else {
            let before = session.from_follower.standing;
            if let Some(control) = accepted.control {
                session.from_follower = FromFollower::from_byte(control);
            }
            session.is_confirmed = true;
            if matches!(before, ControlState::Waits | ControlState::Free)
                && session.from_follower.standing == ControlState::Holds
            {
                session.stream.begin();
            }
            self.received_follower(at);
        }
    }

    /// Processes the follower's byte at a console.
    fn received_follower(&mut self, at: usize) {
        let Some(said) = self.sessions[at].as_ref().map(|session| session.from_follower) else { return };
        self.received_s = Some(self.now_s);
        if said.goodbye {
            self.is_closed = true;
            self.end(at);
            return;
        }
        if said.asked == 0 || self.answer.is_some_and(|(number, _)| number != said.asked) {
            self.answer = None;
        }
        self.wish = match self.wish {
            _ if said.standing == ControlState::Holds => ControlRequest::None,
            ControlRequest::Asks if said.is_denied => ControlRequest::Denied,
            ControlRequest::AsksAgain if !said.is_denied => ControlRequest::Asks,
            wish => wish,
        };
    }
}
