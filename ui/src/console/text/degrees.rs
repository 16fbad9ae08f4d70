//! The panel that compares the chosen polynomial degrees.

use crate::language::{Text, told};

pub(in crate::console) const KEY_OURS: Text = Text::of("this console", "this console");
pub(in crate::console) const KEY_OURS_HOVER: Text = Text::of(
    "The highest power of the position in the model with the smallest recent prediction error; 0 means no correction",
    "The highest power of the position in the model with the smallest recent prediction error; 0 means no correction",
);
pub(in crate::console) const KEY_PAPER: Text = Text::of("the paper's rule", "the paper's rule");
pub(in crate::console) const KEY_PAPER_HOVER: Text = Text::of(
    "The degree with the smallest error inside the window; 0 means that the window is not full yet",
    "The degree with the smallest error inside the window; 0 means that the window is not full yet",
);
pub(in crate::console) const NONLINEAR_OURS: Text = Text::of("Nonlinear, this console", "Nonlinear, this console");
pub(in crate::console) const NONLINEAR_OURS_HOVER: Text = Text::of(
    "Share of ticks in which degree 2 or more had the smallest prediction error",
    "Share of ticks in which degree 2 or more had the smallest prediction error",
);
pub(in crate::console) const NONLINEAR_PAPER: Text =
    Text::of("Nonlinear, the paper's rule", "Nonlinear, the paper's rule");
pub(in crate::console) const NONLINEAR_PAPER_HOVER: Text = Text::of(
    "Share of ticks in which degree 2 or more had the smallest error inside the window. A higher degree \
    always fits the window at least as well, so this is near 100 % for any tissue. It is not evidence of \
    nonlinearity. Computed only while all modes are compared.",
    "Share of ticks in which degree 2 or more had the smallest error inside the window. A higher degree \
    always fits the window at least as well, so this is near 100 % for any tissue. It is not evidence of \
    nonlinearity. Computed only while all modes are compared.",
);
pub(in crate::console) const CONDITION: Text = Text::of("Condition", "Condition");
pub(in crate::console) const CONDITION_HOVER: Text = Text::of(
    "Condition number of the scaled columns that predict best from the window, worst axis, no unit. 1 is perfect; \
     above 10 000 the columns can hardly be told apart. Computed only while all modes are compared.",
    "Condition number of the scaled columns that predict best from the window, worst axis, no unit. 1 is perfect; \
     above 10 000 the columns can hardly be told apart. Computed only while all modes are compared.",
);
pub(in crate::console) const RANK: Text = Text::of("Rank", "Rank");
pub(in crate::console) const RANK_HOVER: Text = Text::of(
    "Number of motion columns that vary enough in the window to be identified, out of all columns (three \
    per degree: position, velocity, acceleration). The ridge gives the others no weight. Used: columns \
    that predict best now. Computed only while all modes are compared.",
    "Number of motion columns that vary enough in the window to be identified, out of all columns (three \
    per degree: position, velocity, acceleration). The ridge gives the others no weight. Used: columns \
    that predict best now. Computed only while all modes are compared.",
);
pub(in crate::console) const EXCITATION: Text = Text::of("Excitation", "Excitation");
pub(in crate::console) const EXCITATION_HOVER: Text = Text::of(
    "How much the motion varies within the window: standard deviation of position (mm) and of velocity \
    (mm/s), all axes. Without motion nothing can be identified. Computed only while \
    all modes are compared.",
    "How much the motion varies within the window: standard deviation of position (mm) and of velocity \
    (mm/s), all axes. Without motion nothing can be identified. Computed only while \
    all modes are compared.",
);
pub(in crate::console) const NOT_COMPUTED: Text = Text::of("not computed", "not computed");
pub(in crate::console) const NONE: Text = Text::of("none", "none");

/// Period that the shares cover.
pub(in crate::console) fn last_minutes(minutes: f64) -> String {
    told!("last {minutes:.0} min", "last {minutes:.0} min")
}

/// Number of motion columns that carry information, and number in use.
pub(in crate::console) fn columns(rank: u8, of: usize, used: u8) -> String {
    told!("{rank} of {of} columns, {used} used", "{rank} of {of} columns, {used} used")
}

/// The chart in one sentence.
pub(in crate::console) fn chosen(shares: &str) -> String {
    told!("Degrees chosen: {shares}", "Degrees chosen: {shares}")
}

/// Shares of both rules.
pub(in crate::console) fn both(ours: &str, papers: &str) -> String {
    told!("This console  {ours}\nPaper's rule  {papers}", "This console  {ours}\nPaper's rule  {papers}")
}
