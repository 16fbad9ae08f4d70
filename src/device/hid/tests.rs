//! Codecs against golden vectors and noise; drivers against emulators over their sockets.

mod codecs;
#[cfg(target_os = "linux")]
mod drivers;
