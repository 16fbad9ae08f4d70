//! The codecs with known reports and random bytes.

mod codecs;
