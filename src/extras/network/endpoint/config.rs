//! Settings of an endpoint, and its status.

use std::{io, net::SocketAddr};

use crate::{
    control::LinkCause,
    keys::{KeyError, NetworkKeys, Peers, PublicKey},
    stream::StreamSettings,
};

/// The end of the link.
#[derive(Clone, Debug)]
pub enum EndpointRole {
    /// The end with the arm.
    Follower {
        /// Address; by default [`PORT`](super::PORT) of loopback, which other machines cannot reach.
        at: Option<SocketAddr>,
        /// The consoles that it admits; one that is paired later is admitted when the endpoint is reopened.
        consoles: Peers,
    },
    /// The end with the handle.
    Console {
        /// The follower's address.
        follower: SocketAddr,
        key: PublicKey,
    },
}

/// Settings of an endpoint.
#[derive(Clone, Debug)]
pub struct EndpointConfig {
    pub role: EndpointRole,
    pub keys: NetworkKeys,
    pub stream: StreamSettings,
    /// Time without a datagram after which the link is silent, s.
    pub silent_after_s: f64,
    /// A follower removes a console that has been silent for this long, s, and is then free for others.
    pub forget_after_s: f64,
}

impl EndpointConfig {
    /// Creates the default settings.
    pub fn new(role: EndpointRole, keys: NetworkKeys) -> Self {
        Self { role, keys, stream: StreamSettings::default(), silent_after_s: 0.1, forget_after_s: 5.0 }
    }
}

/// Why an endpoint cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The address cannot be used.
    #[error("cannot use the UDP address {address}: {source}; end the other nima, or use an address of this machine")]
    Address { address: SocketAddr, source: io::Error },
    #[error("cannot start a thread: {0}; end other programs, then try again")]
    Thread(io::Error),
    #[error(transparent)]
    Keys(#[from] KeyError),
}

/// Status of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinkState {
    /// The other side has not connected yet.
    Waiting,
    /// Payloads pass.
    Open,
    /// Payloads do not pass, or only imperfectly.
    Down(LinkCause),
}

/// Result of sending a payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SendOutcome {
    /// It was sent.
    Sent,
    /// It is sent with the next datagram, because the rate limit leaves no room.
    Held,
    /// There is no other side, or another console has control of the follower.
    NotOpen,
    /// It exceeds the maximum of the settings.
    TooLong,
}

/// Role of a console in the control of the follower.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlRole {
    /// Not connected.
    None,
    /// The console has control of the follower.
    Holds,
    /// The console has control of the follower, and another console requests it:
    /// [`Endpoint::answer`](super::Endpoint::answer).
    HoldsAsked,
    /// Another console, or none, has control.
    Waits,
    /// The console waits for an answer.
    Asks,
    /// The controlling console has refused. It may ask again.
    Denied,
}

/// A console's request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ControlRequest {
    /// None.
    None,
    /// Control of the follower.
    Asks,
    /// Control of the follower, while the follower still reports the earlier denial.
    AsksAgain,
    /// The request of the console was denied.
    Denied,
}
