//! A simulated technician who pushes in the requested directions.

use super::*;
use crate::{
    calibration::Verdict,
    frames::{Wrench, from_roll_pitch_yaw_deg},
    noise::Noise,
};

/// Noise of one reading per axis, N.
const READING_N: f64 = 0.05;

struct Fixture {
    session: CorrespondenceSession,
    noise: Noise,
    t_s: f64,
    world_from_s1: UnitQuaternion<f64>,
    world_from_m: UnitQuaternion<f64>,
    world_from_c: UnitQuaternion<f64>,
    c_from_s2: UnitQuaternion<f64>,
}

impl Fixture {
    fn new(seed: u64) -> Self {
        let mut noise = Noise::new(seed);
        let mut turn = || from_roll_pitch_yaw_deg(&Vector3::from_fn(|_, _| 360.0 * noise.uniform()));
        let world_from_s1 = turn();
        let world_from_m = turn();
        let world_from_c = turn();
        let c_from_s2 = turn();
        let session = CorrespondenceSession::new(CorrespondenceSessionSettings::default());
        Self { session, noise, t_s: 0.0, world_from_s1, world_from_m, world_from_c, c_from_s2 }
    }

    fn noise_n(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.noise.gaussian()) * READING_N
    }

    /// Adds one sample with this force on the instrument (`world`), N.
    fn feel(&mut self, force_in_world_n: Vector3<f64>) -> CorrespondencePhase {
        self.t_s += 1e-3;
        let f1_n = self.world_from_s1.inverse() * force_in_world_n + self.noise_n();
        let world_from_s2 = self.world_from_c * self.c_from_s2;
        let sample = WristSample {
            world_from_s1: Some(self.world_from_s1),
            world_from_m: Some(self.world_from_m),
            m_from_c: Some(self.world_from_m.inverse() * self.world_from_c),
            tissue_n: Some(world_from_s2.inverse() * force_in_world_n + self.noise_n()),
            ..WristSample::of(Wrench { force_n: f1_n, ..Wrench::default() })
        };
        self.session.step(Some(f1_n), &sample, self.t_s)
    }

    fn rest(&mut self, ticks: usize) -> CorrespondencePhase {
        (0..ticks).map(|_| self.feel(Vector3::zeros())).last().unwrap()
    }

    /// Pushes in this direction (`world`), rising and falling within 0.1 s, held for `held_s` with a slow variation;
    /// returns the last phase.
    fn push(&mut self, towards: Vector3<f64>, peak_n: f64, held_s: f64) -> CorrespondencePhase {
        let ticks = ((0.2 + held_s) * 1e3) as usize;
        for tick in 0..ticks {
            let t_s = tick as f64 * 1e-3;
            let envelope = (t_s / 0.1).min((0.2 + held_s - t_s) / 0.1).min(1.0);
            let sway = 1.0 + 0.03 * (9.0 * t_s).sin();
            self.feel(-towards * peak_n * envelope * sway);
        }
        self.rest(100)
    }
}

#[test]
fn pushes_in_the_directions_asked_for_give_an_accepted_rotation_within_a_fifth_of_a_degree() {
    for seed in 0..10 {
        let mut bench = Fixture::new(seed);
        assert_eq!(bench.rest(700), CorrespondencePhase::Ready, "{seed}");
        let mut asked = Vec::new();
        while bench.session.pairs().len() < 20 {
            // The wrist turns slightly between pushes, like that of a real arm.
            bench.world_from_s1 *= from_roll_pitch_yaw_deg(&Vector3::new(3.0, -5.0, 8.0));
            let astray = bench.noise_n() * 3.0;
            let target = bench.session.target();
            asked.extend(target.map(|target| target.name));
            let towards = target.map_or_else(|| bench.noise_n(), |target| target.push_in_world) + astray;
            let index = bench.session.pairs().len();
            let peak_n = 1.5 + 2.5 * bench.noise.uniform();
            let phase = bench.push(towards.normalize(), peak_n, 0.4);
            assert_eq!(phase, CorrespondencePhase::Recorded(index), "{seed}");
        }
        // A push that misses its direction may count towards a neighbouring target.
        assert!(asked.len() + 1 >= bench.session.targets() && bench.session.target().is_none(), "{asked:?}");
        let report = bench.session.report().unwrap();
        assert_eq!(report.verdict, Verdict::Accepted, "{seed}: {}", report.reason);
        let error_deg = report.solution.unwrap().rotation().angle_to(&bench.c_from_s2).to_degrees();
        assert!(error_deg <= 0.2, "{seed}: {error_deg}");
    }
}

