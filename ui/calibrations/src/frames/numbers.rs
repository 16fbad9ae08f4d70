//! Values of the rig file that a result changes. Lengths in m, rotations as roll, pitch, yaw in degrees.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use nima_core::{
    calibration::frames::{
        Carrier, HandEyeResult, SensorMountResult, Sizes, TableResult, TipResult, TrocarResult, ViewResult,
    },
    frames::{from_roll_pitch_yaw_deg, to_roll_pitch_yaw_deg},
};

use super::{FrameSubject, job::Outcome};

/// Decimal places: hundredths of a millimetre, thousandths of a degree.
const DIGITS_M: usize = 5;
const DIGITS_DEG: usize = 3;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberUnit {
    Metres,
    Degrees,
    /// Part of a direction.
    One,
}

/// A value of the rig file: one number or three.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameNumber {
    pub key: String,
    pub unit: NumberUnit,
    /// Value in the rig file; `None` if the file has none.
    pub before: Option<Vec<f64>>,
    pub after: Vec<f64>,
}

impl FrameNumber {
    fn one(key: String, unit: NumberUnit, before: f64, after: f64) -> Self {
        Self { key, unit, before: Some(vec![before]), after: vec![after] }
    }

    fn three(key: String, unit: NumberUnit, before: Option<Vector3<f64>>, after: Vector3<f64>) -> Self {
        Self { key, unit, before: before.map(|before| before.as_slice().to_vec()), after: after.as_slice().to_vec() }
    }

    /// Returns whether the value in the file changes.
    pub fn changes(&self) -> bool {
        let before = self.before.as_ref().map(|before| Self { after: before.clone(), ..self.clone() }.toml());
        before.is_none_or(|before| before != self.toml())
    }

    pub fn toml(&self) -> String {
        let digits = if self.unit == NumberUnit::Degrees { DIGITS_DEG } else { DIGITS_M };
        let number = |x: &f64| {
            let words = format!("{x:.digits$}");
            // Avoids `-0`.
            if words.trim_start_matches(['-', '0', '.']).is_empty() { format!("{:.digits$}", 0.0) } else { words }
        };
        match self.after.as_slice() {
            [one] => number(one),
            many => format!("[{}]", many.iter().map(number).collect::<Vec<_>>().join(", ")),
        }
    }
}

/// Effect of the result on a point or a frame, for a drawing: before, if known, and after, in the same frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameEffect {
    pub before: Option<Isometry3<f64>>,
    pub after: Isometry3<f64>,
}

impl FrameEffect {
    fn of_points(before_m: Vector3<f64>, after_m: Vector3<f64>) -> Self {
        let at = |point_m: Vector3<f64>| Isometry3::from_parts(point_m.into(), UnitQuaternion::identity());
        Self { before: Some(at(before_m)), after: at(after_m) }
    }

    fn of_turns(before: UnitQuaternion<f64>, after: UnitQuaternion<f64>) -> Self {
        let turned = |turn: UnitQuaternion<f64>| Isometry3::from_parts(Vector3::zeros().into(), turn);
        Self { before: Some(turned(before)), after: turned(after) }
    }

    /// Returns the distance (m) and angle (degrees) between before and after.
    pub fn change(&self) -> Option<[f64; 2]> {
        let by = self.before?.inverse() * self.after;
        Some([by.translation.vector.norm(), by.rotation.angle().to_degrees()])
    }

    /// Returns whether the change is smaller than the uncertainty of the result.
    pub fn is_within(&self, known_to: Sizes) -> bool {
        let within = |by: f64, max: Option<f64>| max.map_or(by <= 1e-9, |max| by <= max);
        self.change().is_some_and(|[m, deg]| within(m, known_to.place_m) && within(deg, known_to.angle_deg))
    }
}

/// Returns the values that the result changes, and its effect; `None` without a result.
pub fn of(
    outcome: &Outcome,
    subject: &FrameSubject,
    seen_view: Option<UnitQuaternion<f64>>,
) -> Option<(Vec<FrameNumber>, FrameEffect)> {
    match outcome {
        Outcome::Tip(report) => tip(&report.found?, subject),
        Outcome::HandEye(report) => Some(hand_eye(&report.found?, subject)),
        Outcome::Trocar(report) => trocar(&report.found?, subject),
        Outcome::Table(report) => Some(table(&report.found?, subject)),
        Outcome::View(report) => Some(view(&report.found?, subject, seen_view)),
        Outcome::Mount(report) => Some(mount(report.found.as_ref()?, subject)),
    }
}

