//! Measures that reveal the condition.

/// Measures of the force in the hand, which is zero for a condition without force. They are kept encrypted until the
/// unblinding.
const TELLING: [&str; 2] = ["peak_rendered_n", "rms_rendered_n"];

/// Returns whether the measure with this key reveals the condition.
pub(crate) fn tells(key: &str) -> bool {
    TELLING.iter().any(|id| key.starts_with(id))
}
