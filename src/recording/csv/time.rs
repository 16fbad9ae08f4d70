//! Times of a recording: seconds, a date with a time, a count since 1970 in any unit, or two columns that belong
//! together (`date+time`, `sec+nanosec`).

use jiff::civil;

use super::{
    RecordingError,
    mapping::ColumnSource,
    rate_hz,
    table::{CsvColumn, CsvTable},
};

const NS_PER_S: f64 = 1e9;
const DAY_NS: i64 = 86_400 * 1_000_000_000;
/// Units of a count since 1970, with the number of ns.
const UNITS: [(&str, i64); 4] = [("s", 1_000_000_000), ("ms", 1_000_000), ("us", 1000), ("ns", 1)];
/// Years 2000 to 2100, s since 1970.
const SINCE_1970_S: std::ops::Range<f64> = 946_684_800.0..4_102_444_800.0;
/// Rates of a recording that are usual, Hz.
const USUAL_HZ: std::ops::RangeInclusive<f64> = 0.5..=100_000.0;

pub(super) struct TimeColumn {
    first: CsvColumn,
    /// The time of day, or the fraction of the second.
    second: Option<CsvColumn>,
    scale: f64,
}

/// One row's time, s or ns.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Moment {
    Number {
        value: f64,
        whole: Option<i64>,
    },
    /// Time of a day or of the calendar, ns.
    Clock(i64),
}

/// The times of the rows read so far.
#[derive(Default)]
pub(super) struct Times {
    ends: Option<[Moment; 2]>,
    /// As given for plain seconds, else since the first row in the column's unit.
    rows: Vec<f64>,
    /// Unit of a count since 1970.
    unit: Option<(&'static str, i64)>,
    /// Days passed since the first row, where only times of day are given.
    days: i64,
}

impl TimeColumn {
    /// Finds the column, or the two columns `A+B`.
    pub(super) fn find(table: &CsvTable, source: &ColumnSource, cure: &str) -> Result<Self, RecordingError> {
        let name = source.column();
        let part = |column: &str| table.column(&ColumnSource::plain(column.trim()), "time", cure);
        let (first, second) = match name.split_once('+') {
            Some((first, second)) if !table.has(name) => (part(first)?, Some(part(second)?)),
            _ => (part(name)?, None),
        };
        Ok(Self { first, second, scale: source.scale() })
    }

    /// Returns the unit of a count since 1970 that is not in seconds; a given scale counts more.
    fn unit_of(&self, first: Moment) -> Option<(&'static str, i64)> {
        let Moment::Number { value, .. } = first else { return None };
        #[expect(clippy::float_cmp, reason = "the default, when no scale was given")]
        let is_free = self.scale == 1.0;
        let is_it = |(_, unit_ns): &&(&str, i64)| SINCE_1970_S.contains(&(value * *unit_ns as f64 / NS_PER_S));
        UNITS[1..].iter().find(is_it).filter(|_| is_free).copied()
    }

