//! The driver against the emulator, over pipes in memory and over pseudo-terminals.

mod faults;
mod opening;
mod servos;
mod terminal;
mod world;
