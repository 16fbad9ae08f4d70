//! A loop on a wire.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{SIDES, Side, task::TaskEvent};
use proptest::prelude::*;

use super::{LEFT, RIGHT, at};
use crate::physics::{Instrument, InstrumentLoads, Wire, WireSetting, WireTask};

const PERIOD_S: f64 = 1e-3;

fn holding(tip_m: Vector3<f64>) -> Instrument {
    let trocar_m = at(0.0, -0.06, 0.14);
    Instrument { tip_m, world_from_jaws: UnitQuaternion::identity(), trocar_m, opening_rad: 0.0 }
}

/// Returns a straight wire along x, as high as the workspace's middle.
fn straight() -> WireSetting {
    WireSetting { points_m: vec![[-0.05, 0.0, 0.03], [0.05, 0.0, 0.03]], goal_point: 1, ..WireSetting::default() }
}

/// Returns the distance that the middle of a loop can move from the middle of a straight wire, m.
fn room_m(setting: &WireSetting) -> f64 {
    setting.hoop.radius_m - setting.hoop.tube_radius_m - setting.radius_m
}

/// Around the wire at the origin, then at rest at this offset.
fn at_rest(setting: &WireSetting, off_m: Vector3<f64>) -> (Wire, InstrumentLoads) {
    let mut wire = Wire::new(setting, PERIOD_S);
    let middle_m = at(0.0, 0.0, 0.03);
    let steps = (off_m.norm() / 1e-3).ceil().max(1.0) as u32;
    let mut loads = InstrumentLoads::default();
    for step in 0..=steps + 1 {
        let fraction = f64::from(step.min(steps)) / f64::from(steps);
        loads = wire.step(&Side::Right.alone(holding(middle_m + off_m * fraction)))[RIGHT];
    }
    (wire, loads)
}

#[test]
fn the_force_is_stiffness_times_overlap_also_where_the_wire_is_pulled_through_the_tube() {
    let setting = straight();
    let room_m = room_m(&setting);
    assert_eq!(at_rest(&setting, at(0.0, 0.0, room_m - 1e-5)).1.tip_n, Vector3::zeros(), "not yet");
    for overlap_m in [1e-4, 5e-4, 1e-3, 1.3e-3, 1.5e-3, 3e-3, 6e-3] {
        for way in [at(0.0, 0.0, 1.0), at(0.0, -0.6, 0.8), at(0.0, 1.0, 0.0)] {
            let (wire, loads) = at_rest(&setting, way * (room_m + overlap_m));
            let law_n = way * (-setting.contact.stiffness_n_m * overlap_m);
            // Damping has died out; friction from the approach acts along the approach.
            assert!((loads.tip_n - law_n).norm() < 0.02 * law_n.norm(), "{overlap_m}: {} {law_n}", loads.tip_n);
            let state = wire.states()[RIGHT];
            assert!(state.touches && (state.deepest_m - overlap_m).abs() < 1e-8, "{state:?}");
            assert!((state.along_m.unwrap() - 0.05).abs() < 1e-9);
        }
    }
}

#[test]
fn a_loop_that_leans_against_a_straight_wire_has_less_room_by_the_cosine() {
    for degrees in [0.0, 20.0, 45.0, 60.0_f64] {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        // Thick enough to touch in the middle: the distance of a circle from a line through its middle is `R cos a`.
        let mut setting = straight();
        setting.hoop.axis = Some([cos, sin, 0.0]);
        setting.radius_m = setting.hoop.radius_m * cos - setting.hoop.tube_radius_m + 2e-4;
        let (wire, loads) = at_rest(&setting, Vector3::zeros());
        assert!((wire.states()[RIGHT].deepest_m - 2e-4).abs() < 2e-8, "{degrees}: {:?}", wire.states());
        if degrees > 0.0 {
            // It touches on both sides: the forces cancel, and the torque straightens it.
            assert!(loads.tip_n.norm() < 1e-6, "{}", loads.tip_n);
        }
    }
}

#[test]
fn sliding_along_the_wire_is_held_back_by_the_law_of_coulomb() {
    let setting = straight();
    let (mut wire, _) = at_rest(&setting, at(0.0, 0.0, room_m(&setting) + 1e-3));
    let mut loads = InstrumentLoads::default();
    for tick in 0..400 {
        let tip_m = at(f64::from(tick) * 2e-5, 0.0, 0.03 + room_m(&setting) + 1e-3);
        loads = wire.step(&Side::Right.alone(holding(tip_m)))[RIGHT];
    }
    let ratio = -loads.tip_n.x / loads.tip_n.z.abs();
    assert!((ratio - setting.contact.friction).abs() < 0.01, "{}", loads.tip_n);
}

