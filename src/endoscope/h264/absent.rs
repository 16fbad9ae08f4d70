//! Substitutes for decoder and encoder in a program built without them.

use std::io;

use super::{ABSENT, H264Image};
use crate::Damage;

/// A decoder that always fails.
#[derive(Debug, Default)]
pub struct H264Decoder(());

impl H264Decoder {
    /// Always fails.
    ///
    /// # Errors
    /// Always: the feature was not built.
    pub fn take(&mut self, _: &[u8], _: bool, _: bool) -> Result<Option<H264Image>, Damage> {
        Err(Damage::Undecodable { reason: ABSENT.to_owned() })
    }
}

/// An encoder that always fails.
#[derive(Debug)]
pub struct H264Encoder(());

impl H264Encoder {
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
