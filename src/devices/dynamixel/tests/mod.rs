//! The wire against golden frames and arbitrary bytes.

mod messages;
mod packets;
