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

pub use cookie::Cookies;
pub(crate) use handshake::Agreed;
pub use handshake::{Approach, Heard, NOISE, Reception, Trouble};

#[cfg(test)]
mod tests;
