//! In place of decoder and encoder, in a program that was built without them.

use std::io;

use super::{ABSENT, Taken};
use crate::Damage;

/// Says that it is not there.
#[derive(Debug, Default)]
pub struct Decoder(());

impl Decoder {
    /// Nothing comes of this: there is no such decoder.
    ///
    /// # Errors
    /// Always: it was not built.
    pub fn take(&mut self, _: &[u8], _: bool, _: bool) -> Result<Option<Taken>, Damage> {
        Err(Damage::Undecodable { reason: ABSENT.to_owned() })
    }
}

/// Says that it is not there.
#[derive(Debug)]
pub struct Encoder(());

impl Encoder {
    /// For pictures at this rate.
    ///
    /// # Errors
    /// Always: it was not built.
    pub fn new(_: f64) -> io::Result<Self> {
        Err(io::Error::new(io::ErrorKind::Unsupported, ABSENT))
    }

    /// Nothing comes to this: there is no such encoder.
    ///
    /// # Errors
    /// Always: it was not built.
    pub fn encode(&mut self, _: &[u8], _: [usize; 2], _: bool) -> io::Result<Vec<u8>> {
        Err(io::Error::new(io::ErrorKind::Unsupported, ABSENT))
    }
}
