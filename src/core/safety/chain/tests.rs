//! Tests of the whole chain of gates.

use nalgebra::{SVector, Vector3};
use proptest::prelude::*;

use super::*;

fn request(force_n: Vector3<f64>) -> ForceRequest {
    ForceRequest { force_n: Some(force_n), age_s: 0.0, speed_m_s: 0.1, permitted: true, ..ForceRequest::default() }
}

/// A chain whose clock advances by one period with each request.
struct Clocked<const D: usize>(SafetyChain<D>, f64);

impl<const D: usize> Clocked<D> {
    fn new(settings: ChainSettings) -> Self {
        Self(SafetyChain::new(settings, 1e-3), 0.0)
    }

    fn step(&mut self, request: &ForceRequest<D>) -> (SVector<f64, D>, GateReport) {
        self.1 += 1e-3;
        self.0.step(&ForceRequest { t_s: self.1, ..*request })
    }
}

#[test]
fn a_modest_force_passes_untouched_once_the_slew_has_caught_up() {
    let mut chain = Clocked::new(ChainSettings::default());
    let asked = Vector3::new(1.0, -0.5, 2.0);
    for _ in 0..100 {
        chain.step(&request(asked));
    }
    let (force_n, report) = chain.step(&request(asked));
    assert!((force_n - asked).norm() < 1e-12);
    assert_eq!(report.first_closed(), "open");
    assert_eq!(report.counts.ticks, 101);
}

#[test]
fn silence_fades_after_5_ms_and_is_zero_at_20_ms() {
    let settings = ChainSettings { slew_n_per_s: 1e9, ..ChainSettings::default() };
    let mut chain = Clocked::new(settings);
    let at = |chain: &mut Clocked<3>, age_s| chain.step(&ForceRequest { age_s, ..request(Vector3::z()) }).0.z;
    assert!((at(&mut chain, 0.005) - 1.0).abs() < 1e-12);
    let halfway = at(&mut chain, 0.0125);
    assert!((halfway - 0.5).abs() < 1e-12, "{halfway}");
    assert!(at(&mut chain, 0.020).abs() < 1e-12);
    assert!(at(&mut chain, f64::NAN).abs() < 1e-12);
}

#[test]
fn a_stop_takes_the_force_away_at_once() {
    let mut chain = Clocked::new(ChainSettings::default());
    for _ in 0..100 {
        chain.step(&request(Vector3::z() * 3.0));
    }
    let (force_n, report) = chain.step(&ForceRequest { permitted: false, ..request(Vector3::z() * 3.0) });
    assert!(force_n.norm() < 1e-15);
    assert_eq!(report.first(), Some((Gate::Permission, Reason::NotPermitted)));
    assert_eq!(chain.0.counts().acted[Gate::Permission.index()], 1);
}

#[test]
fn the_dead_band_says_how_much_it_withholds() {
    let mut chain = Clocked::new(ChainSettings::default());
    let held = ForceRequest { speed_m_s: 0.0, ..request(Vector3::z() * 1.4) };
    let (force_n, report) = chain.step(&held);
    assert!(force_n.norm() < 1e-15 && (report.withheld_n - 1.4).abs() < 1e-12);
    chain.0.set_static_hold(true);
    for _ in 0..10 {
        chain.step(&held);
    }
    assert!((chain.step(&held).0.z - 1.4).abs() < 1e-12);
}

#[test]
fn the_ceiling_is_never_above_what_the_device_can_give() {
    let settings = ChainSettings { device_limit_n: 2.5, ..ChainSettings::default() };
    let mut chain = Clocked::new(settings);
    let last = (0..100).map(|_| chain.step(&request(Vector3::z() * 30.0))).last().unwrap();
    assert!((last.0.norm() - 2.5).abs() < 1e-12);
    assert_eq!(last.1.reason(Gate::Ceiling), Reason::AboveDeviceLimit);
}

