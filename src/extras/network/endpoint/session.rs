//! One session at an endpoint: its stream, its other side, and what that side last said.

use std::net::SocketAddr;

use crate::{
    control::{FromConsole, FromFollower},
    keys::PublicKey,
    secure::Agreed,
    stream::{Stream, StreamSettings},
};

/// A session.
#[derive(Debug)]
pub(super) struct Session {
    pub(super) stream: Stream,
    pub(super) peer: PublicKey,
    /// Where its datagrams go: where the newest authentic one came from.
    pub(super) at: SocketAddr,
    /// Its number here.
    pub(super) ours: u32,
    /// When it was taken over by the loop, s.
    pub(super) opened_s: f64,
    /// When the newest authentic datagram came, s.
    pub(super) heard_s: f64,
    /// When the last datagram was sent, s.
    pub(super) sent_s: f64,
    /// An authentic datagram has come: the other side has the keys too.
    pub(super) is_confirmed: bool,
    /// The other side's byte of control; which one, the role says.
    pub(super) from_console: FromConsole,
    pub(super) from_follower: FromFollower,
    /// The holder has refused its question.
    pub(super) is_denied: bool,
}

impl Session {
    pub(super) fn new(agreed: Agreed, at: SocketAddr, settings: &StreamSettings) -> Self {
        Self {
            stream: Stream::new(agreed.keys, agreed.theirs, settings),
            peer: agreed.peer,
            at,
            ours: agreed.ours,
            opened_s: 0.0,
            heard_s: 0.0,
            sent_s: f64::MIN,
            is_confirmed: false,
            from_console: FromConsole::default(),
            from_follower: FromFollower::default(),
            is_denied: false,
        }
    }
}
