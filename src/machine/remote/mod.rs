//! One rig at two places: the handle at the operator's machine, arm and sensors at the follower's, a network between them.
//!
//! Each machine runs the whole loop, interlock and gates included, over a rig of which one half is real and the other half is what
//! the network brings. [`FarFollower`] is the operator's rig: the handle here, tip and identified force from there. [`FarLeader`]
//! is the follower's: arm and sensor here; the hand is the commanded tip from there. Either machine stops both; neither resumes by
//! itself: an engagement and a release are counted at the operator's machine, and the follower's obeys a count that moved on, once.
//!
//! Times on the wire are those of the operator's loop. The follower returns with each answer the time of the command that was in
//! force, so that every age is a difference on one clock, and the rendering corrects over the whole way there and back.
//!
//! A [`Wire`] carries the messages; that of the crate `nima-network` is encrypted and evens out delay and loss.

mod far_follower;
mod far_hand;
mod far_leader;
mod follower_message;
mod leader_message;
mod packing;
#[cfg(test)]
mod tests;

pub use far_follower::FarFollower;
pub use far_leader::{FarLeader, at_follower};

use crate::{
    rig::{Ends, Rig},
    runtime::Assembly,
};

/// The assembly of a loop with one half of its rig at another machine: `here` is what is at this one. The loop of a follower is to be made
/// of [`at_follower`].
#[must_use]
pub fn joined(assembly: Assembly, wire: Box<dyn Wire>, here: Ends) -> Assembly {
    let Assembly { rig, rate_hz, .. } = assembly;
    let rig: Box<dyn Rig> = match here {
        Ends::Both => rig,
        Ends::Leader => Box::new(FarFollower::new(rig, wire, rate_hz)),
        Ends::Follower => Box::new(FarLeader::new(rig, wire, rate_hz)),
    };
    Assembly { rig, ..assembly }
}

/// Longest message, bytes.
pub const MESSAGE_MAX: usize = 1100;

/// Carries messages between two machines. An implementation neither waits nor allocates.
pub trait Wire: Send {
    /// Sends one message, which was made at `now_s` of this machine's loop.
    fn send(&mut self, now_s: f64, message: &[u8]);

    /// Calls `take` with each message whose time to be played out has come, oldest first.
    fn receive(&mut self, now_s: f64, take: &mut dyn FnMut(&[u8]));
}

impl<W: Wire + ?Sized> Wire for Box<W> {
    fn send(&mut self, now_s: f64, message: &[u8]) {
        (**self).send(now_s, message);
    }

    fn receive(&mut self, now_s: f64, take: &mut dyn FnMut(&[u8])) {
        (**self).receive(now_s, take);
    }
}

/// The other machine is gone when nothing has come for so long, s. The force is zero long before (the age gate), and a pair that is
/// driven has then failed with the link as its cause.
const GONE_AFTER_S: f64 = 0.5;
