//! The message of the operator's machine to the follower's machine in every tick.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::impedance::Mode;

use super::packing::{PER_M, PER_RAD, Packer, Unpacker, number_of_side, side_of_number};
use crate::rig::{SIDES, Side};

/// Request of the operator's pair to the follower.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Intent {
    #[default]
    Rest,
    /// Drives are on, at rest: an engagement has started, or the clutch is pressed.
    Hold,
    Follow,
    /// Stopped, by the operator or by a fault.
    Stop,
}

impl Intent {
    // Stored in two bits of a message, so a further intent needs a new format.
    const ALL: [Self; 4] = [Self::Rest, Self::Hold, Self::Follow, Self::Stop];
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LeaderSide {
    pub(super) intent: Intent,
    /// Number of engagements and of releases so far, wrapping from 255 to 0.
    pub(super) engagements: u8,
    pub(super) releases: u8,
    /// Commanded tip, m; without a command, the last reported tip.
    pub(super) tip_m: Vector3<f64>,
    pub(super) world_from_jaws: Option<UnitQuaternion<f64>>,
    pub(super) gripper_rad: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LeaderMessage {
    /// Time of the sender's loop, s.
    pub(super) t_s: f64,
    /// Time from a command to its answer, ticks of the loop.
    pub(super) delay_ticks: u16,
    pub(super) mode: Mode,
    pub(super) compares: bool,
    pub(super) sides: [Option<LeaderSide>; SIDES],
}

/// Returns every mode in the order of its number in the protocol.
pub(super) fn modes() -> impl Iterator<Item = Mode> {
    Mode::ALL.into_iter().chain(Mode::BASELINES)
}

pub(super) fn number_of(mode: Mode) -> u8 {
    modes().position(|other| other == mode).unwrap_or(0) as u8
}

impl LeaderMessage {
    pub(super) fn pack<'a>(&self, buffer: &'a mut [u8]) -> Option<&'a [u8]> {
        let mut to = Packer::new(buffer);
        to.time(self.t_s);
        to.short(self.delay_ticks);
        // There are far fewer than 128 modes, so the highest bit is free.
        to.byte(number_of(self.mode) | u8::from(self.compares) << 7);
        for side in Side::ALL {
            let Some(report) = &self.sides[side.index()] else { continue };
            let intent = Intent::ALL.iter().position(|intent| *intent == report.intent).unwrap_or(0) as u8;
            let turned = u8::from(report.world_from_jaws.is_some()) << 4;
            let gripped = u8::from(report.gripper_rad.is_some()) << 5;
            to.byte(number_of_side(side) | intent << 2 | turned | gripped);
            to.byte(report.engagements);
            to.byte(report.releases);
            to.vector(&report.tip_m, PER_M);
            report.world_from_jaws.iter().for_each(|turn| to.turn(turn));
            report.gripper_rad.iter().for_each(|rad| to.scaled(*rad, PER_RAD));
        }
        to.done()
    }

    pub(super) fn unpack(message: &[u8]) -> Option<Self> {
        let mut from = Unpacker::new(message);
        let t_s = from.time()?;
        let delay_ticks = from.short()?;
        let first = from.byte()?;
        let mode = modes().nth(usize::from(first & 0x7f))?;
        let mut report = Self { t_s, delay_ticks, mode, compares: first >> 7 == 1, sides: [None; SIDES] };
        while !from.is_empty() {
            let first = from.byte()?;
            // Two bits, although one would name the side: a number without a side invalidates a damaged message.
            let place = &mut report.sides[side_of_number(first & 3)?.index()];
            // A side that occurs twice is ambiguous, and a wrong command is worse than none.
            if place.is_some() {
                return None;
            }
            *place = Some(LeaderSide {
                intent: Intent::ALL[usize::from(first >> 2 & 3)],
                engagements: from.byte()?,
                releases: from.byte()?,
                tip_m: from.vector(PER_M)?,
                world_from_jaws: if first >> 4 & 1 == 1 { Some(from.turn()?) } else { None },
                gripper_rad: if first >> 5 & 1 == 1 { Some(from.scaled(PER_RAD)?) } else { None },
            });
        }
        Some(report)
    }
}
