//! Writing: a temporary file first, then a rename. Only a regular file is ever replaced; a link is followed.

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

/// Another program may have a file open for so long before it cannot be replaced.
#[cfg(windows)]
const HELD_MAX: Duration = Duration::from_millis(500);

/// Writes `path` by `fill`; on any error the old file (or none) stays as it was.
///
/// A file that is there is replaced and keeps its mode and, where the system lets us, its owner; a new one gets the usual mode. A
/// link is followed: the file that it leads to is replaced, beside itself.
///
/// # Errors
/// A folder, pipe, socket or device at `path`, a link to nothing, and whatever the system says while writing.
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
    let target = Target::at(path)?;
    target.replace(target.old.as_ref(), fill)
}

/// Makes `to` a copy of the regular file `from`, with its mode and, where the system lets us, its owner.
///
/// # Errors
/// Those of [`write_atomically`]; no such file, or not a regular one.
pub fn copy_atomically(from: &Path, to: &Path) -> io::Result<()> {
    let (mut old, metadata) = open(from, false)?;
    Target::at(to)?.replace(Some(&metadata), |file| io::copy(&mut old, file).map(drop))
}

/// Writes a new file that its owner alone can read, as a key needs it.
///
/// # Errors
/// A file that is there already, and whatever the system says while writing.
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
    // A temporary file is its owner's alone from the beginning.
    let mut file = NamedTempFile::new_in(folder)?;
    file.write_all(text.as_bytes())?;
    file.as_file().sync_all()?;
    file.persist_noclobber(path).map(drop).map_err(|error| error.error)
}

/// Whether [`write_atomically`] could replace `path` without destroying one of the `inputs`; before the work that is to be written.
///
/// # Errors
/// What [`write_atomically`] refuses, a folder that is not there, and an input that is the same file, also by another name.
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
    let target = Target::at(path)?;
    fs::metadata(target.folder())?;
    if let Some(old) = &target.old
        && let Some(input) = inputs.iter().find(|input| is_same(old, &target.path, input))
    {
        return Err(refusal(&format!("it is the input {} itself; choose another file", input.display())));
    }
    Ok(())
}

/// Where a file is to stand, links followed, and what stands there now.
struct Target {
    path: PathBuf,
    old: Option<Metadata>,
}

impl Target {
    fn at(path: &Path) -> io::Result<Self> {
        let here = match fs::symlink_metadata(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Ok(Self { path: path.to_owned(), old: None });
            }
            here => here?,
        };
        let is_link = here.is_symlink();
        let nothing = |error: io::Error| match error.kind() {
            io::ErrorKind::NotFound => refusal("it is a link to a file that is not there; name that file itself"),
            _ => error,
        };
        // The link is followed by the system first, which knows links of strangers that may not be followed.
        let old = if is_link { fs::metadata(path).map_err(nothing)? } else { here };
        if let Some(what) = what_it_is(&old) {
            return Err(refusal(&format!("{what} is there and is left as it is; choose another name")));
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

/// Who looks at a new file (a scanner for viruses, an indexer) or reads the old one may keep it from being replaced for a moment.
#[cfg(windows)]
fn put(file: NamedTempFile, path: &Path) -> io::Result<()> {
    let file = file.into_temp_path();
    let begin = Instant::now();
    loop {
        // Not by `persist`, which never replaces a file that somebody has open.
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

/// For others as unreadable as what it is like, from the beginning; else as any new file, by the user's umask.
#[cfg(unix)]
fn temporary(folder: &Path, like: Option<&Metadata>) -> io::Result<NamedTempFile> {
    use std::os::unix::fs::PermissionsExt as _;
    let mode = if like.is_some() { 0o600 } else { 0o666 };
    tempfile::Builder::new().permissions(fs::Permissions::from_mode(mode)).tempfile_in(folder)
}

/// Owner first: a change of owner takes bits of the mode away.
#[cfg(unix)]
fn keep(file: &File, like: &Metadata) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _, fchown};
    let ours = file.metadata()?;
    let mut mode = like.mode() & 0o777;
    if (ours.uid(), ours.gid()) != (like.uid(), like.gid()) && fchown(file, Some(like.uid()), Some(like.gid())).is_err()
    {
        // Ours now: what its group was allowed is not for another group.
        mode &= 0o707;
    }
    file.set_permissions(fs::Permissions::from_mode(mode))
}

/// An ordinary file: one that is marked as temporary would stay so under its new name.
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
