//! Words of the room `roles`.

pub(in crate::console) const SURGEON: &str = "Surgeon";
pub(in crate::console) const TECHNICIAN: &str = "Technician";
pub(in crate::console) const DEMO: &str = "Demo";
pub(in crate::console) const THE_FIELD_AS_THE: &str =
    "The field as the endoscope sees it, the forces against the ceiling, the gain, alarms.";
pub(in crate::console) const EVERY_PANEL_FEEDBACK_DEVICES: &str =
    "Every panel: feedback, devices, calibrations, gates, errors, degrees, timing, trade-off.";
pub(in crate::console) const A_DEMONSTRATION_THAT_RUNS: &str =
    "A demonstration that runs by itself and tells what is seen. On simulated rigs only.";
pub(in crate::console) const CLOSE_THE_WIZARD_FIRST: &str = "Close the wizard first.";
pub(in crate::console) const WHAT_IS_SEEN: &str = "What is seen";
pub(in crate::console) const A_HAND_CARRIES_AN: &str = "A hand carries an instrument from peg to peg and presses into soft tissue. The ivory arrow is the force measured at \
                the instrument, the blue one the force that the hand feels. The link is 50 ms late.";
pub(in crate::console) const DIRECT_LATE: &str = "Direct, late";
pub(in crate::console) const NOW_THE_LINK_IS: &str = "Now the link is 300 ms late, and the force is sent as it is: the blue arrow comes after the ivory one. The hand \
                feels a contact that is over, and misses one that has begun.";
pub(in crate::console) const LINEAR_IMPEDANCE: &str = "Linear impedance";
pub(in crate::console) const INSTEAD_OF_THE_FORCE: &str = "Instead of the force, its law crosses the link: stiffness, damping and mass of the last 300 ms, rendered from the \
                hand's own motion (IMA). It answers at once. But where the law has changed since, so has the force.";
pub(in crate::console) const NONLINEAR_TO_THE_LETTER: &str = "Nonlinear, to the letter";
pub(in crate::console) const THE_PAPER_S_RECIPE: &str = "The paper's recipe: a law of degree 1 to 5 (NIMA). It fits the past so closely that it foretells the future badly, \
                and renders nothing where the hand rests. The gates keep its excesses from the hand.";
pub(in crate::console) const ANCHORED: &str = "Anchored";
pub(in crate::console) const OURS_THE_LAST_MEASURED: &str = "Ours: the last measured force, corrected for what the hand did since, and only as far as such corrections have \
                proven themselves. See the error on the right, beside direct reflection.";
pub(in crate::console) const YOUR_TURN: &str = "Your turn";
pub(in crate::console) const PRESS_M_OR_THE: &str = "Press M, or the button in the view, and lead the instrument yourself: drag with the mouse, wheel for the height, arrow \
                keys for small steps. Press into the tissue and watch the arrows. With the rig \"desk\" a SpaceMouse leads it.";
pub(in crate::console) const PLAY: &str = "Play";
pub(in crate::console) const THE_SCRIPT_GOES_ON: &str = "The script goes on by itself.";
pub(in crate::console) const HOLD: &str = "Hold";
pub(in crate::console) const STAYS_IN_THIS_CHAPTER: &str = "Stays in this chapter; the loop goes on.";
pub(in crate::console) const THE_DEMONSTRATION_PLAYS_ON: &str =
    "The demonstration plays on simulated rigs only: on a real one nothing changes mode or delay by itself.";
pub(in crate::console) const THE_LOOP_IS_IDLE: &str = "The loop is idle. Press Engage, and the demonstration goes on.";
pub(in crate::console) const STOPPED_NO_FORCE_NO: &str =
    "Stopped: no force, no motion. Press Release stop, then Engage; these are two steps on purpose.";
pub(in crate::console) const THE_LOOP_GETS_READY: &str = "The loop gets ready.";
pub(in crate::console) const CHOOSE_A_SIMULATED_RIG: &str = "Choose a simulated rig to see it.";
pub(in crate::console) const MEASURED_AT_THE_INSTRUMENT: &str = "measured at the instrument";
pub(in crate::console) const RENDERED_TO_THE_HAND: &str = "rendered to the hand";
pub(in crate::console) const SIZE_OF_THE_FORCE: &str = "Size of the force measured at the instrument and of the force rendered to the hand (N). The mark is the ceiling: no \
         larger force ever reaches the hand.";

/// What a role shows, and its key.
pub(in crate::console) fn meaning_and_key(meaning: &str, key: &str) -> String {
    format!("{meaning} Key {key}.")
}

/// Both forces of a hand against the ceiling, N.
pub(in crate::console) fn hand(name: &str, measured_n: f64, rendered_n: f64, ceiling_n: f64) -> String {
    format!("{name}: measured {measured_n:.1} N, rendered {rendered_n:.1} N, ceiling {ceiling_n:.0} N")
}