    fn read(&self, table: &CsvTable) -> Result<Moment, RecordingError> {
        let text = table.field(&self.first);
        let Some(second) = &self.second else {
            return moment(table, text).ok_or_else(|| table.not_a_time(&self.first));
        };
        let other = table.field(second);
        if let Some(date) = date(text) {
            let time = time_of_day(other).ok_or_else(|| table.not_a_time(second))?;
            return Ok(Moment::Clock(date + time));
        }
        let seconds: i64 = text.parse().map_err(|_| table.not_a_time(&self.first))?;
        let fraction: i64 = other.parse().map_err(|_| table.not_a_time(second))?;
        let unit_ns = UNITS[1..].iter().find(|(unit, _)| names_unit(second.name(), unit)).map_or(1, |(_, ns)| *ns);
        let fraction_ns = fraction.checked_mul(unit_ns).filter(|ns| (0..UNITS[0].1).contains(ns));
        let at_ns = seconds.checked_mul(UNITS[0].1).zip(fraction_ns).map(|(whole_ns, rest_ns)| whole_ns + rest_ns);
        at_ns.map(Moment::Clock).ok_or_else(|| table.not_a_time(second))
    }
}

/// Returns whether a column of fractions is named after this unit; nanoseconds are the default.
fn names_unit(name: &str, unit: &str) -> bool {
    let name = name.to_ascii_lowercase();
    let long = match unit {
        "ms" => "milli",
        "us" => "micro",
        _ => "nano",
    };
    name.contains(long) || name.ends_with(&format!("_{unit}")) || name.starts_with("usec") && unit == "us"
}

fn moment(table: &CsvTable, text: &str) -> Option<Moment> {
    if let Some(value) = table.parsed(text) {
        return Some(Moment::Number { value, whole: text.parse().ok() });
    }
    date_and_time(text).or_else(|| time_of_day(text)).map(Moment::Clock)
}

/// Parses ISO 8601, ns since 1970; without a zone as if in UTC, because only differences count.
fn date_and_time(text: &str) -> Option<i64> {
    let text = text.replace(',', ".");
    let at = text.parse::<jiff::Timestamp>().ok().and_then(|at| at.as_nanosecond().try_into().ok());
    at.or_else(|| text.parse::<civil::DateTime>().ok().and_then(nanoseconds))
}

fn nanoseconds(at: civil::DateTime) -> Option<i64> {
    at.to_zoned(jiff::tz::TimeZone::UTC).ok()?.timestamp().as_nanosecond().try_into().ok()
}

/// Parses `2026-11-28` or `28.11.2026`, ns since 1970. Dates with `/` are refused: their order differs between
/// countries.
fn date(text: &str) -> Option<i64> {
    let date = text.parse::<civil::Date>().ok().filter(|_| text.contains('-')).or_else(|| {
        let mut parts = text.split('.');
        let mut part = || parts.next()?.parse::<i16>().ok();
        let [day, month, year] = [part()?, part()?, part()?];
        civil::Date::new(year, month.try_into().ok()?, day.try_into().ok()?).ok()
    })?;
    nanoseconds(date.to_datetime(civil::Time::midnight()))
}

/// Parses `07:25:56.125`, ns since midnight.
fn time_of_day(text: &str) -> Option<i64> {
    let text = text.replace(',', ".");
    let time = text.parse::<civil::Time>().ok().filter(|_| text.contains(':'))?;
    let at = civil::Date::constant(1970, 1, 1).to_datetime(time);
    nanoseconds(at)
}

impl Times {
    /// Reads the time of the current row.
    ///
    /// # Errors
    /// [`RecordingError`] for a field that is not a time, and for a time that does not increase.
    pub(super) fn read(&mut self, table: &CsvTable, column: &TimeColumn) -> Result<(), RecordingError> {
        let mut now = column.read(table)?;
        let Some([first, last]) = self.ends else {
            self.unit = column.unit_of(now);
            self.ends = Some([now; 2]);
            self.rows.push(if self.is_since_first(now) { 0.0 } else { seconds(now, column.scale) });
            return Ok(());
        };
        if let (Moment::Clock(now_ns), Moment::Clock(last_ns)) = (&mut now, last)
            && column.second.is_none()
            && *now_ns < DAY_NS
        {
            *now_ns += self.days * DAY_NS;
            // A recording over midnight.
            if last_ns - *now_ns > DAY_NS / 2 {
                self.days += 1;
                *now_ns += DAY_NS;
            }
        }
        let scale = self.unit.map_or(column.scale, |(_, unit_ns)| unit_ns as f64 / NS_PER_S);
        let not_a_time = || table.not_a_time(&column.first);
        let step_s = between_s(last, now, scale).ok_or_else(not_a_time)?;
        if step_s <= 0.0 {
            return Err(table.clock(seconds(last, scale), seconds(now, scale), step_s));
        }
        let since_first = if self.is_since_first(now) { between_s(first, now, scale) } else { None };
        self.rows.push(since_first.unwrap_or_else(|| seconds(now, scale)));
        self.ends = Some([first, now]);
        Ok(())
    }

    /// Returns whether times count from the first row, because the float of a moment would lose digits.
    const fn is_since_first(&self, now: Moment) -> bool {
        self.unit.is_some() || matches!(now, Moment::Clock(_))
    }

    /// Returns the newest time, s.
    pub(super) fn last_s(&self) -> f64 {
        self.rows.last().copied().unwrap_or_default()
    }

    /// Checks that the unit of a count gives a usual rate.
    ///
    /// # Errors
    /// [`RecordingError`] if the unit cannot be recognised.
    pub(super) fn check(&self, table: &CsvTable, column: &TimeColumn) -> Result<(), RecordingError> {
        let Some((unit, _)) = self.unit else { return Ok(()) };
        match rate_hz(self.rows.iter().copied()) {
            Some(rate_hz) if !USUAL_HZ.contains(&rate_hz) => Err(table.unknown_unit(&column.first, unit, rate_hz)),
            _ => Ok(()),
        }
    }
}

fn seconds(moment: Moment, scale: f64) -> f64 {
    match moment {
        Moment::Number { value, .. } => value * scale,
        Moment::Clock(ns) => ns as f64 / NS_PER_S,
    }
}

/// Returns the time from one moment to another, s; `None` if they have different forms. Whole numbers are subtracted
/// exactly: a count of ns since 1970 has more digits than a float.
fn between_s(from: Moment, to: Moment, scale: f64) -> Option<f64> {
    match (from, to) {
        (Moment::Number { whole: Some(from), .. }, Moment::Number { whole: Some(to), .. }) => {
            Some((to - from) as f64 * scale)
        }
        (Moment::Number { value: from, .. }, Moment::Number { value: to, .. }) => Some((to - from) * scale),
        (Moment::Clock(from), Moment::Clock(to)) => Some((to - from) as f64 / NS_PER_S),
        _ => None,
    }
}
