//! Numbers as bytes and back, least significant byte first, into and from buffers of fixed size.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Writes a message. What does not fit is left out, and the message is then no message ([`Packer::done`]).
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

    pub(super) fn double(&mut self, number: f64) {
        self.bytes(&number.to_le_bytes());
    }

    pub(super) fn vector(&mut self, vector: &Vector3<f64>) {
        vector.iter().for_each(|x| self.single(*x as f32));
    }

    /// The three imaginary parts; the real one is made positive and follows from them.
    pub(super) fn turn(&mut self, turn: &UnitQuaternion<f64>) {
        let sign = if turn.w < 0.0 { -1.0 } else { 1.0 };
        self.vector(&(turn.imag() * sign));
    }

    /// The message, if all of it fitted.
    pub(super) fn done(self) -> Option<&'a [u8]> {
        let Self { buffer, len, fits } = self;
        let buffer: &'a [u8] = buffer;
        buffer.get(..len).filter(|_| fits)
    }
}

/// Reads a message; `None` wherever it is too short or says what cannot be.
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
        self.take().map(f32::from_le_bytes).filter(|number| number.is_finite())
    }

    pub(super) fn double(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes).filter(|number| number.is_finite())
    }

    pub(super) fn vector(&mut self) -> Option<Vector3<f64>> {
        let mut one = || self.single().map(f64::from);
        Some(Vector3::new(one()?, one()?, one()?))
    }

    pub(super) fn turn(&mut self) -> Option<UnitQuaternion<f64>> {
        let imaginary = self.vector()?;
        let real = (1.0 - imaginary.norm_squared()).max(0.0).sqrt();
        let turn = Quaternion::from_parts(real, imaginary);
        (imaginary.norm_squared() <= 1.0 + 1e-5).then(|| UnitQuaternion::new_normalize(turn))
    }
}
