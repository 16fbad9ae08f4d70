//! Reading and writing at a position of a file, independent of its cursor.

use std::{fs::File, io, path::Path};
#[cfg(windows)]
use std::{fs::OpenOptions, os::windows::fs::OpenOptionsExt as _, time::Duration};

// Constants of the Windows API.
#[cfg(windows)]
const SHARE_READ: u32 = 1;
#[cfg(windows)]
const SHARE_WRITE: u32 = 2;
#[cfg(windows)]
const SHARE_DELETE: u32 = 4;
/// The right to delete.
#[cfg(windows)]
const DELETE: u32 = 0x1_0000;
#[cfg(windows)]
const SHARING_VIOLATION: i32 = 32;

#[cfg(windows)]
const GUARD_ATTEMPTS: u32 = 5;
#[cfg(windows)]
const GUARD_NAP: Duration = Duration::from_millis(2);

#[cfg(unix)]
pub(super) fn write_all(file: &File, bytes: &[u8], at: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::write_all_at(file, bytes, at)
}

#[cfg(unix)]
pub(super) fn read_exact(file: &File, bytes: &mut [u8], at: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, bytes, at)
}

#[cfg(windows)]
pub(super) fn write_all(file: &File, mut bytes: &[u8], mut at: u64) -> io::Result<()> {
    while !bytes.is_empty() {
        let count = std::os::windows::fs::FileExt::seek_write(file, bytes, at)?;
        if count == 0 {
            return Err(io::ErrorKind::WriteZero.into());
        }
        bytes = &bytes[count..];
        at += count as u64;
    }
    Ok(())
}

#[cfg(windows)]
pub(super) fn read_exact(file: &File, mut bytes: &mut [u8], mut at: u64) -> io::Result<()> {
    while !bytes.is_empty() {
        let count = std::os::windows::fs::FileExt::seek_read(file, bytes, at)?;
        if count == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        bytes = &mut bytes[count..];
        at += count as u64;
    }
    Ok(())
}

/// Locks a file for as long as it is open, on systems where a lock does not keep others from reading. Does nothing on a
/// file system without locks.
#[cfg(unix)]
pub(super) fn lock(file: &File) {
    file.try_lock().ok();
}

#[cfg(not(unix))]
pub(super) fn lock(_: &File) {}

/// A second sign, kept while the file is written, that a process writes it. On Windows a lock would keep others from
/// reading; there the guard is a second handle, which prevents deleting and renaming the file.
#[cfg(windows)]
pub(super) fn guard(path: &Path) -> Option<File> {
    let mut open = OpenOptions::new();
    open.read(true).share_mode(SHARE_READ | SHARE_WRITE);
    // Another program may be checking the guard at this moment.
    (0..GUARD_ATTEMPTS).find_map(|attempt| {
        std::thread::sleep(GUARD_NAP * attempt);
        open.open(path).ok()
    })
}

#[cfg(not(windows))]
pub(super) const fn guard(_: &Path) -> Option<File> {
    None
}

/// Returns whether a process holds the lock of this file.
#[cfg(unix)]
pub(super) fn is_locked(path: &Path) -> io::Result<bool> {
    match File::open(path)?.try_lock_shared() {
        Ok(()) => Ok(false),
        Err(std::fs::TryLockError::WouldBlock) => Ok(true),
        Err(std::fs::TryLockError::Error(error)) => Err(error),
    }
}

/// Returns whether a process holds the file's guard: then it cannot be opened for deletion.
#[cfg(windows)]
pub(super) fn is_locked(path: &Path) -> io::Result<bool> {
    match OpenOptions::new().access_mode(DELETE).share_mode(SHARE_READ | SHARE_WRITE | SHARE_DELETE).open(path) {
        Ok(_) => Ok(false),
        Err(error) if error.raw_os_error() == Some(SHARING_VIOLATION) => Ok(true),
        Err(error) => Err(error),
    }
}

#[cfg(not(any(unix, windows)))]
pub(super) fn is_locked(_: &Path) -> io::Result<bool> {
    Ok(false)
}

/// Returns whether the file has been deleted while it is open: data written from now on are lost when it is closed.
#[cfg(unix)]
pub(super) fn is_deleted(file: &File) -> io::Result<bool> {
    Ok(std::os::unix::fs::MetadataExt::nlink(&file.metadata()?) == 0)
}

/// Always false on Windows, where the guard prevents deletion.
#[cfg(not(unix))]
pub(super) fn is_deleted(_: &File) -> io::Result<bool> {
    Ok(false)
}
