//! The line to the machine with the arm.

pub(in crate::console) const LINK: &str = "link to the follower's machine";
pub(in crate::console) const MEANING: &str = "The line to the machine with the arm, as this one measures it. \
    The play-out delay is what every message is held back to, so that jitter is not felt.";
