//! The three views, and the script of the demonstration.

pub(in crate::console) const SURGEON: &str = "Surgeon";
pub(in crate::console) const TECHNICIAN: &str = "Technician";
pub(in crate::console) const DEMO: &str = "Demo";
pub(in crate::console) const SURGEON_HOVER: &str =
    "The endoscope's view, the forces with their ceiling, the gain and the alarms";
pub(in crate::console) const TECHNICIAN_HOVER: &str =
    "All panels: feedback, devices, calibration, gates, errors, degrees, timing and trade-off";
pub(in crate::console) const DEMO_HOVER: &str = "A demonstration that runs and explains itself, on simulated rigs only";
pub(in crate::console) const SWITCH_DISABLED_HOVER: &str = "Close the wizard or the study first";
pub(in crate::console) const DEMO_START: &str = "What you see";
pub(in crate::console) const DEMO_START_CAPTION: &str = "A hand moves an instrument from peg to peg and presses it into soft tissue. The ivory arrow is the \
    force measured at the instrument, the blue arrow is the force that the hand feels. The link delays \
    all data by 50 ms.";
pub(in crate::console) const DEMO_DIRECT: &str = "Direct reflection";
pub(in crate::console) const DEMO_DIRECT_CAPTION: &str = "The delay is now 300 ms, and the measured force is sent as it is: the blue arrow lags behind the \
    ivory arrow. The hand feels contacts that are already over and misses contacts that have just begun.";
pub(in crate::console) const DEMO_LINEAR: &str = "Linear impedance";
pub(in crate::console) const DEMO_LINEAR_CAPTION: &str = "The link now carries the tissue's impedance instead of the force: stiffness, damping and mass of the \
    last 300 ms. The force is computed from the hand's own motion (IMA), without delay. It is wrong \
    where the impedance has changed since.";
pub(in crate::console) const DEMO_LITERAL: &str = "Nonlinear, as in the paper";
pub(in crate::console) const DEMO_LITERAL_CAPTION: &str = "The paper's method: a polynomial of degree 1 to 5 (NIMA). It fits the past so closely that it \
    predicts the future badly, and it renders no force while the hand rests. The gates keep its \
    excessive forces from the hand.";
pub(in crate::console) const DEMO_ANCHORED: &str = "Anchored";
pub(in crate::console) const DEMO_ANCHORED_CAPTION: &str = "The last measured force, corrected for the hand's motion since then, and only as far as \
    earlier corrections reduced the error. On the right, compare its error with direct reflection.";
pub(in crate::console) const DEMO_MATCHED: &str = "Matched";
pub(in crate::console) const DEMO_MATCHED_CAPTION: &str = "Same delay, and no force crosses the link at all. Only the tissue's \
    parameters do; the blue arrow is made from the hand's own motion, so a late force cannot kick.";
pub(in crate::console) const DEMO_LET_GO: &str = "Letting go";
pub(in crate::console) const DEMO_LET_GO_CAPTION: &str = "Direct reflection at 300 ms, and the governor is left out. The hand lets go while it presses: the late \
    force now pushes a handle that nobody holds, and kicks it away.";
pub(in crate::console) const DEMO_GOVERNOR: &str = "The governor";
pub(in crate::console) const DEMO_GOVERNOR_CAPTION: &str = "The same with the last gate, the governor: it notices that no hand carries the force, brakes the handle \
    instead, and ends the feedback. The demonstration engages again when the hand is back.";
pub(in crate::console) const DEMO_YOUR_TURN: &str = "Your turn";
pub(in crate::console) const DEMO_YOUR_TURN_CAPTION: &str = "Press M, or the button in the view, and move the instrument yourself: drag with the mouse, wheel for \
    the height, arrow keys for small steps. Press into the tissue and watch the arrows. The mode is now \
    the best of both, anchored and matched, by what each was worth lately. With the rig \"desk\" you can use a SpaceMouse.";
pub(in crate::console) const PLAY: &str = "Play";
pub(in crate::console) const PLAY_HOVER: &str = "Continues with the next chapter automatically";
pub(in crate::console) const HOLD: &str = "Hold";
pub(in crate::console) const HOLD_HOVER: &str = "Stays in this chapter; the control loop keeps running";
pub(in crate::console) const NOTE_REAL_RIG: &str =
    "The demonstration runs on simulated rigs only: on a real rig, mode and delay never change by themselves";
pub(in crate::console) const NOTE_IDLE: &str = "The loop is idle. Press Engage to continue the demonstration.";
pub(in crate::console) const NOTE_STOPPED: &str = "Stopped: no force, no motion. Press Release stop, then Engage.";
pub(in crate::console) const NOTE_NOT_ENGAGED: &str = "The loop is not engaged yet";
pub(in crate::console) const NOTE_CHOOSE_SIMULATED: &str = "To see it, start the console with a simulated rig";
pub(in crate::console) const MEASURED: &str = "measured at the instrument";
pub(in crate::console) const RENDERED: &str = "rendered to the hand";
pub(in crate::console) const BARS_HOVER: &str = "Size of the force measured at the instrument and of the force rendered to the hand (N). The mark is \
    the force ceiling, the largest force that can reach the hand.";

/// How far the handle went since it was let go, mm.
pub(in crate::console) fn handle_went(travel_mm: f64) -> String {
    if travel_mm < 10.0 {
        format!("The handle moved {travel_mm:.1} mm.")
    } else {
        format!("The handle moved {travel_mm:.0} mm.")
    }
}

/// Hover text of a view, with its key.
pub(in crate::console) fn meaning_and_key(meaning: &str, key: &str) -> String {
    format!("{meaning}\nKey {key}")
}

/// Both forces of a hand and the ceiling, N.
pub(in crate::console) fn hand(name: &str, measured_n: f64, rendered_n: f64, ceiling_n: f64) -> String {
    format!("{name}: measured {measured_n:.1} N, rendered {rendered_n:.1} N, ceiling {ceiling_n:.0} N")
}

/// Label of the ceiling's mark.
pub(in crate::console) fn ceiling(ceiling_n: f64) -> String {
    format!("ceiling {ceiling_n:.0} N")
}
