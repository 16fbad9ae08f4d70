//! Checks that the fitted tool is one that exists, because a file in other units fits as well as one in N and Nm.

use super::GravityReport;
use crate::units;

/// Maximum mass of a tool, kg: more than the payload of any arm that carries a laparoscopic instrument.
pub(super) const MASS_MAX_KG: f64 = 10.0;
/// Maximum distance of the tool's centre of mass from the sensor, m: the middle of the longest shaft.
pub(super) const LEVER_MAX_M: f64 = 0.5;
/// Usual distances of a centre of mass, m; they reveal a wrong unit.
const LEVER_USUAL_M: std::ops::Range<f64> = 0.005..0.3;
/// Maximum deviation of the fitted mass from the weighed one, as a fraction of it.
const WEIGHED_FRACTION: f64 = 0.1;

/// Returns the reason why the fitted tool cannot be real, with the likely units.
pub(super) fn implausible(report: &GravityReport, weighed_kg: Option<f64>) -> Option<String> {
    let mass_kg = report.mass_kg?;
    if let Some(weighed_kg) = weighed_kg {
        let ratio = mass_kg / weighed_kg;
        if (ratio - 1.0).abs() > WEIGHED_FRACTION {
            return Some(format!(
                "the fitted mass is {mass_kg:.3} kg, but the tool weighs {weighed_kg:.3} kg; {}",
                unit_remedy(units::force_unit(ratio))
            ));
        }
    }
    if mass_kg > MASS_MAX_KG {
        return Some(format!(
            "the fitted mass is {mass_kg:.0} kg, more than an arm can carry ({MASS_MAX_KG} kg); {}",
            unit_remedy(None)
        ));
    }
    let lever_m = report.com_m?.into_iter().map(|axis| axis * axis).sum::<f64>().sqrt();
    (lever_m > LEVER_MAX_M).then(|| {
        let unit = units::lever_units(lever_m, LEVER_USUAL_M).map_or_else(String::new, |units| format!(": probably {units}"));
        format!(
            "the fitted centre of mass is {lever_m:.2} m from the sensor (limit {LEVER_MAX_M} m); enter forces in N and torques in Nm{unit}"
        )
    })
}

fn unit_remedy(unit: Option<&str>) -> String {
    match unit {
        Some(unit) => format!("the forces are probably in {unit}: convert them to N, for example with --map"),
        None => "check that the forces are in N".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};

    use super::super::{
        GravityModel, GravityParameters, GravityPose, GravityReport, GravitySettings, Orientation, TorqueParameters,
        fit,
    };
    use crate::{calibration::Verdict, frames::Wrench};

    /// Fits a tool of 0.25 kg with its centre of mass at 60 mm, whose force and torque are given in other units.
    fn fitted(force: f64, torque: f64, weighed_kg: Option<f64>) -> GravityReport {
        let pose = |i: u32| {
            let turn = f64::from(i);
            let world_from_s1 = UnitQuaternion::from_euler_angles(turn, 0.7 * turn, 1.3 * turn);
            let weight_n = world_from_s1.inverse() * Vector3::new(0.0, 0.0, -0.25 * 9.81);
            let torque_nm = Vector3::new(0.0, 0.0, 0.06).cross(&weight_n);
            let wrench = Wrench { force_n: weight_n * force, torque_nm: torque_nm * torque };
            GravityPose { wrench, has_torque: true, orientation: Orientation::Arm(world_from_s1) }
        };
        let poses: Vec<GravityPose> = (0..14).map(pose).collect();
        fit(&poses, &GravitySettings { weighed_kg, ..GravitySettings::default() }).unwrap()
    }

    #[test]
    fn a_model_in_grams_or_millimetres_is_refused() {
        let model = fitted(1.0, 1.0, None).chosen_fit().unwrap().model;
        assert_eq!(model.fault(), None);
        let GravityParameters::Physical { mass_kg, s1_from_source_wxyz, bias_n, torque } = model.parameters else {
            panic!("{model:?}")
        };
        let com_m = torque.unwrap().com_m.map(|axis| axis * 1e3);
        let torque_mm = torque.map(|torque| TorqueParameters { com_m, ..torque });
        for (mass_kg, torque) in [(mass_kg * 1e3, torque), (mass_kg, torque_mm)] {
            let parameters = GravityParameters::Physical { mass_kg, s1_from_source_wxyz, bias_n, torque };
            assert!(GravityModel { parameters, ..model }.fault().unwrap().contains("within 0 to 10 kg"));
        }
    }

    #[test]
    fn forces_and_torques_in_other_units_are_refused_with_their_unit() {
        for weighed_kg in [None, Some(0.25), Some(0.26)] {
            let good = fitted(1.0, 1.0, weighed_kg);
            assert_eq!(good.verdict, Verdict::Accepted, "{}", good.reason);
        }
        // lbf and lbf·in, as a sensor set to these units sends them.
        let pounds = fitted(0.224_81, 8.850_7, None);
        assert_eq!(pounds.verdict, Verdict::PoorData);
        assert!(
            pounds.reason.contains("centre of mass is 2.36 m") && pounds.reason.contains("lbf·in"),
            "{}",
            pounds.reason
        );
        let weighed = fitted(0.224_81, 0.224_81, Some(0.25));
        assert!(weighed.reason.contains("pounds (lbf)") && weighed.reason.contains("--map"), "{}", weighed.reason);
        let millinewtons = fitted(1000.0, 1000.0, None);
        assert!(millinewtons.reason.contains("250 kg"), "{}", millinewtons.reason);
        let torque_only = fitted(1.0, 1000.0, None);
        assert!(torque_only.reason.contains("N·mm"), "{}", torque_only.reason);
        let other_tool = fitted(1.0, 1.0, Some(0.4));
        assert!(other_tool.reason.contains("0.400 kg"), "{}", other_tool.reason);
        assert_eq!(other_tool.verdict, Verdict::PoorData);
    }
}
