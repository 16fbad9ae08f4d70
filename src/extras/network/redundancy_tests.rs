use super::*;
use crate::wire;

#[test]
fn the_history_gives_the_last_payloads_newest_first() {
    let mut history = RedundancyHistory::new(16);
    let mut room = [0; 100];
    assert_eq!(history.write(4, 1, 0.0, &mut room, 100), DatagramContent::default());
    for i in 0..40_u8 {
        assert!(history.add(&[i; 5], f64::from(i) * 1e-3));
    }
    assert!(!history.add(&[0; 17], 0.0));
    let written = history.write(4, 1, 0.040, &mut room, 100);
    // Two bytes each for length and age, three from 3 ms on.
    assert_eq!(written, DatagramContent { bytes: 30, records: 4, carried: 4 });
    let mut rest = &room[..30];
    for i in (36..40).rev() {
        let (record, more) = wire::record(rest).unwrap();
        assert_eq!(record.bytes, Some(&[i; 5][..]));
        assert!((record.age_s - (0.040 - f64::from(i) * 1e-3)).abs() < 1e-9);
        rest = more;
    }
    assert_eq!(history.write(30, 1, 0.040, &mut room, 100).records, 12, "as many as there is room for");
    assert_eq!(history.write(30, 1, 0.040, &mut room, 50).records, 6, "copies leave the rest free");
    assert_eq!(history.write(30, 8, 0.040, &mut room, 50).records, 8, "what was not sent yet may use it");
    assert_eq!(history.write(30, 1, 5.0, &mut room, 100), DatagramContent::default(), "too old to be of use");
}

#[test]
fn a_long_payload_does_not_cost_the_short_ones_their_copies() {
    let mut history = RedundancyHistory::new(64);
    let mut room = [0; 200];
    for i in 0..8_u8 {
        history.add(&[i; 60][..if i == 5 { 60 } else { 5 }], f64::from(i) * 1e-3);
    }
    assert_eq!(history.longest(), 60);
    let all = history.write(8, 1, 0.008, &mut room, 200);
    assert_eq!((all.records, all.carried), (8, 8), "where there is room for all, all are carried");
    let few = history.write(8, 1, 0.008, &mut room, 100);
    assert_eq!((few.records, few.carried), (8, 7), "its place is kept");
    let fresh = history.write(8, 3, 0.008, &mut room, 100);
    assert_eq!((fresh.records, fresh.carried), (5, 5), "before it was sent it comes first");
}

fn measured(lost: impl Fn(u64) -> bool, count: u64) -> Losses {
    let mut losses = Losses::default();
    for number in (0..count).filter(|&number| !lost(number)) {
        losses.add(number, number as f64 * 1e-3);
    }
    losses
}

#[test]
fn loss_is_measured_and_gives_the_number_of_copies() {
    let mut rng = fastrand::Rng::with_seed(3);
    let random: Vec<f64> = (0..20_000).map(|_| rng.f64()).collect();
    for (loss, min, max) in [(0.0, 1, 0), (0.01, 2, 3), (0.1, 4, 5), (0.3, 8, 9)] {
        let losses = measured(|number| random[number as usize] < loss, 20_000);
        let (fraction, again) = losses.fractions();
        assert!((fraction - loss).abs() < 0.06, "{fraction} of {loss}");
        let copies = copies_for(fraction, again);
        assert!((min..=max + 1).contains(&copies), "{copies} copies at {loss}: {fraction} {again}");
        let (all, lost) = losses.totals();
        assert!(all > 19_900 && (lost as f64 / all as f64 - loss).abs() < 0.01);
    }
}

#[test]
fn bursts_need_more_copies_and_reordering_is_no_loss() {
    let bursts = measured(|number| number % 100 < 10, 20_000);
    let (fraction, again) = bursts.fractions();
    assert!((fraction - 0.1).abs() < 0.02 && again > 0.8, "{fraction} {again}");
    assert!(copies_for(fraction, again) > 20);
    let mut losses = Losses::default();
    for number in 0..10_000_u64 {
        losses.add(number ^ 31, number as f64 * 1e-3);
        losses.add(number, number as f64 * 1e-3);
    }
    assert!(losses.fractions().0 <= 0.0);
}

#[test]
fn a_bad_link_is_noticed_within_a_second_and_forgotten_after_five() {
    let mut losses = Losses::default();
    let mut noticed = None;
    for number in 0..20_000_u64 {
        let is_bad = (5000..6000).contains(&number);
        if !is_bad || number % 3 != 0 {
            losses.add(number, number as f64 * 1e-3);
        }
        if noticed.is_none() && losses.fractions().0 > 0.2 {
            noticed = Some(number);
        }
    }
    assert!((5000..6000).contains(&noticed.unwrap()), "{noticed:?}");
    assert!(losses.fractions().0 <= 0.0);
}

#[test]
fn an_outage_asks_for_no_copies() {
    for outage in [500, 5000, 1_000_000_u64] {
        let losses = measured(|number| (3000..3000 + outage).contains(&number), 4000 + outage);
        assert!(losses.fractions().0 < 0.01, "{outage}: {:?}", losses.fractions());
        assert!(losses.totals().1 >= outage - 64, "all the same it is counted");
    }
}
