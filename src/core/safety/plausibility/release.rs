//! Recognises a contact that ends: the force falls to zero within a few samples, while the tip hardly moves.
//!
//! An object that is held under force snaps away as fast as its mass allows: a ring of 1.5 g on a contact of 4 kN/m
//! takes about 3 ms. The force therefore falls over several samples, and a sensor's own filter spreads the fall
//! further. A failing sensor steps from one sample to the next, or stops at a value other than zero. A growing force is
//! never excused.

use nalgebra::Vector3;

/// A force below this counts as zero, N: the noise of the noisiest sensor here.
const GONE_N: f64 = 0.5;
/// A fall decreases by at least this amount from one sample to the next, N; noise does not.
const FALLS_N: f64 = 0.1;
/// A fall with more than this fraction in one sample is a step. Rings that snap away have 0.38 to 0.6 at 1 kHz
/// (`docs/results/faults.md`); a sensor that steps has 1.
const SHARPEST: f64 = 0.65;
/// A fall begins at most this many samples before the first sample that is too far away. Chosen on the study of faults
/// (`docs/results/faults.md`).
const BEFORE: usize = 4;
/// Maximum number of samples until a fall must have ended. Chosen on the study of faults: with it, every case there
/// keeps its verdict, and rings that snap away are excused (`docs/results/faults.md`).
const LONGEST: u32 = 6;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fall {
    #[default]
    No,
    /// The force falls and has not reached zero yet.
    Going,
    /// The force has fallen to zero, as at the end of a contact.
    Over,
}

#[derive(Clone, Copy, Debug, Default)]
pub struct ReleaseMemory {
    fall: Option<FallState>,
    /// The last samples that were not too far away, the newest first.
    before_n: [Vector3<f64>; BEFORE],
}

#[derive(Clone, Copy, Debug)]
struct FallState {
    believed_n: Vector3<f64>,
    /// The largest of the samples before the fall.
    from_n: Vector3<f64>,
    size_n: f64,
    sharpest_n: f64,
    samples: u32,
    falls: bool,
}

impl ReleaseMemory {
    /// Adds a sample (N); `far` states that it is too far from the last accepted one.
    pub fn look(&mut self, believed_n: &Vector3<f64>, now_n: &Vector3<f64>, far: bool) -> Fall {
        if !far {
            self.fall = None;
            self.before_n.rotate_right(1);
            self.before_n[0] = *now_n;
            return Fall::No;
        }
        // While a fall is bridged, the accepted force stays the same.
        // A changed accepted force means that the detector ended the bridge, so this is another fall.
        let going = self.fall.filter(|fall| fall.believed_n == *believed_n);
        let mut fall = going.unwrap_or_else(|| self.begin(believed_n));
        let doing = fall.look(now_n);
        self.fall = Some(fall);
        doing
    }
}

impl ReleaseMemory {
    fn begin(&self, believed_n: &Vector3<f64>) -> FallState {
        let larger = |a: Vector3<f64>, b: &Vector3<f64>| if b.norm() > a.norm() { *b } else { a };
        // The largest of the last samples, because a slow sensor begins to fall before the first sample is too far
        // away.
        let from_n = self.before_n.iter().fold(*believed_n, larger);
        let steps_n = self.before_n.windows(2).map(|pair| pair[1].norm() - pair[0].norm());
        let sharpest_n = steps_n.fold(0.0, f64::max);
        FallState { believed_n: *believed_n, from_n, size_n: believed_n.norm(), sharpest_n, samples: 0, falls: true }
    }
}

impl FallState {
    fn look(&mut self, now_n: &Vector3<f64>) -> Fall {
        let from_n = self.from_n.norm();
        let size_n = now_n.norm();
        let falls_n = self.size_n - size_n;
        let is_gone = size_n <= GONE_N;
        // The force must not turn sideways or reverse by more than the force that counts as zero.
        let along_n = if from_n > 0.0 { now_n.dot(&self.from_n) / from_n } else { 0.0 };
        let aside_n = (now_n.norm_squared() - along_n * along_n).max(0.0).sqrt();
        // Every sample has to continue the fall; one that rises ends it for good.
        self.falls &= aside_n <= GONE_N && along_n >= -GONE_N && (is_gone || falls_n >= FALLS_N);
        self.sharpest_n = self.sharpest_n.max(falls_n);
        self.size_n = size_n;
        self.samples += 1;
        // A fall in one sample could also be a sensor that lost its supply, so the sharpest step is limited.
        match (self.falls, is_gone) {
            (true, true) if self.sharpest_n <= SHARPEST * (from_n - size_n) => Fall::Over,
            (true, false) if self.samples < LONGEST => Fall::Going,
            _ => Fall::No,
        }
    }
}
