//! The columns of a data set, and their conversion to the features of a network.
//!
//! An orientation is given as a quaternion (`qw, qx, qy, qz`); q and -q are the same rotation. The
//! network therefore uses the nine entries of the rotation matrix, which are products of two components and so
//! identical for both signs. A quaternion of length zero gives numbers that are not finite, which the estimator
//! refuses.

/// Default inputs, as far as a data set contains them: gravity-free wrench at the wrist (`shaft`; N, Nm), orientation
/// (`world_from_shaft`), depth through the trocar (m), its speed (m/s), and the state of the seal: its stretch (m) and its
/// past sliding speed (m/s); see [`super::TipForceFeatures`].
pub const DEFAULT_INPUTS: [&str; 15] = [
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
    "presliding_200um_m",
    "presliding_600um_m",
    "slip_m_s",
];

/// Default outputs: the force of the tissue on the tip (`shaft`, N).
pub const DEFAULT_OUTPUTS: [&str; 3] = ["tip_fx_n", "tip_fy_n", "tip_fz_n"];

// Force and torque: no model predicts more.
pub const MAX_OUTPUTS: usize = 6;

/// Maximum number of features of a network (a quaternion counts as its nine matrix entries).
/// Bounds the memory and time of a tick for a model file that was made elsewhere.
pub const MAX_FEATURES: usize = 64;

const QUATERNION: [&str; 4] = ["qw", "qx", "qy", "qz"];

/// Conversion of input columns to features, in this order: plain columns unchanged; the nine entries of the rotation
/// matrix; for each direction of motion its soft sign `s = v / sqrt(v^2 + v0^2)`; and the products of that sign with
/// every plain column that is not a direction of motion itself.
///
/// A direction of motion is a column whose name contains `speed` or `presliding`. Coulomb friction is a sign times a
/// load: with these products as features, the linear path of a network extrapolates it beyond the loads of the training
/// data.
#[derive(Clone, Debug, PartialEq)]
pub struct Expansion {
    plain: Vec<usize>,
    quaternion: Option<[usize; 4]>,
    directions: Vec<(usize, f32)>,
    loads: Vec<usize>,
}

/// `v0` as a fraction of the root mean square of the column. Design choice.
/// A smaller fraction makes the sign jump at noise, a larger one blurs friction at slow motion.
const SOFT_FRACTION: f32 = 0.1;

impl Expansion {
    /// Creates the conversion for these input columns; `soft[i]` is the `v0` of column `i` if that is a direction of
    /// motion. Returns `None` if such a number is missing or not positive.
    pub fn new(inputs: &[String], soft: &[f32]) -> Option<Self> {
        let at = |name: &str| inputs.iter().position(|input| input == name);
        let quaternion = match QUATERNION.map(at) {
            [Some(w), Some(x), Some(y), Some(z)] => Some([w, x, y, z]),
            _ => None,
        };
        let plain: Vec<usize> = (0..inputs.len()).filter(|i| !quaternion.is_some_and(|q| q.contains(i))).collect();
        // Every other plain column is a load that friction can depend on.
        let (directions, loads): (Vec<_>, Vec<_>) = plain.iter().copied().partition(|&i| is_direction(&inputs[i]));
        let softened = directions.iter().map(|&i| soft.get(i).map(|v0| (i, *v0))).collect::<Option<Vec<_>>>()?;
        let positive = softened.iter().all(|(_, v0)| v0.is_finite() && *v0 > 0.0);
        positive.then_some(Self { plain, quaternion, directions: softened, loads })
    }

    /// Fits the conversion to these data: every `v0` is a tenth of the column's root mean square.
    pub fn fit(inputs: &[String], x: &[f32]) -> Self {
        let rows = (x.len() / inputs.len().max(1)).max(1) as f64;
        let mut square = vec![0.0_f64; inputs.len()];
        for row in x.chunks_exact(inputs.len().max(1)) {
            square.iter_mut().zip(row).for_each(|(sum, value)| *sum += f64::from(*value) * f64::from(*value) / rows);
        }
        // Not zero for a column that never moved: it divides in every row.
        let soft: Vec<f32> = square.into_iter().map(|s| (SOFT_FRACTION * s.sqrt() as f32).max(1e-9)).collect();
        // Only if a `v0` is not finite: plain columns are then the safe choice.
        Self::new(inputs, &soft).unwrap_or_else(|| Self {
            plain: (0..inputs.len()).collect(),
            quaternion: None,
            directions: Vec::new(),
            loads: Vec::new(),
        })
    }

