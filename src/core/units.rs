//! Names the units in which a value was probably given, when it is not plausible in SI units.

use std::ops::Range;

/// Factors by which a number in another unit exceeds the one in SI units, with the name of the unit.
type UnitFactors = [(f64, &'static str)];

/// Numbers of one metre.
const LENGTHS: &UnitFactors = &[(1000.0, "mm"), (100.0, "cm"), (39.37, "inches")];
/// Numbers of one newton.
const FORCES: &UnitFactors = &[
    (0.224_81, "pounds (lbf)"),
    (3.596_9, "ounces (ozf)"),
    (0.101_97, "kilograms-force (kgf)"),
    (101.97, "grams-force (gf)"),
    (1000.0, "mN"),
];
/// Numbers of a lever of one metre, computed from a torque and a force.
const LEVERS: &UnitFactors = &[
    (4.448_2, "the force is in pounds (lbf)"),
    (8.850_7, "the torque is in lbf·in"),
    (9.806_65, "the force is in kilograms-force (kgf)"),
    (39.37, "force and torque are in lbf and lbf·in"),
    (1000.0, "the torque is in N·mm"),
];
/// A ratio that deviates from a factor by less than this fraction is that factor: a weighed and a fitted mass agree
/// within a few per cent.
const AGREES: f64 = 0.1;

/// Returns the remedy for a length whose number is too large for metres.
pub fn length_remedy(value: f64, max_m: f64) -> String {
    let units = plausible(LENGTHS, value, 0.0..max_m);
    let hint = units.map_or_else(String::new, |units| format!("; it is probably in {units}"));
    format!("enter metres, at most {max_m} m{hint}")
}

/// Returns the unit of a force whose number is `ratio` times the one in newtons.
pub fn force_unit(ratio: f64) -> Option<&'static str> {
    FORCES.iter().find(|(factor, _)| (ratio / factor - 1.0).abs() < AGREES).map(|(_, unit)| *unit)
}

/// Returns the units that explain a lever outside this range, m.
pub fn lever_units(lever: f64, range_m: Range<f64>) -> Option<String> {
    plausible(LEVERS, lever, range_m)
}

/// Returns the units in which the value is within the range.
fn plausible(units: &UnitFactors, value: f64, range: Range<f64>) -> Option<String> {
    let found: Vec<&str> =
        units.iter().filter(|(factor, _)| range.contains(&(value / factor))).map(|(_, unit)| *unit).collect();
    (!found.is_empty()).then(|| found.join(" or "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_likely_units_are_named() {
        assert_eq!(length_remedy(450.0, 2.0), "enter metres, at most 2 m; it is probably in mm");
        assert_eq!(length_remedy(45.0, 2.0), "enter metres, at most 2 m; it is probably in mm or cm or inches");
        assert_eq!(length_remedy(1e9, 2.0), "enter metres, at most 2 m");
        assert_eq!(force_unit(1.0 / 4.448), Some("pounds (lbf)"));
        assert_eq!(force_unit(1000.0), Some("mN"));
        assert_eq!(force_unit(1.02), None);
        assert!(lever_units(2.4, 0.01..0.1).is_some_and(|units| units.contains("lbf·in")));
        assert_eq!(lever_units(60.0, 0.01..0.4).as_deref(), Some("the torque is in N·mm"));
    }
}
