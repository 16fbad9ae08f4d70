//! Words of the room `modes`.

pub(in crate::console) const LITERAL_NIMA: &str = "Literal (NIMA)";
pub(in crate::console) const LINEAR_IMA: &str = "Linear (IMA)";
pub(in crate::console) const DIRECT_DFR: &str = "Direct (DFR)";
pub(in crate::console) const ANCHORED: &str = "Anchored";
pub(in crate::console) const THE_PAPER_TO_THE: &str = "The paper to the letter: renders M X from the hand's own motion, degree chosen by the error inside the window. \
             Renders nothing at standstill.";
pub(in crate::console) const THE_PAPER_S_LINEAR: &str = "The paper's linear predecessor: the same with degree 1 only.";
pub(in crate::console) const DIRECT_FORCE_REFLECTION_THE: &str =
    "Direct force reflection: the measured force, as late as the link delivers it.";
pub(in crate::console) const THE_LAST_MEASURED_FORCE: &str = "The last measured force, corrected by the identified impedance for what the hand did since. Falls back to \
             direct reflection where a correction does not pay.";
