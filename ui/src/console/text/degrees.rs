//! The panel that compares the chosen polynomial degrees.

pub(in crate::console) const KEY_OURS: &str = "this console";
pub(in crate::console) const KEY_OURS_HOVER: &str =
    "The highest power of the position in the model with the smallest recent prediction error; 0 means no correction";
pub(in crate::console) const KEY_PAPER: &str = "the paper's rule";
pub(in crate::console) const KEY_PAPER_HOVER: &str =
    "The degree with the smallest error inside the window; 0 means that the window is not full yet";
pub(in crate::console) const NONLINEAR_OURS: &str = "Nonlinear, this console";
pub(in crate::console) const NONLINEAR_OURS_HOVER: &str =
    "Share of ticks in which degree 2 or more had the smallest prediction error";
pub(in crate::console) const NONLINEAR_PAPER: &str = "Nonlinear, the paper's rule";
pub(in crate::console) const NONLINEAR_PAPER_HOVER: &str = "Share of ticks in which degree 2 or more had the smallest error inside the window. A higher degree \
    always fits the window at least as well, so this is near 100 % for any tissue. It is not evidence of \
    nonlinearity. Computed only while all modes are compared.";
pub(in crate::console) const CONDITION: &str = "Condition";
pub(in crate::console) const CONDITION_HOVER: &str = "Condition number of the scaled columns that predict best from the window, worst axis, no unit. 1 is perfect; above 10 \
    000 the columns can hardly be told apart. Computed only while all modes are compared.";
pub(in crate::console) const RANK: &str = "Rank";
pub(in crate::console) const RANK_HOVER: &str = "Number of motion columns that vary enough in the window to be identified, out of all columns (three \
    per degree: position, velocity, acceleration). The ridge gives the others no weight. Used: columns \
    that predict best now. Computed only while all modes are compared.";
pub(in crate::console) const EXCITATION: &str = "Excitation";
pub(in crate::console) const EXCITATION_HOVER: &str = "How much the motion varies within the window: standard deviation of position (mm) and of velocity \
    (mm/s), all axes. Without motion nothing can be identified. Computed only while \
    all modes are compared.";
pub(in crate::console) const NOT_COMPUTED: &str = "not computed";
pub(in crate::console) const NONE: &str = "none";

/// Period that the shares cover.
pub(in crate::console) fn last_minutes(minutes: f64) -> String {
    format!("last {minutes:.0} min")
}

/// Number of motion columns that carry information, and number in use.
pub(in crate::console) fn columns(rank: u8, of: usize, used: u8) -> String {
    format!("{rank} of {of} columns, {used} used")
}

/// The chart in one sentence.
pub(in crate::console) fn chosen(shares: &str) -> String {
    format!("Degrees chosen: {shares}")
}

/// Shares of both rules.
pub(in crate::console) fn both(ours: &str, papers: &str) -> String {
    format!("This console  {ours}\nPaper's rule  {papers}")
}
