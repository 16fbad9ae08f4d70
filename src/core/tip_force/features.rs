//! Computes the inputs of the network from a stream of wrist samples, in the same way for recording a data set and in
//! the live loop.
//!
//! Takes the gravity-free wrench (N, Nm, `s1`), the wrist's orientation and its depth through the trocar, at the time
//! of each sample (s); returns one row of [`DEFAULT_INPUTS`]. Friction depends on the direction of the last motion, so
//! the computation has a state; until this state is known, and after a gap in the samples, no row is returned.
//! Allocates nothing.
//!
//! The row is in the frame `shaft`, which does not roll with the sensor: the arm's posture rolls it during work by
//! angles that no recording covers. On the emulated rig a roll of 0.2 deg/s took the left arm out of its training data
//! within half a minute.

use nalgebra::UnitQuaternion;

use super::DEFAULT_INPUTS;
use crate::frames::{Wrench, WristSample, world_from_shaft};

pub const LIVE_INPUTS: usize = DEFAULT_INPUTS.len();

/// Time constants and lengths. A network must be used with the settings with which its data were recorded; only the
/// study that chose them uses others than the default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeatureSettings {
    /// Time constant of the low-pass on wrench and depth, s: less noise for some delay. It is the same for both,
    /// because a wrench delayed against its motion would look like friction of the wrong sign at every reversal.
    pub smoothing_s: f64,
    /// Lengths over which a sticking seal stretches before it slides, m, shortest first (Dahl 1968): `dz = dx - |dx| z
    /// / length`.
    pub presliding_m: [f64; 2],
    /// Length of sliding after which the past sliding speed no longer matters, m (rate-and-state friction, Ruina 1983).
    pub slip_m: f64,
}

impl Default for FeatureSettings {
    fn default() -> Self {
        // Chosen in the study of the features (see `FeatureSettings`); 5 ms are five samples at 1 kHz.
        Self { smoothing_s: 0.005, presliding_m: [2e-4, 6e-4], slip_m: 4e-4 }
    }
}

/// A stretch counts as known once it has reached this fraction of its maximum, because it then hardly depends on its
/// initial value.
const KNOWN_FRACTION: f64 = 0.8;

