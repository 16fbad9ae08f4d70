//! Opening and reading: a regular file of a plausible size, or a clear refusal. Nothing here waits for ever or fills the memory.

use std::{
    fs::{self, File, Metadata, OpenOptions},
    io::{self, Read},
    path::Path,
    thread,
    time::{Duration, Instant},
};

/// Most bytes of a recording or a data set: four hours of motion and force on three axes at 1 kHz.
pub const TABLE_MAX: u64 = 1 << 30;
/// Most bytes of a trained network; the largest that can be trained has a fifth of it.
pub const MODEL_MAX: u64 = 64 << 20;
/// Most bytes of a file that a person writes: rig, scene, settings, calibration.
pub const CONFIG_MAX: u64 = 1 << 20;
/// Most bytes of one line of a table. What has no line breaks is no table.
const LINE_MAX: usize = 1 << 20;
/// A pipe may be silent for so long before its writer counts as dead.
const PIPE_TIMEOUT: Duration = Duration::from_secs(30);
const NAP: Duration = Duration::from_millis(2);

/// All bytes of a regular file.
///
/// # Errors
/// No such file, not a regular one, or more than `most` bytes.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let (file, metadata) = open(path, false)?;
    if metadata.len() > most {
        return Err(too_large(most));
    }
    let mut bytes = Vec::with_capacity(metadata.len() as usize);
    // A file may grow while it is read.
    if file.take(most + 1).read_to_end(&mut bytes)? as u64 > most {
        return Err(too_large(most));
    }
    Ok(bytes)
}

/// The same as text.
///
/// # Errors
/// Those of [`read`], and bytes that are not UTF-8.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("rig.toml");
/// std::fs::write(&path, "rate_hz = 1000.0")?;
/// assert_eq!(nima_files::read_text(&path, 100)?, "rate_hz = 1000.0");
/// assert!(nima_files::read_text(&path, 10).is_err(), "larger than the most that is read");
/// assert!(nima_files::read_text(folder.path(), 100).is_err(), "a folder is no file");
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    let no_text = |_| io::Error::new(io::ErrorKind::InvalidData, "it is not UTF-8 text; is it the right file?");
    String::from_utf8(read(path, most)?).map_err(no_text)
}

/// Opens a table (CSV) to be read as a stream: a regular file, or a pipe as in `<(zcat x.csv.gz)` and `/dev/stdin`.
///
/// # Errors
/// No such file, neither file nor pipe, or more than [`TABLE_MAX`] bytes. Reading it ends with an error at [`TABLE_MAX`], at a
/// line of more than 1 MiB, and at a pipe that nobody writes to or that is silent for 30 s.
///
/// ```
/// use std::io::Read;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("recording.csv");
/// std::fs::write(&path, "t_s,x_m\n0.0,0.1\n")?;
/// let mut text = String::new();
/// nima_files::open_table(&path)?.read_to_string(&mut text)?;
/// assert_eq!(text.lines().count(), 2);
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn open_table(path: &Path) -> io::Result<Input> {
    let (file, metadata) = open(path, true)?;
    let pipe = is_pipe(&metadata);
    if metadata.len() > TABLE_MAX {
        return Err(too_large(TABLE_MAX));
    }
    Ok(Input { file, pipe: pipe.then_some(PIPE_TIMEOUT), taken: 0, line: 0 })
}

/// Opens a regular file that is read in parts, wherever they stand; gives its size too, which may be any.
///
/// # Errors
/// No such file, or not a regular one.
pub fn open_file(path: &Path) -> io::Result<(File, u64)> {
    open(path, false).map(|(file, metadata)| (file, metadata.len()))
}

/// A table that is being read.
#[derive(Debug)]
pub struct Input {
    file: File,
    /// How long to wait for more, where it is a pipe.
    pipe: Option<Duration>,
    taken: u64,
    /// Bytes since the last line break.
    line: usize,
}

impl Read for Input {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = match self.pipe {
            None => self.file.read(buffer)?,
            Some(timeout) => self.read_pipe(buffer, timeout)?,
        };
        self.taken += count as u64;
        if self.taken > TABLE_MAX {
            return Err(too_large(TABLE_MAX));
        }
        let is_break = |byte: &u8| matches!(byte, b'\n' | b'\r');
        self.line = match buffer[..count].iter().rposition(is_break) {
            Some(last) => count - last - 1,
            None => self.line + count,
        };
        if self.line > LINE_MAX {
            return Err(refusal("it has a line of more than 1 MiB; is it a table (CSV)?"));
        }
        Ok(count)
    }
}

impl Input {
    /// A pipe is opened without waiting, so that it is asked again until something comes.
    fn read_pipe(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let begin = Instant::now();
        loop {
            match self.file.read(buffer) {
                Ok(0) if self.taken == 0 && !buffer.is_empty() => {
                    return Err(refusal("it is a pipe that nobody writes to; start the writer first, or name a file"));
                }
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                    if begin.elapsed() > timeout {
                        return Err(refusal("it is a pipe and nothing comes through it; check what writes to it"));
                    }
                    thread::sleep(NAP);
                }
                done => return done,
            }
        }
    }
}

/// Opens without waiting and without touching what is no file: opening alone can start a tape or a watchdog.
pub(super) fn open(path: &Path, pipes: bool) -> io::Result<(File, Metadata)> {
    let check = |metadata: &Metadata| match what_it_is(metadata) {
        None => Ok(()),
        Some(_) if pipes && is_pipe(metadata) => Ok(()),
        Some("a pipe") => Err(refusal("it is a pipe; write what comes through it to a file and name that")),
        Some(what) => Err(refusal(&format!("it is {what}; name a file"))),
    };
    check(&fs::metadata(path)?)?;
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NONBLOCK | libc::O_NOCTTY);
    let file = options.open(path)?;
    // It may have been exchanged since.
    let metadata = file.metadata()?;
    check(&metadata)?;
    Ok((file, metadata))
}

/// What stands there, in words, where it is no regular file.
pub(super) fn what_it_is(metadata: &Metadata) -> Option<&'static str> {
    if metadata.is_file() {
        None
    } else if metadata.is_dir() {
        Some("a folder")
    } else if is_pipe(metadata) {
        Some("a pipe")
    } else if is_socket(metadata) {
        Some("a socket")
    } else {
        Some("a device")
    }
}

#[cfg(unix)]
fn is_pipe(metadata: &Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_fifo(&metadata.file_type())
}

#[cfg(unix)]
fn is_socket(metadata: &Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_socket(&metadata.file_type())
}

#[cfg(not(unix))]
fn is_pipe(_: &Metadata) -> bool {
    false
}

#[cfg(not(unix))]
fn is_socket(_: &Metadata) -> bool {
    false
}

fn too_large(most: u64) -> io::Error {
    let size = if most >= 1 << 20 { format!("{} MiB", most >> 20) } else { format!("{most} bytes") };
    io::Error::new(
        io::ErrorKind::FileTooLarge,
        format!("it is larger than {size}, the most that is read; is it the right file?"),
    )
}

pub(super) fn refusal(words: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, words)
}

#[cfg(test)]
#[path = "input_tests.rs"]
mod tests;
