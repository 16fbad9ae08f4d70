//! A value that clients can read, set and reset; stored as the bytes of its message.

use prost::Message;

use super::interface::{AnswerPayload, INVALID_PARAM, read};

pub(super) struct KinovaSetting {
    get: u16,
    set: u16,
    reset: Option<u16>,
    initial: Vec<u8>,
    value: Vec<u8>,
    checked: SettingCheck,
}

/// Function that returns the stored form of an offered value, or why it is refused.
type SettingCheck = Box<dyn Fn(&[u8]) -> AnswerPayload + Send>;

impl KinovaSetting {
    /// Returns a value read and set by these functions of its service; `fits` returns which values are accepted.
    pub(super) fn new<M>(get: u16, set: u16, initial: &M, fits: fn(&M) -> bool) -> Self
    where
        M: Message + Default + 'static,
    {
        let checked = move |payload: &[u8]| {
            let message = read::<M>(payload)?;
            if fits(&message) { Ok(message.encode_to_vec()) } else { Err(INVALID_PARAM) }
        };
        let initial = initial.encode_to_vec();
        Self { get, set, reset: None, value: initial.clone(), initial, checked: Box::new(checked) }
    }

    /// Adds the function that resets it.
    pub(super) fn with_reset(self, reset: u16) -> Self {
        Self { reset: Some(reset), ..self }
    }

    /// Returns whether the function changes it.
    pub(super) fn is_changed_by(&self, function: u16) -> bool {
        function == self.set || Some(function) == self.reset
    }

    /// Returns the answer, if the function belongs to this value.
    pub(super) fn answer(&mut self, function: u16, payload: &[u8]) -> Option<AnswerPayload> {
        if function == self.set {
            return Some((self.checked)(payload).map(|value| {
                self.value = value;
                Vec::new()
            }));
        }
        if Some(function) == self.reset {
            self.value.clone_from(&self.initial);
        } else if function != self.get {
            return None;
        }
        Some(Ok(self.value.clone()))
    }
}
