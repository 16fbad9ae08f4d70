//! Set-up of a session: first a cookie, then a handshake of the Noise protocol with keys that both sides already have.
//!
//! 1. The console says hello; the follower answers with a cookie that it can check later without having stored
//!    anything.
//! 2. The console sends the first message of Noise IK with the cookie; the follower answers with the second.
//!
//! A stranger costs the follower only one hash per hello. Only a sender that can receive at its address makes the
//! follower compute a key agreement, and only a known key makes it store anything. Both are limited per address and in
//! total. Source: The Noise Protocol Framework, revision 34; the cookie follows RFC 6347, 4.2.1.

mod cookie;
mod handshake;

use std::net::Ipv4Addr;

pub(crate) use cookie::COOKIE_LEN;
pub use cookie::Cookies;
pub(crate) use handshake::AgreedKeys;
pub use handshake::{Approach, HandshakeError, HandshakeResult, NOISE, Reception};

use crate::{
    keys::{KeyError, NetworkKeys, Peers},
    wire::HANDSHAKE_MAX,
};

/// Creates both ends of a session between two fictitious machines, without a network.
pub(crate) fn both_ends() -> Result<[AgreedKeys; 2], KeyError> {
    let console = NetworkKeys::random()?;
    let follower = NetworkKeys::random()?;
    let mut consoles = Peers::default();
    consoles.add("console", console.public())?;
    let from = (Ipv4Addr::LOCALHOST, 1).into();
    let mut reception = Reception::new(follower.clone(), consoles, 0.0)?;
    let mut approach = Approach::new(console, follower.public())?;
    let mut there = [0; HANDSHAKE_MAX];
    let mut back = [0; HANDSHAKE_MAX];
    let mut len = approach.due(0.0, &mut there);
    // Two round trips.
    for _ in 0..2 {
        let answer = reception.receive(&there[..len], from, 0.0, &mut back);
        let received = approach.receive(&back[..answer.answer], 0.0, &mut there);
        len = received.answer;
        if let (Some(ours), Some(theirs)) = (received.agreed, answer.agreed) {
            return Ok([*ours, *theirs]);
        }
    }
    Err(KeyError::Random)
}

#[cfg(test)]
mod tests;
