//! The tour, the list of keys, and the glossary.

pub(in crate::console) const STEP_BACK: &str = "Step back";
pub(in crate::console) const NEXT_STEP: &str = "Next step";
pub(in crate::console) const BEGIN: &str = "Begin";
pub(in crate::console) const SKIP_THE_TOUR: &str = "Skip the tour";

/// Position within the tour.
pub(in crate::console) fn step_of(step: usize, steps: usize) -> String {
    format!("{step} of {steps}")
}

/// Title and text of each step.
pub(in crate::console) const TOUR: [(&str, &str); 4] = [
    (
        "Three views of one loop",
        "Surgeon, Technician and Demo: click above, or press F1, F2 or F3. A view changes only what is shown, never what the control \
         loop does. Only Demo changes the mode by itself, and only on simulated rigs.",
    ),
    (
        "The stop",
        "Stop is always at the top right, and on Space and Escape. It switches force and motion off at once and stays on. To start \
         again, press Release stop, then Engage.",
    ),
    (
        "Two forces",
        "Measured at the instrument: a line with one arrowhead. Rendered to the hand: a beaded line with two arrowheads. Arrows, bars \
         and traces use the same two styles.",
    ),
    (
        "Help on hover",
        "Hold the pointer over any number to see its unit, its frame and its meaning. M: drive the instrument by mouse. E: mark a \
         moment in the traces. F4: keys and glossary. Ctrl P: every command by its name.",
    ),
];

/// Terms of the field and of this program, with their explanations.
pub(in crate::console) const GLOSSARY: [(&str, &str); 25] = [
    (
        "Anchored",
        "Our mode: the last measured force, corrected for the hand's motion since then as far as earlier corrections reduced the error.",
    ),
    ("Ceiling", "The largest force that can reach the hand, N."),
    ("Clutch", "While it is pressed, the hand moves freely and the follower holds still."),
    ("Condition", "How well the columns of a model can be told apart; 1 is perfect, above 10 000 hardly at all."),
    ("Correspondence", "The rotation between the sensor under the tissue and the sensor at the wrist."),
    (
        "Dead band",
        "Speed of the hand below which no force is rendered: at standstill an impedance cannot be identified.",
    ),
    ("Degree", "N of the polynomial between motion and force; 0 means no correction."),
    ("Delay", "Time that a measurement takes from the follower to the hand, one way, ms."),
    ("DFR", "Direct force reflection: the measured force, delayed by the link."),
    ("Excitation", "How much the motion in the window varies. Without motion nothing can be identified."),
    ("Follower", "The robot arm with the instrument."),
    ("Gain", "Ratio of the force in the hand to the force that the mode asks for, no unit."),
    ("Gate", "A safety function between the model and the hand that can reduce or stop the force."),
    ("Held out", "Data that were not used for a fit and therefore show its true error."),
    ("Horizon", "The link's delay: how far ahead of its newest data the leader predicts the force."),
    ("IMA, NIMA", "(Nonlinear) impedance matching: the link carries the tissue's impedance instead of the force."),
    ("Interlock", "The state machine that permits force and motion; nothing else does."),
    ("Leader", "The haptic device in the hand."),
    ("Measured", "The force at the tip of the instrument now, N."),
    ("Missed", "Periods that the control loop missed because it was late; counted and skipped, never caught up."),
    ("Rendered", "The force commanded to the hand after all gates, N."),
    (
        "Tip force",
        "The force at the tip, estimated from the wrist sensor without gravity and without the trocar's friction, N.",
    ),
    ("Trocar", "The port through which the instrument enters the body; the remote centre of its motion."),
    (
        "World",
        "The frame of all forces and positions (kbf in the paper): z up, the tissue at rest at z = 0. Forces act on the instrument.",
    ),
    ("Wrench", "Force and torque together, as the wrist sensor measures them."),
];

pub(in crate::console) const KEYS_HEADING: &str = "Keys";
pub(in crate::console) const WORDS_HEADING: &str = "Terms";

pub(in crate::console) const GLOSSARY_WINDOW: &str = "Glossary";
pub(in crate::console) const TOUR_WINDOW: &str = "Tour";
