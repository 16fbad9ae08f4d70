//! Input of the scorer: both hands at one moment.

use nalgebra::Vector3;
use nima_core::SIDES;

/// Maximum plausible position, m, and force, N. Larger values are a fault of the input, and their squares would spoil
/// every mean.
const LARGEST_M: f64 = 1e3;
const LARGEST_N: f64 = 1e5;

/// Both hands at one moment. Steps may be uneven; a step back in time is skipped and counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScoreSample {
    /// Time, s, on any clock that runs forward; the same as the events'.
    pub t_s: f64,
    /// Both hands, in the order of [`nima_core::Side::ALL`]; `None` while that side is unknown.
    pub hands: [Option<HandSample>; SIDES],
}

/// One hand at one moment, in the frame `world` (z up).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandSample {
    /// m.
    pub tip_m: Vector3<f64>,
    /// Opening of the jaw, rad; `None` for an instrument without one.
    pub jaw_rad: Option<f64>,
    /// Contact force on the instrument at its tip, N. NaN while unknown: the motion still counts.
    pub force_n: Vector3<f64>,
    /// Force that the hand feels, N.
    pub rendered_n: Vector3<f64>,
    /// Whether the hand moves the instrument.
    pub engaged: bool,
    /// Whether the tip is in the endoscope image.
    pub in_view: bool,
}

/// The usable parts of a hand's sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Usable {
    pub tip_m: Option<Vector3<f64>>,
    pub jaw_rad: Option<f64>,
    pub force_n: Option<Vector3<f64>>,
    pub rendered_n: Option<Vector3<f64>>,
    /// Whether a part was present but unusable.
    pub spoilt: bool,
}

impl HandSample {
    pub(crate) fn usable(&self) -> Usable {
        let tip_m = within(&self.tip_m, LARGEST_M);
        let force_n = within(&self.force_n, LARGEST_N);
        let rendered_n = within(&self.rendered_n, LARGEST_N);
        let jaw_rad = self.jaw_rad.filter(|jaw| jaw.is_finite());
        let spoilt = tip_m.is_none()
            || force_n.is_none()
            || rendered_n.is_none()
            || (self.jaw_rad.is_some() && jaw_rad.is_none());
        Usable { tip_m, jaw_rad, force_n, rendered_n, spoilt }
    }
}

fn within(vector: &Vector3<f64>, largest: f64) -> Option<Vector3<f64>> {
    vector.iter().all(|value| value.abs() <= largest).then_some(*vector)
}
