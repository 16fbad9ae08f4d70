//! The key of this machine, and the keys of its paired machines; files that only their owner can read.

use std::{
    fmt, fs,
    io::{self, ErrorKind},
    path::{Path, PathBuf},
    str::FromStr,
};

use snow::{
    Builder,
    params::DHChoice,
    resolvers::{CryptoResolver as _, DefaultResolver},
};

use crate::secure::NOISE;

/// Names of the files in the folder.
const KEY_FILE: &str = "network.key";
const PEERS_FILE: &str = "network.peers";
/// Maximum number of paired machines.
pub const PEERS_MAX: usize = 32;
/// Maximum length of a paired machine's name, characters.
const NAME_MAX: usize = 60;
/// Maximum size of a file of keys, bytes.
const FILE_MAX: usize = 16 * 1024;

/// Why keys cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum KeyError {
    #[error("{}: {source}", path.display())]
    File { path: PathBuf, source: io::Error },
    /// Other users can read or change the file.
    #[error("{}: other users can read or change it (mode {mode:03o}); restrict it to yourself: chmod 600", path.display())]
    Mode { path: PathBuf, mode: u32 },
    /// The file is malformed.
    #[error("{}, line {line}: {what}", path.display())]
    Content {
        path: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// The fault.
        what: &'static str,
    },
    /// The system provides no random numbers.
    #[error("the system provides no random numbers; try again")]
    Random,
    /// Too many machines, or a name that cannot be written.
    #[error("{0}")]
    Peers(&'static str),
}

/// Identifies a machine to others: the public half of its key (Curve25519).
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct PublicKey([u8; 32]);

impl PublicKey {
    pub const fn new(bytes: [u8; 32]) -> Self {
        Self(bytes)
    }

    pub const fn bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

impl fmt::Display for PublicKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for PublicKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// The text is not a key: 64 hexadecimal digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("this is not a key: a key has 64 hexadecimal digits; copy it again")]
pub struct ParseKeyError;

impl FromStr for PublicKey {
    type Err = ParseKeyError;

    fn from_str(text: &str) -> Result<Self, ParseKeyError> {
        bytes_of(text).map(Self).ok_or(ParseKeyError)
    }
}

fn bytes_of(text: &str) -> Option<[u8; 32]> {
    let digits = text.as_bytes();
    let mut bytes = [0; 32];
    if digits.len() != 64 {
        return None;
    }
    for (byte, pair) in bytes.iter_mut().zip(digits.chunks_exact(2)) {
        let digit = |at: usize| char::from(pair[at]).to_digit(16);
        *byte = (digit(0)? * 16 + digit(1)?) as u8;
    }
    Some(bytes)
}

/// The key of this machine. Only its public half is printed.
#[derive(Clone)]
pub struct NetworkKeys {
    private: [u8; 32],
    public: PublicKey,
}

impl fmt::Debug for NetworkKeys {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Keys").field("public", &self.public).finish_non_exhaustive()
    }
}

impl NetworkKeys {
    /// Generates a key that is not stored.
    ///
    /// # Errors
    /// [`KeyError::Random`] if the system provides no random numbers.
    pub fn random() -> Result<Self, KeyError> {
        let parameters = NOISE.parse().map_err(|_| KeyError::Random)?;
        let pair = Builder::new(parameters).generate_keypair().map_err(|_| KeyError::Random)?;
        let private = pair.private.try_into().map_err(|_| KeyError::Random)?;
        Self::of(private).ok_or(KeyError::Random)
    }

