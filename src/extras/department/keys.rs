//! The keys under which a rig publishes, and the packing of its messages.

use crate::DepartmentError;

/// All keys.
pub(crate) const ALL: &str = "nima/**";
/// Maximum size of a message that is unpacked, bytes. A small compressed message could otherwise unpack to any size.
const MAX_BYTES: usize = 64 << 20;

/// Returns the key that announces the presence of the rig.
pub(crate) fn presence(rig: &str) -> String {
    format!("nima/rig/{rig}")
}

/// Presence of every rig; see [`presence`].
pub(crate) const PRESENCES: &str = "nima/rig/*";

/// Returns the name in a key of [`presence`].
pub(crate) fn rig_of(presence: &str) -> Option<&str> {
    presence.strip_prefix("nima/rig/").filter(|name| !name.contains('/'))
}

/// Returns the description of the rig and its running session.
pub(crate) fn about(rig: &str) -> String {
    format!("nima/about/{rig}")
}

/// Returns the current content of its screen.
pub(crate) fn moments(rig: &str) -> String {
    format!("nima/moments/{rig}")
}

/// Returns the beginning of the session that is no longer in the stored batches.
pub(crate) fn head(rig: &str) -> String {
    format!("nima/head/{rig}")
}

/// Returns a bundle of its session.
pub(crate) fn bundle(rig: &str, number: u64) -> String {
    format!("nima/session/{rig}/{number}")
}

/// Returns the key that matches all bundles; see [`bundle`].
pub(crate) fn bundles(rig: &str) -> String {
    format!("nima/session/{rig}/*")
}

/// Returns the key that announces the presence of a watcher.
pub(crate) fn watcher(rig: &str, watcher: &str) -> String {
    format!("nima/watcher/{rig}/{watcher}")
}

/// Returns the key that matches all watchers; see [`watcher`].
pub(crate) fn watchers(rig: &str) -> String {
    format!("nima/watcher/{rig}/*")
}

/// Returns the name if it can be part of a key and of a file's name.
pub(crate) fn checked_name(name: &str) -> Result<String, DepartmentError> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-';
    let fits = (1..=40).contains(&name.len()) && name.chars().all(plain);
    if fits { Ok(name.to_owned()) } else { Err(DepartmentError::Name(name.escape_debug().take(60).collect())) }
}

pub(crate) fn pack(message: &[u8]) -> Vec<u8> {
    lz4_flex::block::compress_prepend_size(message)
}

/// Decompresses a message of [`pack`]; `None` if it is damaged.
pub(crate) fn unpack(packed: &[u8]) -> Option<Vec<u8>> {
    let size = u32::from_le_bytes(packed.get(..4)?.try_into().ok()?);
    let fits = usize::try_from(size).is_ok_and(|size| size <= MAX_BYTES);
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
