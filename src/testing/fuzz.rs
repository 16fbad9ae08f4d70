//! Random test loops whose duration the caller sets: `./dev fuzz`.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Calls `round` with successive seeds for `NIMA_FUZZ_SECONDS`, at least once, and returns the number of rounds. The
/// first seed is `NIMA_FUZZ_SEED`, so that a failure can be repeated, or is taken from the clock.
pub fn rounds(round: impl Fn(u64)) -> u64 {
    let report = |name| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let length = Duration::from_secs(report("NIMA_FUZZ_SECONDS").unwrap_or(0));
    let clock = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let begin = Instant::now();
    let first = report("NIMA_FUZZ_SEED").unwrap_or(clock);
    let mut count = 0;
    loop {
        let seed = first.wrapping_add(count);
        println!("NIMA_FUZZ_SEED={seed}");
        round(seed);
        count += 1;
        if begin.elapsed() >= length {
            return count;
        }
    }
}