/// Moves the shaft's axis sideways, parallel to itself, until it passes through the tip; its length follows.
fn tip(found: &TipResult, subject: &FrameSubject) -> Option<(Vec<FrameNumber>, FrameEffect)> {
    let found_m = Point3::from(Vector3::from(found.tip_in_carrier_m));
    let tip_m = match found.carrier {
        Carrier::Marker => subject.hand_eye()?[0] * found_m,
        Carrier::Flange | Carrier::Handle => found_m,
    };
    let mount = subject.arm.flange_from_s1;
    let tip_in_s1_m = mount.inverse_transform_point(&tip_m).coords;
    let across_m = mount.rotation * Vector3::new(tip_in_s1_m.x, tip_in_s1_m.y, 0.0);
    let sensor_m = subject.set.mount.sensor_m;
    let moved = Isometry3::from_parts((sensor_m + across_m).into(), mount.rotation);
    let mut numbers = vec![
        FrameNumber::three(subject.key("mount.sensor_m"), NumberUnit::Metres, Some(sensor_m), moved.translation.vector),
        FrameNumber::one(subject.key("mount.shaft_m"), NumberUnit::Metres, subject.arm.shaft_m, tip_in_s1_m.z),
    ];
    numbers.extend(marker_stays(subject, &moved));
    Some((numbers, FrameEffect::of_points(subject.tip_in_flange_m(), tip_m.coords)))
}

/// The marker stays where it was on the flange, so its pose in the frame of a sensor that moved changes.
fn marker_stays(subject: &FrameSubject, flange_from_s1: &Isometry3<f64>) -> Vec<FrameNumber> {
    let Some([flange_from_m, _]) = subject.hand_eye() else { return Vec::new() };
    marker(subject, &(flange_from_s1.inverse() * flange_from_m))
}

fn marker(subject: &FrameSubject, s1_from_m: &Isometry3<f64>) -> Vec<FrameNumber> {
    let angles_deg = to_roll_pitch_yaw_deg(&s1_from_m.rotation);
    vec![
        FrameNumber::three(subject.key("s1_from_m_deg"), NumberUnit::Degrees, subject.set.s1_from_m_deg, angles_deg),
        FrameNumber::three(
            subject.key("s1_from_m_m"),
            NumberUnit::Metres,
            subject.set.s1_from_m_m,
            s1_from_m.translation.vector,
        ),
    ]
}

fn hand_eye(found: &HandEyeResult, subject: &FrameSubject) -> (Vec<FrameNumber>, FrameEffect) {
    let s1_from_m = subject.arm.flange_from_s1.inverse() * found.flange_from_m.pose();
    let base_from_c = found.base_from_c.pose();
    let set = &subject.set;
    let angles_deg = to_roll_pitch_yaw_deg(&base_from_c.rotation);
    let place_m = base_from_c.translation.vector;
    let mut numbers = marker(subject, &s1_from_m);
    numbers.push(FrameNumber::three(subject.key("base_from_c_m"), NumberUnit::Metres, set.base_from_c_m, place_m));
    numbers.push(FrameNumber::three(
        subject.key("base_from_c_deg"),
        NumberUnit::Degrees,
        set.base_from_c_deg,
        angles_deg,
    ));
    // If the rig file lacks the marker's pose, it has at least the orientation.
    let before = subject.s1_from_m().or_else(|| {
        let turn = from_roll_pitch_yaw_deg(&set.s1_from_m_deg?);
        Some(Isometry3::from_parts(s1_from_m.translation, turn))
    });
    (numbers, FrameEffect { before, after: s1_from_m })
}

fn trocar(found: &TrocarResult, subject: &FrameSubject) -> Option<(Vec<FrameNumber>, FrameEffect)> {
    let found_m = Point3::from(Vector3::from(found.trocar_m));
    let in_base_m = match found.carrier {
        Carrier::Marker => subject.base_from_c()? * found_m,
        Carrier::Flange | Carrier::Handle => found_m,
    };
    let before_m = subject.set.rcm.trocar_m;
    let after_m = (subject.arm.world_from_base * in_base_m).coords;
    let number = FrameNumber::three(subject.key("rcm.trocar_m"), NumberUnit::Metres, Some(before_m), after_m);
    Some((vec![number], FrameEffect::of_points(before_m, after_m)))
}

