//! One rig at two places: the handle at the operator's machine, arm and sensors at the follower's, and a network
//! between them.
//!
//! Each machine runs the whole loop, including interlock and gates, over a rig with one real half and one half that
//! arrives over the network. [`OperatorRig`] has the handle; tip and identified force are remote. [`FollowerRig`] has
//! arm and sensor, and the commanded tip replaces the hand. Each machine stops both; neither resumes by itself. The
//! operator's machine counts engagements and releases, and the follower's machine carries out each increase of a count
//! once.
//!
//! Times in messages belong to the clock of the operator's loop. With each answer the follower returns the time of its
//! active command, so that every age is a difference on one clock, and the rendering corrects over the whole round
//! trip.
//!
//! A [`RemoteWire`] carries the messages; the implementation in the crate `nima-network` encrypts them and compensates delay
//! and loss.

mod commanded_hand;
mod follower_message;
mod follower_there;
mod leader_message;
mod leader_there;
mod packing;
#[cfg(test)]
mod tests;

use follower_there::FollowerThere;
use leader_there::LeaderThere;
pub use leader_there::at_follower;

use crate::{
    messages::{Command, PeerStatus},
    rig::{Inputs, Outputs, Rig, RigEnds, SIDES, devices_of},
    runtime::Assembly,
};

/// Returns the assembly of a loop with one half of its rig at another machine; `here` is the local half. Create the
/// loop of a follower from [`at_follower`].
#[must_use]
pub fn joined(assembly: Assembly, wire: Box<dyn RemoteWire>, here: RigEnds) -> Assembly {
    let Assembly { rig, rate_hz, .. } = assembly;
    let rig: Box<dyn Rig> = match here {
        RigEnds::Both => rig,
        RigEnds::Leader => Box::new(OperatorRig::new(rig, wire, rate_hz)),
        RigEnds::Follower => Box::new(FollowerRig::new(rig, wire, rate_hz)),
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

/// Rig of the operator's machine: the handles of `R` with arms behind the wire `W`. Measurements of arms and sensors
/// here are not used.
pub type OperatorRig<R, W> = JoinedRig<R, W, FollowerThere>;
/// Rig of the follower's machine: the arms of `R` with hands behind the wire `W`. Measurements of handles here are not
/// used, and the handles get no force. Create its loop from [`at_follower`].
pub type FollowerRig<R, W> = JoinedRig<R, W, LeaderThere>;

/// A rig with one half on this machine; `H` is the other half, at another machine.
#[derive(Debug)]
pub struct JoinedRig<R, W, H> {
    local: R,
    wire: W,
    there: H,
    /// Last measurements of the rig here.
    measured: [Option<Inputs>; SIDES],
    buffer: [u8; MESSAGE_MAX],
}

impl<R, W> OperatorRig<R, W> {
    /// Creates the rig for a loop of this rate (Hz).
    pub fn new(local: R, wire: W, rate_hz: f64) -> Self {
        Self::with(local, wire, FollowerThere::new(rate_hz))
    }
}

impl<R, W> FollowerRig<R, W> {
    /// Creates the rig for a loop of this rate (Hz).
    pub fn new(local: R, wire: W, rate_hz: f64) -> Self {
        Self::with(local, wire, LeaderThere::new(rate_hz))
    }
}

impl<R, W, H> JoinedRig<R, W, H> {
    const fn with(local: R, wire: W, there: H) -> Self {
        Self { local, wire, there, measured: [None; SIDES], buffer: [0; MESSAGE_MAX] }
    }

    /// Returns the last measurements of the rig here, without the other half.
    pub const fn measured(&self) -> &[Option<Inputs>; SIDES] {
        &self.measured
    }

    pub const fn local(&self) -> &R {
        &self.local
    }

    pub const fn local_mut(&mut self) -> &mut R {
        &mut self.local
    }

    pub const fn wire(&self) -> &W {
        &self.wire
    }

    pub const fn wire_mut(&mut self) -> &mut W {
        &mut self.wire
    }
}

/// The half of a rig at another machine, as known from its messages.
trait HalfThere: Send {
    fn receive(&mut self, now_s: f64, wire: &mut dyn RemoteWire);

    /// Returns the measurements of both halves; `here`: those of the half here.
    fn join(&mut self, here: &[Option<Inputs>; SIDES], now_s: f64) -> [Option<Inputs>; SIDES];

    /// Returns the next command of the other machine's operator.
    fn command(&mut self) -> Option<Command> {
        None
    }

    /// Returns the outputs for the half here.
    fn outputs(&mut self, outputs: &[Outputs; SIDES]) -> [Outputs; SIDES];

    /// Writes the message of this tick to the other machine; `here`: the measurements of the half here.
    fn report<'a>(
        &mut self,
        now_s: f64,
        here: &[Option<Inputs>; SIDES],
        bulletins: &[Option<PeerStatus<'_>>; SIDES],
        buffer: &'a mut [u8],
    ) -> Option<&'a [u8]>;
}

impl<R: Rig, W: RemoteWire, H: HalfThere> Rig for JoinedRig<R, W, H> {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        self.measured = self.local.read(now_s);
        self.there.receive(now_s, &mut self.wire);
        self.there.join(&self.measured, now_s)
    }

    fn command(&mut self) -> Option<Command> {
        self.there.command()
    }

    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        self.local.write(now_s, &self.there.outputs(outputs));
    }

    fn receive_status(&mut self, now_s: f64, bulletins: &[Option<PeerStatus<'_>>; SIDES]) {
        if let Some(bytes) = self.there.report(now_s, &self.measured, bulletins, &mut self.buffer) {
            self.wire.send(now_s, bytes);
        }
    }

    devices_of!(self, self.local);
}
