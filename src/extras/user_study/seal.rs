//! Encryption of data that must remain unreadable until the unblinding.
//!
//! ChaCha20-Poly1305 in pieces of 64 KiB: each sealed text has its own key, derived from the study's key, a random salt
//! and the purpose, and its pieces are numbered, with the last one marked. A piece that was changed, swapped, or cut
//! off is refused. The purpose names the trial, so a text that was moved to another trial is refused too. Everything
//! that depends on the condition is padded, so that no length shows it. (The construction is STREAM: Hoang, Reyhanitabar, Rogaway and Vizár 2015, Online
//! authenticated-encryption and its nonce-reuse misuse-resistance.)

use std::io::{self, Read, Write};

use blake2::{Blake2b, Blake2s256, Digest as _, digest::consts::U32};
use chacha20poly1305::{AeadInPlace as _, ChaCha20Poly1305, KeyInit as _, Nonce, Tag};

const MAGIC: &[u8; 8] = b"NIMASEA1";
const SALT: usize = 16;
const PIECE: usize = 64 * 1024;
const TAG: usize = 16;
/// Length of a padded text, bytes: more than the measures that reveal the condition, or a reason, ever need.
const PADDED: usize = 1024;

/// The key of a study. Its `Debug` shows nothing.
#[derive(Clone)]
pub(crate) struct Key([u8; 32]);

impl std::fmt::Debug for Key {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Key")
    }
}

/// Returns random bytes from the system.
pub(crate) fn random<const N: usize>() -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    getrandom::fill(&mut bytes).map_err(|error| io::Error::other(format!("no random numbers: {error}")))?;
    Ok(bytes)
}

/// `BLAKE2b` with 256 bits, as `b2sum -l 256` prints it.
pub(crate) fn hash(bytes: &[u8]) -> String {
    hex(&Blake2b::<U32>::digest(bytes))
}

pub(crate) fn hex(bytes: &[u8]) -> String {
    let digit = |half: u8| char::from_digit(u32::from(half), 16).unwrap_or('0');
    bytes.iter().flat_map(|byte| [digit(byte >> 4), digit(byte & 0xf)]).collect()
}

pub(crate) fn from_hex(text: &str) -> Option<Vec<u8>> {
    let text = text.trim();
    if !text.is_ascii() || !text.len().is_multiple_of(2) {
        return None;
    }
    (0..text.len()).step_by(2).map(|at| u8::from_str_radix(&text[at..at + 2], 16).ok()).collect()
}

impl Key {
    pub(crate) fn new() -> io::Result<Self> {
        Ok(Self(random()?))
    }

    pub(crate) fn from_hex(text: &str) -> Option<Self> {
        Some(Self(from_hex(text)?.try_into().ok()?))
    }

    pub(crate) fn to_hex(&self) -> String {
        hex(&self.0)
    }

    fn cipher(&self, salt: &[u8; SALT], purpose: &str) -> ChaCha20Poly1305 {
        let of = Blake2s256::new().chain_update(self.0).chain_update(salt).chain_update(purpose.as_bytes());
        ChaCha20Poly1305::new(&of.finalize())
    }

    /// Encrypts everything read from `from`.
    pub(crate) fn seal_stream(&self, purpose: &str, mut from: impl Read, mut to: impl Write) -> io::Result<()> {
        let salt = random::<SALT>()?;
        let cipher = self.cipher(&salt, purpose);
        to.write_all(MAGIC)?;
        to.write_all(&salt)?;
        let mut piece = Vec::with_capacity(PIECE);
        for number in 0.. {
            piece.clear();
            from.by_ref().take(PIECE as u64).read_to_end(&mut piece)?;
            let is_last = piece.len() < PIECE;
            let sealed = cipher.encrypt_in_place_detached(&nonce(number, is_last), &[], &mut piece);
            let tag = sealed.map_err(|_| io::Error::other("encryption failed"))?;
            to.write_all(&piece)?;
            to.write_all(&tag)?;
            if is_last {
                break;
            }
        }
        to.flush()
    }

    /// Decrypts the output of [`Key::seal_stream`]. On an error the output must be discarded.
    pub(crate) fn open_stream(&self, purpose: &str, mut from: impl Read, mut to: impl Write) -> io::Result<()> {
        let refused = |why: &str| io::Error::new(io::ErrorKind::InvalidData, why);
        let mut head = [0; 8 + SALT];
        from.read_exact(&mut head).map_err(|_| refused("it is not a sealed file, or it was cut off"))?;
        let (magic, salt) = head.split_at(8);
        if magic != MAGIC {
            return Err(refused("it is not a sealed file"));
        }
        let salt: [u8; SALT] = salt.try_into().map_err(|_| refused("it is not a sealed file"))?;
        let cipher = self.cipher(&salt, purpose);
        let mut sealed = Vec::with_capacity(PIECE + TAG);
        for number in 0.. {
            sealed.clear();
            from.by_ref().take((PIECE + TAG) as u64).read_to_end(&mut sealed)?;
            let Some((piece, tag)) = sealed.split_last_chunk_mut::<TAG>() else {
                return Err(refused("it was cut off"));
            };
            let is_last = piece.len() < PIECE;
            let opened = cipher.decrypt_in_place_detached(&nonce(number, is_last), &[], piece, Tag::from_slice(tag));
            opened.map_err(|_| refused("it was changed or cut off, or the key belongs to another study"))?;
            to.write_all(piece)?;
            if is_last {
                break;
            }
        }
        to.flush()
    }

    /// Encrypts a text that is padded with blanks to a length that is the same for all texts of this kind.
    pub(crate) fn seal_padded(&self, purpose: &str, plain: &[u8]) -> io::Result<String> {
        let mut padded = plain.to_vec();
        padded.resize(plain.len().next_multiple_of(PADDED), b' ');
        self.seal(purpose, &padded)
    }

    pub(crate) fn seal(&self, purpose: &str, plain: &[u8]) -> io::Result<String> {
        let mut sealed = Vec::new();
        self.seal_stream(purpose, plain, &mut sealed)?;
        Ok(hex(&sealed))
    }

    pub(crate) fn open(&self, purpose: &str, sealed: &str) -> io::Result<Vec<u8>> {
        let refused = || io::Error::new(io::ErrorKind::InvalidData, "it is not a sealed text");
        let mut plain = Vec::new();
        self.open_stream(purpose, from_hex(sealed).ok_or_else(refused)?.as_slice(), &mut plain)?;
        Ok(plain)
    }
}

fn nonce(number: u64, is_last: bool) -> Nonce {
    let mut nonce = [0; 12];
    nonce[..8].copy_from_slice(&number.to_le_bytes());
    nonce[8] = u8::from(is_last);
    nonce.into()
}
