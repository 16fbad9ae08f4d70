//! The channels of objects: rings as frames, jaws as named numbers, happenings as JSON and as lines of the log.

use std::collections::VecDeque;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use nima_machine::rig::{SIDES, Side};
use nima_recording::{
    messages::{
        foxglove::{self, FrameTransform, FrameTransforms, Timestamp},
        json_encoding,
    },
    session::WriteError,
};
use nima_score::Happening;
use prost::Message as _;

use super::{
    plot::Plot,
    scene::{WORLD, quaternion, vector},
};
use crate::{
    objects::{Jaws, ObjectSource, Objects, SCHEMA, SCHEMA_NAME, encode},
    outlet::{Channel, Outlet},
};

/// Topic of the rings.
pub(crate) const RINGS_TOPIC: &str = "rings";
/// Topic of what happens.
pub(crate) const HAPPENINGS_TOPIC: &str = "happenings";
/// The plot of a side that has its jaws, and its numbers.
pub(crate) const JAWS_PLOT: &str = "jaws";
/// See [`JAWS_PLOT`]; what touches is 1.
pub(crate) const JAWS: [&str; 12] = [
    "opening_rad",
    "opens_n",
    "load.x_n",
    "load.y_n",
    "load.z_n",
    "torque.x_nm",
    "torque.y_nm",
    "torque.z_nm",
    "touches.ring",
    "touches.peg",
    "touches.board",
    "touches.instrument",
];
/// Frames of rings are this and their number, from 0.
const RING: &str = "ring.";
/// Most rings that a message is read for.
const RINGS_MAX: usize = 64;

/// Writes what a source tells, as soon as the loop's tick of its time has passed.
#[derive(Debug)]
pub(crate) struct OfObjects {
    source: Box<dyn ObjectSource>,
    moments: VecDeque<Objects>,
    happenings: VecDeque<Happening>,
    rings: Option<Channel>,
    jaws: [Option<Plot>; SIDES],
    told: Channel,
}

impl OfObjects {
    pub(crate) fn new(out: &mut Outlet, source: Box<dyn ObjectSource>) -> Result<Self, WriteError> {
        let told = happenings_channel(out)?;
        Ok(Self {
            source,
            moments: VecDeque::new(),
            happenings: VecDeque::new(),
            rings: None,
            jaws: [None, None],
            told,
        })
    }

    /// Writes the moments up to this time of the loop, s, and returns what happened up to it. `time_ns` gives the time of a message.
    pub(crate) fn until(
        &mut self,
        out: &mut Outlet,
        t_s: f64,
        time_ns: impl Fn(f64) -> u64,
    ) -> Result<Vec<Happening>, WriteError> {
        while let Some(moment) = self.source.moment() {
            self.moments.push_back(moment);
        }
        while let Some(happening) = self.source.happening() {
            self.happenings.push_back(happening);
        }
        while let Some(moment) = self.moments.pop_front_if(|moment| moment.t_s <= t_s) {
            self.write(out, time_ns(moment.t_s), &moment)?;
            out.objects(&moment);
        }
        let mut happened = Vec::new();
        while let Some(happening) = self.happenings.pop_front_if(|happening| happening.t_s <= t_s) {
            out.message(self.told, time_ns(happening.t_s), &encode(&happening))?;
            happened.push(happening);
        }
        Ok(happened)
    }

    fn write(&mut self, out: &mut Outlet, time_ns: u64, objects: &Objects) -> Result<(), WriteError> {
        if self.rings.is_some() || objects.rings.iter().any(Option::is_some) {
            let channel = match self.rings {
                Some(channel) => channel,
                None => *self.rings.insert(rings_channel(out)?),
            };
            out.message(channel, time_ns, &rings(time_ns, &objects.rings).encode_to_vec())?;
        }
        for side in Side::ALL {
            let Some(jaws) = &objects.jaws[side.index()] else { continue };
            let plot = match &mut self.jaws[side.index()] {
                Some(plot) => plot,
                none => none.insert(Plot::of_side(out, side, JAWS_PLOT, &JAWS)?),
            };
            plot.values.extend(numbers(jaws));
            plot.write(out, time_ns, false)?;
        }
        Ok(())
    }
}

pub(crate) fn happenings_channel(out: &mut Outlet) -> Result<Channel, WriteError> {
    out.channel(HAPPENINGS_TOPIC, json_encoding(SCHEMA_NAME, SCHEMA))
}

