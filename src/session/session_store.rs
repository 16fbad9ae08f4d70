//! The folder of a user's sessions: names for new sessions, marks of the kept ones, and room for the next.
//!
//! Every session is recorded automatically. Sessions that are not marked as kept make room for new ones, the oldest
//! first; a kept session is never deleted. The mark is an empty file next to the session (`NAME.mcap.kept`), so that a
//! session can be marked while it is being written.

use std::{
    fs, io,
    path::{Path, PathBuf},
    time::{Duration, SystemTime},
};

use nima_recording::session::is_being_written;

/// Maximum bytes of the sessions that are not kept: ten hours of two arms.
pub const MAX_BYTES: u64 = 20_000_000_000;
/// Disk space, in bytes, that sessions which are not kept leave free for other uses.
pub const LEFT_BYTES: u64 = 2_000_000_000;
/// A file written to this recently may be the session of another program that is running now.
const IN_USE: Duration = Duration::from_mins(1);
const EXTENSION: &str = "mcap";
const MARK: &str = "mcap.kept";
const NOTE: &str = "mcap.note";
/// Longest note that is read, bytes.
const NOTE_MAX: u64 = 4096;
/// Maximum length of a rig's name within a file's name, bytes.
const NAME_MAX: usize = 40;

/// Returns a free path in this folder for a session that began at this time (UTC, ISO 8601), with the rig's name in it.
///
/// # Errors
/// All thousand names for sessions that began in the same second are taken.
pub fn free_name(folder: &Path, started: &str, rig: &str) -> io::Result<PathBuf> {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    let rig: String = rig.chars().map(plain).take(NAME_MAX).collect();
    let stem: String = started.chars().filter(char::is_ascii_alphanumeric).collect();
    let name = |number: u32| match number {
        0 => format!("{stem}-{rig}.{EXTENSION}"),
        _ => format!("{stem}-{rig}-{number}.{EXTENSION}"),
    };
    let mut free = (0..1000).map(|number| folder.join(name(number))).filter(|path| !path.exists());
    free.next().ok_or_else(|| io::Error::other("a thousand sessions began in this second"))
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SessionStore {
    folder: PathBuf,
    max_bytes: u64,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredSession {
    pub path: PathBuf,
    /// Bytes on the disk.
    pub bytes: u64,
    /// Time of the last write.
    pub written: SystemTime,
    /// Whether it is never deleted.
    pub kept: bool,
    /// Whether a process is writing it now.
    pub writing: bool,
}

impl SessionStore {
    /// Creates the sessions in this folder, which is created with the first one; those that are not kept use at most
    /// `max_bytes`.
    pub fn new(folder: impl Into<PathBuf>, max_bytes: u64) -> Self {
        Self { folder: folder.into(), max_bytes }
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Creates the folder, makes room in it, and returns the path for a session: `started` (UTC, ISO 8601) and the
    /// rig's name.
    ///
    /// # Errors
    /// I/O errors of the folder.
    pub fn place(&self, started: &str, rig: &str) -> io::Result<PathBuf> {
        fs::create_dir_all(&self.folder)?;
        self.make_room(None)?;
        free_name(&self.folder, started, rig)
    }

    /// Returns the sessions, oldest first.
    ///
    /// # Errors
    /// I/O errors of the folder; a missing folder has no sessions.
    pub fn sessions(&self) -> io::Result<Vec<StoredSession>> {
        let entries = match fs::read_dir(&self.folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            entries => entries?,
        };
        let mut all = Vec::new();
        for entry in entries {
            let path = entry?.path();
            if path.extension().is_some_and(|extension| extension == EXTENSION) {
                // Skip a file that was deleted in the meantime.
                let Ok(about) = fs::symlink_metadata(&path) else { continue };
                if about.is_file() {
                    let kept = mark_of(&path).exists();
                    let written = about.modified()?;
                    // If the system cannot say, assume that a recently written file is still being written.
                    let lately = || written.elapsed().is_ok_and(|since| since < IN_USE);
                    let writing = is_being_written(&path)
                        .map_or_else(|_| lately(), |writes| writes || cfg!(not(any(unix, windows))) && lately());
                    all.push(StoredSession { bytes: taken(&about), written, kept, writing, path });
                }
            }
        }
        all.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(all)
    }

    /// Deletes sessions that are not kept, the oldest first, until the rest stays within its limit and leaves
    /// [`LEFT_BYTES`] of the disk free. Never deletes `running`, the session that is being recorded, or a session that
    /// another program may be recording. Returns the bytes that can still be freed in this way.
    ///
    /// # Errors
    /// I/O errors of the folder or of a deletion.
    pub fn make_room(&self, running: Option<&Path>) -> io::Result<u64> {
        let sessions = self.sessions()?;
        let mut loose: u64 = sessions.iter().filter(|session| !session.kept).map(|session| session.bytes).sum();
        let free = free_bytes(&self.folder).unwrap_or(u64::MAX);
        let max = self.max_bytes.min(loose.saturating_add(free).saturating_sub(LEFT_BYTES));
        let in_use =
            |session: &StoredSession| session.writing || session.written.elapsed().is_ok_and(|since| since < IN_USE);
        let may_go =
            |session: &&StoredSession| !session.kept && !in_use(session) && Some(session.path.as_path()) != running;
        let mut left = 0;
        for session in sessions.iter().filter(may_go) {
            if loose > max {
                remove(&session.path)?;
                loose -= session.bytes;
            } else {
                left += session.bytes;
            }
        }
        Ok(left)
    }
}

/// Marks a session as kept, or removes the mark.
///
/// # Errors
/// I/O errors.
pub fn keep(session: &Path, kept: bool) -> io::Result<()> {
    let mark = mark_of(session);
    if kept {
        return fs::write(mark, []);
    }
    match fs::remove_file(mark) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Returns the note of a session; empty if there is none.
pub fn note_of(session: &Path) -> String {
    use std::io::Read as _;

    let mut note = String::new();
    let read =
        fs::File::open(session.with_extension(NOTE)).and_then(|file| file.take(NOTE_MAX).read_to_string(&mut note));
    if read.is_ok() { note } else { String::new() }
}

/// Saves a note of a session in a file next to it, so that this is possible while it is being written; an empty note
/// removes the file.
///
/// # Errors
/// I/O errors.
pub fn set_note(session: &Path, note: &str) -> io::Result<()> {
    let path = session.with_extension(NOTE);
    if !note.is_empty() {
        return fs::write(path, note);
    }
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Deletes a session and its note.
///
/// # Errors
/// I/O errors.
pub fn remove(session: &Path) -> io::Result<()> {
    fs::remove_file(session)?;
    set_note(session, "")
}

fn mark_of(session: &Path) -> PathBuf {
    session.with_extension(MARK)
}

/// Returns the bytes on the disk. A session that is being written has free space that uses none.
#[cfg(unix)]
fn taken(about: &fs::Metadata) -> u64 {
    std::os::unix::fs::MetadataExt::blocks(about) * 512
}

#[cfg(not(unix))]
fn taken(about: &fs::Metadata) -> u64 {
    about.len()
}

/// Returns the bytes that an ordinary user may still write to the disk of this folder; `None` if the system does not
/// report it.
#[cfg(unix)]
pub fn free_bytes(folder: &Path) -> Option<u64> {
    let disk = rustix::fs::statvfs(folder).ok()?;
    Some(disk.f_bavail.saturating_mul(disk.f_frsize))
}

/// As on Unix.
#[cfg(windows)]
#[expect(unsafe_code, reason = "std does not ask for the room on a disk")]
pub fn free_bytes(folder: &Path) -> Option<u64> {
    use std::os::windows::ffi::OsStrExt as _;

    let mut name: Vec<u16> = folder.as_os_str().encode_wide().collect();
    name.push(0);
    let mut free = 0;
    // SAFETY: the name is zero-terminated, and the output outlives the call; pointers to unused outputs may be null.
    let report = unsafe {
        windows_sys::Win32::Storage::FileSystem::GetDiskFreeSpaceExW(
            name.as_ptr(),
            &raw mut free,
            std::ptr::null_mut(),
            std::ptr::null_mut(),
        )
    };
    (report != 0).then_some(free)
}

/// Unknown on this system.
#[cfg(not(any(unix, windows)))]
pub const fn free_bytes(_: &Path) -> Option<u64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_stays_with_its_session_and_goes_with_it() {
        let folder = tempfile::tempdir().unwrap();
        let shelf = SessionStore::new(folder.path(), MAX_BYTES);
        let path = session(&shelf, "1.mcap", Duration::ZERO);
        assert_eq!(note_of(&path), "");
        set_note(&path, "third try").unwrap();
        assert_eq!((note_of(&path), shelf.sessions().unwrap().len()), ("third try".to_owned(), 1));
        set_note(&path, "").unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "no empty note is left");
        set_note(&path, "last").unwrap();
        remove(&path).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    fn session(shelf: &SessionStore, name: &str, age: Duration) -> PathBuf {
        let path = shelf.folder().join(name);
        fs::write(&path, vec![1; 1 << 20]).unwrap();
        fs::File::options().write(true).open(&path).unwrap().set_modified(SystemTime::now() - age).unwrap();
        path
    }

    #[test]
    fn the_oldest_that_nobody_keeps_makes_room_and_the_running_one_never() {
        let folder = tempfile::tempdir().unwrap();
        let shelf = SessionStore::new(folder.path(), 2 << 20);
        let old = Duration::from_hours(1);
        let [first, kept, running, other, last] =
            [("1.mcap", old), ("2.mcap", old), ("3.mcap", old), ("4.mcap", IN_USE / 2), ("5.mcap", old)]
                .map(|(name, age)| session(&shelf, name, age));
        fs::write(folder.path().join("notes.txt"), "mine").unwrap();
        keep(&kept, true).unwrap();
        assert_eq!(shelf.make_room(Some(&running)).unwrap(), 0, "nothing is left that might be deleted");
        let there = |path: &Path| path.exists();
        assert_eq!([&first, &kept, &running, &other, &last].map(|path| there(path)), [false, true, true, true, false]);
        assert!(there(&folder.path().join("notes.txt")));
        let kept_ones: Vec<_> = shelf.sessions().unwrap().into_iter().filter(|session| session.kept).collect();
        assert!(kept_ones.len() == 1 && kept_ones[0].path == kept);
        keep(&kept, false).unwrap();
        keep(&kept, false).unwrap();
        assert!(shelf.sessions().unwrap().iter().all(|session| !session.kept));
    }

    #[test]
    fn a_new_session_has_a_name_of_its_own_in_a_folder_that_is_made_for_it() {
        let folder = tempfile::tempdir().unwrap();
        let shelf = SessionStore::new(folder.path().join("sessions"), MAX_BYTES);
        assert_eq!(shelf.sessions().unwrap(), []);
        let place = || shelf.place("2026-11-23T07:29:15Z", "My rig / 2").unwrap();
        let first = place();
        assert_eq!(first.file_name().unwrap(), "20261123T072915Z-My-rig---2.mcap");
        fs::write(&first, []).unwrap();
        assert_eq!(place().file_name().unwrap(), "20261123T072915Z-My-rig---2-1.mcap");
        assert_eq!(shelf.sessions().unwrap().len(), 1);
    }
}
