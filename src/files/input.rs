//! Opening and reading regular files of a plausible size. All other files are rejected with a clear message, so that no
//! call blocks forever or fills the memory.

use std::{
    fs::{self, File, Metadata, OpenOptions},
    io::{self, Read},
    path::Path,
    thread,
    time::{Duration, Instant},
};

/// Maximum size of a recording or data set, in bytes: four hours of motion and force on three axes at 1 kHz.
pub const TABLE_MAX: u64 = 1 << 30;
/// Maximum size of a trained network, in bytes: five times that of the largest network that can be trained.
pub const MODEL_MAX: u64 = 64 << 20;
/// Maximum size of a file written by a person (rig, scene, settings, calibration), in bytes.
pub const CONFIG_MAX: u64 = 1 << 20;
/// Maximum length of a line of a table, in bytes. A file without line breaks is not a table.
const LINE_MAX: usize = 1 << 20;
/// A pipe without data for this long counts as abandoned by its writer.
const PIPE_TIMEOUT: Duration = Duration::from_secs(30);
const NAP: Duration = Duration::from_millis(2);

/// Returns all bytes of a regular file.
///
/// # Errors
/// The file does not exist, is not a regular file, or has more than `max` bytes.
pub fn read(path: &Path, max: u64) -> io::Result<Vec<u8>> {
    let (file, metadata) = open(path, false)?;
    if metadata.len() > max {
        return Err(too_large(max));
    }
    let mut bytes = Vec::with_capacity(metadata.len() as usize);
    // Limits the bytes that are read, because the file may grow in the meantime.
    if file.take(max + 1).read_to_end(&mut bytes)? as u64 > max {
        return Err(too_large(max));
    }
    Ok(bytes)
}

/// Returns the text of a regular file.
///
/// # Errors
/// The errors of [`read`], and bytes that are not UTF-8.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("rig.toml");
/// std::fs::write(&path, "rate_hz = 1000.0")?;
/// assert_eq!(nima_files::read_text(&path, 100)?, "rate_hz = 1000.0");
/// assert!(nima_files::read_text(&path, 10).is_err(), "larger than the limit");
/// assert!(nima_files::read_text(folder.path(), 100).is_err(), "a folder is not a file");
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn read_text(path: &Path, max: u64) -> io::Result<String> {
    let no_text = |_| io::Error::new(io::ErrorKind::InvalidData, "it is not UTF-8 text; is it the right file?");
    String::from_utf8(read(path, max)?).map_err(no_text)
}

/// Opens a table (CSV) for reading as a stream: a regular file, or a pipe such as `<(zcat x.csv.gz)` or `/dev/stdin`.
///
/// # Errors
/// The path does not exist, is neither a file nor a pipe, or has more than [`TABLE_MAX`] bytes. Reading fails at
/// [`TABLE_MAX`], at a line of more than 1 MiB, and at a pipe that has no writer or is silent for 30 s.
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

/// Opens a regular file of any size for reading at arbitrary positions. Returns the file and its size in bytes.
///
/// # Errors
/// The path does not exist or is not a regular file.
pub fn open_file(path: &Path) -> io::Result<(File, u64)> {
    open(path, false).map(|(file, metadata)| (file, metadata.len()))
}

#[derive(Debug)]
pub struct Input {
    file: File,
    /// Timeout for more data; only for a pipe.
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
            return Err(refusal("it has a line of more than 1 MiB; check that it is a table (CSV)"));
        }
        Ok(count)
    }
}

impl Input {
    /// Pipes are opened in non-blocking mode; this retries the read until data arrive.
    fn read_pipe(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let begin = Instant::now();
        loop {
            match self.file.read(buffer) {
                Ok(0) if self.taken == 0 && !buffer.is_empty() => {
                    return Err(refusal("no process writes to this pipe; start the writer first, or name a file"));
                }
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                    if begin.elapsed() > timeout {
                        return Err(refusal("no data arrive through this pipe; check the program that writes to it"));
                    }
                    thread::sleep(NAP);
                }
                done => return done,
            }
        }
    }
}

/// Opens without blocking, and only after checking the kind of file: opening alone can start a tape or a watchdog.
pub(super) fn open(path: &Path, pipes: bool) -> io::Result<(File, Metadata)> {
    let check = |metadata: &Metadata| match what_it_is(metadata) {
        None => Ok(()),
        Some(_) if pipes && is_pipe(metadata) => Ok(()),
        Some("a pipe") => Err(refusal("it is a pipe; save its output to a file and name that file")),
        Some(what) => Err(refusal(&format!("it is {what}; name a file"))),
    };
    check(&fs::metadata(path)?)?;
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NONBLOCK | libc::O_NOCTTY);
    let file = options.open(path)?;
    // The path may have been replaced since the first check.
    let metadata = file.metadata()?;
    check(&metadata)?;
    Ok((file, metadata))
}

/// Describes the kind of the file at the path if it is not a regular file.
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

fn too_large(max: u64) -> io::Error {
    let size = if max >= 1 << 20 { format!("{} MiB", max >> 20) } else { format!("{max} bytes") };
    io::Error::new(
        io::ErrorKind::FileTooLarge,
        format!("it is larger than the limit of {size}; check that this is the right file"),
    )
}

pub(super) fn refusal(words: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, words)
}

#[cfg(test)]
#[path = "input_tests.rs"]
mod tests;
