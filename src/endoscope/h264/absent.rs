//! Replaces decoder and encoder in a program built without them.

use std::io;

use super::{ABSENT, Taken};
use crate::Damage;

/// A decoder that always fails.
#[derive(Debug, Default)]
pub struct Decoder(());

impl Decoder {
    /// Always fails.
    ///
    /// # Errors
    /// Always: the feature was not built.
    pub fn take(&mut self, _: &[u8], _: bool, _: bool) -> Result<Option<Taken>, Damage> {
        Err(Damage::Undecodable { reason: ABSENT.to_owned() })
    }
}

/// An encoder that always fails.
#[derive(Debug)]
pub struct Encoder(());

impl Encoder {
    /// Always fails.
    ///
    /// # Errors
    /// Always: the feature was not built.
    pub fn new(_: f64) -> io::Result<Self> {
        Err(io::Error::new(io::ErrorKind::Unsupported, ABSENT))
    }

    /// Always fails.
    ///
    /// # Errors
    /// Always: the feature was not built.
    pub fn encode(&mut self, _: &[u8], _: [usize; 2], _: bool) -> io::Result<Vec<u8>> {
        Err(io::Error::new(io::ErrorKind::Unsupported, ABSENT))
    }
}