/// Returns the new pose of the base: the table's frame is the workspace, and the trocar, which has not moved, is
/// transformed too.
fn table(found: &TableResult, subject: &FrameSubject) -> (Vec<FrameNumber>, FrameEffect) {
    let before = subject.arm.world_from_base;
    let after = found.from_table.pose().inverse();
    let moved = after * before.inverse();
    let mount = &subject.set.mount;
    let rcm = &subject.set.rcm;
    let angles_deg = to_roll_pitch_yaw_deg(&after.rotation);
    let trocar_m = (moved * Point3::from(rcm.trocar_m)).coords;
    let numbers = vec![
        FrameNumber::three(
            subject.key("mount.base_m"),
            NumberUnit::Metres,
            Some(mount.base_m),
            after.translation.vector,
        ),
        FrameNumber::three(subject.key("mount.base_deg"), NumberUnit::Degrees, Some(mount.base_deg), angles_deg),
        FrameNumber::three(subject.key("rcm.trocar_m"), NumberUnit::Metres, Some(rcm.trocar_m), trocar_m),
        FrameNumber::three(subject.key("rcm.inward"), NumberUnit::One, Some(rcm.inward), moved.rotation * rcm.inward),
    ];
    // The drawing shows the table in the frame of the base in which it was touched.
    (numbers, FrameEffect { before: Some(before.inverse()), after: found.from_table.pose() })
}

fn view(
    found: &ViewResult,
    subject: &FrameSubject,
    seen_view: Option<UnitQuaternion<f64>>,
) -> (Vec<FrameNumber>, FrameEffect) {
    let teleoperation = &subject.teleoperation;
    if found.carrier == Carrier::Handle {
        let before = teleoperation.view_from_leader();
        let after = found.from_view().inverse();
        let key = "teleoperation.view_from_leader_deg".to_owned();
        let angles_deg = to_roll_pitch_yaw_deg(&after);
        let number = FrameNumber::three(key, NumberUnit::Degrees, teleoperation.view_from_leader_deg, angles_deg);
        return (vec![number], FrameEffect::of_turns(before, after));
    }
    let after = subject.arm.world_from_base.rotation * found.from_view();
    // With a marker on the endoscope, the rig file contains the rotation of the image relative to the marker.
    if let (Some(endoscope), Some(seen)) = (&subject.endoscope, seen_view) {
        let n_from_view = from_roll_pitch_yaw_deg(&endoscope.n_from_view_deg) * seen.inverse() * after;
        let key = "devices.endoscope.n_from_view_deg".to_owned();
        let angles_deg = to_roll_pitch_yaw_deg(&n_from_view);
        let number = FrameNumber::three(key, NumberUnit::Degrees, Some(endoscope.n_from_view_deg), angles_deg);
        return (vec![number], FrameEffect::of_turns(seen, after));
    }
    let before_deg = teleoperation.world_from_view_deg;
    let key = "teleoperation.world_from_view_deg".to_owned();
    let number = FrameNumber::three(key, NumberUnit::Degrees, Some(before_deg), to_roll_pitch_yaw_deg(&after));
    (vec![number], FrameEffect::of_turns(from_roll_pitch_yaw_deg(&before_deg), after))
}

/// Returns a mount that agrees stays: a design drawing gives an angle more accurately than a weight.
fn mount(found: &SensorMountResult, subject: &FrameSubject) -> (Vec<FrameNumber>, FrameEffect) {
    let before = subject.arm.flange_from_s1;
    let after = found.flange_from_s1();
    let effect = FrameEffect::of_turns(before.rotation, after);
    if found.agrees() {
        return (Vec::new(), effect);
    }
    let before_deg = subject.set.mount.sensor_deg;
    let key = subject.key("mount.sensor_deg");
    let mut numbers =
        vec![FrameNumber::three(key, NumberUnit::Degrees, Some(before_deg), to_roll_pitch_yaw_deg(&after))];
    numbers.extend(marker_stays(subject, &Isometry3::from_parts(before.translation, after)));
    (numbers, effect)
}
