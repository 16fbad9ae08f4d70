//! System calls that the drivers need and that have no safe interface.
#![expect(unsafe_code, reason = "file descriptors and one ioctl have no safe interface in std")]

use std::{
    fs::File,
    io,
    os::fd::{AsRawFd, FromRawFd as _},
};

/// Returns a second descriptor of an open line, whose reads and writes never wait.
///
/// # Errors
/// If the descriptor cannot be duplicated.
pub fn bytes_of(port: &impl AsRawFd) -> io::Result<File> {
    // SAFETY: the descriptor is open for as long as `port` is borrowed; the duplicate has one owner, the file returned.
    unsafe {
        let copy = libc::fcntl(port.as_raw_fd(), libc::F_DUPFD_CLOEXEC, 0);
        if copy < 0 {
            return Err(io::Error::last_os_error());
        }
        let file = File::from_raw_fd(copy);
        let flags = libc::fcntl(copy, libc::F_GETFL);
        if flags < 0 || libc::fcntl(copy, libc::F_SETFL, flags | libc::O_NONBLOCK) < 0 {
            return Err(io::Error::last_os_error());
        }
        Ok(file)
    }
}

/// Makes a write beyond the size that `ulimit -f` permits fail with an error. By default, the system would end the
/// process, with an arm engaged.
pub fn survive_file_size_limit() {
    // SAFETY: a plain system call; ignoring a signal runs no code.
    unsafe { libc::signal(libc::SIGXFSZ, libc::SIG_IGN) };
}

pub fn user_id() -> u32 {
    // SAFETY: no arguments, and it cannot fail.
    unsafe { libc::geteuid() }
}

/// Requests that the port's driver deliver bytes without delay; returns false if it cannot (a pseudo-terminal, another
/// system).
#[cfg(target_os = "linux")]
pub(super) fn ask_low_latency(port: &impl AsRawFd) -> bool {
    /// `struct serial_struct` of <linux/serial.h> is 72 bytes on 64-bit systems; its flags are the fifth 32-bit word.
    const WORDS: usize = 32;
    const FLAGS: usize = 4;
    const ASYNC_LOW_LATENCY: u32 = 1 << 13;
    const TIOCGSERIAL: libc::Ioctl = 0x541E;
    const TIOCSSERIAL: libc::Ioctl = 0x541F;
    let mut settings = [0_u32; WORDS];
    // SAFETY: the buffer is larger than the structure that the kernel reads and writes.
    unsafe {
        if libc::ioctl(port.as_raw_fd(), TIOCGSERIAL, settings.as_mut_ptr()) != 0 {
            return false;
        }
        settings[FLAGS] |= ASYNC_LOW_LATENCY;
        libc::ioctl(port.as_raw_fd(), TIOCSSERIAL, settings.as_ptr()) == 0
    }
}

/// Returns false, because other systems have no such flag.
#[cfg(not(target_os = "linux"))]
pub(super) fn ask_low_latency(_: &impl AsRawFd) -> bool {
    false
}

/// Returns the errors counted by the port's hardware (framing, parity, overrun, break); `None` if it does not count
/// them.
#[cfg(target_os = "linux")]
pub(super) fn line_errors(port: &impl AsRawFd) -> Option<u32> {
    /// `struct serial_icounter_struct` of <linux/serial.h>: twenty 32-bit integers; after cts, dsr, rng, dcd, rx and tx come frame, overrun,
    /// parity and brk.
    const WORDS: usize = 20;
    const TIOCGICOUNT: libc::Ioctl = 0x545D;
    let mut counts = [0_u32; WORDS];
    // SAFETY: the buffer has the size of the structure that the kernel writes.
    let answered = unsafe { libc::ioctl(port.as_raw_fd(), TIOCGICOUNT, counts.as_mut_ptr()) == 0 };
    answered.then(|| counts[6..10].iter().fold(0, |sum, count| u32::wrapping_add(sum, *count)))
}

/// Returns `None`, because other systems do not report these errors.
#[cfg(not(target_os = "linux"))]
pub(super) fn line_errors(_: &impl AsRawFd) -> Option<u32> {
    None
}
