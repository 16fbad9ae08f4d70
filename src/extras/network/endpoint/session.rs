//! One session at an endpoint: its stream, its other side, and the last state received from it.

use std::net::SocketAddr;

use crate::{
    control::{FromConsole, FromFollower},
    keys::PublicKey,
    secure::AgreedKeys,
    stream::{NetworkStream, StreamSettings},
};

#[derive(Debug)]
pub(super) struct NetworkSession {
    pub(super) stream: NetworkStream,
    pub(super) peer: PublicKey,
    /// Destination of its datagrams: the origin of the newest authentic one.
    pub(super) at: SocketAddr,
    /// Number here.
    pub(super) ours: u32,
    /// When the loop adopted it, s.
    pub(super) opened_s: f64,
    /// Arrival of the newest authentic datagram, s.
    pub(super) received_s: f64,
    /// When the last datagram was sent, s.
    pub(super) sent_s: f64,
    /// Whether an authentic datagram has arrived: the other side has the keys too.
    pub(super) is_confirmed: bool,
    /// The other side's control byte; the role determines which one.
    pub(super) from_console: FromConsole,
    pub(super) from_follower: FromFollower,
    /// Whether the controlling console has refused its request.
    pub(super) is_denied: bool,
}

impl NetworkSession {
    pub(super) fn new(agreed: AgreedKeys, at: SocketAddr, settings: &StreamSettings) -> Self {
        Self {
            stream: NetworkStream::new(agreed.keys, agreed.theirs, settings),
            peer: agreed.peer,
            at,
            ours: agreed.ours,
            opened_s: 0.0,
            received_s: 0.0,
            sent_s: f64::MIN,
            is_confirmed: false,
            from_console: FromConsole::default(),
            from_follower: FromFollower::default(),
            is_denied: false,
        }
    }
}