/// Returns the distance of the loop from the wire, by brute force.
fn tried_m(wire: &Wire, setting: &WireSetting, centre_m: &Vector3<f64>) -> f64 {
    let points_m = wire.curve().points_m();
    let gap_m = |point_m: Vector3<f64>| {
        let offset_m = point_m - centre_m;
        (offset_m.yz().norm() - setting.hoop.radius_m).hypot(offset_m.x)
    };
    let pieces = points_m.windows(2).flat_map(|pair| {
        let from_m = pair[0];
        let travel_m = pair[1] - pair[0];
        (0..=1000).map(move |part| from_m + travel_m * (f64::from(part) / 1000.0))
    });
    pieces.map(gap_m).fold(f64::INFINITY, f64::min)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn the_overlap_is_that_of_a_fine_search(x in -0.05..0.06f64, off in [-0.007..0.007f64, -0.007..0.007f64]) {
        let setting = WireSetting::default();
        let mut wire = Wire::new(&setting, PERIOD_S);
        let near_m = wire.curve().points_m().iter().copied()
            .min_by(|a, b| (a.x - x).abs().total_cmp(&(b.x - x).abs())).unwrap();
        let centre_m = at(x, near_m.y + off[0], near_m.z + off[1]);
        wire.step(&Side::Right.alone(holding(centre_m)));
        let fine_m = setting.radius_m + setting.hoop.tube_radius_m - tried_m(&wire, &setting, &centre_m);
        let found_m = wire.states()[RIGHT].deepest_m;
        prop_assert!((found_m - fine_m.max(0.0)).abs() < 2e-6, "{} m instead of {} m", found_m, fine_m);
    }
}

#[test]
fn the_curve_goes_through_its_points_and_is_as_long_as_an_arc_is() {
    let setting = WireSetting::default();
    let curve = setting.curve();
    for (number, point_m) in setting.points_m.iter().enumerate() {
        let there_m = curve.at(curve.given_m(number));
        assert!((there_m - Vector3::from(*point_m)).norm() < 1e-12, "point {number}: {there_m}");
    }
    // A quarter circle of 30 mm through 10 points.
    let arc = (0..10).map(|i| {
        let (sin, cos) = libm::sincos(f64::from(i) / 9.0 * std::f64::consts::FRAC_PI_2);
        [0.03 * cos, 0.03 * sin, 0.02]
    });
    let curve = WireSetting { points_m: arc.collect(), ..WireSetting::default() }.curve();
    let exact_m = 0.03 * std::f64::consts::FRAC_PI_2;
    assert!((curve.length_m() / exact_m - 1.0).abs() < 2e-3, "{} m", curve.length_m());
    let max_m = curve.points_m().iter().map(|position_m| (position_m.xy().norm() - 0.03).abs()).fold(0.0, f64::max);
    assert!(max_m < 1e-4, "{max_m} m from the arc");
}

/// A mass attached only to the loop, thrown inside it, bounces from side to side for ten minutes.
#[test]
fn energy_of_a_loop_that_bounces_around_the_wire_does_not_grow() {
    const MASS_KG: f64 = 0.3;
    let mut setting = WireSetting::default();
    for (damping_n_s_m, friction) in [(0.0, 0.0), (0.0, 0.3), (3.0, 0.15)] {
        setting.contact.damping_n_s_m = damping_n_s_m;
        setting.contact.friction = friction;
        let mut wire = Wire::new(&setting, PERIOD_S);
        let mut tip_m = wire.curve().at(0.05);
        let mut speed_m_s = at(0.02, 0.09, -0.07);
        let first_j = 0.5 * MASS_KG * speed_m_s.norm_squared();
        // In free flight, all energy is kinetic.
        let mut max_j = 0.0_f64;
        let mut bounces = 0;
        for tick in 0..600_000 {
            let loads = wire.step(&Side::Right.alone(holding(tip_m)))[RIGHT];
            speed_m_s += loads.tip_n * (PERIOD_S / MASS_KG);
            // Reverse the motion; otherwise the loop would fly to the end of the wire.
            speed_m_s.x *= if tick % 2000 == 1999 { -1.0 } else { 1.0 };
            tip_m += speed_m_s * PERIOD_S;
            if wire.states()[RIGHT].touches {
                bounces += 1;
            } else {
                max_j = max_j.max(0.5 * MASS_KG * speed_m_s.norm_squared());
            }
        }
        // A step of 1 ms on undamped springs causes this much ripple.
        assert!(bounces > 100 && max_j < 1.03 * first_j, "{damping_n_s_m}: {max_j} J of {first_j} J, {bounces}");
        let last_j = 0.5 * MASS_KG * speed_m_s.norm_squared();
        assert!(damping_n_s_m == 0.0 || last_j < 0.2 * first_j, "what is damped comes to rest: {last_j} J");
    }
}

