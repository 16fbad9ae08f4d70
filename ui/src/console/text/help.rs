//! The tour, the list of keys, and the glossary.

use crate::language::{Text, told};

pub(in crate::console) const STEP_BACK: Text = Text::of("Step back", "Step back");
pub(in crate::console) const NEXT_STEP: Text = Text::of("Next step", "Next step");
pub(in crate::console) const BEGIN: Text = Text::of("Begin", "Begin");
pub(in crate::console) const SKIP_THE_TOUR: Text = Text::of("Skip the tour", "Skip the tour");

/// Position within the tour.
pub(in crate::console) fn step_of(step: usize, steps: usize) -> String {
    told!("{step} of {steps}", "{step} of {steps}")
}

/// Title and text of each step.
pub(in crate::console) const TOUR: [(Text, Text); 4] = [
    (
        Text::of("Three views of one loop", "Three views of one loop"),
        Text::of(
            "Surgeon, Technician and Demo: click above, or press F1, F2 or F3. A view changes only what is shown, \
             never what the control loop does. Only Demo changes the mode by itself, and only on simulated rigs.",
            "Surgeon, Technician and Demo: click above, or press F1, F2 or F3. A view changes only what is shown, \
             never what the control loop does. Only Demo changes the mode by itself, and only on simulated rigs.",
        ),
    ),
    (
        Text::of("The stop", "The stop"),
        Text::of(
            "Stop is always at the top right, and on Space and Escape. It switches force and motion off at once and \
             stays on. To start again, press Release stop, then Engage.",
            "Stop is always at the top right, and on Space and Escape. It switches force and motion off at once and \
             stays on. To start again, press Release stop, then Engage.",
        ),
    ),
    (
        Text::of("Two forces", "Two forces"),
        Text::of(
            "Measured at the instrument: a line with one arrowhead. Rendered to the hand: a beaded line with two \
             arrowheads. Arrows, bars and traces use the same two styles.",
            "Measured at the instrument: a line with one arrowhead. Rendered to the hand: a beaded line with two \
             arrowheads. Arrows, bars and traces use the same two styles.",
        ),
    ),
    (
        Text::of("Help on hover", "Help on hover"),
        Text::of(
            "Hold the pointer over any number to see its unit, its frame and its meaning. M: drive the instrument by \
             mouse. E: mark a moment in the traces. F4: keys and glossary. Ctrl P: every command by its name.",
            "Hold the pointer over any number to see its unit, its frame and its meaning. M: drive the instrument by \
             mouse. E: mark a moment in the traces. F4: keys and glossary. Ctrl P: every command by its name.",
        ),
    ),
];