#[test]
fn what_is_kept_is_the_force_near_the_peak() {
    let mut bench = Fixture::new(20);
    bench.rest(700);
    bench.push(-Vector3::z(), 3.0, 0.3);
    let pair = bench.session.pairs()[0];
    assert!((pair.f1_n.norm() - 3.0).abs() < 0.15 && (pair.f2_n.norm() - 3.0).abs() < 0.15, "{pair:?}");
    let expected = bench.world_from_s1.inverse() * bench.world_from_c;
    assert!(pair.s1_from_c.angle_to(&expected) < 1e-9);
}

#[test]
fn short_moved_and_one_sided_pushes_are_refused_with_their_reason() {
    let mut bench = Fixture::new(21);
    bench.rest(700);
    assert_eq!(bench.push(Vector3::x(), 3.0, -0.13), CorrespondencePhase::Refused(PushRefusal::TooShort));
    for tick in 0..600 {
        let force_n = 2.5 + 1.6 * (f64::from(tick) * 0.1).sin();
        bench.feel(Vector3::x() * force_n);
    }
    assert!(matches!(bench.rest(50), CorrespondencePhase::Refused(PushRefusal::Moved { by_n }) if by_n > 0.3));
    // The shaft leans on something other than the tissue, so the two sensors disagree.
    let lean = |bench: &mut Fixture, force_n: f64| {
        bench.t_s += 1e-3;
        let turn = Some(UnitQuaternion::identity());
        let sample = WristSample {
            world_from_s1: turn,
            world_from_m: turn,
            m_from_c: turn,
            tissue_n: Some(Vector3::zeros()),
            ..WristSample::of(Wrench::default())
        };
        bench.session.step(Some(Vector3::y() * force_n), &sample, bench.t_s)
    };
    (0..300).for_each(|_| assert!(matches!(lean(&mut bench, 2.0), CorrespondencePhase::Pushing { .. })));
    assert_eq!(lean(&mut bench, 0.0), CorrespondencePhase::Refused(PushRefusal::MissedTissue));
    assert!(bench.session.pairs().is_empty());
}

#[test]
fn a_sensor_that_was_not_zeroed_keeps_the_session_waiting() {
    let mut bench = Fixture::new(22);
    for _ in 0..2000 {
        let phase = bench.feel(Vector3::x() * 0.9);
        assert!(matches!(phase, CorrespondencePhase::Resting { f1_n, .. } if f1_n > 0.5), "{phase:?}");
    }
    assert_eq!(bench.rest(700), CorrespondencePhase::Ready);
}

#[test]
fn a_source_that_goes_missing_drops_the_push_that_was_on() {
    let mut bench = Fixture::new(23);
    bench.rest(700);
    (0..300).for_each(|_| _ = bench.feel(Vector3::z() * 2.0));
    let bare = WristSample::of(Wrench::default());
    let phase = bench.session.step(Some(Vector3::zeros()), &bare, bench.t_s + 1e-3);
    assert_eq!(phase, CorrespondencePhase::Missing(MissingInput::TissueForce));
    assert_eq!(
        bench.session.step(None, &bare, bench.t_s + 2e-3),
        CorrespondencePhase::Missing(MissingInput::WristForce)
    );
    let no_chain = WristSample { tissue_n: Some(Vector3::zeros()), ..bare };
    assert_eq!(
        bench.session.step(Some(Vector3::zeros()), &no_chain, 1e9),
        CorrespondencePhase::Missing(MissingInput::Chain)
    );
    assert!(
        matches!(bench.feel(Vector3::z() * 2.0), CorrespondencePhase::Resting { .. }),
        "its beginning was not seen"
    );
    assert_eq!(bench.rest(10), CorrespondencePhase::Ready);
    assert!(bench.session.pairs().is_empty());
    assert_eq!(bench.feel(Vector3::new(f64::NAN, 0.0, 0.0)), CorrespondencePhase::Missing(MissingInput::Sense));
}

#[test]
fn undo_and_remove_take_pushes_back_and_ask_for_them_again() {
    let mut bench = Fixture::new(24);
    bench.rest(700);
    for _ in 0..3 {
        let target = bench.session.target().unwrap();
        bench.push(target.push_in_world, 2.0, 0.3);
    }
    assert_eq!(bench.session.target().unwrap().name, "away from the base");
    assert!(bench.session.remove(1) && !bench.session.remove(2));
    assert_eq!(bench.session.target().unwrap().name, "left");
    assert!(bench.session.undo() && bench.session.undo() && !bench.session.undo());
    assert_eq!(bench.session.target().unwrap().name, "down");
}
