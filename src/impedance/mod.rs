//! The heart: from motion and tip force to an impedance `f = M X`, and from `M` back to a force for the hand.
//!
//! Takes: tip positions (m, workspace frame) and tip forces (N, same frame), one sample per tick at a fixed rate.
//! Gives: a [`Parcel`] of parameters for the link (follower side) and a force (N) rendered from the leader's own
//! motion (leader side). Pure and deterministic; nothing is allocated after construction; it knows no device, file or thread.
//! Bad input (NaN, infinite, frozen) is counted, left out of the window and never reaches a parameter.

mod mode;

pub use mode::{Mode, ParseModeError};

/// Axes handled in parallel: x, y, z of the workspace.
pub const AXES: usize = 3;
/// Highest polynomial degree `N` of the motion features (the paper's five).
pub const MAX_DEGREE: usize = 5;
