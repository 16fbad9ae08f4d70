//! Instructions of the screen to the person at the arm during calibration.

use nalgebra::{UnitQuaternion, UnitVector3};

/// One instruction. On a real rig a person reads it from the screen and no machine moves; on a simulated one a
/// simulated person follows it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Prompt {
    /// None: leave the instrument alone.
    #[default]
    Rest,
    /// Turn the tool into this orientation, touch nothing, hold still.
    Hold {
        /// Wanted orientation of the wrist sensor.
        world_from_s1: UnitQuaternion<f64>,
    },
    /// Turn the tool slowly in all directions; touch nothing.
    Wave,
    /// Push onto the tissue in this direction, hold, release, and repeat.
    Push {
        /// Direction in which the tool pushes (`world`); the force of the tissue is opposite.
        direction: UnitVector3<f64>,
    },
    /// Work on the tissue: in and out through the trocar, sideways, in contact and free.
    Work,
    /// The same without touching the tissue.
    WorkFree,
}

impl Prompt {
    /// Whether every number in it is finite.
    pub fn is_finite(&self) -> bool {
        match self {
            Self::Hold { world_from_s1 } => world_from_s1.coords.iter().all(|x| x.is_finite()),
            Self::Push { direction } => direction.iter().all(|x| x.is_finite()),
            Self::Rest | Self::Wave | Self::Work | Self::WorkFree => true,
        }
    }
}
