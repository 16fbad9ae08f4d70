//! The instruments: their commands and their loads.

use nalgebra::{UnitQuaternion, Vector3};

/// Maximum opening of the jaws, rad; graspers open to about 70 degrees.
pub const OPENING_MAX_RAD: f64 = 1.4;
/// An instrument farther from the origin than this counts as absent, m.
const FARTHEST_M: f64 = 10.0;

/// Pose of an instrument. Workspace frame, z up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instrument {
    /// End of the closed fingers, m.
    pub tip_m: Vector3<f64>,
    /// Orientation of the jaws: z along the closed fingers towards their end, y the axis about which they open.
    pub world_from_jaws: UnitQuaternion<f64>,
    /// Entry point of the shaft, m. The shaft is straight from there to the hinge of the fingers.
    pub trocar_m: Vector3<f64>,
    /// Commanded angle between the fingers, rad; 0 is closed.
    pub opening_rad: f64,
}

impl Instrument {
    /// Returns whether all values are finite and the instrument is within range.
    pub(crate) fn is_sane(&self) -> bool {
        let near = |position_m: &Vector3<f64>| position_m.iter().all(|x| x.abs() <= FARTHEST_M);
        let turned = (self.world_from_jaws.norm_squared() - 1.0).abs() < 1e-3;
        near(&self.tip_m) && near(&self.trocar_m) && turned && self.opening_rad.is_finite()
    }
}

/// Mean load on an instrument over the last step. Workspace frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InstrumentLoads {
    /// Force of all contacts, N.
    pub tip_n: Vector3<f64>,
    /// Torque of all contacts about the tip, N m.
    pub torque_nm: Vector3<f64>,
    /// Force that opens the jaws, N at the end of a finger; negative if it closes them.
    pub opening_n: f64,
    pub touching: InstrumentContacts,
}

/// Kinds of objects that an instrument touches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a thing that can be touched, in any combination")]
pub struct InstrumentContacts {
    pub ring: bool,
    pub peg: bool,
    pub board: bool,
    pub other_instrument: bool,
}
