//! How a session is made: a cookie first, then a handshake of the Noise protocol with keys that both sides know.
//!
//! 1. The console says hello; the follower answers with a cookie that it can check later without having kept anything.
//! 2. The console sends the first message of Noise IK with the cookie; the follower answers with the second.
//!
//! A stranger costs the follower one hash per hello and nothing else; only who can receive at the address that he sends from makes it
//! compute a key agreement, and only a known key makes it keep anything. Both are limited per address and in all. Source:
//! The Noise Protocol Framework, revision 34; the cookie follows RFC 6347, 4.2.1.

mod cookie;
mod handshake;

use std::net::Ipv4Addr;

pub use cookie::Cookies;
pub(crate) use handshake::Agreed;
pub use handshake::{Approach, Heard, NOISE, Reception, Trouble};

use crate::{
    keys::{KeyError, Keys, Peers},
    wire::HANDSHAKE_MAX,
};

/// Both ends of a session between two machines that were made up, without a network.
pub(crate) fn both_ends() -> Result<[Agreed; 2], KeyError> {
    let console = Keys::random()?;
    let follower = Keys::random()?;
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
        let answer = reception.hear(&there[..len], from, 0.0, &mut back);
        let heard = approach.hear(&back[..answer.answer], 0.0, &mut there);
        len = heard.answer;
        if let (Some(ours), Some(theirs)) = (heard.agreed, answer.agreed) {
            return Ok([*ours, *theirs]);
        }
    }
    Err(KeyError::Random)
}

#[cfg(test)]
mod tests;
