//! Path of a changed rig file: a user's file is changed in place, a built-in rig is first copied into the user's
//! folder.

use std::path::{Path, PathBuf};

use nima_core::calibration::frames::RigChange;

use super::{RigConfig, RigFile, RigFileError};

/// Returns the file to write when the rig of this name changes, and the rig's new name. A user's file keeps its path
/// and name (`None`). A built-in rig gets the first free file of `NAME-2.toml`, `NAME-3.toml`, ... in `folder`, and the
/// number is added to its name.
pub fn own_copy(rig: &RigConfig, name: &str, folder: &Path) -> (PathBuf, Option<String>) {
    if RigConfig::names().all(|built_in| built_in != name) {
        return (PathBuf::from(name), None);
    }
    let path = |number: u32| folder.join(format!("{name}-{number}")).with_extension("toml");
    let number = (2..u32::MAX).find(|number| !path(*number).exists()).unwrap_or(u32::MAX);
    (path(number), Some(format!("{} {number}", rig.name)))
}

/// Applies these changes to the rig of this name and writes its file, or for a built-in rig a copy of it in `folder`;
/// comments are kept. Returns the path and the changed rig.
///
/// # Errors
/// [`RigFileError`] if the rig cannot be read, would be impossible afterwards, or its file cannot be written.
///
/// ```
/// use nima_core::calibration::frames::RigChange;
/// use nima_machine::config::change_rig;
///
/// let folder = tempfile::tempdir()?;
/// let key = "devices.right.mount.shaft_m".to_owned();
/// let change = RigChange { key, before: Some("0.40".to_owned()), after: Some("0.403".to_owned()) };
/// let (path, rig) = change_rig("emulated", folder.path(), std::slice::from_ref(&change))?;
/// assert_eq!(path, folder.path().join("emulated-2.toml"));
/// assert_eq!(rig.devices.and_then(|devices| devices.right).map(|set| set.mount.shaft_m), Some(0.403));
///
/// let name = path.to_str().ok_or("a path in letters")?;
/// let (same, _) = change_rig(name, folder.path(), &[change.undone()])?;
/// assert_eq!(same, path, "a user's file is changed in place");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn change_rig(rig: &str, folder: &Path, changes: &[RigChange]) -> Result<(PathBuf, RigConfig), RigFileError> {
    let mut file = RigFile::of(rig)?;
    for change in changes {
        match &change.after {
            // Invalid text can come only from a damaged record, and changes nothing.
            Some(text) => _ = file.set_text(&change.key, text),
            None => file.remove(&change.key),
        }
    }
    let (path, new_name) = own_copy(&file.rig()?, rig, folder);
    if let Some(new_name) = new_name {
        file.set("name", new_name);
    }
    let rig = file.save(&path)?;
    Ok((path, rig))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_built_in_rig_never_overwrites_a_file_and_a_file_stays_where_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let rig = RigConfig::load("emulated").unwrap();
        let (first, name) = own_copy(&rig, "emulated", folder.path());
        assert_eq!(first, folder.path().join("emulated-2.toml"));
        assert_eq!(name.as_deref(), Some("Emulated rig 2"));
        std::fs::write(&first, "").unwrap();
        assert_eq!(own_copy(&rig, "emulated", folder.path()).0, folder.path().join("emulated-3.toml"));
        assert_eq!(own_copy(&rig, "mine/rig.toml", folder.path()), (PathBuf::from("mine/rig.toml"), None));
    }

    #[test]
    fn an_impossible_change_is_told_and_nothing_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let far = RigChange {
            key: "devices.right.base_from_c_m".to_owned(),
            before: None,
            after: Some("[nan, 0.0, 0.0]".to_owned()),
        };
        let report = change_rig("emulated", folder.path(), &[far]).map(|(path, _)| path);
        assert!(report.is_err(), "{report:?}");
        assert!(!folder.path().join("emulated-2.toml").exists());
    }
}
