//! Creates a user's rig file from another rig.

use std::path::{Path, PathBuf};

use nima_machine::config::RigFile;
use nima_words::{report_text::chain, text};

/// Writes a copy of the rig `from` under a new name; returns its path.
pub(super) fn make(folder: Option<&Path>, from: &str, name: &str) -> Result<PathBuf, String> {
    let folder = folder.ok_or(text::start::NO_FOLDER.get())?;
    let name = name.trim();
    let allowed = |c: char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    if name.is_empty() || name.len() > 60 || !name.chars().all(allowed) {
        return Err(text::start::NAME_FIRST.get().to_owned());
    }
    let file = name.to_lowercase().replace(' ', "-");
    let path = folder.join("rigs").join(file).with_extension("toml");
    if path.exists() {
        return Err(text::start::taken(&path));
    }
    let mut rig = RigFile::of(from).map_err(|error| chain(&error))?;
    rig.set("name", name);
    rig.save(&path).map_err(|error| chain(&error))?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use nima_machine::config::RigConfig;

    use super::*;

    #[test]
    fn a_copy_has_its_own_name_and_everything_else_of_the_rig() {
        let folder = tempfile::tempdir().unwrap();
        let path = make(Some(folder.path()), "paper", "Theatre 3").unwrap();
        assert_eq!(path, folder.path().join("rigs/theatre-3.toml"));
        let copy = RigConfig::load(path.to_str().unwrap()).unwrap();
        assert_eq!(copy, RigConfig { name: "Theatre 3".to_owned(), ..RigConfig::load("paper").unwrap() });
        assert!(make(Some(folder.path()), "paper", "Theatre 3").unwrap_err().contains("theatre-3.toml"));
    }

    #[test]
    fn a_name_that_is_none_and_a_place_that_is_none_are_told() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["", "  ", "../x", "a/b", "a\nb"] {
            assert_eq!(
                make(Some(folder.path()), "paper", name),
                Err(text::start::NAME_FIRST.get().to_owned()),
                "{name:?}"
            );
        }
        assert_eq!(make(None, "paper", "A"), Err(text::start::NO_FOLDER.get().to_owned()));
        assert!(make(Some(folder.path()), "no such rig", "A").unwrap_err().contains("no such rig"));
        assert!(!folder.path().join("rigs").exists());
    }
}
