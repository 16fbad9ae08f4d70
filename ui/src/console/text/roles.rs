//! The three views, and the script of the demonstration.

use crate::language::{Text, told};

pub(in crate::console) const SURGEON: Text = Text::of("Surgeon", "Surgeon");
pub(in crate::console) const TECHNICIAN: Text = Text::of("Technician", "Technician");
pub(in crate::console) const DEMO: Text = Text::of("Demo", "Demo");
pub(in crate::console) const SURGEON_HOVER: Text = Text::of(
    "The endoscope's view, the forces with their ceiling, the gain and the alarms",
    "The endoscope's view, the forces with their ceiling, the gain and the alarms",
);
pub(in crate::console) const TECHNICIAN_HOVER: Text = Text::of(
    "All panels: feedback, devices, calibration, gates, errors, degrees, timing and trade-off",
    "All panels: feedback, devices, calibration, gates, errors, degrees, timing and trade-off",
);
pub(in crate::console) const DEMO_HOVER: Text = Text::of(
    "A demonstration that runs and explains itself, on simulated rigs only",
    "A demonstration that runs and explains itself, on simulated rigs only",
);
pub(in crate::console) const SWITCH_DISABLED_HOVER: Text =
    Text::of("Close the wizard or the study first", "Close the wizard or the study first");
pub(in crate::console) const DEMO_START: Text = Text::of("What you see", "What you see");
pub(in crate::console) const DEMO_START_CAPTION: Text = Text::of(
    "A hand moves an instrument from peg to peg and presses it into soft tissue. The ivory arrow is the \
    force measured at the instrument, the blue arrow is the force that the hand feels. The link delays \
    all data by 50 ms.",
    "A hand moves an instrument from peg to peg and presses it into soft tissue. The ivory arrow is the \
    force measured at the instrument, the blue arrow is the force that the hand feels. The link delays \
    all data by 50 ms.",
);
pub(in crate::console) const DEMO_DIRECT: Text = Text::of("Direct reflection", "Direct reflection");
pub(in crate::console) const DEMO_DIRECT_CAPTION: Text = Text::of(
    "The delay is now 300 ms, and the measured force is sent as it is: the blue arrow lags behind the \
    ivory arrow. The hand feels contacts that are already over and misses contacts that have just begun.",
    "The delay is now 300 ms, and the measured force is sent as it is: the blue arrow lags behind the \
    ivory arrow. The hand feels contacts that are already over and misses contacts that have just begun.",
);
pub(in crate::console) const DEMO_LINEAR: Text = Text::of("Linear impedance", "Linear impedance");
pub(in crate::console) const DEMO_LINEAR_CAPTION: Text = Text::of(
    "The link now carries the tissue's impedance instead of the force: stiffness, damping and mass of the \
    last 300 ms. The force is computed from the hand's own motion (IMA), without delay. It is wrong \
    where the impedance has changed since.",
    "The link now carries the tissue's impedance instead of the force: stiffness, damping and mass of the \
    last 300 ms. The force is computed from the hand's own motion (IMA), without delay. It is wrong \
    where the impedance has changed since.",
);
pub(in crate::console) const DEMO_LITERAL: Text = Text::of("Nonlinear, as in the paper", "Nonlinear, as in the paper");
pub(in crate::console) const DEMO_LITERAL_CAPTION: Text = Text::of(
    "The paper's method: a polynomial of degree 1 to 5 (NIMA). It fits the past so closely that it \
    predicts the future badly, and it renders no force while the hand rests. The gates keep its \
    excessive forces from the hand.",
    "The paper's method: a polynomial of degree 1 to 5 (NIMA). It fits the past so closely that it \
    predicts the future badly, and it renders no force while the hand rests. The gates keep its \
    excessive forces from the hand.",
);
pub(in crate::console) const DEMO_ANCHORED: Text = Text::of("Anchored", "Anchored");
pub(in crate::console) const DEMO_ANCHORED_CAPTION: Text = Text::of(
    "The last measured force, corrected for the hand's motion since then, and only as far as \
    earlier corrections reduced the error. On the right, compare its error with direct reflection.",
    "The last measured force, corrected for the hand's motion since then, and only as far as \
    earlier corrections reduced the error. On the right, compare its error with direct reflection.",
);
pub(in crate::console) const DEMO_MATCHED: Text = Text::of("Matched", "Matched");
pub(in crate::console) const DEMO_MATCHED_CAPTION: Text = Text::of(
    "Same delay, and no force crosses the link at all. Only the tissue's \
    parameters do; the blue arrow is made from the hand's own motion, so a late force cannot kick.",
    "Same delay, and no force crosses the link at all. Only the tissue's \
    parameters do; the blue arrow is made from the hand's own motion, so a late force cannot kick.",
);
pub(in crate::console) const DEMO_LET_GO: Text = Text::of("Letting go", "Letting go");
pub(in crate::console) const DEMO_LET_GO_CAPTION: Text = Text::of(
    "Direct reflection at 300 ms, and the governor is left out. The hand lets go while it presses: the late \
    force now pushes a handle that nobody holds, and kicks it away.",
    "Direct reflection at 300 ms, and the governor is left out. The hand lets go while it presses: the late \
    force now pushes a handle that nobody holds, and kicks it away.",
);
pub(in crate::console) const DEMO_GOVERNOR: Text = Text::of("The governor", "The governor");
pub(in crate::console) const DEMO_GOVERNOR_CAPTION: Text = Text::of(
    "The same with the last gate, the governor: it notices that no hand carries the force, brakes the handle \
    instead, and ends the feedback. The demonstration engages again when the hand is back.",
    "The same with the last gate, the governor: it notices that no hand carries the force, brakes the handle \
    instead, and ends the feedback. The demonstration engages again when the hand is back.",
);
pub(in crate::console) const DEMO_YOUR_TURN: Text = Text::of("Your turn", "Your turn");
pub(in crate::console) const DEMO_YOUR_TURN_CAPTION: Text = Text::of(
    "Press M, or the button in the view, and move the instrument yourself: drag with the mouse, wheel for the height, \
     arrow keys for small steps. Press into the tissue and watch the arrows. The mode is now the best of both, \
     anchored and matched, by what each was worth lately. With the rig \"desk\" you can use a SpaceMouse.",
    "Press M, or the button in the view, and move the instrument yourself: drag with the mouse, wheel for the height, \
     arrow keys for small steps. Press into the tissue and watch the arrows. The mode is now the best of both, \
     anchored and matched, by what each was worth lately. With the rig \"desk\" you can use a SpaceMouse.",
);
pub(in crate::console) const PLAY: Text = Text::of("Play", "Play");
pub(in crate::console) const PLAY_HOVER: Text =
    Text::of("Continues with the next chapter automatically", "Continues with the next chapter automatically");
