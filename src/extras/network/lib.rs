//! A stream of small messages between two machines, a console and a follower, over a real network: encrypted UDP datagrams in real time.
//!
//! The content is the caller's: a payload is bytes. [`endpoint::Endpoint`] is one end: it is driven by the thread of a
//! control loop and never blocks it. [`stream::NetworkStream`] is the same without socket and handshake, for a virtual clock.
//! [`impairment`] simulates an impaired line, for a study or, as a [`relay`], between two real ends.
//!
//! Design: `docs/network.md`. Figures: `docs/results/stream.md`.

pub mod clock;
pub mod control;
pub mod endpoint;
pub mod figures;
pub mod impairment;
pub mod keys;
pub mod pairing;
pub mod playout;
pub mod rate;
pub mod redundancy;
pub mod relay;
pub mod replay;
pub mod secure;
mod socket;
pub mod stream;
pub mod wire;
mod worker;