pub(crate) fn rings_channel(out: &mut Outlet) -> Result<Channel, WriteError> {
    out.channel(RINGS_TOPIC, foxglove::encoding::<FrameTransforms>())
}

/// The frames of those rings that are there.
pub(crate) fn rings(time_ns: u64, rings: &[Option<Isometry3<f64>>]) -> FrameTransforms {
    let timestamp = Some(Timestamp::of_ns(time_ns));
    let frame = |(number, ring): (usize, &Option<Isometry3<f64>>)| {
        let ring = ring.as_ref()?;
        Some(FrameTransform {
            timestamp,
            parent_frame_id: WORLD.to_owned(),
            child_frame_id: format!("{RING}{number}"),
            translation: Some(vector(&ring.translation.vector)),
            rotation: Some(quaternion(&ring.rotation)),
        })
    };
    FrameTransforms { transforms: rings.iter().enumerate().filter_map(frame).collect() }
}

/// The rings of a message; those of other frames are left out.
pub(crate) fn rings_of(message: &[u8]) -> Vec<Option<Isometry3<f64>>> {
    let mut rings = Vec::new();
    for FrameTransform { child_frame_id, translation, rotation, .. } in
        FrameTransforms::decode(message).unwrap_or_default().transforms
    {
        let number = child_frame_id.strip_prefix(RING).and_then(|number| number.parse::<usize>().ok());
        let (Some(number), Some(at), Some(turn)) = (number.filter(|number| *number < RINGS_MAX), translation, rotation)
        else {
            continue;
        };
        let turn = UnitQuaternion::new_unchecked(Quaternion::new(turn.w, turn.x, turn.y, turn.z));
        if rings.len() <= number {
            rings.resize(number + 1, None);
        }
        rings[number] = Some(Isometry3::from_parts(Translation3::new(at.x, at.y, at.z), turn));
    }
    rings
}

fn numbers(jaws: &Jaws) -> [f64; JAWS.len()] {
    let Jaws { opening_rad, opens_n, force_n, torque_nm, touched } = jaws;
    let mut numbers = [0.0; JAWS.len()];
    [numbers[0], numbers[1]] = [*opening_rad, *opens_n];
    numbers[2..5].copy_from_slice(force_n.as_slice());
    numbers[5..8].copy_from_slice(torque_nm.as_slice());
    numbers[8..].copy_from_slice(&touched.map(|touches| f64::from(u8::from(touches))));
    numbers
}

/// Jaws of their numbers, in the order of [`JAWS`].
pub(crate) fn jaws_of(numbers: &[f64]) -> Option<Jaws> {
    let numbers: &[f64; JAWS.len()] = numbers.try_into().ok()?;
    let touched = [numbers[8], numbers[9], numbers[10], numbers[11]];
    Some(Jaws {
        opening_rad: numbers[0],
        opens_n: numbers[1],
        force_n: Vector3::from_column_slice(&numbers[2..5]),
        torque_nm: Vector3::from_column_slice(&numbers[5..8]),
        touched: touched.map(|touches| touches > 0.5),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_and_jaws_come_back_to_the_bit() {
        let turn = UnitQuaternion::from_euler_angles(0.3, -1.2, 2.5);
        let ring = Isometry3::from_parts(Translation3::new(0.1, -0.02, 0.3), turn);
        let all = [Some(ring), None, Some(Isometry3::identity()), None];
        let read = rings_of(&rings(5, &all).encode_to_vec());
        assert_eq!(read, all[..3], "the last one that is there ends the list");
        let jaws = Jaws {
            opening_rad: 0.6,
            opens_n: -1.5,
            force_n: Vector3::new(1.0, 2.0, 3.0),
            torque_nm: Vector3::new(0.1, 0.2, 0.3),
            touched: [true, false, false, true],
        };
        assert_eq!(jaws_of(&numbers(&jaws)), Some(jaws));
        assert_eq!((jaws_of(&[1.0]), rings_of(b"something else")), (None, vec![]));
    }

    #[test]
    fn foreign_frames_are_no_rings() {
        let frame = |name: &str| FrameTransform {
            child_frame_id: name.to_owned(),
            translation: Some(foxglove::Vector3::default()),
            rotation: Some(foxglove::Quaternion::default()),
            ..FrameTransform::default()
        };
        let transforms = ["right.tip", "ring.x", "ring.99999999999", "ring.64"].map(frame).to_vec();
        assert_eq!(rings_of(&FrameTransforms { transforms }.encode_to_vec()), vec![]);
    }
}
