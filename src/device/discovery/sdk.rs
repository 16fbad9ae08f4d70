//! Whether a manufacturer's library is on this computer; looked for, not loaded.

use std::{
    path::{Path, PathBuf},
    time::Duration,
};

use super::{Found, Probe};
use crate::device::{Identity, Standing, Trouble};

/// A try of a library.
#[derive(Debug)]
pub struct LibraryProbe {
    name: &'static str,
    folders: Vec<PathBuf>,
    files: &'static [&'static str],
}

/// Their beginnings; versions follow.
const FORCE_DIMENSION_FILES: &[&str] = &["libdrd.so", "libdhd.so", "drd64.dll", "libdrd.dylib"];

/// Folders that the SDK's own samples and common clients use.
fn force_dimension_folders() -> Vec<PathBuf> {
    let mut folders = Vec::new();
    for key in ["FDSDK", "FORCEDIM_SDK"] {
        if let Some(sdk) = std::env::var_os(key) {
            let sdk = PathBuf::from(sdk);
            let machine = format!("lib/release/lin-{}-gcc", std::env::consts::ARCH);
            folders.extend([sdk.join(machine), sdk.join("lib"), sdk]);
        }
    }
    if let Some(list) = std::env::var_os("LD_LIBRARY_PATH") {
        folders.extend(std::env::split_paths(&list).filter(|path| !path.as_os_str().is_empty()));
    }
    if let Some(home) = std::env::var_os("HOME") {
        folders.push(Path::new(&home).join(".local/lib"));
    }
    let system = ["/usr/local/lib", "/usr/lib", "/usr/lib64"].map(PathBuf::from);
    folders.extend(system);
    folders.push(format!("/usr/lib/{}-linux-gnu", std::env::consts::ARCH).into());
    folders
}

/// The Force Dimension library, where it is found.
pub fn force_dimension_library() -> Option<PathBuf> {
    LibraryProbe::force_dimension().find()
}

impl LibraryProbe {
    /// Of the Force Dimension SDK.
    pub fn force_dimension() -> Self {
        Self { name: "Force Dimension SDK", folders: force_dimension_folders(), files: FORCE_DIMENSION_FILES }
    }

    /// Of the same in other folders.
    #[must_use]
    pub fn in_folders(self, folders: Vec<PathBuf>) -> Self {
        Self { folders, ..self }
    }

    /// Where it is.
    pub fn find(&self) -> Option<PathBuf> {
        for file in self.files {
            for folder in &self.folders {
                let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
                let fits = entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(file));
                // The highest version.
                if let Some(path) = fits.map(|entry| entry.path()).max() {
                    return Some(path);
                }
            }
        }
        None
    }
}

impl Probe for LibraryProbe {
    fn name(&self) -> &str {
        self.name
    }

    fn probe(&mut self, _: Duration) -> Result<Found, Trouble> {
        let folders: Vec<_> = self.folders.iter().map(|folder| folder.display().to_string()).collect();
        let missing = || Trouble::SdkMissing { name: self.name.to_owned(), searched: folders.join(", ") };
        let path = self.find().ok_or_else(missing)?;
        let identity = Identity { product: format!("library {}", path.display()), ..Identity::default() };
        Ok(Found { identity, standing: Standing::Connected, ..Found::default() })
    }
}
