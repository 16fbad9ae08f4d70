//! Tool definitions: `.rom` files, written to the unit in pieces (reference 1.3; 752 bytes are used, 1024 are always
//! sent).

use std::path::Path;

use super::command::CHUNK;
use crate::DeviceError;

/// Length of a definition as sent, padded with zeros, as `ndicapi` does.
pub const DEFINITION: usize = 1024;
// Every tool definition (`.rom`) begins with these bytes; another file is refused before it is sent.
const BEGIN: &[u8] = b"NDI\0";

/// A tool definition in the form in which it is sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NdiDefinition(Box<[u8; DEFINITION]>);

impl NdiDefinition {
    /// Reads the file named under `key` in the rig file.
    ///
    /// # Errors
    /// [`DeviceError::File`] if the file cannot be read, is too long, or is not a tool definition.
    pub fn load(key: &str, path: &Path) -> Result<Self, DeviceError> {
        let refuse =
            |reason: String| DeviceError::File { key: key.to_owned(), path: path.display().to_string(), reason };
        let file = nima_files::read(path, DEFINITION as u64)
            .map_err(|error| refuse(format!("the file cannot be read ({error})")))?;
        if !file.starts_with(BEGIN) {
            return Err(refuse("the file is not a tool definition of NDI (.rom, at most 1024 bytes)".to_owned()));
        }
        let mut bytes = Box::new([0; DEFINITION]);
        bytes[..file.len()].copy_from_slice(&file);
        Ok(Self(bytes))
    }

    pub fn chunks(&self) -> impl Iterator<Item = (u16, [u8; CHUNK])> + '_ {
        let (chunks, _) = self.0.as_chunks::<CHUNK>();
        chunks.iter().enumerate().map(|(k, data)| ((k * CHUNK) as u16, *data))
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::{fs, process::Command, sync::mpsc, thread, time::Duration};

    use super::*;

    #[test]
    fn what_is_no_definition_is_refused_without_waiting_for_it_or_reading_it_whole() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        assert!(Command::new("mkfifo").arg(place("pipe.rom")).status().unwrap().success());
        // A sparse file of 1 TB, which must not be read completely.
        fs::File::create(place("large.rom")).unwrap().set_len(1 << 40).unwrap();
        let cases = [
            (place("pipe.rom"), "it is a pipe"),
            (place("large.rom"), "it is larger than the limit of 1024 bytes"),
            ("/dev/zero".into(), "it is a device"),
            (folder.path().to_owned(), "it is a folder"),
        ];
        for (path, words) in cases {
            let (sender, receiver) = mpsc::channel();
            thread::spawn(move || sender.send(NdiDefinition::load("tools[0]", &path)));
            let trouble = receiver.recv_timeout(Duration::from_mins(1)).expect("it hangs").unwrap_err();
            assert!(trouble.to_string().contains(words) && trouble.cure().contains("correct its path"), "{trouble}");
        }
    }
}
