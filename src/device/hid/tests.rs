//! Codecs against golden vectors and noise; drivers against emulators over their sockets.

mod codecs;
mod drivers;
