//! The names under which a rig publishes, and how its messages are packed.

use crate::DepartmentError;

/// Of every rig.
pub(crate) const ALL: &str = "nima/**";
/// Longest message that is unpacked, bytes.
const MOST_BYTES: usize = 64 << 20;

/// Whether the rig is there.
pub(crate) fn presence(rig: &str) -> String {
    format!("nima/rig/{rig}")
}

/// Of every rig; see [`presence`].
pub(crate) const PRESENCES: &str = "nima/rig/*";

/// The name in a key that [`presence`] made.
pub(crate) fn rig_of(presence: &str) -> Option<&str> {
    presence.strip_prefix("nima/rig/").filter(|name| !name.contains('/'))
}

/// What it is and what it runs.
pub(crate) fn about(rig: &str) -> String {
    format!("nima/about/{rig}")
}

/// What its screen shows now.
pub(crate) fn moments(rig: &str) -> String {
    format!("nima/moments/{rig}")
}

/// The beginning of its session, as far as it is not in the bundles that are left.
pub(crate) fn head(rig: &str) -> String {
    format!("nima/head/{rig}")
}

/// A bundle of its session.
pub(crate) fn bundle(rig: &str, number: u64) -> String {
    format!("nima/session/{rig}/{number}")
}

/// All of them; see [`bundle`].
pub(crate) fn bundles(rig: &str) -> String {
    format!("nima/session/{rig}/*")
}

/// Who watches it.
pub(crate) fn watcher(rig: &str, watcher: &str) -> String {
    format!("nima/watcher/{rig}/{watcher}")
}

/// All of them; see [`watcher`].
pub(crate) fn watchers(rig: &str) -> String {
    format!("nima/watcher/{rig}/*")
}

/// The name, if it can be part of a key and of a file's name.
pub(crate) fn checked_name(name: &str) -> Result<String, DepartmentError> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-';
    let fits = (1..=40).contains(&name.len()) && name.chars().all(plain);
    if fits { Ok(name.to_owned()) } else { Err(DepartmentError::Name(name.escape_debug().take(60).collect())) }
}

/// Compresses a message.
pub(crate) fn pack(message: &[u8]) -> Vec<u8> {
    lz4_flex::block::compress_prepend_size(message)
}

/// What [`pack`] compressed; `None` if it is damaged.
pub(crate) fn unpack(packed: &[u8]) -> Option<Vec<u8>> {
    let size = u32::from_le_bytes(packed.get(..4)?.try_into().ok()?);
    let fits = usize::try_from(size).is_ok_and(|size| size <= MOST_BYTES);
    if fits { lz4_flex::block::decompress_size_prepended(packed).ok() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_would_be_patterns_or_paths_are_refused() {
        for name in ["", "a/b", "*", "theatre 1", "..", "a$b", &"x".repeat(41)] {
            assert!(checked_name(name).is_err(), "{name}");
        }
        assert_eq!(checked_name("theatre-1").unwrap(), "theatre-1");
        assert_eq!(rig_of(&presence("theatre-1")), Some("theatre-1"));
        assert_eq!(rig_of("nima/rig/a/b"), None);
    }

    #[test]
    fn a_message_comes_back_and_a_false_length_takes_no_memory() {
        let message = vec![7; 100_000];
        assert_eq!(unpack(&pack(&message)).unwrap(), message);
        let mut wrong = pack(&message);
        wrong[..4].copy_from_slice(&u32::MAX.to_le_bytes());
        assert_eq!((unpack(&wrong), unpack(&[1, 2])), (None, None));
    }
}
