//! Instructions of the screen to the person at the arm during calibration.

use nalgebra::{UnitQuaternion, UnitVector3};
use nima_core::calibration::frames::ViewMove;

/// One instruction. On a real rig a person reads it from the screen and no machine moves; on a simulated rig a
/// simulated person follows it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Prompt {
    #[default]
    Rest,
    /// Turn the tool to this orientation, touch nothing, hold still.
    Hold {
        /// Requested orientation of the wrist sensor.
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
    /// Like `Work`, without touching the tissue.
    WorkFree,
    /// Turn the tool about its tip, which stays in a dimple; hold each pose still.
    PivotInDimple,
    /// Tilt and turn the tool in free space, also about its shaft; hold each pose still.
    Turn,
    /// Pivot the tool in the trocar to all sides, at several depths.
    PivotInTrocar,
    /// Touch a point of the table with the tip, and hold still.
    Touch {
        /// 0: the origin; 1: a point along x; 2: a point on the side of y; from 3 on: any other point.
        point: u8,
    },
    /// Move the tip in this direction of the endoscope image, then hold still.
    MoveTip(ViewMove),
    /// Move the handle in this direction of the endoscope image, then hold still.
    MoveHandle(ViewMove),
}

impl Prompt {
    pub fn is_finite(&self) -> bool {
        match self {
            Self::Hold { world_from_s1 } => world_from_s1.coords.iter().all(|x| x.is_finite()),
            Self::Push { direction } => direction.iter().all(|x| x.is_finite()),
            _ => true,
        }
    }
}
