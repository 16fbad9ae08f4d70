//! Every calibration on a simulated rig: accuracy against the truth, degenerate data, mistakes by their cause, sessions,
//! records.

mod accuracy;
mod degenerate;
mod mistakes;
mod properties;
mod rig;
mod scenes;
mod session;
mod watch;
