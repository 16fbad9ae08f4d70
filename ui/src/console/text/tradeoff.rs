//! Words of the room `tradeoff`.

pub(in crate::console) const CANCELLED_EARLIER_FIGURES_WERE: &str = "Cancelled. Earlier figures were kept.";
pub(in crate::console) const THE_MEASUREMENT_BROKE_OFF: &str = "The measurement broke off. Try again.";
pub(in crate::console) const NOT_MEASURED_YET_IT: &str = "Not measured yet. It takes some seconds; the loop goes on.";
pub(in crate::console) const RUNS_EVERY_CHOICE_OVER: &str = "Runs every choice over six seconds of this scene on an ordinary background thread. Other work on this \
                       computer makes the times longer and their p99 uncertain.";
pub(in crate::console) const MEASURE_ON_THIS_MACHINE: &str = "Measure on this machine...";
pub(in crate::console) const CANCEL: &str = "Cancel";
pub(in crate::console) const STOPS_MEASURING_AT_ONCE: &str =
    "Stops measuring at once. Figures measured before are kept.";
pub(in crate::console) const NOTHING_MEASURED_BEATS_THESE: &str =
    "Nothing measured beats these in both (cheapest first):";
pub(in crate::console) const THE_PARETO_FRONT_EVERY: &str = "The Pareto front: every other point costs more time or errs more. In anchored mode the window's model is one of \
         several experts, so degree and window change the error by a few hundredths only.";
pub(in crate::console) const APPLY: &str = "Apply";
pub(in crate::console) const DEGREE_OR_WINDOW_DIFFER: &str = "Degree or window differ from the loop's: the loop is restarted with them and comes back idle, without force. Engage \
         it again when ready.";
pub(in crate::console) const TAKEN_OVER_BY_THE: &str = "Taken over by the running loop at once.";
pub(in crate::console) const RELEASE_THE_STOP_OR: &str =
    "Release the stop or the fault first: a restart must not undo it.";
pub(in crate::console) const NOTHING_MEASURED_BEATS_IT: &str = "\nNothing measured beats it in both.";
pub(in crate::console) const ONE_TICK_US: &str = "One tick (us)";
pub(in crate::console) const APPLIED_BY_RESTART: &str =
    "Applied. The loop was restarted and is idle: engage it when ready.";

/// There is no thread for it.
pub(in crate::console) fn not_started(error: &impl std::fmt::Display) -> String {
    format!("The measurement could not be started: {error}")
}

/// How far it is.
pub(in crate::console) fn measured(percent: f32) -> String {
    format!("Trade-off measured: {percent:.0} %")
}

/// The loop goes on with this choice.
pub(in crate::console) fn applied(choice: &str) -> String {
    format!("Applied: {choice}.")
}

/// The loop was restarted with it or not, by this reason.
pub(in crate::console) fn not_applied(reason: &str) -> String {
    format!("Not applied: {reason}.")
}

/// Everything about a point, in figures.
pub(in crate::console) fn point(
    name: &str,
    [median_us, p99_us]: [&str; 2],
    delay_ms: f64,
    [error_n, ratio]: [&str; 2],
) -> String {
    format!(
        "{name}\none tick: median {median_us} us, p99 {p99_us} us\nmean error at {delay_ms:.0} ms: {error_n} N, {ratio} x DFR"
    )
}

/// The axis of errors.
pub(in crate::console) fn error_axis(unit: &str) -> String {
    format!("Mean error ({unit})")
}

/// The plot in one sentence.
pub(in crate::console) fn plot(points: usize) -> String {
    format!("Trade-off plot: {points} points, time of a tick against error at the horizon")
}
