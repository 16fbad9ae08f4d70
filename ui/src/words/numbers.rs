//! Texts: numbers.

use crate::language::word;

/// A number with about three digits; large ones in powers of ten.
pub(crate) fn three_digits(value: f64) -> String {
    match value.abs() {
        x if !x.is_finite() => word("not finite", "nicht endlich").to_owned(),
        x if x >= 1e5 => format!("{value:.1e}"),
        x if x >= 100.0 => format!("{value:.0}"),
        x if x >= 10.0 => format!("{value:.1}"),
        x if x >= 1.0 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    }
}

#[cfg(test)]
mod tests {
    use super::three_digits;

    #[test]
    fn numbers_keep_three_digits() {
        let texts = [0.012_34, 1.234, 12.34, 123.4, 1.2e9, f64::NAN].map(three_digits);
        assert_eq!(texts, ["0.012", "1.23", "12.3", "123", "1.2e9", "not finite"]);
    }
}
