//! Keys of the commands.

use egui::{Key, Modifiers};
use nima_words::text;

/// Modifiers of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyModifiers {
    Nothing,
    Shift,
    /// Control (Command on a Mac).
    Ctrl,
    CtrlShift,
    /// Control; on some keyboards the sign also needs Shift.
    CtrlAndSign,
}

impl KeyModifiers {
    /// Returns whether these modifiers, and no others, are held down.
    pub(in crate::console) fn holds(self, modifiers: Modifiers) -> bool {
        let Modifiers { alt, shift, command, .. } = modifiers;
        match self {
            Self::Nothing => modifiers.is_none(),
            Self::Shift => shift && !command && !alt && !modifiers.ctrl,
            Self::Ctrl => command && !shift && !alt,
            Self::CtrlShift => command && shift && !alt,
            Self::CtrlAndSign => command && !alt,
        }
    }

    /// Returns the modifiers to hold down.
    pub fn modifiers(self) -> Modifiers {
        match self {
            Self::Nothing => Modifiers::NONE,
            Self::Shift => Modifiers::SHIFT,
            Self::Ctrl | Self::CtrlAndSign => Modifiers::COMMAND,
            Self::CtrlShift => Modifiers::COMMAND | Modifiers::SHIFT,
        }
    }
}

/// A key with its modifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stroke {
    pub key: Key,
    pub with: KeyModifiers,
}

impl Stroke {
    pub(super) const fn plain(key: Key) -> Self {
        Self { key, with: KeyModifiers::Nothing }
    }

    pub fn name(self) -> String {
        let key = match self.key {
            Key::Plus | Key::Minus | Key::Equals => self.key.symbol_or_name(),
            key => key.name(),
        };
        let held = match self.with {
            KeyModifiers::Nothing => "",
            KeyModifiers::Shift => text::commands::SHIFT.get(),
            KeyModifiers::Ctrl | KeyModifiers::CtrlAndSign => text::commands::CTRL.get(),
            KeyModifiers::CtrlShift => text::commands::CTRL_SHIFT.get(),
        };
        format!("{held}{key}")
    }

    /// Returns whether the key has a function in a focused text field.
    pub(in crate::console) fn writes(self) -> bool {
        match self.with {
            KeyModifiers::Nothing => !(Key::F1..=Key::F12).contains(&self.key),
            KeyModifiers::Shift => true,
            KeyModifiers::Ctrl | KeyModifiers::CtrlShift => self.key == Key::Z,
            KeyModifiers::CtrlAndSign => false,
        }
    }
}

/// Larger, and smaller.
pub(in crate::console) const SIZE: [&[Stroke]; 2] = [
    &[
        Stroke { key: Key::Plus, with: KeyModifiers::CtrlAndSign },
        Stroke { key: Key::Equals, with: KeyModifiers::CtrlAndSign },
    ],
    &[Stroke { key: Key::Minus, with: KeyModifiers::CtrlAndSign }],
];

/// Undo, and redo.
pub(in crate::console) const UNDO: [&[Stroke]; 2] =
    [&[Stroke { key: Key::Z, with: KeyModifiers::Ctrl }], &[Stroke { key: Key::Z, with: KeyModifiers::CtrlShift }]];
