//! One rig at two places: the handle at the operator's machine, arm and sensors at the follower's, and a network
//! between them.
//!
//! Each machine runs the whole loop, including interlock and gates, over a rig with one real half and one half that
//! arrives over the network. [`FarFollower`] is the operator's rig: the handle is local, tip and identified force are
//! remote. [`FarLeader`] is the follower's rig: arm and sensor are local, and the commanded tip replaces the hand. Each
//! machine stops both; neither resumes by itself. The operator's machine counts engagements and releases, and the
//! follower's machine carries out each increase of a count once.
//!
//! Times in messages belong to the clock of the operator's loop. With each answer the follower returns the time of its
//! active command, so that every age is a difference on one clock, and the rendering corrects over the whole round
//! trip.
//!
//! A [`RemoteWire`] carries the messages; the implementation in the crate `nima-network` encrypts them and compensates delay
//! and loss.

mod far_follower;
mod far_leader;
mod follower_message;
mod leader_message;
mod packing;
mod remote_hand;
#[cfg(test)]
mod tests;

pub use far_follower::FarFollower;
pub use far_leader::{FarLeader, at_follower};

use crate::{
    rig::{Rig, RigEnds},
    runtime::Assembly,
};

/// Returns the assembly of a loop with one half of its rig at another machine; `here` is the local half. Create the
/// loop of a follower from [`at_follower`].
#[must_use]
pub fn joined(assembly: Assembly, wire: Box<dyn RemoteWire>, here: RigEnds) -> Assembly {
    let Assembly { rig, rate_hz, .. } = assembly;
    let rig: Box<dyn Rig> = match here {
        RigEnds::Both => rig,
        RigEnds::Leader => Box::new(FarFollower::new(rig, wire, rate_hz)),
        RigEnds::Follower => Box::new(FarLeader::new(rig, wire, rate_hz)),
    };
    Assembly { rig, ..assembly }
}

/// Maximum length of a message, bytes: below the 1280 bytes that every IPv6 link carries unfragmented (RFC 8200).
pub const MESSAGE_MAX: usize = 1100;

/// Carries messages between two machines. An implementation neither waits nor allocates.
pub trait RemoteWire: Send {
    /// Sends one message, created at `now_s` of this machine's loop.
    fn send(&mut self, now_s: f64, message: &[u8]);

    /// Calls `take` with each message whose playout time has arrived, oldest first.
    fn receive(&mut self, now_s: f64, take: &mut dyn FnMut(&[u8]));
}

impl<W: RemoteWire + ?Sized> RemoteWire for Box<W> {
    fn send(&mut self, now_s: f64, message: &[u8]) {
        (**self).send(now_s, message);
    }

    fn receive(&mut self, now_s: f64, take: &mut dyn FnMut(&[u8])) {
        (**self).receive(now_s, take);
    }
}

/// The other machine counts as gone if no message has arrived for this long, s. The age gate removes the force long
/// before that, and an engaged pair has then failed with the link as its cause.
const GONE_AFTER_S: f64 = 0.5;