/// A gap between two samples longer than this, s, resets the state. Design choice.
const HOLE_S: f64 = 0.020;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoRow {
    /// The sample lacks the wrist's orientation or its depth through the trocar, or is not finite.
    Missing,
    /// The instrument has not moved far enough for the direction of the trocar's friction to be known.
    NotMoved,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeatureRow {
    /// Inputs in the order of [`DEFAULT_INPUTS`].
    pub inputs: [f32; LIVE_INPUTS],
    /// Rotation into the frame of these inputs and of the corresponding force at the tip.
    pub shaft_from_s1: UnitQuaternion<f64>,
}

/// State of the computation; one per wrist sensor.
#[derive(Clone, Debug)]
pub struct TipForceFeatures {
    settings: FeatureSettings,
    last: Option<LastValues>,
}

#[derive(Clone, Copy, Debug)]
struct LastValues {
    t_s: f64,
    wrench: Wrench,
    insertion_m: f64,
    speed_m_s: f64,
    stretch_m: [f64; 2],
    slip_m_s: f64,
    known: bool,
}

impl LastValues {
    // `known: false`: the stretch starts at zero, which is right only by chance.
    const fn unknown(t_s: f64, wrench: &Wrench, insertion_m: f64) -> Self {
        Self { t_s, wrench: *wrench, insertion_m, speed_m_s: 0.0, stretch_m: [0.0; 2], slip_m_s: 0.0, known: false }
    }
}

impl TipForceFeatures {
    pub const fn new(settings: FeatureSettings) -> Self {
        Self { settings, last: None }
    }

    pub const fn reset(&mut self) {
        self.last = None;
    }

    /// Returns the row for this sample. Must be called with every sample, in order.
    ///
    /// # Errors
    /// [`NoRow`] if the sample is incomplete or the state is not known yet.
    pub fn step(&mut self, t_s: f64, gravity_free: &Wrench, sample: &WristSample) -> Result<FeatureRow, NoRow> {
        // The state survives an incomplete sample: the next complete sample shows how far the instrument has moved in
        // the meantime.
        let complete = sample.world_from_s1.zip(sample.insertion_m);
        // The sample is checked as a whole, because one bad number would stay in the low-pass.
        let finite = gravity_free.is_finite() && sample.is_finite() && t_s.is_finite();
        let Some((world_from_s1, insertion_m)) = complete.filter(|_| finite) else { return Err(NoRow::Missing) };
        let now = match self.last {
            Some(last) if t_s > last.t_s && t_s - last.t_s <= HOLE_S => {
                self.advance(&last, t_s, gravity_free, insertion_m)
            }
            _ => LastValues::unknown(t_s, gravity_free, insertion_m),
        };
        self.last = Some(now);
        if !now.known {
            return Err(NoRow::NotMoved);
        }
        let q = world_from_shaft(&world_from_s1);
        // In the shaft's own frame, so that the roll of the arm makes no difference to the network.
        let shaft_from_s1 = q.inverse() * world_from_s1;
        let Wrench { force_n: f, torque_nm: t } = now.wrench.turned(&shaft_from_s1);
        let inputs = [
            f.x,
            f.y,
            f.z,
            t.x,
            t.y,
            t.z,
            q.w,
            q.i,
            q.j,
            q.k,
            now.insertion_m,
            now.speed_m_s,
            now.stretch_m[0],
            now.stretch_m[1],
            now.slip_m_s,
        ];
        Ok(FeatureRow { inputs: inputs.map(|value| value as f32), shaft_from_s1 })
    }

    fn advance(&self, last: &LastValues, t_s: f64, wrench: &Wrench, insertion_m: f64) -> LastValues {
        let FeatureSettings { smoothing_s, presliding_m, slip_m } = self.settings;
        let dt_s = t_s - last.t_s;
        // First-order low-pass, exact for an input that is constant over the step.
        let fraction = 1.0 - libm::exp(-dt_s / smoothing_s);
        // Filtered like the wrench, so that a reversal has the same delay in both.
        let travel_m = (insertion_m - last.insertion_m) * fraction;
        let length_m = travel_m.abs();
        // Semi-implicit, so that it is stable for steps of any length.
        let stretch_m: [f64; 2] =
            std::array::from_fn(|k| (last.stretch_m[k] + travel_m) / (1.0 + length_m / presliding_m[k]));
        // A fraction of path, not of time: friction forgets with travel.
        let slip = length_m / (length_m + slip_m);
        LastValues {
            t_s,
            wrench: Wrench {
                force_n: last.wrench.force_n + (wrench.force_n - last.wrench.force_n) * fraction,
                torque_nm: last.wrench.torque_nm + (wrench.torque_nm - last.wrench.torque_nm) * fraction,
            },
            insertion_m: last.insertion_m + travel_m,
            speed_m_s: travel_m / dt_s,
            stretch_m,
            slip_m_s: last.slip_m_s + (length_m / dt_s - last.slip_m_s) * slip,
            // Once known, known until a gap: later stretches follow from it.
            known: last.known || stretch_m[1].abs() >= KNOWN_FRACTION * presliding_m[1],
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};

    use super::*;

    fn sample(insertion_m: f64) -> WristSample {
        WristSample {
            world_from_s1: Some(UnitQuaternion::identity()),
            insertion_m: Some(insertion_m),
            ..WristSample::of(Wrench::default())
        }
    }

    fn column(name: &str) -> usize {
        DEFAULT_INPUTS.iter().position(|column| *column == name).unwrap()
    }

    #[test]
    fn the_last_way_and_its_speed_are_remembered() {
        let mut features = TipForceFeatures::new(FeatureSettings::default());
        let wrench = Wrench { force_n: Vector3::new(1.0, 2.0, 3.0), torque_nm: Vector3::zeros() };
        let mut t_s = 0.0;
        let mut go = |from_m: f64, to_m: f64| {
            let mut row = Err(NoRow::Missing);
            for i in 0..=100 {
                t_s += 1e-3;
                row = features.step(t_s, &wrench, &sample(from_m + (to_m - from_m) * f64::from(i) / 100.0));
            }
            row.map(|row| row.inputs)
        };
        assert_eq!(go(0.1, 0.1003), Err(NoRow::NotMoved), "half the length proves nothing");
        let inwards = go(0.1003, 0.105).unwrap();
        assert!(inwards[column("presliding_200um_m")] > 1.9e-4 && inwards[column("presliding_600um_m")] > 5.5e-4);
        assert!((inwards[column("insertion_speed_m_s")] - 0.047).abs() < 1e-3);
        assert!((inwards[column("slip_m_s")] - 0.047).abs() < 5e-3);
        assert!((inwards[column("fz_n")] - 3.0).abs() < 1e-6);
        let resting = go(0.105, 0.105).unwrap();
        assert!(resting[column("insertion_speed_m_s")].abs() < 1e-6);
        assert!(resting[column("slip_m_s")] > 0.02, "at rest it is known how fast it came");
        assert!(resting[column("presliding_600um_m")] > 5.5e-4, "and from where");
        let turning = go(0.105, 0.1047).unwrap();
        let [short, long] = ["presliding_200um_m", "presliding_600um_m"].map(|name| turning[column(name)]);
        assert!(short < 0.0 && long > 0.0, "the shorter one turns first: {short} {long}");
        assert!(go(0.1047, 0.100).unwrap()[column("presliding_600um_m")] < -5.5e-4);
    }

    #[test]
    fn the_roll_of_the_sensor_about_the_shaft_changes_no_input() {
        let wrench = Wrench { force_n: Vector3::new(0.7, -0.4, 2.0), torque_nm: Vector3::new(0.1, 0.2, -0.05) };
        let world_from_s1 = UnitQuaternion::from_euler_angles(2.7, 0.3, -0.5);
        let row = |roll_rad: f64| {
            let roll = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), roll_rad);
            let mut features = TipForceFeatures::new(FeatureSettings::default());
            let rolled = wrench.turned(&roll.inverse());
            let rows = (0..100).map(|i| {
                let sample =
                    WristSample { world_from_s1: Some(world_from_s1 * roll), ..sample(0.1 + 1e-4 * f64::from(i)) };
                features.step(1e-3 * f64::from(i), &rolled, &sample)
            });
            let row = rows.last().unwrap().unwrap();
            (row.inputs, row.shaft_from_s1.inverse() * Vector3::x())
        };
        let (inputs, x_s1) = row(0.0);
        for roll_rad in [0.01, 1.0, 3.0, -2.0] {
            let (rolled, rolled_x_s1) = row(roll_rad);
            for (name, (a, b)) in DEFAULT_INPUTS.iter().zip(inputs.iter().zip(rolled)) {
                assert!((a - b).abs() < 1e-5, "{name} at a roll of {roll_rad} rad: {a}, {b}");
            }
            let turned_rad = x_s1.angle(&rolled_x_s1) - roll_rad.abs();
            assert!(turned_rad.abs() < 1e-6, "the force at the tip is turned back into the rolled sensor's frame");
        }
    }

    #[test]
    fn a_hole_empties_the_memory_and_an_incomplete_sample_does_not() {
        let wrench = Wrench::default();
        let mut t_s = 0.0;
        let mut features = TipForceFeatures::new(FeatureSettings::default());
        let mut moved = |features: &mut TipForceFeatures| {
            let mut row = Err(NoRow::Missing);
            for i in 0..60 {
                t_s += 1e-3;
                row = features.step(t_s, &wrench, &sample(0.1 + 1e-4 * f64::from(i)));
            }
            (row, t_s)
        };
        let (row, now_s) = moved(&mut features);
        assert!(row.is_ok());
        let mut after = features.clone();
        assert_eq!(after.step(now_s + 0.04, &wrench, &sample(0.106)), Err(NoRow::NotMoved), "40 ms without a sample");
        assert!(features.clone().step(now_s, &wrench, &sample(0.106)).is_err(), "time that does not increase");
        let mut without = sample(0.106);
        without.insertion_m = None;
        for incomplete in [sample(f64::NAN), without] {
            let mut after = features.clone();
            assert_eq!(after.step(now_s + 1e-3, &wrench, &incomplete), Err(NoRow::Missing));
            assert!(after.step(now_s + 2e-3, &wrench, &sample(0.106)).is_ok(), "it knows the way since then");
            for k in 3..30 {
                assert_eq!(after.step(now_s + 1e-3 * f64::from(k), &wrench, &incomplete), Err(NoRow::Missing));
            }
            assert_eq!(after.step(now_s + 0.03, &wrench, &sample(0.106)), Err(NoRow::NotMoved), "28 ms of them");
        }
        assert!(moved(&mut features).0.is_ok(), "a hole heals by moving");
    }
}
