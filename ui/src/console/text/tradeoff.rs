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
