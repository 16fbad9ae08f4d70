//! Records a data set: a state machine that is fed every sample, without a clock or a screen.
//!
//! Takes the gravity-free wrench (N, Nm, `s1`), the [`WristSample`] with the sensor under the tissue, and the time (s).
//! Stores one row for several samples: the network's inputs ([`DEFAULT_INPUTS`]) and the force at the tip from the
//! sensor under the tissue, transformed with the calibrated correspondence to the frame of the inputs (`shaft`). Memory
//! is bounded and allocated at the start.

use std::{io, path::Path};

use nalgebra::Vector3;
use nima_core::{
    calibration::correspondence::Correspondence,
    frames::{Wrench, WristSample},
    tip_force::{
        DEFAULT_INPUTS, DEFAULT_OUTPUTS, FeatureRow, FeatureSettings, LIVE_INPUTS, NoRow, TipForceCoverage,
        TipForceFeatures,
    },
};
use nima_files::write_atomically;

/// Maximum number of rows: four of the paper's data sets.
pub const MAX_ROWS: usize = 120_000;
/// Interval between rows, s: the paper's 30000 rows take two and a half minutes.
pub const ROW_EVERY_S: f64 = 0.005;
/// Duration of a trajectory, s: the unit in which rows are held out for judging a network.
const TRAJECTORY_S: f64 = 5.0;
/// Required rest of the sensor under the tissue at the start, s, and its maximum standard deviation during it, N.
const REST_S: f64 = 0.5;
const REST_SD_N: f64 = 0.15;
/// Force above which the tip is in contact, N, and averaging time of that force, s.
const CONTACT_N: f64 = 0.10;
const CONTACT_S: f64 = 0.020;

/// The part that a sample lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecorderLack {
    /// Gravity is not calibrated, or the wrist sensor is silent.
    WristForce,
    /// The sensor under the tissue is silent.
    TissueForce,
    /// A rotation of the chain, from the arm or the tracker.
    Chain,
    /// The depth through the trocar or the wrist's orientation is missing, or a number is not finite.
    Pose,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RecorderPhase {
    /// A source is missing; no rows are recorded.
    Lacks(RecorderLack),
    /// The sensor under the tissue is being zeroed; the tip must be free and still.
    Resting {
        /// Fraction of the required time, 0 to 1.
        fraction: f64,
    },
    /// Waiting until the instrument has moved far enough for the direction of friction to be known.
    NotMoved,
    Recording,
    Full,
}

#[derive(Clone, Debug)]
pub struct TipForceRecorder {
    correspondence: Correspondence,
    features: TipForceFeatures,
    phase: RecorderPhase,
    rest: RestStatistics,
    tissue_zero_n: Option<Vector3<f64>>,
    smooth_tip_n: Vector3<f64>,
    last_t_s: Option<f64>,
    next_row_s: f64,
    trajectory: u32,
    trajectory_ends_s: f64,
    rows: Vec<RecordedSample>,
    coverage: TipForceCoverage,
}

#[derive(Clone, Copy, Debug)]
struct RecordedSample {
    t_s: f64,
    trajectory: u32,
    contact: bool,
    inputs: [f32; LIVE_INPUTS],
    tip_n: [f32; 3],
}

/// Mean and standard deviation of the sensor under the tissue at rest.
#[derive(Clone, Copy, Debug, Default)]
struct RestStatistics {
    since_s: f64,
    count: f64,
    sum: Vector3<f64>,
    squares: f64,
}

impl TipForceRecorder {
    /// Creates an empty recording and allocates its memory.
    pub fn new(correspondence: Correspondence) -> Self {
        Self {
            correspondence,
            features: TipForceFeatures::new(FeatureSettings::default()),
            phase: RecorderPhase::Resting { fraction: 0.0 },
            rest: RestStatistics::default(),
            tissue_zero_n: None,
            smooth_tip_n: Vector3::zeros(),
            last_t_s: None,
            next_row_s: f64::NEG_INFINITY,
            trajectory: 0,
            trajectory_ends_s: f64::NEG_INFINITY,
            rows: Vec::with_capacity(MAX_ROWS),
            coverage: TipForceCoverage::default(),
        }
    }

    /// Uses other feature settings than the live loop; for the study that selected them.
    #[must_use]
    pub const fn with_features(mut self, settings: FeatureSettings) -> Self {
        self.features = TipForceFeatures::new(settings);
        self
    }

    /// Adds one sample; returns the state of the recording.
    pub fn step(&mut self, t_s: f64, gravity_free: Option<&Wrench>, sample: &WristSample) -> RecorderPhase {
        self.phase = match self.tip_n(gravity_free, sample) {
            Ok((wrench, tip_n)) => self.take(t_s, &wrench, sample, tip_n),
            Err(lack) => {
                self.rest.count = 0.0;
                self.features.reset();
                RecorderPhase::Lacks(lack)
            }
        };
        self.last_t_s = Some(t_s);
        self.phase
    }

