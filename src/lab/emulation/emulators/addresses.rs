//! Endpoints of emulators: ports of this computer, names of pseudo-terminals and paths of sockets, each claimed by one
//! process at a time.
//!
//! A name is a link to the terminal. Remains of a dead process are replaced. An endpoint of a running process, and
//! anything not created by an emulator (a real device, a file), is left alone and reported in one line. Folders are
//! those that [`own_folder`](nima_devices::own_folder) accepts.

use std::io::{Error, ErrorKind, Result};
#[cfg(unix)]
use std::path::{Path, PathBuf};

/// Adds the remedy to the error if a requested port is in use by another program.
pub(super) fn taken<T>(port: u16, protocol: &str, bound: Result<T>) -> Result<T> {
    bound.map_err(|error| {
        let reason = match error.kind() {
            ErrorKind::AddrInUse => {
                "is in use by another program, perhaps by another emulated rig: end it, or change the port"
            }
            ErrorKind::PermissionDenied => "requires administrator rights, like all ports below 1024: use another port",
            _ => return error,
        };
        Error::new(error.kind(), format!("{protocol} port {port} of this computer {reason}"))
    })
}

/// Returns `path` after creating its folder; without a path, `name` in a new folder, which is deleted with the second
/// value.
#[cfg(unix)]
fn path_of(path: Option<&Path>, name: &str) -> Result<(PathBuf, Option<tempfile::TempDir>)> {
    let Some(path) = path else {
        let folder = tempfile::Builder::new().prefix("nima-").tempdir()?;
        return Ok((folder.path().join(name), Some(folder)));
    };
    if let Some(parent) = path.parent().filter(|parent| !parent.as_os_str().is_empty()) {
        nima_devices::own_folder::prepare(parent)?;
    }
    Ok((path.to_owned(), None))
}

#[cfg(unix)]
fn foreign(path: &Path) -> Error {
    let report = format!("{} does not belong to an emulator: choose another path, or remove it", path.display());
    Error::new(ErrorKind::AlreadyExists, report)
}

#[cfg(unix)]
fn served(path: &Path) -> Error {
    let report = format!("{} is in use by another emulator: end that emulator, or use another path", path.display());
    Error::new(ErrorKind::AddrInUse, report)
}

/// Returns a path for a socket, like [`path_of`]; a path left by a dead process is freed.
#[cfg(target_os = "linux")]
pub(super) fn socket_path(path: Option<&Path>, name: &str) -> Result<(PathBuf, Option<tempfile::TempDir>)> {
    use std::os::unix::fs::FileTypeExt as _;
    let (path, folder) = path_of(path, name)?;
    match std::fs::symlink_metadata(&path) {
        Err(_) => {}
        Ok(there) if !there.file_type().is_socket() => return Err(foreign(&path)),
        Ok(_) => match nima_devices::hid::seqpacket::connect(&path) {
            Err(error) if error.kind() == ErrorKind::ConnectionRefused => std::fs::remove_file(&path)?,
            _ => return Err(served(&path)),
        },
    }
    Ok((path, folder))
}

#[cfg(unix)]
pub(super) use terminal::TerminalName;

#[cfg(unix)]
mod terminal {
    use std::{
        fs::{self, File, TryLockError},
        io::{Error, Result},
        os::unix::fs::symlink,
        path::{Path, PathBuf},
        thread::sleep,
        time::{Duration, Instant},
    };

    use nima_devices::own_folder::lock_file;
    use serialport::{SerialPort as _, TTYPort};

    use super::{foreign, path_of, served};

    /// A program started by this process inherits the lock until it has been loaded, even if the emulator has just
    /// ended.
    const INHERITED: Duration = Duration::from_millis(500);
    /// Folder of the system's pseudo-terminals: only links into it are replaced.
    const TERMINALS: &str = "/dev/pts/";

    /// The name of a pseudo-terminal, held for the lifetime of this value; the link exists while a terminal is
    /// connected.
    #[derive(Debug)]
    pub(in crate::emulators) struct TerminalName {
        path: PathBuf,
        /// Lock of this process: the system releases it when the process ends for any reason.
        _claim: File,
        /// Temporary folder, if no path was requested.
        _folder: Option<tempfile::TempDir>,
    }

