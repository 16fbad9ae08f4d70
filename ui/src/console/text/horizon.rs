//! Words of the room `horizon`.

pub(in crate::console) const LAST_3_MIN: &str = "last 3 min";
