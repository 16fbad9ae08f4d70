//! Texts: the rendering modes.

use nima_core::impedance::{Baseline, Mode};

/// Name of a mode on a button.
pub(crate) const fn mode_name(mode: Mode) -> &'static str {
    words(mode)[0]
}

/// Explanation of a mode, one sentence.
pub(crate) const fn mode_meaning(mode: Mode) -> &'static str {
    words(mode)[1]
}

/// Name and explanation. The methods of others are on the screen where the rig file names one.
const fn words(mode: Mode) -> [&'static str; 2] {
    match mode {
        Mode::Literal => [
            "Literal",
            "Exactly as in the paper: renders M X from the hand's own motion, with the degree that has the \
    smallest error inside the window. Renders no force at standstill.",
        ],
        Mode::Linear => ["Linear", "The paper's linear predecessor: like Literal, but always with degree 1"],
        Mode::Dfr => ["Direct (DFR)", "Direct force reflection: the measured force, delayed by the link"],
        Mode::Anchored => [
            "Anchored",
            "The last measured force, corrected by the identified impedance for the hand's motion since then. \
    Where a correction does not reduce the error, it is plain direct reflection.",
        ],
        Mode::Matched => [
            "Matched",
            "Only the tissue's parameters cross the link; the force is made from the hand's own motion, so no late force can kick",
        ],
        Mode::Nima => [
            "NIMA",
            "The paper's polynomials under the rules of Matched: a constant, a kept origin, a ridge, and degrees judged at the horizon",
        ],
        Mode::Best => [
            "Best of both",
            "Anchored and Matched, mixed on each axis by how wrong each was at the leader during the last second; the default",
        ],
        Mode::Baseline(Baseline::ModelMediated) => [
            "Model-mediated",
            "For comparison: a Hunt-Crossley contact is identified at the tissue; \
    its parameters cross the link and the force is made from the hand's own motion",
        ],
        Mode::Baseline(Baseline::Waves) => [
            "Wave variables",
            "For comparison: force and velocity come back as a wave and are decoded with the hand's own velocity",
        ],
        Mode::Baseline(Baseline::Passivity) => [
            "Time-domain passivity",
            "For comparison: direct reflection with damping whenever the hand would get more \
    energy than the tissue has returned",
        ],
        Mode::Baseline(Baseline::Kalman) => {
            ["Kalman", "For comparison: a Kalman filter of the force and its rate, extrapolated over the delay"]
        }
        Mode::Baseline(Baseline::Autoregressive) => {
            ["Autoregressive", "For comparison: the force foretold from its own past by an autoregressive model"]
        }
    }
}