    impl TerminalName {
        /// Claims `link`; without one, `name` in its own folder. Parent folders are created.
        pub(in crate::emulators) fn claim(link: Option<&Path>, name: &str) -> Result<Self> {
            let (path, folder) = path_of(link, name)?;
            let claim = lock_file(&hidden(&path, "lock"))?;
            let begin = Instant::now();
            loop {
                match claim.try_lock() {
                    Ok(()) => break,
                    Err(TryLockError::Error(error)) => return Err(error),
                    Err(TryLockError::WouldBlock) if begin.elapsed() < INHERITED => sleep(INHERITED / 50),
                    Err(TryLockError::WouldBlock) => return Err(served(&path)),
                }
            }
            if !may_be_replaced(&path) {
                return Err(foreign(&path));
            }
            Ok(Self { path, _claim: claim, _folder: folder })
        }

        /// Returns the path that a client opens.
        pub(in crate::emulators) fn path(&self) -> String {
            self.path.display().to_string()
        }

        /// Links the name to this terminal from now on.
        pub(in crate::emulators) fn lead_to(&self, terminal: &TTYPort) -> Result<()> {
            let target = terminal.name().ok_or_else(|| Error::other("a pseudo-terminal without a name"))?;
            let fresh = hidden(&self.path, "new");
            fs::remove_file(&fresh).ok();
            symlink(target, &fresh)?;
            fs::rename(&fresh, &self.path)
        }

        /// Removes the link, as when the cable is unplugged.
        pub(in crate::emulators) fn cut(&self) {
            fs::remove_file(&self.path).ok();
        }
    }

    impl Drop for TerminalName {
        fn drop(&mut self) {
            self.cut();
        }
    }

    /// Returns a file next to `path` that no listing of devices shows.
    fn hidden(path: &Path, kind: &str) -> PathBuf {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        path.with_file_name(format!(".{name}.{kind}"))
    }

    /// Returns whether nothing exists at the path, or a link left by an emulator.
    fn may_be_replaced(path: &Path) -> bool {
        match fs::symlink_metadata(path) {
            Err(_) => true,
            Ok(_) => fs::read_link(path).is_ok_and(|target| target.starts_with(TERMINALS)),
        }
    }

    #[cfg(test)]
    mod tests {
        use std::io::ErrorKind;

        use super::*;

        #[test]
        fn a_name_has_one_owner_and_what_a_dead_one_left_is_replaced() {
            let folder = tempfile::tempdir().unwrap();
            let link = folder.path().join("new/folder/ttyACM0");
            let (_near, far) = TTYPort::pair().unwrap();
            let first = TerminalName::claim(Some(&link), "tty").unwrap();
            first.lead_to(&far).unwrap();
            assert_eq!(fs::read_link(&link).unwrap().to_str(), far.name().as_deref());
            let second = TerminalName::claim(Some(&link), "tty").unwrap_err();
            assert!(second.kind() == ErrorKind::AddrInUse && second.to_string().contains("ttyACM0"), "{second}");
            drop(first);
            assert!(fs::symlink_metadata(&link).is_err(), "the name goes with its owner");
            symlink("/dev/pts/9999", &link).unwrap();
            let third = TerminalName::claim(Some(&link), "tty").unwrap();
            third.lead_to(&far).unwrap();
            assert_eq!(fs::read_link(&link).unwrap().to_str(), far.name().as_deref());
        }

        #[test]
        fn a_real_device_or_a_file_is_left_alone() {
            let folder = tempfile::tempdir().unwrap();
            let file = folder.path().join("file");
            let device = folder.path().join("by-id");
            fs::write(&file, "kept").unwrap();
            symlink("/dev/null", &device).unwrap();
            for path in [&file, &device] {
                let refused = TerminalName::claim(Some(path), "tty").unwrap_err();
                assert_eq!(refused.kind(), ErrorKind::AlreadyExists, "{refused}");
            }
            assert_eq!(fs::read_to_string(&file).unwrap(), "kept");
            assert_eq!(fs::read_link(&device).unwrap(), Path::new("/dev/null"));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::net::TcpListener;

    use super::*;

    #[test]
    fn a_port_in_use_is_told_with_its_number() {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let port = listener.local_addr().unwrap().port();
        let error = taken(port, "TCP", TcpListener::bind(("127.0.0.1", port))).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::AddrInUse);
        assert!(error.to_string().contains(&format!("TCP port {port}")), "{error}");
    }
}
