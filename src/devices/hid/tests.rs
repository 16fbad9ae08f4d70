//! The codecs against known reports and random bytes.

mod codecs;