    /// Opens the key in this folder; creates it, with its file, on first use. The file must be readable by its owner
    /// only.
    ///
    /// # Errors
    /// [`KeyError`] with the file.
    ///
    /// ```
    /// use nima_network::keys::NetworkKeys;
    ///
    /// let folder = tempfile::tempdir()?;
    /// let made = NetworkKeys::open(folder.path())?;
    /// assert_eq!(NetworkKeys::open(folder.path())?.public(), made.public(), "kept");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn open(folder: &Path) -> Result<Self, KeyError> {
        let path = folder.join(KEY_FILE);
        let Some(text) = read(&path)? else {
            let keys = Self::random()?;
            write_new(&path, &format!("{}\n", PublicKey(keys.private)))?;
            return Ok(keys);
        };
        let what = "not a nima key; delete the file to create a new key, then pair again";
        let private = bytes_of(text.trim()).and_then(Self::of);
        private.ok_or(KeyError::Content { path, line: 1, what })
    }

    fn of(private: [u8; 32]) -> Option<Self> {
        let mut curve = DefaultResolver.resolve_dh(&DHChoice::Curve25519)?;
        curve.set(&private);
        let public = PublicKey(curve.pubkey().try_into().ok()?);
        Some(Self { private, public })
    }

    /// Returns the public half.
    pub const fn public(&self) -> PublicKey {
        self.public
    }

    pub(crate) const fn private(&self) -> &[u8; 32] {
        &self.private
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PairedMachine {
    /// Name given by the user.
    pub name: String,
    pub key: PublicKey,
}

/// The paired machines.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Peers {
    list: Vec<PairedMachine>,
}

impl Peers {
    /// Reads the file in this folder; empty if there is no file.
    ///
    /// # Errors
    /// [`KeyError`] with the file and the malformed line.
    pub fn open(folder: &Path) -> Result<Self, KeyError> {
        let path = folder.join(PEERS_FILE);
        let mut this = Self::default();
        for (line, text) in read(&path)?.unwrap_or_default().lines().enumerate() {
            let content = |what| KeyError::Content { path: path.clone(), line: line + 1, what };
            let (key, name) =
                text.split_once(' ').ok_or_else(|| content("a line must be a key, a space and a name"))?;
            let key = key.parse().map_err(|_| content("a key has 64 hexadecimal digits"))?;
            this.add(name, key).map_err(|_| content("too many machines, or a name that is empty or too long"))?;
        }
        Ok(this)
    }

    /// Writes them into the file in this folder.
    ///
    /// # Errors
    /// [`KeyError`] with the file.
    pub fn save(&self, folder: &Path) -> Result<(), KeyError> {
        replace(&folder.join(PEERS_FILE), self.list.iter().map(|peer| format!("{} {}", peer.key, peer.name)))
    }

    /// Adds a machine, or renames the one with this key.
    ///
    /// # Errors
    /// [`KeyError::Peers`] if there are too many, or the name is empty, too long or of more than one line.
    pub fn add(&mut self, name: &str, key: PublicKey) -> Result<(), KeyError> {
        let name = name.trim();
        if name.is_empty() || name.chars().count() > NAME_MAX || name.chars().any(char::is_control) {
            return Err(KeyError::Peers("the name of a machine must be one line of 1 to 60 characters"));
        }
        self.remove(&key);
        if self.list.len() == PEERS_MAX {
            return Err(KeyError::Peers("32 machines are already paired with this one; remove one of them"));
        }
        self.list.push(PairedMachine { name: name.into(), key });
        Ok(())
    }

    /// Removes the machine with this key.
    pub fn remove(&mut self, key: &PublicKey) {
        self.list.retain(|peer| peer.key != *key);
    }

    pub fn list(&self) -> &[PairedMachine] {
        &self.list
    }

    /// Returns the machine with this key.
    pub fn with_key(&self, key: &PublicKey) -> Option<&PairedMachine> {
        self.list.iter().find(|peer| peer.key == *key)
    }
}

/// Returns the content of a file that only its owner can read; `None` if there is none.
pub(crate) fn read(path: &Path) -> Result<Option<String>, KeyError> {
    let error = |source| KeyError::File { path: path.into(), source };
    let metadata = match fs::metadata(path) {
        Err(source) if source.kind() == ErrorKind::NotFound => return Ok(None),
        other => other.map_err(error)?,
    };
    if let Some(mode) = mode_for_others(&metadata) {
        return Err(KeyError::Mode { path: path.into(), mode });
    }
    nima_files::read_text(path, FILE_MAX as u64).map(Some).map_err(error)
}

