//! The answer of the follower's machine in every tick.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{
    impedance::{Mode, ModeSet, PACKED_MAX, ParameterPack, SLOTS},
    tip_force::{Fallback, Unsure},
};

use super::{
    leader_message::{modes, number_of},
    packing::{PER_M, PER_N, Packer, Unpacker, number_of_side, side_of_number},
};
use crate::{
    messages::{FarStop, ForceSource},
    rig::{SIDES, Side},
};

#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "independent facts, each with its own reader")]
pub(super) struct FollowerSide {
    pub(super) tip_m: Vector3<f64>,
    pub(super) world_from_jaws: Option<UnitQuaternion<f64>>,
    pub(super) grip_n: Option<f64>,
    pub(super) powered: bool,
    /// The arm cannot be engaged from its current position.
    pub(super) is_obstructed: bool,
    pub(super) stop: Option<FarStop>,
    pub(super) source: ForceSource,
    pub(super) force_n: Vector3<f64>,
    pub(super) fresh: bool,
    pub(super) resting: bool,
    pub(super) modes: ModeSet,
    pub(super) packed: Option<ParameterPack>,
    pub(super) errors_n: Option<[f32; SLOTS]>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FollowerMessage {
    /// Time at which the active command was given, on the clock of the operator's loop, s.
    pub(super) t_s: f64,
    pub(super) sides: [Option<FollowerSide>; SIDES],
}

// The order belongs to the message format, as in [`PLAIN`].
const UNSURE: [Unsure; 3] = [Unsure::OutsideTraining, Unsure::NotMoved, Unsure::Missing];
/// The order belongs to the message format: append new sources, and never reorder.
const PLAIN: [ForceSource; 9] = [
    ForceSource::AtTip,
    ForceSource::Wrist,
    ForceSource::Network,
    ForceSource::Extrapolated,
    ForceSource::Uncalibrated,
    ForceSource::NoOrientation,
    ForceSource::Poisoned,
    ForceSource::NoSample,
    ForceSource::Unidentified,
];

fn number_of_source(source: ForceSource) -> u8 {
    let ForceSource::InDoubt { unsure, fallback } = source else {
        return PLAIN.iter().position(|other| *other == source).unwrap_or(0) as u8;
    };
    let why = UNSURE.iter().position(|other| *other == unsure).unwrap_or(0);
    // Two numbers for each reason, one for each fallback.
    (PLAIN.len() + 2 * why) as u8 + u8::from(fallback == Fallback::HoldAndFade)
}

fn source_of(number: u8) -> Option<ForceSource> {
    let number = usize::from(number);
    PLAIN.get(number).copied().or_else(|| {
        let doubt = number - PLAIN.len();
        // As in [`number_of_source`]: two numbers for each reason, one for each fallback.
        let fallback = if doubt.is_multiple_of(2) { Fallback::WristForce } else { Fallback::HoldAndFade };
        Some(ForceSource::InDoubt { unsure: *UNSURE.get(doubt / 2)?, fallback })
    })
}

fn bits_of(set: ModeSet) -> u16 {
    modes().filter(|mode| set.contains(*mode)).fold(0, |bits, mode| bits | 1 << number_of(mode))
}

fn set_of(bits: u16) -> ModeSet {
    let asked = modes().filter(|mode| bits >> number_of(*mode) & 1 == 1);
    // Delayed reflection is always in a set; a bit for it would be redundant.
    asked.fold(ModeSet::only(Mode::Dfr), ModeSet::with)
}

impl FollowerMessage {
    pub(super) fn pack<'a>(&self, buffer: &'a mut [u8]) -> Option<&'a [u8]> {
        let mut to = Packer::new(buffer);
        to.time(self.t_s);
        for side in Side::ALL {
            if let Some(report) = &self.sides[side.index()] {
                report.pack(side, &mut to);
            }
        }
        to.done()
    }

    pub(super) fn unpack(message: &[u8]) -> Option<Self> {
        let mut from = Unpacker::new(message);
        let mut report = Self { t_s: from.time()?, sides: [None; SIDES] };
        while !from.is_empty() {
            // A side that occurs twice is ambiguous; the whole message is refused.
            let place = &mut report.sides[side_of_number(from.byte()?)?.index()];
            if place.is_some() {
                return None;
            }
            *place = Some(FollowerSide::unpack(&mut from)?);
        }
        Some(report)
    }
}

