//! The system calls: a thin implementation, and a trait that a test replaces by a table.
#![expect(unsafe_code, reason = "ioctl, mmap, poll and a clock have no safe interface in std")]

use std::{
    ffi::c_void,
    fs::{File, OpenOptions},
    io::{Error, ErrorKind, Result},
    os::{fd::AsRawFd as _, unix::fs::OpenOptionsExt as _},
    path::Path,
    ptr::NonNull,
    time::Duration,
};

use super::layout::KernelRequest;

/// The system calls on a camera.
pub(super) trait Kernel: Send {
    /// Sends a request with its structure, whose length the request defines.
    fn ioctl(&mut self, request: KernelRequest, structure: &mut [u8]) -> Result<()>;
    /// Maps the next buffer, which the driver has at this offset.
    fn map(&mut self, offset: u32, length: usize) -> Result<()>;
    /// Returns the first bytes of a buffer that the driver has returned.
    fn copy(&self, buffer: usize, length: usize) -> Vec<u8>;
    /// Waits until data are available, at most this long.
    fn wait(&mut self, longest: Duration) -> Result<()>;
    /// Returns the monotonic clock, which the driver uses for its time stamps.
    fn now(&self) -> Duration;
}

/// An open device.
pub(super) struct KernelDevice {
    file: File,
    buffers: Vec<Buffer>,
}

/// Memory that is shared with the driver.
struct Buffer {
    begin: NonNull<c_void>,
    length: usize,
}

// SAFETY: the mapping belongs to the process, not to the thread that made it, and only its owner can access it.
unsafe impl Send for Buffer {}

impl Drop for Buffer {
    fn drop(&mut self) {
        // SAFETY: the range comes from one successful mmap, and no reference to it exists: `copy` returns copies only.
        unsafe { libc::munmap(self.begin.as_ptr(), self.length) };
    }
}

impl KernelDevice {
    pub(super) fn open(path: &Path) -> Result<Self> {
        let file = OpenOptions::new().read(true).write(true).custom_flags(libc::O_NONBLOCK).open(path)?;
        Ok(Self { file, buffers: Vec::new() })
    }
}

impl Kernel for KernelDevice {
    fn ioctl(&mut self, request: KernelRequest, structure: &mut [u8]) -> Result<()> {
        if structure.len() != request.length {
            return Err(Error::from(ErrorKind::InvalidInput));
        }
        loop {
            // SAFETY: the kernel reads and writes the number of bytes in the request code, which is the size of the
            // structure; the structure contains no pointers.
            let answer = unsafe {
                libc::ioctl(self.file.as_raw_fd(), libc::Ioctl::from(request.code()), structure.as_mut_ptr())
            };
            if answer >= 0 {
                return Ok(());
            }
            let error = Error::last_os_error();
            if error.kind() != ErrorKind::Interrupted {
                return Err(error);
            }
        }
    }

    fn map(&mut self, offset: u32, length: usize) -> Result<()> {
        // SAFETY: the kernel chooses the address of the new mapping and refuses a wrong offset or length.
        let begin = unsafe {
            libc::mmap(
                std::ptr::null_mut(),
                length,
                libc::PROT_READ | libc::PROT_WRITE,
                libc::MAP_SHARED,
                self.file.as_raw_fd(),
                libc::off_t::from(offset),
            )
        };
        if begin == libc::MAP_FAILED {
            return Err(Error::last_os_error());
        }
        let begin = NonNull::new(begin).ok_or(ErrorKind::InvalidData)?;
        self.buffers.push(Buffer { begin, length });
        Ok(())
    }

    fn copy(&self, buffer: usize, length: usize) -> Vec<u8> {
        let Some(Buffer { begin, length: max }) = self.buffers.get(buffer) else { return Vec::new() };
        let length = length.min(*max);
        let mut bytes = vec![0; length];
        // SAFETY: both ranges have at least `length` bytes and do not overlap. While the buffer is ours the driver does not write to it; if it
        // did, bytes of two images would be mixed; no reference to the range exists.
        unsafe { std::ptr::copy_nonoverlapping(begin.as_ptr().cast::<u8>(), bytes.as_mut_ptr(), length) };
        bytes
    }

    fn wait(&mut self, longest: Duration) -> Result<()> {
        let mut watched = libc::pollfd { fd: self.file.as_raw_fd(), events: libc::POLLIN, revents: 0 };
        // SAFETY: one structure with one open descriptor.
        let answer = unsafe { libc::poll(&raw mut watched, 1, longest.as_millis() as i32) };
        let error = Error::last_os_error();
        if answer < 0 && error.kind() != ErrorKind::Interrupted { Err(error) } else { Ok(()) }
    }

    fn now(&self) -> Duration {
        let mut now = libc::timespec { tv_sec: 0, tv_nsec: 0 };
        // SAFETY: the clock exists on every system of this kind, and the structure is ours.
        unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &raw mut now) };
        Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
    }
}
