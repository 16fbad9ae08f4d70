//! The protocol with known frames and arbitrary bytes.

mod messages;
mod opening;
mod packets;
