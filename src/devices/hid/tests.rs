//! Codecs against golden vectors and noise.

mod codecs;
