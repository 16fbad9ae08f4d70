//! The columns of a data set, and how they become the numbers that a network reads.
//!
//! An orientation is given as a quaternion (`qw, qx, qy, qz`, `kbf_from_s1`), of which q and -q are the same rotation. The
//! network therefore reads the nine entries of the rotation matrix, in which every component appears as a product of two:
//! both signs give the same bits. A quaternion of length zero gives numbers that are not finite, which the estimator refuses.

/// Inputs taken by default, as far as a data set has them: gravity-free wrench at the wrist (`s1`; N, Nm), orientation
/// (`kbf_from_s1`), depth through the trocar (m), its speed (m/s), and how far it went since it last turned back (m).
pub const DEFAULT_INPUTS: [&str; 13] = [
    "fx_n",
    "fy_n",
    "fz_n",
    "tx_nm",
    "ty_nm",
    "tz_nm",
    "qw",
    "qx",
    "qy",
    "qz",
    "insertion_m",
    "insertion_speed_m_s",
    "presliding_m",
];

/// Outputs taken by default: the force of the tissue on the tip (`s1`, N).
pub const DEFAULT_OUTPUTS: [&str; 3] = ["tip_fx_n", "tip_fy_n", "tip_fz_n"];

/// Most outputs a model can have.
pub const MAX_OUTPUTS: usize = 6;

/// Most numbers a network can read (after quaternions have become matrices).
pub const MAX_FEATURES: usize = 64;

const QUATERNION: [&str; 4] = ["qw", "qx", "qy", "qz"];

/// How input columns become features: plain ones as they are, in order, then the nine entries of the rotation matrix.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Expansion {
    plain: Vec<usize>,
    quaternion: Option<[usize; 4]>,
}

impl Expansion {
    /// The expansion of these input columns.
    pub fn of(inputs: &[String]) -> Self {
        let at = |name: &str| inputs.iter().position(|input| input == name);
        let quaternion = match QUATERNION.map(at) {
            [Some(w), Some(x), Some(y), Some(z)] => Some([w, x, y, z]),
            _ => None,
        };
        let plain = (0..inputs.len()).filter(|i| !quaternion.is_some_and(|q| q.contains(i))).collect();
        Self { plain, quaternion }
    }

    /// How many features there are.
    pub fn width(&self) -> usize {
        self.plain.len() + if self.quaternion.is_some() { 9 } else { 0 }
    }

    /// What a feature is made of, for messages.
    pub fn name(&self, feature: usize, inputs: &[String]) -> String {
        match self.plain.get(feature) {
            Some(&column) => inputs[column].clone(),
            None => format!("rotation entry {}", feature - self.plain.len()),
        }
    }

    /// Whether a feature is an input column as it stands; then which.
    pub fn column(&self, feature: usize) -> Option<usize> {
        self.plain.get(feature).copied()
    }

    /// Fills `features` (of [`Self::width`]) from one row of inputs.
    pub fn expand(&self, inputs: &[f32], features: &mut [f32]) {
        for (feature, &column) in features.iter_mut().zip(&self.plain) {
            *feature = inputs[column];
        }
        if let Some(columns) = self.quaternion {
            let [w, x, y, z] = columns.map(|column| inputs[column]);
            features[self.plain.len()..].copy_from_slice(&rotation_entries(w, x, y, z));
        }
    }
}

/// The rotation matrix of a quaternion of any length, row by row.
fn rotation_entries(w: f32, x: f32, y: f32, z: f32) -> [f32; 9] {
    let s = 2.0 / (w * w + x * x + y * y + z * z);
    [
        1.0 - s * (y * y + z * z),
        s * (x * y - w * z),
        s * (x * z + w * y),
        s * (x * y + w * z),
        1.0 - s * (x * x + z * z),
        s * (y * z - w * x),
        s * (x * z - w * y),
        s * (y * z + w * x),
        1.0 - s * (x * x + y * y),
    ]
}

#[cfg(test)]
mod tests {
    use nalgebra::{Quaternion, UnitQuaternion};

    use super::*;

    #[test]
    fn a_quaternion_becomes_its_matrix_whatever_its_sign_and_length() {
        let names = ["a", "qw", "qx", "qy", "qz", "b"].map(str::to_owned);
        let expansion = Expansion::of(&names);
        assert_eq!(expansion.width(), 11);
        let q = [0.5_f32, -0.3, 0.7, 0.2];
        let matrix = UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3])).to_rotation_matrix();
        let mut plus = [0.0; 11];
        let mut minus = [0.0; 11];
        expansion.expand(&[1.0, q[0], q[1], q[2], q[3], 2.0], &mut plus);
        expansion.expand(&[1.0, -q[0], -q[1], -q[2], -q[3], 2.0], &mut minus);
        assert_eq!(plus.map(f32::to_bits), minus.map(f32::to_bits));
        assert_eq!(&plus[..2], &[1.0, 2.0]);
        for k in 0..9 {
            assert!((plus[2 + k] - matrix[(k / 3, k % 3)]).abs() < 1e-6);
        }
    }

    #[test]
    fn three_quarters_of_a_quaternion_stay_plain_columns() {
        let names = ["qw", "qx", "qy"].map(str::to_owned);
        assert_eq!(Expansion::of(&names).width(), 3);
    }
}
