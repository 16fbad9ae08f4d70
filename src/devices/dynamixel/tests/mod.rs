//! The protocol against known frames and arbitrary bytes.

mod messages;
mod packets;
