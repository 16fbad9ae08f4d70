//! The folder in which this user's emulators create their sockets and terminals, and its required permissions.
//!
//! Anyone who may write in such a folder could replace a device, or redirect the emulators' files with a link. The
//! folder is therefore created for this user alone, and a folder that another user owns or may write in is refused.

use std::path::PathBuf;

/// Returns the folder for relative paths of emulated devices: in the user's runtime folder or, if the system has none,
/// a folder of this user among the temporary ones. The folder is neither created nor checked ([`prepare`] does that).
pub fn runtime_folder() -> PathBuf {
    let given = std::env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from);
    match given.filter(|folder| folder.is_absolute() && is_own(folder)) {
        Some(folder) => folder.join("nima-emulated"),
        None => std::env::temp_dir().join(fallback_name()),
    }
}

#[cfg(unix)]
pub use unix::lock_file;
#[cfg(unix)]
pub use unix::prepare;
#[cfg(unix)]
use unix::{fallback_name, is_own};

#[cfg(unix)]
mod unix {
    use std::{
        fs::{self, DirBuilder, File, Metadata, OpenOptions},
        io::{Error, ErrorKind, Result},
        os::unix::fs::{DirBuilderExt as _, MetadataExt as _, OpenOptionsExt as _},
        path::Path,
    };

    use crate::os::user_id;

    // Every permission of group and others: a socket of an emulated device must not be reachable for them.
    const FOR_OTHERS: u32 = 0o077;
    /// Permission bit for writing by others; with the sticky bit they cannot remove each other's files.
    const WORLD_WRITABLE: u32 = 0o002;
    const STICKY: u32 = 0o1000;

    pub(super) fn fallback_name() -> String {
        format!("nima-emulated-{}", user_id())
    }

    /// Returns whether this user owns the folder and no other user may enter it, as for a runtime folder.
    pub(super) fn is_own(folder: &Path) -> bool {
        fs::symlink_metadata(folder)
            .is_ok_and(|there| there.is_dir() && there.uid() == user_id() && there.mode() & FOR_OTHERS == 0)
    }

    /// Creates a folder that only this user may enter, and its parents. An existing folder is accepted if it belongs to
    /// this user or to the system and no other user can replace files created in it.
    ///
    /// # Errors
    /// I/O errors; [`ErrorKind::PermissionDenied`], with the reason and what to do, if another user could interfere.
    pub fn prepare(folder: &Path) -> Result<()> {
        let report = |error: Error| Error::new(error.kind(), format!("folder {}: {error}", folder.display()));
        DirBuilder::new().recursive(true).mode(0o700).create(folder).map_err(report)?;
        // A link must be as trustworthy as the folder that it points to.
        let foreign = |there: &Metadata| ![0, user_id()].contains(&there.uid());
        let link = fs::symlink_metadata(folder).map_err(report)?;
        let there = fs::metadata(folder).map_err(report)?;
        let reason = if foreign(&link) || foreign(&there) {
            "belongs to another user"
        } else if there.mode() & (WORLD_WRITABLE | STICKY) == WORLD_WRITABLE {
            "is writable by every user"
        } else {
            return Ok(());
        };
        let report = format!(
            "folder {} {reason}: remove it, or choose another folder for the emulated devices",
            folder.display()
        );
        Err(Error::new(ErrorKind::PermissionDenied, report))
    }

    /// Opens a file for locking: creates it if necessary, does not follow links, does not truncate.
    ///
    /// # Errors
    /// I/O errors, for instance if the path is a link.
    pub fn lock_file(path: &Path) -> Result<File> {
        let refuse = |reason: &str| {
            let report = format!("{} {reason}: remove it, or choose another folder", path.display());
            Error::new(ErrorKind::AlreadyExists, report)
        };
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false).mode(0o600);
        // Non-blocking, because opening a pipe of this name would otherwise wait for a writer.
        let file = options.custom_flags(libc::O_NOFOLLOW | libc::O_NONBLOCK).open(path);
        let file = file.map_err(|error| match error.raw_os_error() {
            Some(libc::ELOOP) => refuse("is a link"),
            _ => Error::new(error.kind(), format!("{}: {error}", path.display())),
        })?;
        let there = file.metadata()?;
        if there.is_file() && there.uid() == user_id() {
            Ok(file)
        } else {
            Err(refuse("does not belong to an emulator"))
        }
    }
}

/// Creates a folder and its parents.
///
/// # Errors
/// I/O errors.
#[cfg(not(unix))]
pub fn prepare(folder: &std::path::Path) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)
}

#[cfg(not(unix))]
fn fallback_name() -> String {
    "nima-emulated".to_owned()
}

/// Returns false, because other systems have no such variable.
#[cfg(not(unix))]
fn is_own(_: &std::path::Path) -> bool {
    false
}

#[cfg(all(test, unix))]
mod tests {
    use std::{
        fs::{self, Permissions},
        io::ErrorKind,
        os::unix::fs::{MetadataExt as _, PermissionsExt as _, symlink},
        path::Path,
    };

    use super::*;
    use crate::os::user_id;

    #[test]
    fn a_folder_is_made_for_this_user_alone_and_its_own_is_accepted() {
        let folder = tempfile::tempdir().unwrap();
        let new = folder.path().join("one/two");
        prepare(&new).unwrap();
        for made in [&new, &folder.path().join("one")] {
            assert_eq!(fs::metadata(made).unwrap().mode() & 0o777, 0o700, "{}", made.display());
        }
        prepare(&new).unwrap();
        // World-writable with the sticky bit, like /tmp.
        fs::set_permissions(&new, Permissions::from_mode(0o1777)).unwrap();
        prepare(&new).unwrap();
    }

    #[test]
    fn a_folder_in_which_others_may_interfere_is_refused_with_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let refused = |at: &Path, reason: &str| {
            let error = prepare(at).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::PermissionDenied);
            let report = error.to_string();
            assert!(report.contains(reason) && report.contains(&at.display().to_string()), "{report}");
        };
        let open = folder.path().join("open");
        prepare(&open).unwrap();
        fs::set_permissions(&open, Permissions::from_mode(0o777)).unwrap();
        refused(&open, "every user");
        // Only root may change the owner of a folder; without that right this part cannot be tested.
        let foreign = folder.path().join("foreign");
        prepare(&foreign).unwrap();
        if std::os::unix::fs::chown(&foreign, Some(user_id() + 12345), None).is_ok() {
            refused(&foreign, "another user");
            let link = folder.path().join("link");
            symlink(&foreign, &link).unwrap();
            refused(&link, "another user");
        }
    }

    #[test]
    fn a_planted_lock_is_neither_followed_nor_emptied() {
        let folder = tempfile::tempdir().unwrap();
        let victim = folder.path().join("victim");
        let lock = folder.path().join(".tty.lock");
        fs::write(&victim, "kept").unwrap();
        symlink(&victim, &lock).unwrap();
        let report = lock_file(&lock).unwrap_err().to_string();
        assert!(report.contains("is a link") && report.contains(".tty.lock"), "{report}");
        assert_eq!(fs::read_to_string(&victim).unwrap(), "kept");
        fs::remove_file(&lock).unwrap();
        fs::hard_link(&victim, &lock).unwrap();
        lock_file(&lock).unwrap();
        assert_eq!(fs::read_to_string(&victim).unwrap(), "kept");
        fs::remove_file(&lock).unwrap();
        assert!(std::process::Command::new("mkfifo").arg(&lock).status().unwrap().success());
        assert!(lock_file(&lock).unwrap_err().to_string().contains("does not belong to an emulator"));
    }
}
