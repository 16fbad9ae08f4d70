use super::*;

fn playout() -> Playout {
    Playout::new(PlayoutSettings::default(), 8)
}

/// Feeds 1 kHz of payloads with these delays (s) and takes the due ones every ms. Returns the delivered numbers with
/// their ages.
fn run(playout: &mut Playout, from: u64, count: u64, delay_s: impl Fn(u64) -> Option<f64>) -> Vec<(u64, f64, bool)> {
    let mut under_way: Vec<(f64, u64)> =
        (from..from + count).filter_map(|i| Some((i as f64 * 1e-3 + delay_s(i)?, i))).collect();
    under_way.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut next = 0;
    let mut got = Vec::new();
    for tick in from..from + count {
        let now_s = tick as f64 * 1e-3;
        while let Some(&(came_s, number)) = under_way.get(next).filter(|(came_s, _)| *came_s <= now_s) {
            playout.insert(number, number as f64 * 1e-3, came_s, true, &number.to_le_bytes());
            next += 1;
        }
        playout.advance(now_s);
        while let Some(payload) = playout.take(now_s, 0.0) {
            assert_eq!(payload.bytes, payload.number.to_le_bytes());
            got.push((payload.number, payload.age_s, payload.is_late));
        }
    }
    got
}

/// Returns a pseudo-random delay between 0 and 5 ms.
fn scattered_s(i: u64) -> f64 {
    (i.wrapping_mul(2_654_435_761) % 1000) as f64 * 5e-6
}

#[test]
fn payloads_come_in_order_once_and_with_an_even_age() {
    let mut playout = playout();
    let got = run(&mut playout, 0, 10_000, |i| Some(20e-3 + scattered_s(i)));
    assert!(got.windows(2).all(|pair| pair[1].0 == pair[0].0 + 1), "in order, none left out");
    assert!(got.iter().all(|&(_, age_s, _)| age_s < 28e-3), "25 ms, margin, a tick");
    let steady = &got[2000..];
    let (min, max) = steady.iter().fold((1.0_f64, 0.0_f64), |(a, b), &(_, age_s, _)| (a.min(age_s), b.max(age_s)));
    assert!(max - min < 1.1e-3, "{min} to {max}");
    assert_eq!(playout.counts().late + playout.counts().lost + playout.counts().stale, 0, "{:?}", playout.counts());
    let delay_s = playout.delay_s().unwrap();
    assert!((delay_s - 25.5e-3).abs() < 0.05e-3, "{delay_s}");
}

#[test]
fn the_percentile_is_that_of_the_last_five_seconds() {
    let mut playout = playout();
    // First 2 in 1000 are late by 30 ms, then none, then less than 1 in 1000.
    run(&mut playout, 0, 6000, |i| Some(if i % 500 == 7 { 40e-3 } else { 10e-3 }));
    assert!((playout.wanted_s().unwrap() - 40.5e-3).abs() < 1e-9);
    run(&mut playout, 6000, 6000, |_| Some(10e-3));
    assert!((playout.wanted_s().unwrap() - 10.5e-3).abs() < 1e-9);
    run(&mut playout, 12_000, 6000, |i| Some(if i % 2500 == 7 { 40e-3 } else { 10e-3 }));
    assert!((playout.wanted_s().unwrap() - 10.5e-3).abs() < 1e-9, "{:?}", playout.wanted_s());
    let delays = playout.delays().unwrap();
    assert!((delays.min_s - 10e-3).abs() < 1e-9 && delays.mean_s < 10.1e-3, "{delays:?}");
}

#[test]
fn a_sudden_rise_is_told_and_the_delay_follows_without_a_step() {
    let mut playout = playout();
    run(&mut playout, 0, 3000, |_| Some(10e-3));
    let before_s = playout.delay_s().unwrap();
    let got = run(&mut playout, 3000, 1000, |_| Some(30e-3));
    assert!(playout.counts().late > 900, "every payload comes after its time: {:?}", playout.counts());
    assert!(got.iter().rev().take(900).all(|&(_, age_s, is_late)| is_late && age_s < 32e-3), "delivered at once");
    let after_s = playout.delay_s().unwrap();
    assert!(after_s > before_s && after_s - before_s <= 1e-3 + 1e-9, "{before_s} to {after_s}");
    run(&mut playout, 4000, 25_000, |_| Some(30e-3));
    assert!((playout.delay_s().unwrap() - 30.5e-3).abs() < 0.1e-3);
    let late = playout.counts().late;
    run(&mut playout, 29_000, 2000, |_| Some(30e-3));
    assert_eq!(playout.counts().late, late);
}

