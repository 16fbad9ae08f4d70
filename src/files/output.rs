//! Writes to a temporary file first, then renames it. Only a regular file is ever replaced; a link is followed.

use std::{
    fs::{self, File, Metadata},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

#[cfg(windows)]
use std::{
    thread,
    time::{Duration, Instant},
};

use tempfile::NamedTempFile;

use super::input::{open, refusal, what_it_is};

/// Time for which another program may keep a file open before its replacement fails.
#[cfg(windows)]
const HELD_MAX: Duration = Duration::from_millis(500);

/// Writes `path` with `fill`. On any error the old file, if any, is unchanged.
///
/// An existing file keeps its mode and, where the system allows it, its owner; a new file gets the usual mode. If
/// `path` is a link, its target is replaced.
///
/// # Errors
/// `path` is a folder, pipe, socket, device or dangling link, or writing fails.
///
/// ```
/// use std::io::{Error, Write};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("figures.csv");
/// nima_files::write_atomically(&path, |file| file.write_all(b"t_s,force_n\n"))?;
///
/// let broken = nima_files::write_atomically(&path, |file| {
///     file.write_all(b"half")?;
///     Err(Error::other("the disk is full"))
/// });
/// assert!(broken.is_err());
/// assert_eq!(std::fs::read(&path)?, b"t_s,force_n\n", "the old file stays");
/// # Ok::<(), Error>(())
/// ```
pub fn write_atomically(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let target = OutputTarget::at(path)?;
    target.replace(target.old.as_ref(), fill)
}

/// Copies the regular file `from` to `to`, with its mode and, where the system allows it, its owner.
///
/// # Errors
/// The errors of [`write_atomically`]; `from` does not exist or is not a regular file.
pub fn copy_atomically(from: &Path, to: &Path) -> io::Result<()> {
    let (mut old, metadata) = open(from, false)?;
    OutputTarget::at(to)?.replace(Some(&metadata), |file| io::copy(&mut old, file).map(drop))
}

/// Writes a new file that only its owner can read, for keys.
///
/// # Errors
/// The file exists already, or writing fails.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("key");
/// nima_files::write_private(&path, "secret\n")?;
/// assert!(nima_files::write_private(&path, "another\n").is_err());
/// assert_eq!(std::fs::read(&path)?, b"secret\n");
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn write_private(path: &Path, text: &str) -> io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    // The temporary file is readable by its owner only from the start.
    let mut file = NamedTempFile::new_in(folder)?;
    file.write_all(text.as_bytes())?;
    file.as_file().sync_all()?;
    file.persist_noclobber(path).map(drop).map_err(|error| error.error)
}

/// Checks whether [`write_atomically`] could replace `path` without destroying one of the `inputs`. Call it before
/// computing the result for the file.
///
/// # Errors
/// Everything that [`write_atomically`] refuses, a missing folder, and an input that is the same file, also under
/// another name.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let input = folder.path().join("poses.csv");
/// std::fs::write(&input, "fx_n\n")?;
/// assert!(nima_files::check_output(&input, &[&input]).is_err(), "the output is the input");
/// assert!(nima_files::check_output(&folder.path().join("out.csv"), &[&input]).is_ok());
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn check_output(path: &Path, inputs: &[&Path]) -> io::Result<()> {
    let target = OutputTarget::at(path)?;
    fs::metadata(target.folder())?;
    if let Some(old) = &target.old
        && let Some(input) = inputs.iter().find(|input| is_same(old, &target.path, input))
    {
        return Err(refusal(&format!("it is the input {} itself; choose another file", input.display())));
    }
    Ok(())
}

/// The final path of a file, with links followed, and the existing file.
struct OutputTarget {
    path: PathBuf,
    old: Option<Metadata>,
}