    /// Returns `v0` of every input column, 0 for columns that are not directions of motion; the argument of
    /// [`Self::new`].
    pub fn soft(&self, inputs: usize) -> Vec<f32> {
        let mut soft = vec![0.0; inputs];
        self.directions.iter().for_each(|(column, v0)| soft[*column] = *v0);
        soft
    }

    pub fn width(&self) -> usize {
        let rotation = if self.quaternion.is_some() { 9 } else { 0 };
        self.plain.len() + rotation + self.directions.len() * (1 + self.loads.len())
    }

    /// Returns the number of measured features, which come first; signs and products follow.
    pub fn measured(&self) -> usize {
        // Products repeat the measured columns, so doubt is judged without them.
        self.plain.len() + if self.quaternion.is_some() { 9 } else { 0 }
    }

    /// Returns the name of a feature, for messages.
    pub fn name(&self, feature: usize, inputs: &[String]) -> String {
        match self.plain.get(feature) {
            Some(&column) => inputs[column].clone(),
            None if feature < self.measured() => format!("rotation entry {}", feature - self.plain.len()),
            None => {
                let place = feature - self.measured();
                let direction = place / (1 + self.loads.len());
                let load = place % (1 + self.loads.len());
                let sign = format!("sign of {}", inputs[self.directions[direction].0]);
                if load == 0 { sign } else { format!("{sign} times {}", inputs[self.loads[load - 1]]) }
            }
        }
    }

    /// Computes `features` (length [`Self::width`]) from one row of inputs.
    pub fn expand(&self, inputs: &[f32], features: &mut [f32]) {
        for (feature, &column) in features.iter_mut().zip(&self.plain) {
            *feature = inputs[column];
        }
        if let Some(columns) = self.quaternion {
            let [w, x, y, z] = columns.map(|column| inputs[column]);
            features[self.plain.len()..self.plain.len() + 9].copy_from_slice(&rotation_entries(w, x, y, z));
        }
        let products = features[self.measured()..].chunks_exact_mut(1 + self.loads.len());
        for (&(column, v0), to) in self.directions.iter().zip(products) {
            let v = inputs[column];
            let sign = v / (v * v + v0 * v0).sqrt();
            to[0] = sign;
            for (to, &load) in to[1..].iter_mut().zip(&self.loads) {
                *to = sign * inputs[load];
            }
        }
    }
}

fn is_direction(name: &str) -> bool {
    name.contains("speed") || name.contains("presliding")
}

/// Returns the rotation matrix of a quaternion of any length, row by row.
fn rotation_entries(w: f32, x: f32, y: f32, z: f32) -> [f32; 9] {
    // Normalised here: a recorded quaternion may have lost a digit of its length.
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
        let expansion = Expansion::new(&names, &[]).unwrap();
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
        assert_eq!(Expansion::new(&names, &[]).unwrap().width(), 3);
    }

    #[test]
    fn a_speed_gives_its_sign_and_the_sign_times_every_load() {
        let names = ["fz_n", "insertion_speed_m_s", "insertion_m"].map(str::to_owned);
        let expansion = Expansion::new(&names, &[0.0, 0.003, 0.0]).unwrap();
        assert_eq!((expansion.width(), expansion.measured()), (6, 3));
        let mut features = [0.0; 6];
        expansion.expand(&[2.0, -0.004, 0.1], &mut features);
        let expected = [2.0, -0.004, 0.1, -0.8, -1.6, -0.08];
        assert!(features.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{features:?}");
        assert_eq!(expansion.name(4, &names), "sign of insertion_speed_m_s times fz_n");
        assert_eq!(Expansion::new(&names, &expansion.soft(3)).unwrap(), expansion);
        assert!(Expansion::new(&names, &[0.0; 3]).is_none());
    }
}