#[test]
fn the_delay_moves_by_one_millisecond_per_second_at_most() {
    let mut playout = playout();
    let mut last = None;
    for tick in 0..40_000_u64 {
        let now_s = tick as f64 * 1e-3;
        let delay_s = 0.02 + if (tick / 4000) % 2 == 0 { 0.0 } else { 0.05 } + scattered_s(tick);
        playout.insert(tick, now_s - delay_s, now_s, true, b"");
        playout.advance(now_s);
        while playout.take(now_s, 0.0).is_some() {}
        if let Some((then, now)) = last.zip(playout.delay_s()) {
            let moved_s: f64 = now - then;
            assert!(moved_s.abs() <= 1e-6 + 1e-12, "{moved_s} in a tick");
        }
        last = playout.delay_s();
    }
}

#[test]
fn duplicates_reordering_and_loss_are_counted_and_harmless() {
    let mut playout = playout();
    let got = run(&mut playout, 0, 5000, |i| (i % 10 != 3).then_some(10e-3 + if i % 7 == 0 { 4e-3 } else { 0.0 }));
    for back in 1..50 {
        playout.insert(4950 - back, 0.0, 5.0, true, b"again");
    }
    assert!(playout.take(5.0, 0.0).is_none_or(|payload| payload.number > 4900));
    let numbers: Vec<u64> = got.iter().map(|&(number, ..)| number).collect();
    assert!(numbers.windows(2).all(|pair| pair[0] < pair[1]));
    let counts = playout.counts();
    assert!((480..=500).contains(&counts.lost), "{counts:?}");
    assert!(counts.stale <= 5, "the missing ones among the fifty: {counts:?}");
}

#[test]
fn without_waiting_each_comes_at_once_and_never_after_a_newer_one() {
    let settings = PlayoutSettings { waits: false, ..PlayoutSettings::default() };
    let mut playout = Playout::new(settings, 8);
    let got = run(&mut playout, 0, 2000, |i| Some(1e-3 + if i % 5 == 0 { 2.5e-3 } else { 0.0 }));
    assert!(got.windows(2).all(|pair| pair[0].0 < pair[1].0));
    let counts = playout.counts();
    assert!((380..=400).contains(&counts.stale) && counts.late == 0, "overtaken: {counts:?}");
    assert_eq!(playout.delay_s(), None);
}

#[test]
fn a_step_of_the_clock_moves_no_payload() {
    let mut playout = playout();
    run(&mut playout, 0, 3000, |_| Some(10e-3));
    let before_s = playout.delay_s().unwrap();
    playout.clock_stepped(50e-3);
    assert!((playout.delay_s().unwrap() - (before_s - 50e-3)).abs() < 1e-12);
    // From now on their time stamps are 50 ms higher.
    let mut late = 0;
    for tick in 3000..4000_u64 {
        let now_s = tick as f64 * 1e-3;
        playout.insert(tick, now_s - 10e-3 + 50e-3, now_s, true, b"");
        playout.advance(now_s);
        while let Some(payload) = playout.take(now_s, 50e-3) {
            late += u32::from(payload.is_late);
            assert!((payload.age_s - 11e-3).abs() < 1e-3, "{payload:?}");
        }
    }
    assert_eq!(late, 0);
}

#[test]
fn a_gap_longer_than_the_room_and_hostile_numbers_do_no_harm() {
    let mut playout = playout();
    run(&mut playout, 0, 1000, |_| Some(1e-3));
    for number in [1_000_000, 5, u64::from(u32::MAX), 1_000_001, 0, 1 << 40] {
        playout.insert(number, 1.0, 1.0, true, b"x");
        playout.insert(number, f64::NAN, 1.0, true, b"x");
        playout.insert(number, 1.0, 1.0, true, b"far too long");
        playout.advance(1.1);
        while playout.take(2.0, 0.0).is_some() {}
    }
    assert_eq!(playout.end(), (1 << 40) + 1);
}
