//! Tool definitions: `.rom` files, written to the unit in pieces (reference 1.3; 752 bytes are used, 1024 are always
//! sent).

use std::path::Path;

use super::command::CHUNK;
use crate::DeviceError;

/// Length of a definition as sent, padded with zeros, as `ndicapi` does.
pub const DEFINITION: usize = 1024;
/// Length of the used part, whose checksum is in bytes 4 and 5, little endian: the sum of all later bytes modulo 65536.
/// Found in 18 of 18 public files.
const USED: usize = 752;
/// Maximum length of a file: a definition with zeros behind it.
const FILE_MAX: u64 = 1 << 16;
// Every tool definition (`.rom`) begins with these bytes; another file is refused before it is sent.
const BEGIN: &[u8] = b"NDI\0";
const SUMMED: std::ops::Range<usize> = 6..USED;

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
        let file =
            nima_files::read(path, FILE_MAX).map_err(|error| refuse(format!("the file cannot be read ({error})")))?;
        if !file.starts_with(BEGIN) {
            return Err(refuse("the file is not a tool definition of NDI (.rom)".to_owned()));
        }
        if file.len() < USED {
            return Err(refuse(format!("the file was cut: it has {} bytes, a tool definition has {USED}", file.len())));
        }
        if file[USED..].iter().any(|byte| *byte != 0) {
            return Err(refuse(format!("the file has data after byte {USED}, where a tool definition ends")));
        }
        if file[4..6] != sum(&file).to_le_bytes() {
            return Err(refuse("the file is damaged: its checksum does not match its content".to_owned()));
        }
        let mut bytes = Box::new([0; DEFINITION]);
        bytes[..USED].copy_from_slice(&file[..USED]);
        Ok(Self(bytes))
    }

    /// Creates a definition with this text instead of the geometry, which only an emulated unit accepts.
    pub fn emulated(text: &str) -> Self {
        let mut bytes = Box::new([0; DEFINITION]);
        bytes[..BEGIN.len()].copy_from_slice(BEGIN);
        let count = text.len().min(SUMMED.len());
        bytes[SUMMED][..count].copy_from_slice(&text.as_bytes()[..count]);
        let sum = sum(&bytes[..]).to_le_bytes();
        bytes[4..6].copy_from_slice(&sum);
        Self(bytes)
    }

    pub fn bytes(&self) -> &[u8] {
        &self.0[..USED]
    }

    pub fn chunks(&self) -> impl Iterator<Item = (u16, [u8; CHUNK])> + '_ {
        let (chunks, _) = self.0.as_chunks::<CHUNK>();
        chunks.iter().enumerate().map(|(k, data)| ((k * CHUNK) as u16, *data))
    }
}

/// Returns the checksum of at least [`USED`] bytes.
fn sum(bytes: &[u8]) -> u16 {
    bytes[SUMMED].iter().fold(0, |sum, byte| sum.wrapping_add(u16::from(*byte)))
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
            (place("large.rom"), "it is larger than the limit of 65536 bytes"),
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

    #[test]
    fn a_cut_a_damaged_and_a_doubled_definition_are_refused_with_the_reason() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tool.rom");
        let load = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            NdiDefinition::load("tools[0]", &path)
        };
        let good = NdiDefinition::emulated("probe");
        assert_eq!(load(good.bytes()).as_ref(), Ok(&good));
        for zeros in [272, 3000] {
            assert_eq!(load(&[good.bytes(), &vec![0; zeros]].concat()).as_ref(), Ok(&good), "zeros may follow");
        }
        let mut damaged = good.bytes().to_vec();
        damaged[600] ^= 1;
        let cases = [
            (good.bytes()[..751].to_vec(), "was cut: it has 751 bytes"),
            (damaged, "damaged"),
            ([good.bytes(), &good.bytes()[..272]].concat(), "data after byte 752"),
            ([good.bytes(), good.bytes()].concat(), "data after byte 752"),
        ];
        for (bytes, words) in cases {
            let trouble = load(&bytes).unwrap_err().to_string();
            assert!(trouble.contains(words) && trouble.contains("tools[0]"), "{trouble}");
        }
    }
}
