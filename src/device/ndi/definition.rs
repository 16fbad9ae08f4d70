//! Tool definitions: `.rom` files, written to the unit in pieces (reference 1.3, 752 bytes seen, 1024 always sent).

use std::path::Path;

use super::command::CHUNK;
use crate::device::Trouble;

/// Bytes of a definition as sent, zero-padded.
pub const DEFINITION: usize = 1024;
/// What a definition begins with.
const BEGIN: &[u8] = b"NDI\0";

/// A tool definition as it is sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Definition(Box<[u8; DEFINITION]>);

impl Definition {
    /// Reads the file that the rig file names under `key`.
    pub fn load(key: &str, path: &Path) -> Result<Self, Trouble> {
        let refuse =
            |allowed: String| Trouble::Setting { key: key.to_owned(), value: path.display().to_string(), allowed };
        let file = std::fs::read(path).map_err(|error| refuse(format!("a file that can be read ({error})")))?;
        if file.len() > DEFINITION || !file.starts_with(BEGIN) {
            return Err(refuse("a tool definition of NDI (.rom), at most 1024 bytes".to_owned()));
        }
        let mut bytes = Box::new([0; DEFINITION]);
        bytes[..file.len()].copy_from_slice(&file);
        Ok(Self(bytes))
    }

    /// The pieces, each with its address.
    pub fn chunks(&self) -> impl Iterator<Item = (u16, [u8; CHUNK])> + '_ {
        let (chunks, _) = self.0.as_chunks::<CHUNK>();
        chunks.iter().enumerate().map(|(k, data)| ((k * CHUNK) as u16, *data))
    }
}
