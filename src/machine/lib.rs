//! The control loop: its hardware interface, its real-time thread, and the messages between the loop and the screen.
//!
//!  module | content |
//! ---|---|
//!  `config` | rig files, and the reading of settings files |
//!  `rig` | the hardware interface of the loop, and its implementation with the devices of a rig file |
//!  `hand_over` | wait-free queues to and from the real-time thread |
//!  `messages` | commands in; ticks and events out |
//!  `remote` | the loop over a network: one half of the rig at each machine |
//!  `ready` | the ready check before the first engagement of the day |
//!  `teleop` | one tick of the whole loop for both arm pairs |
//!  `runtime` | the real-time thread, its supervisor, the virtual clock |
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod config;
pub mod hand_over;
pub mod messages;
pub mod ready;
pub mod remote;
pub mod rig;
pub mod runtime;
pub mod teleop;
mod texts;
