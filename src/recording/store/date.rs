//! Dates of records: seconds since 1970 to and from `2026-08-21T10:20:30Z`.

use jiff::Timestamp;

/// Formats seconds since 1970 as ISO 8601, UTC; later times than the year 9999 become its last second.
pub(super) fn format(seconds: u64) -> String {
    let time = i64::try_from(seconds).ok().and_then(|seconds| Timestamp::from_second(seconds).ok());
    time.unwrap_or(Timestamp::MAX).to_string()
}

/// Parses exactly the format that [`format`] writes, years 1970 to 9999; `None` for anything else.
pub(super) fn parse(text: &str) -> Option<u64> {
    let seconds = text.parse::<Timestamp>().ok()?.as_second().try_into().ok()?;
    (format(seconds) == text).then_some(seconds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_moments_read_and_write() {
        for (seconds, text) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (1_787_307_630, "2026-08-21T10:20:30Z"),
            (4_107_542_399, "2100-02-28T23:59:59Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(format(seconds), text);
            assert_eq!(parse(text), Some(seconds));
        }
    }

    #[test]
    fn anything_else_is_no_date() {
        for text in [
            "",
            "2026-08-21",
            "2026-02-29T00:00:00Z",
            "2026-13-01T00:00:00Z",
            "2026-08-21T24:00:00Z",
            "2026-08-21T10:20:30+",
            "+026-08-21T10:20:30Z",
            "1969-12-31T23:59:59Z",
        ] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
