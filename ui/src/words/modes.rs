//! Texts: the rendering modes.

use nima_core::impedance::{Baseline, Mode};

use crate::language::word;

/// Name of a mode on a button.
pub(crate) fn mode_name(mode: Mode) -> &'static str {
    words(mode)[0]
}

/// Explanation of a mode, one sentence.
pub(crate) fn mode_meaning(mode: Mode) -> &'static str {
    words(mode)[1]
}

/// Name and explanation. The methods of others are on the screen where the rig file names one.
fn words(mode: Mode) -> [&'static str; 2] {
    match mode {
        Mode::Literal => [
            word("Literal", "Literal"),
            word(
                "Exactly as in the paper: renders M X from the hand's own motion, with the degree that has the \
    smallest error inside the window. Renders no force at standstill.",
                "Exactly as in the paper: renders M X from the hand's own motion, with the degree that has the \
    smallest error inside the window. Renders no force at standstill.",
            ),
        ],
        Mode::Linear => [
            word("Linear", "Linear"),
            word(
                "The paper's linear predecessor: like Literal, but always with degree 1",
                "The paper's linear predecessor: like Literal, but always with degree 1",
            ),
        ],
        Mode::Dfr => [
            word("Direct (DFR)", "Direct (DFR)"),
            word(
                "Direct force reflection: the measured force, delayed by the link",
                "Direct force reflection: the measured force, delayed by the link",
            ),
        ],
        Mode::Anchored => [
            word("Anchored", "Anchored"),
            word(
                "The last measured force, corrected by the identified impedance for the hand's motion since then. \
    Where a correction does not reduce the error, it is plain direct reflection.",
                "The last measured force, corrected by the identified impedance for the hand's motion since then. \
    Where a correction does not reduce the error, it is plain direct reflection.",
            ),
        ],
        Mode::Matched => [
            word("Matched", "Matched"),
            word(
                "Only the tissue's parameters cross the link; the force is made from the hand's own motion, so no late \
                 force can kick",
                "Only the tissue's parameters cross the link; the force is made from the hand's own motion, so no late \
                 force can kick",
            ),
        ],
        Mode::Nima => [
            word("NIMA", "NIMA"),
            word(
                "The paper's polynomials under the rules of Matched: a constant, a kept origin, a ridge, and degrees \
                 judged at the horizon",
                "The paper's polynomials under the rules of Matched: a constant, a kept origin, a ridge, and degrees \
                 judged at the horizon",
            ),
        ],
        Mode::Best => [
            word("Best of both", "Best of both"),
            word(
                "Anchored and Matched, mixed on each axis by how wrong each was at the leader during the last second; \
                 the default",
                "Anchored and Matched, mixed on each axis by how wrong each was at the leader during the last second; \
                 the default",
            ),
        ],
        Mode::Baseline(Baseline::ModelMediated) => [
            word("Model-mediated", "Model-mediated"),
            word(
                "For comparison: a Hunt-Crossley contact is identified at the tissue; \
    its parameters cross the link and the force is made from the hand's own motion",
                "For comparison: a Hunt-Crossley contact is identified at the tissue; \
    its parameters cross the link and the force is made from the hand's own motion",
            ),
        ],
        Mode::Baseline(Baseline::Waves) => [
            word("Wave variables", "Wave variables"),
            word(
                "For comparison: force and velocity come back as a wave and are decoded with the hand's own velocity",
                "For comparison: force and velocity come back as a wave and are decoded with the hand's own velocity",
            ),
        ],
        Mode::Baseline(Baseline::Passivity) => [
            word("Time-domain passivity", "Time-domain passivity"),
            word(
                "For comparison: direct reflection with damping whenever the hand would get more \
    energy than the tissue has returned",
                "For comparison: direct reflection with damping whenever the hand would get more \
    energy than the tissue has returned",
            ),
        ],
        Mode::Baseline(Baseline::Kalman) => [
            word("Kalman", "Kalman"),
            word(
                "For comparison: a Kalman filter of the force and its rate, extrapolated over the delay",
                "For comparison: a Kalman filter of the force and its rate, extrapolated over the delay",
            ),
        ],
        Mode::Baseline(Baseline::Autoregressive) => [
            word("Autoregressive", "Autoregressive"),
            word(
                "For comparison: the force foretold from its own past by an autoregressive model",
                "For comparison: the force foretold from its own past by an autoregressive model",
            ),
        ],
    }
}
