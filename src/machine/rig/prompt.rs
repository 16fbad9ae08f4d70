//! What the screen asks of the person at the arm while calibrating.

use nalgebra::{UnitQuaternion, UnitVector3};

/// One thing to do. On a real rig it is read from the screen and no machine moves; on a simulated one somebody obeys.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Prompt {
    /// Leave the instrument alone.
    #[default]
    Rest,
    /// Turn the tool into this orientation, touch nothing, hold still.
    Hold {
        /// Orientation of the wrist sensor to take.
        world_from_s1: UnitQuaternion<f64>,
    },
    /// Turn the tool slowly this way and that; touch nothing.
    Wave,
    /// Push onto the tissue this way, hold, release, and again.
    Push {
        /// Which way the tool pushes (`world`); the tissue answers the other way.
        direction: UnitVector3<f64>,
    },
    /// Work on the tissue: in and out through the trocar, sideways, in contact and free.
    Work,
    /// The same without touching the tissue.
    WorkFree,
}

impl Prompt {
    /// Every number in it is finite.
    pub fn is_finite(&self) -> bool {
        match self {
            Self::Hold { world_from_s1 } => world_from_s1.coords.iter().all(|x| x.is_finite()),
            Self::Push { direction } => direction.iter().all(|x| x.is_finite()),
            Self::Rest | Self::Wave | Self::Work | Self::WorkFree => true,
        }
    }
}
