//! Every calibration on a simulated rig: accuracy compared with the truth, degenerate data, causes of mistakes,
//! sessions, records.

mod accuracy;
mod degenerate;
mod mistakes;
mod properties;
mod rig;
mod scenes;
mod session;
mod watch;
