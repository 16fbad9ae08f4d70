//! Notifications of the base to its subscribers.

use nima_devices::kinova::{
    frame::{KinovaHeader, NOTIFICATION},
    messages::Rpc,
};
use prost::Message;

use super::interface::{ENTITY_NOT_FOUND, InterfaceError, NO_MORE_STORAGE};
use crate::emulators::WirePeer;

const SUBSCRIPTIONS: usize = 64;

struct Subscription {
    identifier: u16,
    topic: Rpc,
    session: u16,
    link: WirePeer,
}

/// One notification to be sent.
pub(super) struct Notice {
    pub(super) link: WirePeer,
    pub(super) header: KinovaHeader,
    pub(super) payload: Vec<u8>,
}

#[derive(Default)]
pub(super) struct KinovaTopics {
    given: u16,
    subscriptions: Vec<Subscription>,
    waiting: Vec<Notice>,
}

impl KinovaTopics {
    /// Returns the number that notifications of this subscription carry.
    pub(super) fn subscribe(&mut self, topic: Rpc, session: u16, link: WirePeer) -> Result<u16, InterfaceError> {
        if self.subscriptions.len() >= SUBSCRIPTIONS {
            return Err(NO_MORE_STORAGE);
        }
        self.given = self.given.checked_add(1).unwrap_or(1);
        self.subscriptions.push(Subscription { identifier: self.given, topic, session, link });
        Ok(self.given)
    }

    /// Only the session that subscribed may unsubscribe.
    pub(super) fn unsubscribe(&mut self, identifier: u32, session: u16) -> Result<(), InterfaceError> {
        let own = |one: &Subscription| u32::from(one.identifier) == identifier && one.session == session;
        let at = self.subscriptions.iter().position(own).ok_or(ENTITY_NOT_FOUND)?;
        self.subscriptions.remove(at);
        Ok(())
    }

    /// Removes the subscriptions of closed sessions.
    pub(super) fn keep(&mut self, is_open: impl Fn(u16) -> bool) {
        self.subscriptions.retain(|one| is_open(one.session));
    }

    pub(super) fn report(&mut self, topic: Rpc, message: &impl Message) {
        for one in self.subscriptions.iter().filter(|one| one.topic == topic) {
            let Rpc { service, function } = topic;
            let header = KinovaHeader {
                kind: NOTIFICATION,
                session: one.session,
                message: one.identifier,
                service,
                function,
                ..KinovaHeader::default()
            };
            self.waiting.push(Notice { link: one.link, header, payload: message.encode_to_vec() });
        }
    }

    pub(super) fn take(&mut self) -> Vec<Notice> {
        std::mem::take(&mut self.waiting)
    }
}
