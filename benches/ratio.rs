//! What something costs that a user would take instead, as a multiple of what ours costs. `./dev bench` compares these ratios with
//! those of `benches/baseline.toml`: unlike times, they hardly depend on how fast and how busy the computer is.

use std::time::Instant;

/// The ratios alone were asked for.
pub(crate) fn alone() -> bool {
    std::env::args().any(|argument| argument == "--ratios")
}

/// Ours and theirs in turn, so that what disturbs the one disturbs the other; prints the median of the rounds.
pub(crate) fn tell(name: &str, mut ours: impl FnMut(), mut theirs: impl FnMut()) {
    const ROUND_S: f64 = 0.02;
    const ROUNDS: usize = 25;
    let [our_calls, their_calls] = [calls(ROUND_S, &mut ours), calls(ROUND_S, &mut theirs)];
    let round = |_| time_s(their_calls, &mut theirs) / time_s(our_calls, &mut ours);
    print(name, (0..ROUNDS).map(round).collect());
}

/// Prints the median of some ratios, in the form that `./dev bench` reads.
pub(crate) fn print(name: &str, mut ratios: Vec<f64>) {
    ratios.sort_by(f64::total_cmp);
    println!("ratio {name} {:.4}", ratios[ratios.len() / 2]);
}

/// How many calls fill this time, at least one; the caches are warm afterwards.
fn calls(round_s: f64, work: &mut impl FnMut()) -> usize {
    let mut calls = 1;
    while time_s(calls, work) * (calls as f64) < round_s && calls < 1 << 20 {
        calls *= 2;
    }
    calls
}

/// Mean time of a call, s.
fn time_s(calls: usize, work: &mut impl FnMut()) -> f64 {
    let start = Instant::now();
    (0..calls).for_each(|_| work());
    start.elapsed().as_secs_f64() / calls as f64
}
