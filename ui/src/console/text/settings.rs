//! Words of the room `settings`.

pub(in crate::console) const LAYOUT_LOST: &str = "The layout of the panels cannot be read; the default is used";
