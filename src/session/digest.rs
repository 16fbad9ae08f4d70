//! The digest of a tick's outputs: equal digests mean equal bits.
//!
//! Our own digest, because it is stored in files and must be the same in every build and every version.

use nima_machine::{
    messages::{CalibrationReadings, Event, Guidance, Tick, TickForces, TickPositions, TickTiming},
    rig::{Outputs, SIDES, Side},
};

use crate::codec::{CodecError, FromWords, ToWords, WordSink, WordSource, record};

/// A stage of a tick, in the order in which the loop computes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TickStage {
    /// The force at the tip, from the sensor and its calibrations.
    ForcePath,
    /// The identification at the follower.
    Identification,
    /// The forces computed at the leader.
    Rendering,
    /// The gates, and the force that passes them.
    Gates,
    /// State, motion, settings, events and the commands to the devices.
    State,
}

pub const STAGES: usize = 5;

impl TickStage {
    /// Every stage, in the order of the loop.
    pub const ALL: [Self; STAGES] = [Self::ForcePath, Self::Identification, Self::Rendering, Self::Gates, Self::State];

    pub const fn name(self) -> &'static str {
        match self {
            Self::ForcePath => "force at the tip",
            Self::Identification => "identification",
            Self::Rendering => "rendering",
            Self::Gates => "gates",
            Self::State => "state and commands",
        }
    }
}

/// The digest of a tick's outputs, as stored in a journal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DigestCheck {
    /// Digest of all outputs.
    pub all: u64,
    /// Sixteen bits of the digest of each stage of each side; they only locate a difference.
    pub stages: [[u16; STAGES]; SIDES],
}

record!(DigestCheck { all: u64, stages: [[u16; STAGES]; SIDES] });

impl DigestCheck {
    pub fn of<'a>(
        events: impl Iterator<Item = &'a Event>,
        outputs: &[Outputs; SIDES],
        ticks: &[Option<Tick>; SIDES],
    ) -> Self {
        Self::of_sides(events, Side::ALL.map(|side| of_side(&outputs[side.index()], ticks[side.index()].as_ref())))
    }

    /// Returns the digest of a tick from the digests of both sides.
    pub(crate) fn of_sides<'a>(events: impl Iterator<Item = &'a Event>, sides: [[u64; STAGES]; SIDES]) -> Self {
        let mut all = Digest::default();
        events.for_each(|event| event.put(&mut all));
        sides.iter().flatten().for_each(|digest| all.word(*digest));
        Self { all: all.end(), stages: sides.map(|side| side.map(|digest| digest as u16)) }
    }

    /// Returns the first stage, in the order of the loop, whose digest differs, and its side. `None` if only the
    /// overall digest differs: then the difference is in an event, or in a stage whose sixteen bits are equal by
    /// chance.
    pub fn differs(&self, other: &Self) -> Option<(Side, TickStage)> {
        let places =
            TickStage::ALL.into_iter().enumerate().flat_map(|(k, stage)| Side::ALL.map(|side| (k, side, stage)));
        places
            .filter(|(k, side, _)| self.stages[side.index()][*k] != other.stages[side.index()][*k])
            .map(|(_, side, stage)| (side, stage))
            .next()
    }
}

macro_rules! put_all {
    ($to:ident: $($value:ident),*) => { $($value.put($to);)* };
}

/// Returns the digest of each stage of one side.
pub(crate) fn of_side(outputs: &Outputs, tick: Option<&Tick>) -> [u64; STAGES] {
    let mut digests: [Digest; STAGES] = Default::default();
    let [force_path, identifies, renders, gated, stated] = &mut digests;
    outputs.put(stated);
    tick.is_some().put(stated);
    if let Some(tick) = tick {
        // Without `..`, so that a new field does not compile until it is handled here.
        let Tick {
            index,
            side,
            t_s,
            state,
            mode,
            delay_s,
            positions: TickPositions { leader_m, tip_m },
            measured_n,
            force,
            calibration: CalibrationReadings { wrist, frames, view },
            guidance: Guidance { prompt, guide_m },
            rendering: TickForces { delayed_n, asked_n, rendered_n },
            gates,
            identification,
            // The queue to the screen counts what it drops; the loop does not compute it.
            timing: TickTiming { wake_s, work_s, sample_to_force_s, missed, dropped: _ },
        } = tick;
        put_all!(force_path: force, measured_n);
        put_all!(identifies: identification);
        put_all!(renders: delayed_n, asked_n);
        put_all!(gated: gates, rendered_n);
        put_all!(stated: index, side, t_s, state, mode, delay_s, leader_m, tip_m, wrist, frames, view, prompt, guide_m);
        put_all!(stated: wake_s, work_s, sample_to_force_s, missed);
    }
    digests.map(Digest::end)
}

pub(crate) fn digest_of_bytes(bytes: &[u8]) -> u64 {
    let mut digest = Digest::default();
    for chunk in bytes.chunks(8) {
        digest.word(chunk.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte)));
    }
    digest.word(bytes.len() as u64);
    digest.end()
}

/// Mixes words into 64 bits. Two lanes, so that consecutive words do not wait for each other.
#[derive(Clone, Copy, Debug)]
struct Digest {
    lanes: [u64; 2],
    count: u64,
}

/// Odd, with half of its bits set: the fraction of the golden ratio.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

impl Default for Digest {
    fn default() -> Self {
        Self { lanes: [GOLDEN, GOLDEN.rotate_left(32)], count: 0 }
    }
}

impl WordSink for Digest {
    fn word(&mut self, word: u64) {
        let lane = &mut self.lanes[(self.count & 1) as usize];
        let mixed = (*lane ^ word).wrapping_mul(GOLDEN);
        *lane = mixed ^ mixed >> 29;
        self.count += 1;
    }

    fn skip(&mut self, _: usize) {}
}

impl Digest {
    fn end(self) -> u64 {
        let [first, second] = self.lanes;
        let mut end = first ^ second.rotate_left(23) ^ self.count;
        for shift in [31, 29, 32] {
            end = (end ^ end >> shift).wrapping_mul(GOLDEN);
        }
        end ^ end >> 32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn digest(words: &[u64]) -> u64 {
        let mut digest = Digest::default();
        for word in words {
            digest.word(*word);
        }
        digest.end()
    }

    #[test]
    fn every_bit_and_the_order_count() {
        let words: Vec<u64> = (0..50).map(|i| f64::from(i).sin().to_bits()).collect();
        let plain = digest(&words);
        for at in 0..words.len() {
            for bit in 0..64 {
                let mut flipped = words.clone();
                flipped[at] ^= 1 << bit;
                assert_ne!(digest(&flipped), plain, "word {at}, bit {bit}");
            }
        }
        let mut swapped = words.clone();
        swapped.swap(3, 5);
        assert_ne!(digest(&swapped), plain);
        assert_ne!(digest(&words[..49]), plain);
        assert_ne!(digest(&[0]), digest(&[0, 0]));
    }

    #[test]
    fn the_digest_is_the_one_that_files_have() {
        assert_eq!(digest(&[1, 2, 3]), FIRST);
    }

    /// From this program's first version with journals. If this digest changes, the journal's version must change too.
    const FIRST: u64 = 14_529_145_522_030_561_626;
}