    /// Returns the wrench at the wrist, and the force on the tip from the sensor under the tissue, N (`s1`), not yet
    /// zeroed.
    fn tip_n(
        &self,
        gravity_free: Option<&Wrench>,
        sample: &WristSample,
    ) -> Result<(Wrench, Vector3<f64>), RecorderLack> {
        let wrench = gravity_free.filter(|wrench| wrench.is_finite()).ok_or(RecorderLack::WristForce)?;
        let tissue_n = sample.tissue_n.ok_or(RecorderLack::TissueForce)?;
        if !sample.is_finite() {
            return Err(RecorderLack::Pose);
        }
        let zero_n = self.tissue_zero_n.unwrap_or_else(Vector3::zeros);
        let tip_n = self.correspondence.tip_force_s1(sample, &(tissue_n - zero_n)).ok_or(RecorderLack::Chain)?;
        Ok((*wrench, tip_n))
    }

    fn take(&mut self, t_s: f64, wrench: &Wrench, sample: &WristSample, tip_n: Vector3<f64>) -> RecorderPhase {
        if self.tissue_zero_n.is_none() {
            return self.zero(t_s, sample);
        }
        let dt_s = self.last_t_s.map_or(0.0, |last| (t_s - last).max(0.0));
        self.smooth_tip_n += (tip_n - self.smooth_tip_n) * (1.0 - (-dt_s / CONTACT_S).exp());
        let FeatureRow { inputs, shaft_from_s1 } = match self.features.step(t_s, wrench, sample) {
            Ok(row) => row,
            Err(NoRow::Missing) => return RecorderPhase::Lacks(RecorderLack::Pose),
            Err(NoRow::NotMoved) => return RecorderPhase::NotMoved,
        };
        if self.rows.len() == MAX_ROWS {
            return RecorderPhase::Full;
        }
        if t_s >= self.next_row_s {
            self.next_row_s = t_s + ROW_EVERY_S;
            if t_s >= self.trajectory_ends_s {
                self.trajectory_ends_s = t_s + TRAJECTORY_S;
                self.trajectory += 1;
            }
            let contact = self.smooth_tip_n.norm() > CONTACT_N;
            let tip_n = shaft_from_s1 * tip_n;
            let tip_n: [f32; 3] = [tip_n.x as f32, tip_n.y as f32, tip_n.z as f32];
            self.coverage.add(&inputs, &tip_n, contact);
            self.rows.push(RecordedSample { t_s, trajectory: self.trajectory, contact, inputs, tip_n });
        }
        RecorderPhase::Recording
    }

    fn zero(&mut self, t_s: f64, sample: &WristSample) -> RecorderPhase {
        let Some(now_n) = sample.tissue_n else { return RecorderPhase::Lacks(RecorderLack::TissueForce) };
        if self.rest.count == 0.0 {
            self.rest = RestStatistics { since_s: t_s, ..RestStatistics::default() };
        }
        let rest = &mut self.rest;
        rest.count += 1.0;
        rest.sum += now_n;
        rest.squares += now_n.norm_squared();
        let mean = rest.sum / rest.count;
        let variance = (rest.squares / rest.count - mean.norm_squared()).max(0.0);
        if rest.count > 20.0 && variance > 3.0 * REST_SD_N * REST_SD_N {
            rest.count = 0.0;
            return RecorderPhase::Resting { fraction: 0.0 };
        }
        let fraction = ((t_s - rest.since_s) / REST_S).min(1.0);
        if fraction >= 1.0 && rest.count > 20.0 {
            self.tissue_zero_n = Some(mean);
        }
        RecorderPhase::Resting { fraction }
    }

    pub const fn phase(&self) -> RecorderPhase {
        self.phase
    }

    /// Starts another trajectory with the next row and requires another rest period, because the rig may have been
    /// touched.
    pub fn interrupt(&mut self) {
        self.features.reset();
        self.trajectory_ends_s = f64::NEG_INFINITY;
        self.tissue_zero_n = None;
        self.rest.count = 0.0;
    }

    pub const fn rows(&self) -> usize {
        self.rows.len()
    }

    /// Returns how well the rows cover the conditions of use.
    pub const fn coverage(&self) -> &TipForceCoverage {
        &self.coverage
    }

    /// Saves the data set as CSV; on an error the old file, if any, is unchanged.
    ///
    /// # Errors
    /// I/O errors.
    pub fn save(&self, path: &Path) -> io::Result<()> {
        write_atomically(path, |file| self.write(file))
    }

    /// # Errors
    /// I/O errors.
    pub fn write(&self, to: &mut dyn io::Write) -> io::Result<()> {
        writeln!(to, "t_s,trajectory,contact,{},{}", DEFAULT_INPUTS.join(","), DEFAULT_OUTPUTS.join(","))?;
        for row in &self.rows {
            let numbers = row.inputs.iter().chain(&row.tip_n).map(f32::to_string).collect::<Vec<_>>().join(",");
            writeln!(to, "{:.4},{},{},{numbers}", row.t_s, row.trajectory, u8::from(row.contact))?;
        }
        Ok(())
    }
}