/// Returns a digest of ten seconds in which two loops move along the wire, and outside it.
fn digest() -> u64 {
    let setting = WireSetting::default();
    let mut wire = Wire::new(&setting, PERIOD_S);
    let mut task = WireTask::new(&setting);
    let mut digest = 0xcbf2_9ce4_8422_2325_u64;
    let mut mix = |x: f64| digest = (digest ^ x.to_bits()).wrapping_mul(0x0100_0000_01b3);
    for tick in 0..10_000 {
        let t_s = f64::from(tick) * PERIOD_S;
        let along_m = wire.curve().at(0.013 * t_s);
        let beside_m = at(0.0, 5.5e-3 * libm::sin(9.0 * t_s), 5.5e-3 * libm::sin(7.0 * t_s));
        let other_m = at(0.05 * libm::sin(t_s), 0.02 * libm::sin(3.0 * t_s), 0.02 + 0.02 * libm::sin(2.0 * t_s));
        let mut hands = [None; SIDES];
        hands[LEFT] = Some(holding(other_m));
        hands[RIGHT] = Some(holding(along_m + beside_m));
        let loads = wire.step(&hands);
        task.look(&wire, &mut |age_s, _| mix(age_s));
        for loads in [LEFT, RIGHT].map(|side| loads[side]) {
            loads.tip_n.iter().chain(loads.torque_nm.iter()).for_each(|x| mix(*x));
        }
    }
    mix(f64::from(task.touches()));
    digest
}

#[test]
fn ten_seconds_on_a_wire_repeat_to_the_last_bit_in_every_build() {
    let first = digest();
    assert_eq!(first, digest());
    assert_eq!(first, 0xacd3_9e86_be76_6b46, "a build, a processor or a law has changed: {first:#018x}");
}

#[test]
fn what_is_not_a_number_counts_as_absent_and_what_is_far_away_feels_nothing() {
    let setting = straight();
    let (mut wire, _) = at_rest(&setting, at(0.0, 0.0, room_m(&setting) + 1e-3));
    let poisoned = Some(holding(at(0.0, f64::NAN, 0.03)));
    assert_eq!(wire.step(&[poisoned, poisoned]), [InstrumentLoads::default(); 2]);
    assert_eq!(wire.states()[RIGHT].along_m, None);
    let far = Some(holding(at(0.0, 0.04, 0.06)));
    assert_eq!(wire.step(&[far, far]), [InstrumentLoads::default(); 2]);
    for x_m in [0.0, 1e3, -1e300, f64::INFINITY] {
        let loads = wire.step(&[at(0.0, x_m, 0.03), at(x_m, 0.0, 0.03)].map(|tip_m| Some(holding(tip_m))));
        assert!(loads.iter().all(|loads| loads.tip_n.iter().all(|x| x.is_finite() && x.abs() < 100.0)));
    }
}

#[test]
fn a_loop_is_held_back_by_the_board_and_turns_with_its_shaft_if_told_so() {
    let mut setting = straight();
    let reach_m = setting.hoop.radius_m + setting.hoop.tube_radius_m;
    let mut wire = Wire::new(&setting, PERIOD_S);
    let low = holding(at(0.0, 0.02, reach_m - 1e-3));
    wire.step(&Side::Right.alone(low));
    let loads = wire.step(&Side::Right.alone(low))[RIGHT];
    assert!(loads.touching.board && (loads.tip_n.z - 1.0).abs() < 1e-9, "1 kN/m at 1 mm: {}", loads.tip_n);
    setting.hoop.axis = None;
    // The shaft is upright, so the loop is horizontal and the wire does not cross its plane.
    let mut wire = Wire::new(&setting, PERIOD_S);
    let mut flat = holding(at(0.0, 0.02, 0.03));
    flat.trocar_m = at(0.0, 0.02, 0.15);
    wire.step(&Side::Right.alone(flat));
    assert_eq!(wire.states()[RIGHT].along_m, None);
}

struct WireReport {
    wire: Wire,
    task: WireTask,
    events: Vec<(f64, TaskEvent)>,
    t_s: f64,
}

impl WireReport {
    fn new(setting: &WireSetting) -> Self {
        let task = WireTask::new(setting);
        Self { wire: Wire::new(setting, PERIOD_S), task, events: Vec::new(), t_s: 0.0 }
    }

    fn glide(&mut self, side: usize, from_m: Vector3<f64>, to_m: Vector3<f64>, seconds: f64) {
        let ticks = (seconds / PERIOD_S).round() as u32;
        for tick in 1..=ticks {
            let mut hands = [None; SIDES];
            hands[side] = Some(holding(from_m + (to_m - from_m) * (f64::from(tick) / f64::from(ticks))));
            self.wire.step(&hands);
            self.t_s += PERIOD_S;
            let t_s = self.t_s;
            let events = &mut self.events;
            self.task.look(&self.wire, &mut |age_s, event| events.push((t_s - age_s, event)));
        }
    }
}

