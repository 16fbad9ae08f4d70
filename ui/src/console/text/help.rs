//! The tour, the list of keys, and the glossary.

pub(in crate::console) const STEP_BACK: &str = "Step back";
pub(in crate::console) const NEXT_STEP: &str = "Next step";
pub(in crate::console) const BEGIN: &str = "Begin";
pub(in crate::console) const SKIP_THE_TOUR: &str = "Skip the tour";

/// Where in the tour.
pub(in crate::console) fn step_of(step: usize, steps: usize) -> String {
    format!("{step} of {steps}")
}

/// Heading and words of a step.
pub(in crate::console) const TOUR: [(&str, &str); 4] = [
    (
        "Three views of one loop",
        "Surgeon, Technician and Demo, by a click above or by F1, F2 and F3. They change what is shown, never what the loop does; \
         only the demonstration switches modes, and only on simulated rigs.",
    ),
    (
        "The stop",
        "Always above on the right, and Space or Escape from anywhere. It takes force and motion away at once and stays latched: out \
         of it lead two steps, Release stop and Engage.",
    ),
    (
        "Two forces",
        "Measured at the instrument: a line with one head. Rendered to the hand: a beaded line with two. Arrows in the view, bars \
         against the ceiling, lines in the traces mean the same everywhere.",
    ),
    (
        "Ask the screen",
        "Rest the pointer on any number: it tells its unit, its frame and its meaning. M lets you lead the instrument, E marks a \
         moment in the traces, F4 opens the glossary.",
    ),
];

/// Words of the field.
pub(in crate::console) const GLOSSARY: [(&str, &str); 22] = [
    (
        "Anchored",
        "Our mode: the last measured force, corrected for what the hand did since, as far as such corrections have proven themselves.",
    ),
    ("Ceiling", "The largest force that ever reaches the hand, N."),
    ("Clutch", "While it is pressed the hand moves freely and the follower rests."),
    ("Condition", "How hard the columns of a model are to tell apart; 1 is perfect, above 10 000 hardly at all."),
    ("Dead band", "Speed of the hand below which nothing is rendered: at standstill an impedance is unknown."),
    ("Degree", "N of the polynomial between motion and force; 0 means no correction."),
    ("Delay", "Time that a measurement takes from the follower to the hand, one way, ms."),
    ("DFR", "Direct force reflection: the measured force, as late as it comes."),
    ("Excitation", "How much the motion in the window varies. Without motion nothing can be identified."),
    ("Follower", "The robot arm with the instrument."),
    ("Gain", "Factor between the force asked for and the force in the hand, without unit."),
    ("Gate", "A stage between a model and the hand that may take force away, for a reason that it tells."),
    ("Horizon", "The link's delay: how far ahead of its newest data the leader renders."),
    ("IMA, NIMA", "(Nonlinear) impedance matching: the parameters of a law cross the link instead of forces."),
    ("Interlock", "The state machine that alone permits force and motion."),
    (
        "kbf",
        "The frame of the follower's base: z up, the tissue at rest at z = 0. Forces are the tissue's on the instrument.",
    ),
    ("Leader", "The haptic device in the hand."),
    ("Measured", "The force at the tip of the instrument, now, N."),
    ("Missed", "Periods in which the loop was not run in time; counted and skipped, never caught up."),
    ("Rendered", "The force commanded to the hand after all gates, N."),
    ("Trocar", "Where the instrument goes through the wall; the remote centre of its motion."),
    ("Wrench", "Force and torque together, as the wrist sensor reads them."),
];

pub(in crate::console) const KEYS_HEADING: &str = "Keys";
pub(in crate::console) const WORDS_HEADING: &str = "Words";

/// Every key that does something, and what.
pub(in crate::console) const KEYS: [(&str, &str); 13] = [
    ("Space, Escape", "Stop. From anywhere; while a name is written, Escape alone."),
    ("F1, F2, F3", "Surgeon, Technician, Demo."),
    ("F4", "Keys and words: this list."),
    ("F5", "The last alarms."),
    ("A", "Acknowledges the alarms."),
    ("E", "Marks this moment in the traces."),
    ("M", "Lets you lead the instrument, or lets it go."),
    ("Arrow keys", "A small step of the instrument while you lead it."),
    ("Page Up, Page Down", "Its height while you lead it."),
    ("Ctrl +, Ctrl -", "Everything larger or smaller."),
    ("Tab, Shift Tab", "To the next control, or back. It gets a frame."),
    ("Enter", "Presses the control that has the frame."),
    ("Ctrl Tab", "The next tab of the group under the pointer."),
];
pub(in crate::console) const GLOSSARY_WINDOW: &str = "Glossary";
pub(in crate::console) const TOUR_WINDOW: &str = "Tour";