impl OutputTarget {
    fn at(path: &Path) -> io::Result<Self> {
        let here = match fs::symlink_metadata(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Ok(Self { path: path.to_owned(), old: None });
            }
            here => here?,
        };
        let is_link = here.is_symlink();
        let nothing = |error: io::Error| match error.kind() {
            io::ErrorKind::NotFound => refusal("it is a link to a file that does not exist; name that file itself"),
            _ => error,
        };
        // Let the system follow the link first: it refuses to follow other users' links in shared folders.
        let old = if is_link { fs::metadata(path).map_err(nothing)? } else { here };
        if let Some(what) = what_it_is(&old) {
            return Err(refusal(&format!("{what} exists and is never replaced; choose another name")));
        }
        let path = if is_link { path.canonicalize()? } else { path.to_owned() };
        Ok(Self { path, old: Some(old) })
    }

    fn folder(&self) -> &Path {
        self.path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
    }

    fn replace(&self, like: Option<&Metadata>, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        let mut file = temporary(self.folder(), like)?;
        let mut buffer = BufWriter::new(file.as_file_mut());
        fill(&mut buffer)?;
        buffer.flush()?;
        drop(buffer);
        like.map_or(Ok(()), |like| keep(file.as_file(), like))?;
        put(file, &self.path)
    }
}

#[cfg(not(windows))]
fn put(file: NamedTempFile, path: &Path) -> io::Result<()> {
    file.persist(path).map(drop).map_err(|error| error.error)
}

/// A virus scanner, an indexer or a reader of the old file may block the replacement for a moment.
#[cfg(windows)]
fn put(file: NamedTempFile, path: &Path) -> io::Result<()> {
    let file = file.into_temp_path();
    let begin = Instant::now();
    loop {
        // `persist` never replaces a file that another process has open.
        match fs::rename(&file, path) {
            Err(error) if is_held(&error) && begin.elapsed() < HELD_MAX => thread::sleep(HELD_MAX / 50),
            done => return done,
        }
    }
}

#[cfg(windows)]
fn is_held(error: &io::Error) -> bool {
    const SHARING_VIOLATION: i32 = 32;
    error.kind() == io::ErrorKind::PermissionDenied || error.raw_os_error() == Some(SHARING_VIOLATION)
}

/// A replacement is as private as the file it replaces, from the beginning; a new file follows the user's umask.
#[cfg(unix)]
fn temporary(folder: &Path, like: Option<&Metadata>) -> io::Result<NamedTempFile> {
    use std::os::unix::fs::PermissionsExt as _;
    let mode = if like.is_some() { 0o600 } else { 0o666 };
    tempfile::Builder::new().permissions(fs::Permissions::from_mode(mode)).tempfile_in(folder)
}

/// Changes the owner first: a change of owner clears bits of the mode.
#[cfg(unix)]
fn keep(file: &File, like: &Metadata) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _, fchown};
    let ours = file.metadata()?;
    let mut mode = like.mode() & 0o777;
    if (ours.uid(), ours.gid()) != (like.uid(), like.gid()) && fchown(file, Some(like.uid()), Some(like.gid())).is_err()
    {
        // The file now belongs to our group, so the old group's permissions must not apply.
        mode &= 0o707;
    }
    file.set_permissions(fs::Permissions::from_mode(mode))
}

/// Must not be marked as temporary: the mark would remain after the rename.
#[cfg(not(unix))]
fn temporary(folder: &Path, _: Option<&Metadata>) -> io::Result<NamedTempFile> {
    tempfile::Builder::new().make_in(folder, |path| File::options().read(true).write(true).create_new(true).open(path))
}

#[cfg(not(unix))]
fn keep(_: &File, _: &Metadata) -> io::Result<()> {
    Ok(())
}

#[cfg(unix)]
fn is_same(old: &Metadata, _: &Path, input: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    fs::metadata(input).is_ok_and(|input| (input.dev(), input.ino()) == (old.dev(), old.ino()))
}

#[cfg(not(unix))]
fn is_same(_: &Metadata, path: &Path, input: &Path) -> bool {
    matches!((path.canonicalize(), input.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

#[cfg(test)]
#[path = "output_tests.rs"]
mod tests;