#[test]
fn touches_are_counted_once_with_their_times_and_the_goal_ends_the_task() {
    let setting = straight();
    let mut report = WireReport::new(&setting);
    let middle = |x_m: f64| at(x_m, 0.0, 0.03);
    let up_m = at(0.0, 0.0, room_m(&setting) + 3e-4);
    report.glide(RIGHT, middle(-0.06), middle(-0.02), 1.0);
    report.glide(RIGHT, middle(-0.02), middle(-0.02) + up_m, 0.5);
    report.glide(RIGHT, middle(-0.02) + up_m, middle(-0.02), 0.5);
    // Clear of the wire for only 20 ms, which counts as the same touch.
    for _ in 0..3 {
        report.glide(RIGHT, middle(-0.02) + up_m, middle(-0.02) + up_m, 0.1);
        report.glide(RIGHT, middle(-0.02), middle(-0.02), 0.02);
    }
    report.glide(RIGHT, middle(-0.02), middle(0.06), 2.0);
    let right = Side::Right;
    let kinds: Vec<TaskEvent> = report.events.iter().map(|(_, event)| *event).collect();
    let touch = [TaskEvent::WireTouched { side: right }, TaskEvent::WireLeft { side: right }];
    assert_eq!(kinds, [touch[0], touch[1], touch[0], touch[1], TaskEvent::Ended], "{:?}", report.events);
    // Along a path of about 4.9 mm in 0.5 s, there and back, it overlaps by at most 0.3 mm.
    let lasts_s = report.events[1].0 - report.events[0].0;
    let law_s = 2.0 * 0.5 * 3e-4 / up_m.z;
    assert!((lasts_s - law_s).abs() < 4e-3, "{lasts_s} s instead of {law_s} s");
    assert!(report.task.is_done() && report.task.touches() == 2);
    report.task.begin();
    assert!(!report.task.is_done() && report.task.touches() == 0 && report.task.fraction() < 1e-9);
}

#[test]
fn only_a_loop_that_came_from_the_free_end_reaches_the_goal() {
    let setting = straight();
    let mut report = WireReport::new(&setting);
    let middle = |x_m: f64| at(x_m, 0.0, 0.03);
    // Start over the other end, to the middle, and back to the goal.
    report.glide(LEFT, middle(0.06), middle(0.0), 1.0);
    report.glide(LEFT, middle(0.0), middle(0.0495), 1.0);
    assert!(!report.task.is_done() && report.task.fraction() < 1e-9);
    // Move to the free end, over it and half way back: the loop leaves the wire there, and the run no longer counts.
    report.glide(LEFT, middle(0.0495), middle(-0.045), 1.0);
    report.glide(LEFT, middle(-0.045), middle(0.0), 1.0);
    assert!((report.task.fraction() - 0.05 / 0.099).abs() < 1e-3, "{}", report.task.fraction());
    report.glide(LEFT, middle(0.0), middle(-0.06), 1.0);
    assert!(report.task.fraction() < 1e-9 && report.events.is_empty());
}

#[test]
fn the_section_survives_a_file_and_a_value_out_of_range_is_named() {
    let setting: WireSetting = toml::from_str("").unwrap();
    assert_eq!(setting, WireSetting::default());
    setting.validate().unwrap();
    assert_eq!(toml::from_str::<WireSetting>(&toml::to_string(&setting).unwrap()).unwrap(), setting);
    let refused = |text: &str| toml::from_str::<WireSetting>(text).unwrap().validate().unwrap_err().to_string();
    for (text, named) in [
        ("points_m = [[0.0, 0.0, 0.0]]", "wire.points_m (count) = 1"),
        ("points_m = [[0.0, 0.0, nan], [0.1, 0.0, 0.0]]", "wire.points_m = NaN"),
        ("points_m = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]", "wire.points_m (distance) = 0"),
        ("goal_point = 12", "wire.goal_point = 12"),
        ("radius_m = 0.006", "wire.loop.radius_m = 0.006"),
        ("loop = { axis = [0.0, 0.0, 0.0] }", "wire.loop.axis (length) = 0"),
        ("contact = { stiffness_n_m = 1e9 }", "wire.contact.stiffness_n_m"),
        ("contact = { friction = -1.0 }", "wire.contact.friction = -1"),
    ] {
        let message = refused(text);
        assert!(message.contains(named) && message.contains("must be"), "{message}");
    }
    assert!(toml::from_str::<WireSetting>("colour = 3").is_err());
}
