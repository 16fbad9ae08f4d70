//! A contact that ends: the force falls to nothing within a few samples, while the tip hardly moves.
//!
//! What was held under force snaps away as fast as its mass lets it: a ring of 1.5 g on a contact of 4 kN/m takes some 3 ms. So the force falls in
//! several samples, and a sensor's own filter spreads it over more. A sensor that fails steps from one sample to the next, or stops somewhere
//! else than at nothing. A force that grows is never excused.

use nalgebra::Vector3;

/// Nothing is left of a force below this, N: the noise of the noisiest sensor here.
const GONE_N: f64 = 0.5;
/// It falls by at least this from one sample to the next, N; noise does not.
const FALLS_N: f64 = 0.1;
/// A fall of which more than this share comes in one sample is a step. Rings that snap away have 0.38 to 0.6 at 1 kHz.
const SHARPEST: f64 = 0.65;
/// It has begun by so many samples before the first one that lies too far.
const BEFORE: usize = 4;
/// Samples in which it must have come to an end.
const LONGEST: u32 = 6;

/// What a force that changes too fast is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fall {
    /// It does not fall.
    #[default]
    No,
    /// It falls, and has not yet come to its end.
    Going,
    /// It has fallen to nothing, as a contact that ends.
    Over,
}

/// The memory of one fall.
#[derive(Clone, Copy, Debug, Default)]
pub struct Release {
    fall: Option<Falling>,
    /// The last samples that did not lie too far, the newest first.
    before_n: [Vector3<f64>; BEFORE],
}

#[derive(Clone, Copy, Debug)]
struct Falling {
    believed_n: Vector3<f64>,
    /// The largest of what was before.
    from_n: Vector3<f64>,
    size_n: f64,
    sharpest_n: f64,
    samples: u32,
    falls: bool,
}

impl Release {
    /// Takes a sample (N) that lies too far from the one that was believed last, or that does not (`far`).
    pub fn look(&mut self, believed_n: &Vector3<f64>, now_n: &Vector3<f64>, far: bool) -> Fall {
        if !far {
            self.fall = None;
            self.before_n.rotate_right(1);
            self.before_n[0] = *now_n;
            return Fall::No;
        }
        // What is believed stays the same as long as a fall is bridged.
        let going = self.fall.filter(|fall| fall.believed_n == *believed_n);
        let mut fall = going.unwrap_or_else(|| self.begin(believed_n));
        let doing = fall.look(now_n);
        self.fall = Some(fall);
        doing
    }
}

impl Release {
    fn begin(&self, believed_n: &Vector3<f64>) -> Falling {
        let larger = |a: Vector3<f64>, b: &Vector3<f64>| if b.norm() > a.norm() { *b } else { a };
        let from_n = self.before_n.iter().fold(*believed_n, larger);
        let steps_n = self.before_n.windows(2).map(|pair| pair[1].norm() - pair[0].norm());
        let sharpest_n = steps_n.fold(0.0, f64::max);
        Falling { believed_n: *believed_n, from_n, size_n: believed_n.norm(), sharpest_n, samples: 0, falls: true }
    }
}

impl Falling {
    fn look(&mut self, now_n: &Vector3<f64>) -> Fall {
        let from_n = self.from_n.norm();
        let size_n = now_n.norm();
        let falls_n = self.size_n - size_n;
        let is_gone = size_n <= GONE_N;
        // It may not turn aside, nor to the other side, by more than what counts as nothing.
        let along_n = if from_n > 0.0 { now_n.dot(&self.from_n) / from_n } else { 0.0 };
        let aside_n = (now_n.norm_squared() - along_n * along_n).max(0.0).sqrt();
        self.falls &= aside_n <= GONE_N && along_n >= -GONE_N && (is_gone || falls_n >= FALLS_N);
        self.sharpest_n = self.sharpest_n.max(falls_n);
        self.size_n = size_n;
        self.samples += 1;
        match (self.falls, is_gone) {
            (true, true) if self.sharpest_n <= SHARPEST * (from_n - size_n) => Fall::Over,
            (true, false) if self.samples < LONGEST => Fall::Going,
            _ => Fall::No,
        }
    }
}
