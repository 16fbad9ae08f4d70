//! Chooses the library for a handle. Real handle: the manufacturer's library, at the path in the settings or the first
//! one found in the usual places. Emulated handle: the replacement library that the program provides
//! ([`provide_stand_in`]).
//!
//! A real handle never uses a replacement library, wherever one may be installed, and an emulated handle never uses the
//! manufacturer's.

use std::{
    env,
    path::{Path, PathBuf},
    sync::OnceLock,
};

use super::{
    ForceDimensionSettings,
    sdk::{NAME, STAND_IN_SYMBOL, Sdk, is_stand_in, keep, open_library, unusable},
};
use crate::DeviceError;

#[derive(Clone, Debug, PartialEq, Eq)]
enum LibraryCandidate {
    File(PathBuf),
    /// A name for the system's search.
    Name(&'static str),
}

/// Names for the system's search, the most complete library first (`libdrd` includes all of `libdhd`).
#[cfg(target_os = "windows")]
const NAMES: &[&str] = &["drd64.dll", "dhd64.dll"];
#[cfg(target_os = "macos")]
const NAMES: &[&str] = &["libdrd.dylib", "libdhd.dylib"];
#[cfg(not(any(target_os = "windows", target_os = "macos")))]
const NAMES: &[&str] = &["libdrd.so.3", "libdrd.so", "libdhd.so.3", "libdhd.so"];

/// Beginnings of file names, in the same order.
#[cfg(target_os = "windows")]
const FILES: &[&str] = &["drd64.dll", "dhd64.dll"];
#[cfg(target_os = "macos")]
const FILES: &[&str] = &["libdrd.", "libdhd."];
#[cfg(not(any(target_os = "windows", target_os = "macos")))]
const FILES: &[&str] = &["libdrd.so", "libdhd.so"];

/// Returns the folder of the library within the SDK.
fn within_sdk() -> PathBuf {
    if cfg!(target_os = "windows") {
        PathBuf::from("bin")
    } else if cfg!(target_os = "macos") {
        Path::new("lib/release").join(format!("mac-{}-clang", env::consts::ARCH))
    } else {
        Path::new("lib/release").join(format!("lin-{}-gcc", env::consts::ARCH))
    }
}

/// Returns the folders to search, most specific first; `variable` reads the environment.
fn folders(variable: impl Fn(&str) -> Option<PathBuf>) -> (Vec<PathBuf>, Vec<PathBuf>) {
    let sdk = ["FDSDK", "FORCEDIM_SDK"].into_iter().filter_map(&variable).map(|sdk| sdk.join(within_sdk())).collect();
    let mut system = Vec::new();
    if cfg!(unix) {
        system.push(PathBuf::from("/usr/local/lib"));
        system.extend(variable("HOME").map(|home| home.join(".local/lib")));
    }
    (sdk, system)
}

/// Returns the numbers in a file name, for comparing versions: 3.17 is newer than 3.9.
fn version(path: &Path) -> Vec<u32> {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    name.split('.').filter_map(|part| part.parse().ok()).collect()
}

/// Returns the newest library in a folder.
fn newest(folder: &Path, beginning: &str) -> Option<PathBuf> {
    let here = std::fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path());
    let fits = |path: &PathBuf| {
        path.file_name().and_then(|name| name.to_str()).is_some_and(|name| name.starts_with(beginning))
            && path.is_file()
    };
    here.filter(fits).max_by_key(|path| version(path))
}

/// Returns the libraries to try, and a list of them for a message.
fn candidates() -> (Vec<LibraryCandidate>, String) {
    search(|name| env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from))
}

fn search(variable: impl Fn(&str) -> Option<PathBuf>) -> (Vec<LibraryCandidate>, String) {
    let (sdk, system) = folders(&variable);
    let all_of = |folders: &[PathBuf]| -> Vec<LibraryCandidate> {
        let found = FILES.iter().flat_map(|file| folders.iter().filter_map(|folder| newest(folder, file)));
        found.map(LibraryCandidate::File).collect()
    };
    let mut candidates = all_of(&sdk);
    candidates.extend(NAMES.iter().copied().map(LibraryCandidate::Name));
    candidates.extend(all_of(&system));
    let mut places: Vec<String> = sdk.iter().map(|folder| folder.display().to_string()).collect();
    if variable("FDSDK").is_none() {
        places.push("the folder that FDSDK names (it is not set)".to_owned());
    }
    places.push(format!("the system's libraries ({})", NAMES.join(", ")));
    places.extend(system.iter().map(|folder| folder.display().to_string()));
    (candidates, places.join("; "))
}

/// The replacement library for emulated handles, once the program has provided it.
static STAND_IN: OnceLock<&'static Sdk> = OnceLock::new();

/// Makes this program use `sdk` for emulated handles ([`ForceDimensionSettings::emulator`]); later calls have no effect.
pub fn provide_stand_in(sdk: &'static Sdk) {
    STAND_IN.get_or_init(|| sdk);
}

