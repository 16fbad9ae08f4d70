//! Entities that clients store in the base and retrieve by handle: users, sequences, protection zones. Stored as the
//! received bytes.

use prost::{
    Message,
    encoding::{WireType, encode_key, encode_varint},
};

use super::{
    forms::EntityHandle,
    interface::{AnswerPayload, ENTITY_NOT_FOUND, InterfaceError, NO_MORE_STORAGE, read},
};

/// Maximum number of each kind.
const PLACES: usize = 64;
/// `Permission`: read, update, delete.
const ALL: u32 = 7;

#[derive(Default)]
pub(super) struct EntityStore {
    given: u32,
    entries: Vec<(u32, Vec<u8>)>,
}

impl EntityStore {
    /// Stores a message, whose field 1 becomes its handle.
    pub(super) fn create(&mut self, mut bytes: Vec<u8>) -> Result<EntityHandle, InterfaceError> {
        if self.entries.len() >= PLACES {
            return Err(NO_MORE_STORAGE);
        }
        self.given += 1;
        let handle = EntityHandle { identifier: self.given, permission: ALL };
        // If field 1 occurs twice in a message, the later one counts.
        append(1, &handle.encode_to_vec(), &mut bytes);
        self.entries.push((self.given, bytes));
        Ok(handle)
    }

    pub(super) fn get(&self, handle: &[u8]) -> AnswerPayload {
        let identifier = read::<EntityHandle>(handle)?.identifier;
        let found = self.entries.iter().find(|(kept, _)| *kept == identifier);
        found.map(|(_, bytes)| bytes.clone()).ok_or(ENTITY_NOT_FOUND)
    }

    pub(super) fn delete(&mut self, handle: &[u8]) -> Result<EntityHandle, InterfaceError> {
        self.get(handle)?;
        let handle = read::<EntityHandle>(handle)?;
        self.entries.retain(|(kept, _)| *kept != handle.identifier);
        Ok(handle)
    }

    /// Returns all entities as a message that repeats its field 1.
    pub(super) fn all(&self) -> Vec<u8> {
        let mut list = Vec::new();
        self.entries().for_each(|bytes| append(1, bytes, &mut list));
        list
    }

    pub(super) fn entries(&self) -> impl Iterator<Item = &[u8]> {
        self.entries.iter().map(|(_, bytes)| bytes.as_slice())
    }
}

fn append(field: u32, bytes: &[u8], to: &mut Vec<u8>) {
    encode_key(field, WireType::LengthDelimited, to);
    encode_varint(bytes.len() as u64, to);
    to.extend_from_slice(bytes);
}
