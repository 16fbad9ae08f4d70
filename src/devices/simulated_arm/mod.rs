//! An arm without hardware: the joints of a Gen3 follow their commands with a lag of the first order. No wire, no emulator.
//!
//! For trying a handle and a sensor before the arm is there. Commands are checked as those of the real arm are
//! ([`Guard`](crate::kinova::limits::Guard)); it obeys one tick after it was asked to. Angles in rad. Time is handed in with every poll.

mod driver;
mod settings;

pub use driver::Driver;
pub use settings::Settings;