/// Returns the mode of a file if it gives other users any rights.
#[cfg(unix)]
fn mode_for_others(metadata: &fs::Metadata) -> Option<u32> {
    use std::os::unix::fs::PermissionsExt as _;

    let mode = metadata.permissions().mode() & 0o777;
    (mode & 0o077 != 0).then_some(mode)
}

/// On other systems a user's folder is private.
#[cfg(not(unix))]
const fn mode_for_others(_: &fs::Metadata) -> Option<u32> {
    None
}

/// Writes these lines into a file that only its owner can read, or replaces it.
pub(crate) fn replace(path: &Path, mut lines: impl Iterator<Item = String>) -> Result<(), KeyError> {
    if read(path)?.is_none() {
        // Created with its mode, which is kept when the file is replaced.
        write_new(path, "")?;
    }
    let written = nima_files::write_atomically(path, |file| lines.try_for_each(|line| writeln!(file, "{line}")));
    written.map_err(|source| KeyError::File { path: path.into(), source })
}

fn write_new(path: &Path, text: &str) -> Result<(), KeyError> {
    nima_files::write_private(path, text).map_err(|source| KeyError::File { path: path.into(), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_and_peers_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let keys = NetworkKeys::open(folder.path()).unwrap();
        assert_eq!(NetworkKeys::open(folder.path()).unwrap().private(), keys.private());
        assert!(!format!("{keys:?}").contains(&PublicKey(*keys.private()).to_string()), "never printed");
        let other = NetworkKeys::random().unwrap().public();
        let third = NetworkKeys::random().unwrap().public();
        let mut peers = Peers::open(folder.path()).unwrap();
        assert!(peers.list().is_empty());
        peers.add("theatre 2", other).unwrap();
        peers.add("teacher", third).unwrap();
        peers.add("theatre 3", other).unwrap();
        peers.save(folder.path()).unwrap();
        peers.save(folder.path()).unwrap();
        assert_eq!(Peers::open(folder.path()).unwrap(), peers);
        assert_eq!(peers.with_key(&other).unwrap().name, "theatre 3");
        for name in ["", " ", "two\nlines", &"x".repeat(61)] {
            assert!(peers.add(name, other).is_err(), "{name:?}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn files_that_others_can_read_are_refused() {
        use std::os::unix::fs::PermissionsExt as _;

        let folder = tempfile::tempdir().unwrap();
        NetworkKeys::open(folder.path()).unwrap();
        Peers::default().save(folder.path()).unwrap();
        for (name, mode) in [(KEY_FILE, 0o640), (KEY_FILE, 0o604), (PEERS_FILE, 0o660)] {
            let path = folder.path().join(name);
            assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600, "{name}");
            fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
            let report = match name {
                KEY_FILE => NetworkKeys::open(folder.path()).unwrap_err(),
                _ => Peers::open(folder.path()).unwrap_err(),
            };
            assert!(report.to_string().contains("chmod 600"), "{report}");
            fs::set_permissions(&path, fs::Permissions::from_mode(0o600)).unwrap();
        }
    }

    #[test]
    fn damaged_files_are_told_with_their_line() {
        let folder = tempfile::tempdir().unwrap();
        write_new(&folder.path().join(KEY_FILE), "abc\n").unwrap();
        assert!(NetworkKeys::open(folder.path()).unwrap_err().to_string().contains("not a nima key"));
        let key = NetworkKeys::random().unwrap().public();
        write_new(&folder.path().join(PEERS_FILE), &format!("{key} one\n{key}\n")).unwrap();
        assert!(Peers::open(folder.path()).unwrap_err().to_string().contains("line 2"));
    }
}
