//! Texts about a disk that is filling up.

use std::time::Duration;

use crate::language::text_format;

pub fn disk_full_in(time: Duration) -> String {
    let minutes = time.as_secs_f64() / 60.0;
    let lasts = if minutes < 120.0 { format!("{minutes:.0} min") } else { format!("{:.0} h", minutes / 60.0) };
    text_format!("at this rate the disk will be full in {lasts}", "bei dieser Rate ist der Datenträger in {lasts} voll")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_is_told_in_hours_and_near_the_end_in_minutes() {
        let words = |minutes| disk_full_in(Duration::from_mins(minutes));
        assert_eq!(words(17 * 60 + 20), "at this rate the disk will be full in 17 h");
        assert_eq!(words(40), "at this rate the disk will be full in 40 min");
    }
}
