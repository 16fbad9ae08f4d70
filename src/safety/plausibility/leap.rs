//! A vector that changes faster than it can: single leaps are bridged, lasting ones told.

use nalgebra::Vector3;

/// Samples in a row that are bridged; the next one is a jump.
const BRIDGED: u32 = 2;

/// The last vector that was believed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Leap {
    last: Option<Vector3<f64>>,
    moved: Vector3<f64>,
    refused: u32,
}

impl Leap {
    /// Gives the vector, or the last believed one in its place when it lies farther than `most` from it for every sample since; and
    /// whether this is no spike but a jump. What has jumped is believed from then on.
    pub fn admit(&mut self, now: &Vector3<f64>, most: f64) -> (Vector3<f64>, bool) {
        let last = self.last.unwrap_or(*now);
        let far = (now - last).norm() > most * f64::from(self.refused + 1);
        if far && self.refused < BRIDGED {
            self.refused += 1;
            self.moved = Vector3::zeros();
            return (last, false);
        }
        self.moved = now - last;
        (self.last, self.refused) = (Some(*now), 0);
        (*now, far)
    }

    /// How far the believed vector went in the last step.
    pub fn moved(&self) -> Vector3<f64> {
        self.moved
    }

    /// The same as a length.
    pub fn way(&self) -> f64 {
        self.moved.norm()
    }
}
