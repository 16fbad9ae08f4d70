//! The cameras of this computer, as listed by the kernel, without opening them.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// A camera that is plugged in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PluggedCamera {
    pub path: PathBuf,
    /// As reported by the driver.
    pub name: String,
}

/// Returns the cameras of this computer, by number.
pub fn plugged_cameras() -> Vec<PluggedCamera> {
    listed(Path::new("/sys/class/video4linux"))
}

fn listed(folder: &Path) -> Vec<PluggedCamera> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut found: Vec<(u32, PluggedCamera)> = entries.flatten().filter_map(|entry| camera(&entry.path())).collect();
    found.sort_by_key(|(number, _)| *number);
    found.into_iter().map(|(_, camera)| camera).collect()
}

fn camera(folder: &Path) -> Option<(u32, PluggedCamera)> {
    let node = folder.file_name()?.to_str()?;
    let number = node.strip_prefix("video")?.parse().ok()?;
    let line = |name: &str| fs::read_to_string(folder.join(name)).ok();
    // A camera has further nodes that do not deliver images (metadata of each image, for example).
    if line("index").is_some_and(|index| index.trim() != "0") {
        return None;
    }
    let name: String = line("name")?.trim().chars().filter(|c| !c.is_control()).take(80).collect();
    Some((number, PluggedCamera { path: Path::new("/dev").join(node), name }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_are_listed_by_number_and_once() {
        let folder = tempfile::tempdir().unwrap();
        for (node, index, name) in [
            ("video10", "0\n", "USB Video: Grabber\n"),
            ("video2", "0\n", "C920\n"),
            ("video3", "1\n", "C920\n"),
            ("vbi0", "0\n", "x\n"),
        ] {
            let node = folder.path().join(node);
            fs::create_dir(&node).unwrap();
            fs::write(node.join("index"), index).unwrap();
            fs::write(node.join("name"), name).unwrap();
        }
        let names: Vec<_> = listed(folder.path()).into_iter().map(|camera| (camera.path, camera.name)).collect();
        let expected = [("/dev/video2", "C920"), ("/dev/video10", "USB Video: Grabber")];
        assert_eq!(names, expected.map(|(path, name)| (PathBuf::from(path), name.to_owned())));
        assert_eq!(listed(&folder.path().join("missing")), []);
    }
}