pub(in crate::console) const HOLD: Text = Text::of("Hold", "Hold");
pub(in crate::console) const HOLD_HOVER: Text = Text::of(
    "Stays in this chapter; the control loop keeps running",
    "Stays in this chapter; the control loop keeps running",
);
pub(in crate::console) const NOTE_REAL_RIG: Text = Text::of(
    "The demonstration runs on simulated rigs only: on a real rig, mode and delay never change by themselves",
    "The demonstration runs on simulated rigs only: on a real rig, mode and delay never change by themselves",
);
pub(in crate::console) const NOTE_IDLE: Text = Text::of(
    "The loop is idle. Press Engage to continue the demonstration.",
    "The loop is idle. Press Engage to continue the demonstration.",
);
pub(in crate::console) const NOTE_STOPPED: Text = Text::of(
    "Stopped: no force, no motion. Press Release stop, then Engage.",
    "Stopped: no force, no motion. Press Release stop, then Engage.",
);
pub(in crate::console) const NOTE_NOT_ENGAGED: Text =
    Text::of("The loop is not engaged yet", "The loop is not engaged yet");
pub(in crate::console) const NOTE_CHOOSE_SIMULATED: Text =
    Text::of("To see it, start the console with a simulated rig", "To see it, start the console with a simulated rig");
pub(in crate::console) const MEASURED: Text = Text::of("measured at the instrument", "measured at the instrument");
pub(in crate::console) const RENDERED: Text = Text::of("rendered to the hand", "rendered to the hand");
pub(in crate::console) const BARS_HOVER: Text = Text::of(
    "Size of the force measured at the instrument and of the force rendered to the hand (N). The mark is \
    the force ceiling, the largest force that can reach the hand.",
    "Size of the force measured at the instrument and of the force rendered to the hand (N). The mark is \
    the force ceiling, the largest force that can reach the hand.",
);

/// How far the handle went since it was let go, mm.
pub(in crate::console) fn handle_went(travel_mm: f64) -> String {
    if travel_mm < 10.0 {
        told!("The handle moved {travel_mm:.1} mm.", "The handle moved {travel_mm:.1} mm.")
    } else {
        told!("The handle moved {travel_mm:.0} mm.", "The handle moved {travel_mm:.0} mm.")
    }
}

/// Hover text of a view, with its key.
pub(in crate::console) fn meaning_and_key(meaning: &str, key: &str) -> String {
    told!("{meaning}\nKey {key}", "{meaning}\nKey {key}")
}

/// Both forces of a hand and the ceiling, N.
pub(in crate::console) fn hand(name: &str, measured_n: f64, rendered_n: f64, ceiling_n: f64) -> String {
    told!(
        "{name}: measured {measured_n:.1} N, rendered {rendered_n:.1} N, ceiling {ceiling_n:.0} N",
        "{name}: measured {measured_n:.1} N, rendered {rendered_n:.1} N, ceiling {ceiling_n:.0} N"
    )
}

/// Label of the ceiling's mark.
pub(in crate::console) fn ceiling(ceiling_n: f64) -> String {
    told!("ceiling {ceiling_n:.0} N", "ceiling {ceiling_n:.0} N")
}
