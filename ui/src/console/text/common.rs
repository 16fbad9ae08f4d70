//! Names that several panels use.

pub(in crate::console) const RIGHT: &str = "Right";
pub(in crate::console) const LEFT: &str = "Left";
pub(in crate::console) const MEASURED: &str = "Measured";
pub(in crate::console) const RENDERED: &str = "Rendered";

/// Name of a hand, as in "Right hand".
pub(in crate::console) fn hand(side: &str) -> String {
    format!("{side} hand")
}
