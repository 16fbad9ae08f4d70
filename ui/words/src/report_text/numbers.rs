//! Texts: numbers.

use crate::language::word;

/// Returns the number with about three digits; large numbers in powers of ten.
pub fn three_digits(value: f64) -> String {
    match value.abs() {
        x if !x.is_finite() => word("not finite", "nicht endlich").to_owned(),
        x if x >= 1e5 => format!("{value:.1e}"),
        x if x >= 100.0 => format!("{value:.0}"),
        x if x >= 10.0 => format!("{value:.1}"),
        x if x >= 1.0 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    }
}

/// Sign for an unknown number.
pub const UNKNOWN: &str = "–";

/// Returns the force (N) with about three digits and its unit, or the sign for an unknown number.
pub fn newtons_in_three(force_n: Option<f64>) -> String {
    force_n.map_or_else(|| UNKNOWN.to_owned(), |force_n| format!("{} N", three_digits(force_n)))
}

/// Returns the force (N) with this many decimals and its unit, or the sign for an unknown number.
pub fn newtons(force_n: Option<f64>, decimals: usize) -> String {
    force_n.map_or_else(|| UNKNOWN.to_owned(), |force_n| format!("{force_n:.decimals$} N"))
}

/// Like [`newtons`], for a screen reader, which does not read the sign.
pub fn newtons_read(force_n: Option<f64>, decimals: usize) -> String {
    if force_n.is_some() { newtons(force_n, decimals) } else { word("unknown", "unbekannt").to_owned() }
}

#[cfg(test)]
mod tests {
    use super::{newtons, newtons_in_three, newtons_read, three_digits};

    #[test]
    fn an_unknown_number_is_never_zero() {
        assert_eq!([newtons(None, 2), newtons(Some(0.0), 2)], ["–", "0.00 N"]);
        assert_eq!([newtons_read(None, 1), newtons_read(Some(1.26), 1)], ["unknown", "1.3 N"]);
        assert_eq!([newtons_in_three(None), newtons_in_three(Some(0.0))], ["–", "0.000 N"]);
    }

    #[test]
    fn numbers_keep_three_digits() {
        let texts = [0.012_34, 1.234, 12.34, 123.4, 1.2e9, f64::NAN].map(three_digits);
        assert_eq!(texts, ["0.012", "1.23", "12.3", "123", "1.2e9", "not finite"]);
    }
}
