//! What several panels name alike.

pub(in crate::console) const RIGHT: &str = "Right";
pub(in crate::console) const LEFT: &str = "Left";
pub(in crate::console) const MEASURED: &str = "Measured";
pub(in crate::console) const RENDERED: &str = "Rendered";
pub(in crate::console) const NOT_FINITE: &str = "not finite";

/// A hand by its name, as in "Right hand".
pub(in crate::console) fn hand(side: &str) -> String {
    format!("{side} hand")
}