/// Terms of the field and of this program, with their explanations.
pub(in crate::console) const GLOSSARY: [(Text, Text); 25] = [
    (
        Text::of("Anchored", "Anchored"),
        Text::of(
            "Our mode: the last measured force, corrected for the hand's motion since then as far as earlier \
             corrections reduced the error.",
            "Our mode: the last measured force, corrected for the hand's motion since then as far as earlier \
             corrections reduced the error.",
        ),
    ),
    (
        Text::of("Ceiling", "Ceiling"),
        Text::of("The largest force that can reach the hand, N.", "The largest force that can reach the hand, N."),
    ),
    (
        Text::of("Clutch", "Clutch"),
        Text::of(
            "While it is pressed, the hand moves freely and the follower holds still.",
            "While it is pressed, the hand moves freely and the follower holds still.",
        ),
    ),
    (
        Text::of("Condition", "Condition"),
        Text::of(
            "How well the columns of a model can be told apart; 1 is perfect, above 10 000 hardly at all.",
            "How well the columns of a model can be told apart; 1 is perfect, above 10 000 hardly at all.",
        ),
    ),
    (
        Text::of("Correspondence", "Correspondence"),
        Text::of(
            "The rotation between the sensor under the tissue and the sensor at the wrist.",
            "The rotation between the sensor under the tissue and the sensor at the wrist.",
        ),
    ),
    (
        Text::of("Dead band", "Dead band"),
        Text::of(
            "Speed of the hand below which no force is rendered: at standstill an impedance cannot be identified.",
            "Speed of the hand below which no force is rendered: at standstill an impedance cannot be identified.",
        ),
    ),
    (
        Text::of("Degree", "Degree"),
        Text::of(
            "N of the polynomial between motion and force; 0 means no correction.",
            "N of the polynomial between motion and force; 0 means no correction.",
        ),
    ),
    (
        Text::of("Delay", "Delay"),
        Text::of(
            "Time that a measurement takes from the follower to the hand, one way, ms.",
            "Time that a measurement takes from the follower to the hand, one way, ms.",
        ),
    ),
    (
        Text::of("DFR", "DFR"),
        Text::of(
            "Direct force reflection: the measured force, delayed by the link.",
            "Direct force reflection: the measured force, delayed by the link.",
        ),
    ),
    (
        Text::of("Excitation", "Excitation"),
        Text::of(
            "How much the motion in the window varies. Without motion nothing can be identified.",
            "How much the motion in the window varies. Without motion nothing can be identified.",
        ),
    ),
    (
        Text::of("Follower", "Follower"),
        Text::of("The robot arm with the instrument.", "The robot arm with the instrument."),
    ),
    (
        Text::of("Gain", "Gain"),
        Text::of(
            "Ratio of the force in the hand to the force that the mode asks for, no unit.",
            "Ratio of the force in the hand to the force that the mode asks for, no unit.",
        ),
    ),
    (
        Text::of("Gate", "Gate"),
        Text::of(
            "A safety function between the model and the hand that can reduce or stop the force.",
            "A safety function between the model and the hand that can reduce or stop the force.",
        ),
    ),
    (
        Text::of("Held out", "Held out"),
        Text::of(
            "Data that were not used for a fit and therefore show its true error.",
            "Data that were not used for a fit and therefore show its true error.",
        ),
    ),
    (
        Text::of("Horizon", "Horizon"),
        Text::of(
            "The link's delay: how far ahead of its newest data the leader predicts the force.",
            "The link's delay: how far ahead of its newest data the leader predicts the force.",
        ),
    ),
    (
        Text::of("IMA, NIMA", "IMA, NIMA"),
        Text::of(
            "(Nonlinear) impedance matching: the link carries the tissue's impedance instead of the force.",
            "(Nonlinear) impedance matching: the link carries the tissue's impedance instead of the force.",
        ),
    ),
    (
        Text::of("Interlock", "Interlock"),
        Text::of(
            "The state machine that permits force and motion; nothing else does.",
            "The state machine that permits force and motion; nothing else does.",
        ),
    ),
    (Text::of("Leader", "Leader"), Text::of("The haptic device in the hand.", "The haptic device in the hand.")),
    (
        Text::of("Measured", "Measured"),
        Text::of("The force at the tip of the instrument now, N.", "The force at the tip of the instrument now, N."),
    ),
    (
        Text::of("Missed", "Missed"),
        Text::of(
            "Periods that the control loop missed because it was late; counted and skipped, never caught up.",
            "Periods that the control loop missed because it was late; counted and skipped, never caught up.",
        ),
    ),
    (
        Text::of("Rendered", "Rendered"),
        Text::of(
            "The force commanded to the hand after all gates, N.",
            "The force commanded to the hand after all gates, N.",
        ),
    ),
    (
        Text::of("Tip force", "Tip force"),
        Text::of(
            "The force at the tip, estimated from the wrist sensor without gravity and without the trocar's friction, \
             N.",
            "The force at the tip, estimated from the wrist sensor without gravity and without the trocar's friction, \
             N.",
        ),
    ),
    (
        Text::of("Trocar", "Trocar"),
        Text::of(
            "The port through which the instrument enters the body; the remote centre of its motion.",
            "The port through which the instrument enters the body; the remote centre of its motion.",
        ),
    ),
    (
        Text::of("World", "World"),
        Text::of(
            "The frame of all forces and positions (kbf in the paper): z up, the tissue at rest at z = 0. Forces act \
             on the instrument.",
            "The frame of all forces and positions (kbf in the paper): z up, the tissue at rest at z = 0. Forces act \
             on the instrument.",
        ),
    ),
    (
        Text::of("Wrench", "Wrench"),
        Text::of(
            "Force and torque together, as the wrist sensor measures them.",
            "Force and torque together, as the wrist sensor measures them.",
        ),
    ),
];

pub(in crate::console) const KEYS_HEADING: Text = Text::of("Keys", "Keys");
pub(in crate::console) const WORDS_HEADING: Text = Text::of("Terms", "Terms");

pub(in crate::console) const GLOSSARY_WINDOW: Text = Text::of("Glossary", "Glossary");
pub(in crate::console) const TOUR_WINDOW: Text = Text::of("Tour", "Tour");
