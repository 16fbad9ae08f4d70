//! Monitors a calibrated trocar and detects that the patient or the table has moved.

use nalgebra::{Matrix3, Vector3};

use super::{ShaftLine, across};

/// Time over which lines are averaged, s: at 60 Hz and 0.25 mm of noise 0.03 mm remain.
const AVERAGE_S: f64 = 0.5;
/// Fraction of a line's information above which a direction counts as observed: the information of lines tilted by 13
/// degrees. Along the shaft, nothing can be observed until it pivots.
const SEEN: f64 = 0.05;
/// After a longer gap the watch restarts, s, because the lines before the gap may be from another place. Design choice.
const GAP_S: f64 = 1.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TrocarState {
    Waiting,
    Fine {
        /// Distance from the calibrated position, m.
        by_m: f64,
    },
    Moved {
        /// Displacement in the trocar's frame, m. Along the shaft it is observed only as far as the shaft pivots.
        by_m: [f64; 3],
    },
}

/// Compares lines of the shaft with a trocar. Steps allocate nothing.
///
/// A shift `x` of the trocar is the least-squares solution of `(I - d d^T) (x - (p - trocar)) = 0` over the lines of
/// the last half second, exponentially weighted, and shrunk towards zero in directions that no line determines.
#[derive(Clone, Debug)]
pub struct TrocarWatch {
    trocar_m: Vector3<f64>,
    limit_m: f64,
    normal: Matrix3<f64>,
    right_m: Vector3<f64>,
    since_s: f64,
    last_s: Option<f64>,
    state: TrocarState,
}

impl TrocarWatch {
    /// Default limit, m. Breathing of the patient or a less accurate arm requires a larger one.
    pub const LIMIT_M: f64 = 1.0e-3;

    /// Creates a watch for this trocar, m, in the frame of the lines. The state is `Moved` when the trocar is more than
    /// `limit_m` from its calibrated position, and `Fine` again below half of that.
    pub fn new(trocar_m: Vector3<f64>, limit_m: f64) -> Self {
        Self {
            trocar_m,
            limit_m,
            normal: Matrix3::zeros(),
            right_m: Vector3::zeros(),
            since_s: 0.0,
            last_s: None,
            state: TrocarState::Waiting,
        }
    }

    pub const fn state(&self) -> TrocarState {
        self.state
    }

    /// Adds a measured line at time `t_s` (s, increasing). A non-finite line changes nothing.
    pub fn step(&mut self, line: &ShaftLine, t_s: f64) -> TrocarState {
        let finite = line.point_m.iter().chain(&line.direction).all(|x| x.is_finite()) && t_s.is_finite();
        let follows = self.last_s.filter(|last_s| finite && t_s > *last_s);
        match (finite, self.last_s, follows) {
            (false, ..) | (true, Some(_), None) => return self.state,
            (true, Some(last_s), Some(_)) if t_s - last_s <= GAP_S => {
                self.average(line, 1.0 - libm::exp(-(t_s - last_s) / AVERAGE_S));
            }
            _ => {
                self.normal = Matrix3::zeros();
                self.right_m = Vector3::zeros();
                self.since_s = t_s;
                self.state = TrocarState::Waiting;
            }
        }
        self.last_s = Some(t_s);
        if t_s - self.since_s >= AVERAGE_S {
            self.judge();
        }
        self.state
    }

    fn average(&mut self, line: &ShaftLine, fraction: f64) {
        let across = across(&line.direction);
        self.normal += (across - self.normal) * fraction;
        self.right_m += (across * (line.point_m - self.trocar_m) - self.right_m) * fraction;
    }

    fn judge(&mut self) {
        let Some(inverse) = (self.normal + Matrix3::identity() * SEEN).cholesky() else { return };
        let shift_m = inverse.solve(&self.right_m);
        let by_m = shift_m.norm();
        let stays = matches!(self.state, TrocarState::Moved { .. }) && by_m > 0.5 * self.limit_m;
        self.state = if by_m > self.limit_m || stays {
            TrocarState::Moved { by_m: shift_m.into() }
        } else {
            TrocarState::Fine { by_m }
        };
    }
}
