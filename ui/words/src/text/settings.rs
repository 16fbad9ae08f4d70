//! Errors of the settings file.

use crate::language::{Text, text_format};

pub const LAYOUT_LOST: Text = Text::of(
    "The panel layout cannot be read; the default layout is used",
    "Die Panel-Anordnung ist nicht lesbar; es gilt die Standardanordnung",
);

pub fn not_read(error: &impl std::fmt::Display) -> String {
    text_format!("The settings cannot be read: {error}", "Einstellungen nicht lesbar: „{error}“")
}

pub fn not_kept(error: &impl std::fmt::Display) -> String {
    text_format!("The settings cannot be saved: {error}", "Einstellungen nicht speicherbar: „{error}“")
}

pub fn layout_lost(error: &impl std::fmt::Display) -> String {
    text_format!("{LAYOUT_LOST} ({error})", "{LAYOUT_LOST} („{error}“)")
}

pub fn set_aside(error: &impl std::fmt::Display, name: &str) -> String {
    text_format!(
        "The settings file was damaged ({error}); it was renamed to {name}, and the defaults are used",
        "Die Einstellungsdatei war beschädigt („{error}“); sie heißt jetzt {name}, es gelten die Standardwerte"
    )
}

pub fn damaged(error: &impl std::fmt::Display) -> String {
    text_format!(
        "The settings file is damaged ({error}); the defaults are used",
        "Die Einstellungsdatei ist beschädigt („{error}“); es gelten die Standardwerte"
    )
}
