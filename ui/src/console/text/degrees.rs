//! Words of the room `degrees`.

pub(in crate::console) const THIS_CONSOLE: &str = "this console";
pub(in crate::console) const CHOSEN_BY_THE_RUNNING: &str =
    "Chosen by the running error at the horizon; 0 means no correction.";
pub(in crate::console) const THE_PAPER_S_RULE: &str = "the paper's rule";
pub(in crate::console) const LEAST_ERROR_INSIDE_THE: &str =
    "Least error inside the window; 0 means the window is not full.";
pub(in crate::console) const NONLINEAR_THIS_CONSOLE: &str = "Nonlinear, this console";
pub(in crate::console) const SHARE_OF_TICKS_IN: &str =
    "Share of ticks in which a degree of 2 or more paid off at the horizon.";
pub(in crate::console) const NONLINEAR_THE_PAPER_S: &str = "Nonlinear, the paper's rule";
pub(in crate::console) const SHARE_OF_TICKS_WITH: &str = "Share of ticks with degree 2 or more by the error inside the window. The models are nested, so this is near 100 % \
         whatever the tissue: it is not evidence of nonlinearity.";
pub(in crate::console) const CONDITION: &str = "Condition";
pub(in crate::console) const CONDITION_NUMBER_OF_THE: &str = "Condition number of the chosen model's scaled columns, the worst axis, without unit: 1 is perfect, above 1e4 the columns \
         are hard to tell apart.";
pub(in crate::console) const RANK: &str = "Rank";
pub(in crate::console) const MOTION_COLUMNS_WITH_ENOUGH: &str = "Motion columns with enough excitation in the window to carry information, of all (three per degree: position, velocity, \
         acceleration); the others are left out: the ridge gives them no weight. Used: columns of the model chosen now.";
pub(in crate::console) const EXCITATION: &str = "Excitation";
pub(in crate::console) const HOW_MUCH_THE_MOTION: &str = "How much the motion varies within the window: standard deviation of position (mm) and velocity (mm/s), all axes. Without \
         motion nothing can be identified.";

/// How long the shares go back.
pub(in crate::console) fn last_minutes(minutes: f64) -> String {
    format!("last {minutes:.0} min")
}

/// Motion columns that carry information, and those in use.
pub(in crate::console) fn columns(rank: u8, of: usize, used: u8) -> String {
    format!("{rank} of {of}, {used} used")
}

/// The chart in one sentence.
pub(in crate::console) fn chosen(shares: &str) -> String {
    format!("Degrees chosen: {shares}")
}

/// Both rows of shares.
pub(in crate::console) fn both(ours: &str, papers: &str) -> String {
    format!("This console  {ours}\nPaper's rule  {papers}")
}
