//! The rendering modes.

pub(in crate::console) const LITERAL: &str = "Literal";
pub(in crate::console) const LINEAR: &str = "Linear";
pub(in crate::console) const DFR: &str = "Direct (DFR)";
pub(in crate::console) const ANCHORED: &str = "Anchored";
pub(in crate::console) const MATCHED: &str = "Matched";
pub(in crate::console) const NIMA: &str = "NIMA";
pub(in crate::console) const BEST: &str = "Best of both";
pub(in crate::console) const MATCHED_HOVER: &str = "Only the tissue's parameters cross the link; the force is made from the hand's own motion, so no late force can kick";
pub(in crate::console) const NIMA_HOVER: &str = "The paper's polynomials under the rules of Matched: a constant, a kept origin, a ridge, and degrees judged at the horizon";
pub(in crate::console) const BEST_HOVER: &str =
    "Anchored and Matched, mixed on each axis by how wrong each was at the leader during the last second; the default";
pub(in crate::console) const LITERAL_HOVER: &str = "Exactly as in the paper: renders M X from the hand's own motion, with the degree that has the \
    smallest error inside the window. Renders no force at standstill.";
pub(in crate::console) const LINEAR_HOVER: &str =
    "The paper's linear predecessor: like Literal, but always with degree 1";
pub(in crate::console) const DFR_HOVER: &str = "Direct force reflection: the measured force, delayed by the link";
pub(in crate::console) const ANCHORED_HOVER: &str = "The last measured force, corrected by the identified impedance for the hand's motion since then. \
    Where a correction does not reduce the error, it is plain direct reflection.";

// Methods of others; the screen has the one that the rig file names.
pub(in crate::console) const MODEL_MEDIATED: &str = "Model-mediated";
pub(in crate::console) const WAVES: &str = "Wave variables";
pub(in crate::console) const PASSIVITY: &str = "Time-domain passivity";
pub(in crate::console) const KALMAN: &str = "Kalman";
pub(in crate::console) const AUTOREGRESSIVE: &str = "Autoregressive";
pub(in crate::console) const MODEL_MEDIATED_HOVER: &str = "For comparison: a Hunt-Crossley contact is identified at the tissue; \
    its parameters cross the link and the force is made from the hand's own motion";
pub(in crate::console) const WAVES_HOVER: &str =
    "For comparison: force and velocity come back as a wave and are decoded with the hand's own velocity";
pub(in crate::console) const PASSIVITY_HOVER: &str = "For comparison: direct reflection with damping whenever the hand would get more \
    energy than the tissue has returned";
pub(in crate::console) const KALMAN_HOVER: &str =
    "For comparison: a Kalman filter of the force and its rate, extrapolated over the delay";
pub(in crate::console) const AUTOREGRESSIVE_HOVER: &str =
    "For comparison: the force foretold from its own past by an autoregressive model";