#[test]
fn a_gripper_and_a_torque_pass_gates_of_their_own() {
    let mut gripper = Clocked::<1>::new(ChainSettings::gripper());
    let squeeze = ForceRequest::<1> {
        force_n: Some(SVector::from([1e2])),
        age_s: 0.0,
        permitted: true,
        ..ForceRequest::default()
    };
    let held = (0..100).map(|_| gripper.step(&squeeze).0.x).last().unwrap();
    assert!((held - 4.0).abs() < 1e-12, "a held grip is felt, up to the ceiling: {held}");
    let mut torque = Clocked::<3>::new(ChainSettings::torque(0.4));
    let twist = (0..100).map(|_| torque.step(&request(Vector3::x())).0.norm()).last().unwrap();
    assert!((twist - 0.1).abs() < 1e-12, "{twist} Nm");
    let mut none = Clocked::<3>::new(ChainSettings::torque(0.0));
    assert!(none.step(&request(Vector3::x())).0.norm() < 1e-15, "a device without torques is sent none");
}

#[test]
fn a_gain_above_one_takes_the_second_action() {
    let settings = ChainSettings { gain: 2.0, gain_rate_per_s: 1e3, ..ChainSettings::default() };
    let mut chain = Clocked::new(settings);
    assert!((chain.0.settings().gain - 1.0).abs() < 1e-12);
    let felt = |chain: &mut Clocked<3>| (0..20).map(|_| chain.step(&request(Vector3::x())).0.x).last().unwrap();
    chain.0.set_ordinary_gain(2.0);
    assert!((felt(&mut chain) - 1.0).abs() < 1e-12);
    chain.0.set_gain_above_one(2.0);
    assert!((felt(&mut chain) - 2.0).abs() < 1e-12);
}

#[test]
fn a_late_tick_allows_no_larger_step() {
    let mut chain = SafetyChain::new(ChainSettings::default(), 1e-3);
    let asked = |t_s| ForceRequest { t_s, ..request(Vector3::z() * 3.0) };
    let mut last_n = chain.step(&asked(0.0)).0.z;
    for t_s in [1e-3, 1.4e-3, 8e-3, 8e-3, 7e-3, 9e-3] {
        let now_n = chain.step(&asked(t_s)).0.z;
        assert!(now_n >= last_n && now_n - last_n <= 0.5 + 1e-12, "at {t_s} s: from {last_n} to {now_n} N");
        last_n = now_n;
    }
    assert!((last_n - 2.2).abs() < 1e-9, "0.5 N for each period that passed, 0.2 N for the early tick: {last_n}");
}

/// Force (N), age (s), speed (m/s), permission, gain, and the time since the last request (s).
type RequestedForce = ([f64; 3], f64, f64, bool, f64, f64);

fn any_request() -> impl Strategy<Value = RequestedForce> {
    let number = || prop_oneof![-20.0..20.0f64, prop::num::f64::ANY];
    let spacing_s = prop_oneof![4 => Just(1e-3), 4 => 0.0..6e-3f64, 1 => prop::num::f64::ANY];
    (prop::array::uniform3(number()), number(), number(), any::<bool>(), 0.0..5.0f64, spacing_s)
}

proptest! {
    #[test]
    fn no_sequence_of_requests_at_any_spacing_breaches_ceiling_or_slew(
        requests in prop::collection::vec(any_request(), 1..200),
    ) {
        let settings = ChainSettings::default();
        let mut chain = SafetyChain::new(settings, 1e-3);
        let mut last = Vector3::<f64>::zeros();
        let mut last_gain = 1.0;
        let mut t_s = 0.0;
        let mut last_s = -1e-3;
        for (force, age_s, speed_m_s, permitted, gain, spacing_s) in requests {
            chain.set_gain_above_one(gain);
            let force = Vector3::from(force);
            t_s = if f64::is_finite(t_s) { t_s + spacing_s } else { 0.0 };
            let hand_m = Some(force * 1e-4);
            let asked = ForceRequest { t_s, force_n: Some(force), age_s, speed_m_s, hand_m, permitted, hand_age_s: 0.0 };
            let (now, report) = chain.step(&asked);
            prop_assert!(now.iter().all(|f| f.is_finite()));
            prop_assert!(now.norm() <= settings.ceiling_n * (1.0 + 1e-12));
            let change = (now - last).norm();
            prop_assert!(now.norm() == 0.0 || change <= 0.5 * (1.0 + 1e-9), "change {}", change);
            let ramp = 2.0 * f64::max(t_s - last_s, 0.0);
            prop_assert!((report.gain - last_gain).abs() <= ramp * (1.0 + 1e-9) + 2.001e-3);
            last = now;
            last_gain = report.gain;
            last_s = if f64::is_finite(t_s) { t_s } else { last_s };
        }
    }
}
