//! What an endpoint is made with, and what it tells.

use std::{io, net::SocketAddr};

use crate::{
    control::Cause,
    keys::{KeyError, Keys, Peers, PublicKey},
    stream::StreamSettings,
};

/// Which end it is.
#[derive(Clone, Debug)]
pub enum Role {
    /// The end with the arm.
    Follower {
        /// Where it listens; `None` for [`PORT`](super::PORT) of loopback, so that nobody outside can reach it.
        at: Option<SocketAddr>,
        /// The consoles that it admits; one that is paired later is admitted when the endpoint is opened anew.
        consoles: Peers,
    },
    /// The end with the handle.
    Console {
        /// Where the follower listens.
        follower: SocketAddr,
        /// The follower's key.
        key: PublicKey,
    },
}

/// What an endpoint is made with.
#[derive(Clone, Debug)]
pub struct Config {
    /// Which end.
    pub role: Role,
    /// The key of this machine.
    pub keys: Keys,
    /// The stream.
    pub stream: StreamSettings,
    /// Without a datagram for this long the link is silent, s.
    pub silent_after_s: f64,
    /// A follower forgets a console that is silent for this long, s; it is then free for others.
    pub forget_after_s: f64,
}

impl Config {
    /// With the usual settings.
    pub fn new(role: Role, keys: Keys) -> Self {
        Self { role, keys, stream: StreamSettings::default(), silent_after_s: 0.1, forget_after_s: 5.0 }
    }
}

/// Why an endpoint cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The address cannot be used.
    #[error(
        "cannot use the UDP address {address}: {source}; is another nima running, or is it another machine's address?"
    )]
    Address {
        /// The address.
        address: SocketAddr,
        /// Why.
        source: io::Error,
    },
    /// No thread can be started.
    #[error("cannot start a thread: {0}")]
    Thread(io::Error),
    /// Keys.
    #[error(transparent)]
    Keys(#[from] KeyError),
}

/// What a link is now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinkState {
    /// Nobody has been there yet.
    Waiting,
    /// Payloads pass.
    Open,
    /// They do not, or not as they should.
    Down(Cause),
}

/// What came of sending a payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It is under way.
    Sent,
    /// It goes with the next datagram: the rate's limit leaves no room.
    Held,
    /// There is nobody to send it to, or another console holds the follower.
    NotOpen,
    /// It is longer than the settings allow.
    TooLong,
}

/// A console's part in who holds the follower.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// Not connected.
    None,
    /// It holds the follower.
    Holds,
    /// It holds the follower, and another console asks for control: [`Endpoint::answer`](super::Endpoint::answer).
    HoldsAsked,
    /// Another console, or nobody, holds it.
    Waits,
    /// It waits for an answer.
    Asks,
    /// The holder has refused. It may ask again.
    Denied,
}

/// What a console wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wish {
    /// Nothing.
    None,
    /// Control of the follower.
    Asks,
    /// The same, while the follower still tells of its denial before.
    AsksAgain,
    /// It was denied.
    Denied,
}
