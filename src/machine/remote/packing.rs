//! Packs numbers into bytes and unpacks them, least significant byte first, in buffers of fixed size.
//!
//! A message is sent a thousand times per second: measurements and commands are whole numbers of a unit far below their
//! noise.

use std::f64::consts::FRAC_1_SQRT_2;

use nalgebra::{Quaternion, UnitQuaternion, Vector3, Vector4};

use crate::rig::Side;

/// Units per second: 48 bits cover 325 days.
/// A tenth of a microsecond is finer than any clock on the path.
const TIME_PER_S: f64 = 1e7;
/// Units of 24-bit numbers: a length covers 4.2 m, a force 168 N, an angle 4.2 rad.
/// Half a micrometre: a twentieth of the finest handle's step.
pub(super) const PER_M: f64 = 2e6;
// 20 uN, far below the noise of a sensor.
pub(super) const PER_N: f64 = 5e4;
// Half a microradian.
pub(super) const PER_RAD: f64 = 2e6;
/// Steps of a quaternion component other than the largest, from 0 to 1 / sqrt(2): 20 bits with its sign.
const TURN_STEPS: f64 = 524_287.0;

/// Returns the number of a side in a message. The numbers belong to the message format, so they must not depend on the
/// order of the enum.
pub(super) const fn number_of_side(side: Side) -> u8 {
    match side {
        Side::Right => 0,
        Side::Left => 1,
    }
}

/// Returns the side with this number in a message.
pub(super) fn side_of_number(number: u8) -> Option<Side> {
    Side::ALL.into_iter().find(|side| number_of_side(*side) == number)
}

/// Writes a message. If a value does not fit, the result is not a message ([`Packer::done`]).
pub(super) struct Packer<'a> {
    buffer: &'a mut [u8],
    len: usize,
    fits: bool,
}

impl<'a> Packer<'a> {
    pub(super) const fn new(buffer: &'a mut [u8]) -> Self {
        Self { buffer, len: 0, fits: true }
    }

    pub(super) fn bytes(&mut self, bytes: &[u8]) {
        match self.buffer.get_mut(self.len..self.len + bytes.len()) {
            Some(place) => {
                place.copy_from_slice(bytes);
                self.len += bytes.len();
            }
            None => self.fits = false,
        }
    }

    pub(super) fn byte(&mut self, byte: u8) {
        self.bytes(&[byte]);
    }

    pub(super) fn short(&mut self, number: u16) {
        self.bytes(&number.to_le_bytes());
    }

    pub(super) fn single(&mut self, number: f32) {
        self.bytes(&number.to_le_bytes());
    }

    /// Writes a non-negative time, s.
    pub(super) fn time(&mut self, time_s: f64) {
        let units = (time_s * TIME_PER_S).round();
        // 2^48. NaN is in no range, so it invalidates the message too.
        self.fits &= (0.0..281_474_976_710_656.0).contains(&units);
        self.bytes(&(units as u64).to_le_bytes()[..6]);
    }

    /// Writes a number in 24 bits, with this many steps per unit. A number beyond that range invalidates the message.
    pub(super) fn scaled(&mut self, number: f64, per_unit: f64) {
        let steps = (number * per_unit).round();
        // 2^23; a conversion without this check would saturate, and the receiver would use a wrong number.
        self.fits &= (-8_388_608.0..8_388_608.0).contains(&steps);
        self.bytes(&(steps as i32).to_le_bytes()[..3]);
    }

    pub(super) fn vector(&mut self, vector: &Vector3<f64>, per_unit: f64) {
        vector.iter().for_each(|x| self.scaled(*x, per_unit));
    }

    /// Writes the three smaller components of the quaternion whose largest is positive, and the index of the largest:
    /// accurate to 3e-6 rad.
    pub(super) fn turn(&mut self, turn: &UnitQuaternion<f64>) {
        let coords = turn.coords;
        let largest = coords.iamax();
        // A quaternion and its negative are the same rotation, so the sign of one component can be chosen.
        let sign = if coords[largest] < 0.0 { -1.0 } else { 1.0 };
        let mut bits = largest as u64;
        for at in (0..4).filter(|at| *at != largest) {
            let steps = (sign * coords[at] / FRAC_1_SQRT_2 * TURN_STEPS).round();
            self.fits &= steps.abs() <= TURN_STEPS;
            bits = bits << 20 | (steps as i64 & 0xf_ffff) as u64;
        }
        self.bytes(&bits.to_le_bytes());
    }

    pub(super) fn done(self) -> Option<&'a [u8]> {
        let Self { buffer, len, fits } = self;
        let buffer: &'a [u8] = buffer;
        buffer.get(..len).filter(|_| fits)
    }
}

/// Reads a message; returns `None` if it is too short or contains an impossible value.
pub(super) struct Unpacker<'a> {
    rest: &'a [u8],
}

impl<'a> Unpacker<'a> {
    pub(super) const fn new(message: &'a [u8]) -> Self {
        Self { rest: message }
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.rest.split_first_chunk::<N>()?;
        self.rest = rest;
        Some(*first)
    }

    pub(super) fn byte(&mut self) -> Option<u8> {
        self.take::<1>().map(|[byte]| byte)
    }

    pub(super) fn short(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    pub(super) fn single(&mut self) -> Option<f32> {
        // The only numbers that can be NaN on the line: all others are whole numbers.
        self.take().map(f32::from_le_bytes).filter(|number| number.is_finite())
    }

    pub(super) fn time(&mut self) -> Option<f64> {
        let [b0, b1, b2, b3, b4, b5] = self.take()?;
        Some(u64::from_le_bytes([b0, b1, b2, b3, b4, b5, 0, 0]) as f64 / TIME_PER_S)
    }

    pub(super) fn scaled(&mut self, per_unit: f64) -> Option<f64> {
        let [b0, b1, b2] = self.take()?;
        // In the upper three bytes, so that the shift extends the sign.
        Some(f64::from(i32::from_le_bytes([0, b0, b1, b2]) >> 8) / per_unit)
    }

    pub(super) fn vector(&mut self, per_unit: f64) -> Option<Vector3<f64>> {
        Some(Vector3::new(self.scaled(per_unit)?, self.scaled(per_unit)?, self.scaled(per_unit)?))
    }

    pub(super) fn turn(&mut self) -> Option<UnitQuaternion<f64>> {
        let bits = u64::from_le_bytes(self.take()?);
        let largest = (bits >> 60) as usize;
        let mut coords = Vector4::zeros();
        let mut squares = 0.0;
        if largest >= coords.len() {
            return None;
        }
        for (place, at) in (0..4).filter(|at| *at != largest).enumerate() {
            // Shifted to the top first, so that the shift back extends the sign of the 20 bits.
            let steps = (bits << (4 + 20 * place)).cast_signed() >> 44;
            coords[at] = steps as f64 / TURN_STEPS * FRAC_1_SQRT_2;
            squares += coords[at] * coords[at];
        }
        coords[largest] = f64::max(1.0 - squares, 0.0).sqrt();
        // Three components that are not larger than the fourth have squares that add up to at most three quarters.
        (squares <= 0.751).then(|| UnitQuaternion::new_normalize(Quaternion::from(coords)))
    }
}
