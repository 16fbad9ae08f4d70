//! The cost of an alternative as a multiple of our cost. `./dev bench` compares these ratios with those in
//! `benches/baseline.toml`. Unlike times, they hardly depend on the speed of the computer, nor on other users, because
//! only the time counts in which the thread has a processor.

/// Returns whether only the ratios were requested.
pub(crate) fn alone() -> bool {
    std::env::args().any(|argument| argument == "--ratios")
}

/// Runs our version and theirs alternately, so that a disturbance affects both; prints the median of the rounds.
pub(crate) fn report(name: &str, mut ours: impl FnMut(), mut theirs: impl FnMut()) {
    const ROUND_S: f64 = 0.02;
    const ROUNDS: usize = 25;
    let [our_calls, their_calls] = [calls(ROUND_S, &mut ours), calls(ROUND_S, &mut theirs)];
    let round = |_| time_s(their_calls, &mut theirs) / time_s(our_calls, &mut ours);
    let mut ratios: Vec<f64> = (0..ROUNDS).map(round).collect();
    ratios.sort_by(f64::total_cmp);
    println!("ratio {name} {:.4}", ratios[ROUNDS / 2]);
}

/// Returns the number of calls that fit into this time, at least one. Warms the caches.
fn calls(round_s: f64, work: &mut impl FnMut()) -> usize {
    let mut calls = 1;
    while time_s(calls, work) * (calls as f64) < round_s && calls < 1 << 20 {
        calls *= 2;
    }
    calls
}

/// Returns the mean time of a call, s.
fn time_s(calls: usize, work: &mut impl FnMut()) -> f64 {
    let start_s = processor_s();
    (0..calls).for_each(|_| work());
    (processor_s() - start_s) / calls as f64
}

/// Returns how long this thread has had a processor, s.
#[cfg(unix)]
#[expect(unsafe_code, reason = "the standard library does not report it")]
fn processor_s() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `time` is a valid `timespec` that outlives the call.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// On other systems all time counts.
#[cfg(not(unix))]
fn processor_s() -> f64 {
    static START: std::sync::LazyLock<std::time::Instant> = std::sync::LazyLock::new(std::time::Instant::now);
    START.elapsed().as_secs_f64()
}
