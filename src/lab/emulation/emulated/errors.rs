//! Errors of the force at the tip, compared with the true force of the tissue, which is known only in a simulation.

use nalgebra::Vector3;
use nima_core::tip_force::Unsure;
use nima_machine::{
    messages::{ForceSource, Tick},
    rig::{SIDES, Side},
};
use serde::Serialize;

/// Name of the force that the loop uses.
pub const IN_USE: &str = "tip force";
/// The compared methods: the force that the loop uses, and the force without the later calibrations.
const METHODS: [&str; 3] = [IN_USE, "gravity only", "wrist only"];

/// Mean and deviation, per axis (x, y, z of `world`), N.
#[derive(Clone, Copy, Debug, Default)]
struct ErrorSums {
    count: f64,
    magnitude: Vector3<f64>,
    mean: Vector3<f64>,
    squares: Vector3<f64>,
}

impl ErrorSums {
    fn add(&mut self, error_n: &Vector3<f64>) {
        self.count += 1.0;
        self.magnitude += error_n.abs();
        let before = error_n - self.mean;
        self.mean += before / self.count;
        self.squares += before.component_mul(&(error_n - self.mean));
    }

    fn mae_n(&self) -> [f64; 3] {
        (self.magnitude / self.count.max(1.0)).into()
    }

    fn sd_n(&self) -> [f64; 3] {
        (self.squares / self.count.max(1.0)).map(f64::sqrt).into()
    }
}

/// Errors of one method without contact, where every reported force is an error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FreeError {
    /// Number of samples without contact.
    pub samples: u64,
    /// Mean per axis, N.
    pub mean_n: [f64; 3],
    /// Standard deviation per axis, N.
    pub sd_n: [f64; 3],
}

/// Errors of one method on one side, per axis (x, y, z of `world`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TipError {
    pub side: Side,
    /// `tip force`: the force that the loop uses; `gravity only`: without the network; `wrist only`: the sensor's
    /// reading.
    pub method: &'static str,
    /// Samples while engaged.
    pub samples: u64,
    /// Mean absolute error per axis, N.
    pub mae_n: [f64; 3],
    /// Without contact; `None` if there was contact all the time.
    pub free: Option<FreeError>,
    /// Fraction of the samples in which the loop did not use the network.
    pub without_network: f64,
    /// Fractions of the samples in which the network was uncertain, by reason.
    pub doubt: DoubtFractions,
}

/// Samples with an uncertain network, as fractions of all samples, 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct DoubtFractions {
    /// Outside the training data, where the network still returns its linear path.
    pub extrapolated: f64,
    /// Far outside the training data.
    pub outside_training: f64,
    /// The direction of friction was unknown.
    pub not_moved: f64,
    /// The orientation or the depth was missing.
    pub missing: f64,
}

impl DoubtFractions {
    fn over(self, samples: f64) -> Self {
        Self {
            extrapolated: self.extrapolated / samples,
            outside_training: self.outside_training / samples,
            not_moved: self.not_moved / samples,
            missing: self.missing / samples,
        }
    }
}

#[derive(Clone, Debug, Default)]
pub struct TipErrors {
    sides: [[(ErrorSums, ErrorSums); METHODS.len()]; SIDES],
    without_network: [u64; SIDES],
    /// Number of uncertain samples.
    doubt: [DoubtFractions; SIDES],
}

impl TipErrors {
    /// Adds the true force (N, `world`) at the time of a tick; only engaged ticks count.
    pub fn add(&mut self, tick: &Tick, true_n: &Vector3<f64>) {
        let Some(sample) = tick.calibration.wrist.as_ref().filter(|_| tick.state.permits().coupled) else { return };
        let (Some(world_from_s1), Some(gravity_free)) = (sample.world_from_s1, tick.force.gravity_free) else { return };
        let side = tick.side.index();
        let reported_n = [tick.force.tip_n, world_from_s1 * gravity_free.force_n, world_from_s1 * sample.raw.force_n];
        for ((all, free), reported_n) in self.sides[side].iter_mut().zip(reported_n) {
            let error_n = reported_n - true_n;
            all.add(&error_n);
            if true_n.norm() < f64::EPSILON {
                free.add(&error_n);
            }
        }
        let by_network = tick.force.tip_force.is_some() && tick.force.source.doubt().is_none();
        self.without_network[side] += u64::from(!by_network);
        let doubt = &mut self.doubt[side];
        if tick.force.source == ForceSource::Extrapolated {
            doubt.extrapolated += 1.0;
        }
        match tick.force.source.doubt() {
            Some(Unsure::OutsideTraining) => doubt.outside_training += 1.0,
            Some(Unsure::NotMoved) => doubt.not_moved += 1.0,
            Some(Unsure::Missing) => doubt.missing += 1.0,
            None => {}
        }
    }

    /// Returns the results; none for a side without samples.
    pub fn figures(&self) -> Vec<TipError> {
        Side::ALL.into_iter().flat_map(|side| self.of(side)).collect()
    }

    fn of(&self, side: Side) -> Vec<TipError> {
        let of_side = METHODS.iter().zip(&self.sides[side.index()]).filter(|(_, (all, _))| all.count > 0.0);
        let figures = of_side.map(|(method, (all, free))| TipError {
            side,
            method,
            samples: all.count as u64,
            mae_n: all.mae_n(),
            free: (free.count > 0.0).then(|| FreeError {
                samples: free.count as u64,
                mean_n: free.mean.into(),
                sd_n: free.sd_n(),
            }),
            without_network: self.without_network[side.index()] as f64 / all.count,
            doubt: self.doubt[side.index()].over(all.count),
        });
        figures.collect()
    }
}