pub(super) fn of(settings: &ForceDimensionSettings) -> Result<&'static Sdk, DeviceError> {
    let sdk = match (&settings.library, settings.emulator) {
        (Some(path), _) if !path.is_file() => return Err(missing(path.display().to_string())),
        (Some(path), _) => load_file(path)?,
        (None, Some(_)) => STAND_IN.get().copied().ok_or_else(no_stand_in)?,
        (None, None) => installed()?,
    };
    match settings.emulator {
        Some(address) => sdk.emulate(&address.to_string())?,
        None if sdk.is_stand_in() => {
            return Err(unusable(
                sdk.path(),
                "it is the library for emulated handles, but this handle is not emulated".to_owned(),
            ));
        }
        None => {}
    }
    Ok(sdk)
}

fn no_stand_in() -> DeviceError {
    unusable(
        "(within this program)",
        "this program was built without the replacement library for emulated handles".to_owned(),
    )
}

/// Returns the first usable library of the manufacturer. Replacement libraries found on the way (in a build folder that
/// the system searches) are skipped.
fn installed() -> Result<&'static Sdk, DeviceError> {
    let (candidates, searched) = candidates();
    for candidate in &candidates {
        let path = match candidate {
            LibraryCandidate::File(path) => path.canonicalize().unwrap_or_else(|_| path.clone()),
            LibraryCandidate::Name(name) => PathBuf::from(name),
        };
        match (open_library(&path), candidate) {
            (Ok(library), _) if is_stand_in(&library) => {}
            (Ok(library), _) => return keep(&path, library),
            // A message that begins with this file's name means that the file is missing; with another name, that a
            // required library is missing.
            (Err(error), LibraryCandidate::Name(name)) if error.starts_with(name) || cfg!(not(target_os = "linux")) => {
            }
            (Err(error), _) => return Err(unusable(&path.display().to_string(), error)),
        }
    }
    Err(missing(searched))
}

/// Returns the path of the library that would be loaded, if it is a file. The library is not loaded.
pub fn installed_library() -> Option<PathBuf> {
    let real = |path: &PathBuf| path.is_file() && !is_stand_in_file(path);
    let by_linker = |name: &str| linker_folders().into_iter().map(|folder| folder.join(name)).find(real);
    candidates().0.into_iter().find_map(|candidate| match candidate {
        LibraryCandidate::File(path) => Some(path).filter(real),
        LibraryCandidate::Name(name) => by_linker(name),
    })
}

/// Returns whether a file is a replacement library, recognised by a symbol that only such a library has.
fn is_stand_in_file(path: &Path) -> bool {
    let symbol = STAND_IN_SYMBOL.as_bytes();
    std::fs::read(path).is_ok_and(|bytes| bytes.windows(symbol.len()).any(|window| window == symbol))
}

/// Returns the folders of the system's search.
fn linker_folders() -> Vec<PathBuf> {
    let named = env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    let mut folders: Vec<_> = env::split_paths(&named).filter(|path| !path.as_os_str().is_empty()).collect();
    if cfg!(unix) {
        folders.push(format!("/usr/lib/{}-linux-gnu", env::consts::ARCH).into());
        folders.extend(["/usr/lib64", "/usr/lib", "/lib"].map(PathBuf::from));
    }
    folders
}

fn missing(searched: String) -> DeviceError {
    DeviceError::SdkMissing { name: NAME.to_owned(), searched }
}

fn load_file(path: &Path) -> Result<&'static Sdk, DeviceError> {
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let library = open_library(&path).map_err(|error| unusable(&path.display().to_string(), error))?;
    keep(&path, library)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn the_newest_library_of_the_sdk_comes_first_and_the_list_tells_every_place() {
        let sdk = tempfile::tempdir().unwrap();
        let folder = sdk.path().join(within_sdk());
        std::fs::create_dir_all(&folder).unwrap();
        for name in ["libdrd.so.3.9.1", "libdrd.so.3.17.5", "libdhd.so.3.17.5", "libdrd.a"] {
            std::fs::write(folder.join(name), "").unwrap();
        }
        let home = tempfile::tempdir().unwrap();
        let set = |name: &str| match name {
            "FDSDK" => Some(sdk.path().to_owned()),
            "HOME" => Some(home.path().to_owned()),
            _ => None,
        };
        let (candidates, places) = search(set);
        assert_eq!(candidates[0], LibraryCandidate::File(folder.join("libdrd.so.3.17.5")));
        assert_eq!(candidates[1], LibraryCandidate::File(folder.join("libdhd.so.3.17.5")));
        assert_eq!(candidates[2], LibraryCandidate::Name("libdrd.so.3"));
        for place in [folder.display().to_string().as_str(), "libdhd.so", "/usr/local/lib", ".local/lib"] {
            assert!(places.contains(place), "{place} is not in {places}");
        }
        let (candidates, places) = search(|_| None);
        assert_eq!(candidates[0], LibraryCandidate::Name("libdrd.so.3"));
        assert!(places.contains("FDSDK names (it is not set)"));
    }
}