impl FollowerSide {
    fn pack(&self, side: Side, to: &mut Packer<'_>) {
        let flags = [
            self.world_from_jaws.is_some(),
            self.grip_n.is_some(),
            self.powered,
            self.is_obstructed,
            self.fresh,
            self.resting,
            self.packed.is_some(),
            self.errors_n.is_some(),
        ];
        to.byte(number_of_side(side));
        // The first flag is the lowest bit.
        to.byte(flags.iter().rev().fold(0, |bits, flag| bits << 1 | u8::from(*flag)));
        let stop = self.stop.and_then(|stop| FarStop::ALL.iter().position(|other| *other == stop));
        // Stop and source share a byte: 11 reasons and 15 sources fit into four bits each.
        to.byte(stop.map_or(0, |place| place as u8 + 1) << 4 | number_of_source(self.source));
        to.vector(&self.tip_m, PER_M);
        self.world_from_jaws.iter().for_each(|turn| to.turn(turn));
        self.grip_n.iter().for_each(|grip_n| to.scaled(*grip_n, PER_N));
        to.vector(&self.force_n, PER_N);
        to.short(bits_of(self.modes));
        if let Some(packed) = &self.packed {
            to.byte(packed.slot);
            to.byte(packed.len);
            packed.used().iter().for_each(|number| to.single(*number));
        }
        self.errors_n.iter().flatten().for_each(|error_n| to.single(*error_n));
    }

    fn unpack(from: &mut Unpacker<'_>) -> Option<Self> {
        let flags = from.byte()?;
        let flag = |place: u8| flags >> place & 1 == 1;
        let state = from.byte()?;
        let stop = match (state >> 4).checked_sub(1) {
            None => None,
            Some(place) => Some(*FarStop::ALL.get(usize::from(place))?),
        };
        Some(Self {
            stop,
            source: source_of(state & 15)?,
            tip_m: from.vector(PER_M)?,
            world_from_jaws: if flag(0) { Some(from.turn()?) } else { None },
            grip_n: if flag(1) { Some(from.scaled(PER_N)?) } else { None },
            powered: flag(2),
            is_obstructed: flag(3),
            fresh: flag(4),
            resting: flag(5),
            force_n: from.vector(PER_N)?,
            modes: set_of(from.short()?),
            packed: if flag(6) { Some(packed_of(from)?) } else { None },
            errors_n: if flag(7) { Some(errors_of(from)?) } else { None },
        })
    }
}

fn errors_of(from: &mut Unpacker<'_>) -> Option<[f32; SLOTS]> {
    let mut errors_n = [0.0; SLOTS];
    for place in &mut errors_n {
        *place = from.single()?;
    }
    Some(errors_n)
}

fn packed_of(from: &mut Unpacker<'_>) -> Option<ParameterPack> {
    let mut packed = ParameterPack { slot: from.byte()?, len: from.byte()?, ..ParameterPack::NONE };
    // The length comes from the network; without this check it would decide how far to read.
    if usize::from(packed.len) > PACKED_MAX {
        return None;
    }
    for place in packed.numbers.iter_mut().take(usize::from(packed.len)) {
        *place = from.single()?;
    }
    Some(packed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_source_and_every_set_has_a_number() {
        assert!(FarStop::ALL.len() < 16, "both fit into one byte");
        let doubts = UNSURE.into_iter().flat_map(|unsure| {
            [Fallback::WristForce, Fallback::HoldAndFade].map(|fallback| ForceSource::InDoubt { unsure, fallback })
        });
        for source in PLAIN.into_iter().chain(doubts) {
            assert_eq!(source_of(number_of_source(source)), Some(source));
        }
        assert_eq!(source_of(15), None);
        for mode in modes() {
            let set = ModeSet::only(mode);
            assert_eq!(set_of(bits_of(set)), set, "{mode}");
        }
        assert_eq!(set_of(bits_of(ModeSet::ALL)), ModeSet::ALL);
    }
}
