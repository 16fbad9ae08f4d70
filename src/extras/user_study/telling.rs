//! Measures that tell the condition to whoever reads them.

/// What the hand felt: without force it is zero. Until the unblinding these are kept encrypted.
const TELLING: [&str; 2] = ["peak_rendered_n", "rms_rendered_n"];

/// Whether this measure, by its key, tells the condition.
pub(crate) fn tells(key: &str) -> bool {
    TELLING.iter().any(|id| key.starts_with(id))
}
