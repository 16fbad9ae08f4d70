//! Words of the room `settings`.

pub(in crate::console) const LAYOUT_LOST: &str = "The layout of the panels cannot be read; the default is used";

/// The file cannot be opened.
pub(in crate::console) fn not_read(error: &impl std::fmt::Display) -> String {
    format!("The settings cannot be read: {error}")
}

/// The file cannot be written.
pub(in crate::console) fn not_kept(error: &impl std::fmt::Display) -> String {
    format!("The settings are not kept: {error}")
}

/// The layout alone cannot be read.
pub(in crate::console) fn layout_lost(error: &impl std::fmt::Display) -> String {
    format!("{LAYOUT_LOST} ({error})")
}

/// The file makes no sense and has another name now.
pub(in crate::console) fn set_aside(error: &impl std::fmt::Display, name: &str) -> String {
    format!("The settings were damaged ({error}); they are set aside as {name}, and the defaults are used")
}

/// The file makes no sense.
pub(in crate::console) fn damaged(error: &impl std::fmt::Display) -> String {
    format!("The settings are damaged ({error}); the defaults are used")
}
