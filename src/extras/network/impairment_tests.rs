use super::*;

fn fates(settings: ImpairmentSettings, count: u32) -> Vec<(f64, DeliveryTimes)> {
    let mut impairment = Impairment::new(settings, 5);
    (0..count).map(|i| f64::from(i) * 1e-3).map(|now_s| (now_s, impairment.pass(now_s, 125))).collect()
}

fn lost_fraction(fates: &[(f64, DeliveryTimes)]) -> f64 {
    fates.iter().filter(|(_, fate)| fate[0].is_none()).count() as f64 / fates.len() as f64
}

#[test]
fn the_same_seed_gives_the_same_line() {
    let settings = ImpairmentSettings {
        delay_s: 0.01,
        jitter: ImpairmentJitter::Pareto { mean_s: 0.01, shape: 3.0 },
        loss: LossModel::Bursts { fraction: 0.1, burst_s: 0.05 },
        duplicate: 0.1,
        reorder: 0.1,
        reorder_s: 0.01,
        ..ImpairmentSettings::default()
    };
    assert_eq!(fates(settings, 10_000), fates(settings, 10_000));
    assert!(settings.check().is_ok());
}

#[test]
fn delay_and_jitter_are_those_asked_for() {
    for (jitter, mean_s) in [
        (ImpairmentJitter::None, 0.0),
        (ImpairmentJitter::Normal { deviation_s: 5e-3 }, 5e-3 * 0.7979),
        (ImpairmentJitter::Pareto { mean_s: 5e-3, shape: 3.0 }, 5e-3),
    ] {
        let settings = ImpairmentSettings { delay_s: 0.05, jitter, overtakes: true, ..ImpairmentSettings::default() };
        let delays: Vec<f64> = fates(settings, 100_000).iter().map(|(now_s, fate)| fate[0].unwrap() - now_s).collect();
        let mean = delays.iter().sum::<f64>() / delays.len() as f64;
        assert!((mean - 0.05 - mean_s).abs() < 0.2e-3, "{jitter:?}: {mean}");
        assert!(delays.iter().all(|&delay_s| delay_s > 0.05 - 1e-9));
        let queue = ImpairmentSettings { overtakes: false, ..settings };
        let arrivals: Vec<f64> = fates(queue, 100_000).iter().filter_map(|(_, fate)| fate[0]).collect();
        assert!(arrivals.windows(2).all(|pair| pair[0] <= pair[1]), "in order");
    }
}

#[test]
fn loss_is_that_asked_for_and_bursts_are_as_long_as_asked_for() {
    let independent = fates(
        ImpairmentSettings { loss: LossModel::Independent { fraction: 0.3 }, ..ImpairmentSettings::default() },
        100_000,
    );
    assert!((lost_fraction(&independent) - 0.3).abs() < 0.01);
    for burst_s in [0.01, 0.05, 0.2] {
        let settings =
            ImpairmentSettings { loss: LossModel::Bursts { fraction: 0.1, burst_s }, ..ImpairmentSettings::default() };
        let fates = fates(settings, 1_000_000);
        assert!((lost_fraction(&fates) - 0.1).abs() < 0.02, "{}", lost_fraction(&fates));
        let runs = fates.windows(2).filter(|pair| pair[0].1[0].is_none() && pair[1].1[0].is_some()).count();
        let mean_s = lost_fraction(&fates) * fates.len() as f64 * 1e-3 / runs as f64;
        assert!((mean_s - burst_s).abs() < 0.2 * burst_s, "{mean_s} of {burst_s}");
    }
}

#[test]
fn outages_come_at_their_times() {
    let fates = fates(ImpairmentSettings { flap: Some(OUTAGES), ..ImpairmentSettings::default() }, 40_000);
    for (now_s, fate) in fates {
        let place_s = now_s % 4.0;
        if (place_s - 3.2).abs() > 1e-6 && place_s > 1e-6 && place_s < 4.0 - 1e-6 {
            assert_eq!(fate[0].is_none(), place_s > 3.2, "{now_s}");
        }
    }
}

#[test]
fn the_rate_is_limited_with_a_short_queue() {
    // 1 Mbit/s of datagrams through half that rate.
    let settings = ImpairmentSettings { rate_bit_s: 0.5e6, queue_s: 0.02, ..ImpairmentSettings::default() };
    let fates = fates(settings, 10_000);
    assert!((lost_fraction(&fates) - 0.5).abs() < 0.02, "{}", lost_fraction(&fates));
    let longest_s = fates.iter().filter_map(|(now_s, fate)| Some(fate[0]? - now_s)).fold(0.0, f64::max);
    assert!((0.02..0.024).contains(&longest_s), "{longest_s}");
}

#[test]
fn reordering_and_duplicates_come_as_often_as_asked_for() {
    let settings = ImpairmentSettings {
        delay_s: 0.01,
        reorder: 0.1,
        reorder_s: 0.005,
        duplicate: 0.2,
        ..ImpairmentSettings::default()
    };
    let mut line = ImpairedLine::new(settings, 9);
    let mut numbers = Vec::new();
    for i in 0..20_000_u32 {
        line.send(f64::from(i) * 1e-3, &i.to_le_bytes());
        while let Some((due_s, bytes)) = line.receive(f64::from(i) * 1e-3) {
            assert!(due_s <= f64::from(i) * 1e-3);
            numbers.push(u32::from_le_bytes(bytes.try_into().unwrap()));
        }
    }
    let back = numbers.windows(2).filter(|pair| pair[1] < pair[0]).count() as f64 / numbers.len() as f64;
    let twice = numbers.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64 / numbers.len() as f64;
    assert!((0.05..0.11).contains(&back), "{back}");
    assert!((0.13..0.18).contains(&twice), "{twice}");
    assert_eq!(line.totals(), (20_000, 0));
}

#[test]
fn settings_are_read_and_what_cannot_be_is_told() {
    let text = "delay_s = 0.05\njitter = { normal = { deviation_s = 0.005 } }\nloss = { bursts = { share = 0.1, burst_s = 0.05 } }\nflap = { down_s = 1.0, every_s = 5.0 }\n";
    let settings: ImpairmentSettings = toml::from_str(text).unwrap();
    assert_eq!(settings.loss, LossModel::Bursts { fraction: 0.1, burst_s: 0.05 });
    assert!(settings.check().is_ok());
    assert!(toml::from_str::<ImpairmentSettings>("delya_s = 1").is_err());
    let wrong = [
        ImpairmentSettings { delay_s: f64::NAN, ..settings },
        ImpairmentSettings { duplicate: 1.5, ..settings },
        ImpairmentSettings { jitter: ImpairmentJitter::Pareto { mean_s: 0.1, shape: 0.5 }, ..settings },
        ImpairmentSettings { flap: Some(Flap { down_s: 5.0, every_s: 5.0 }), ..settings },
        ImpairmentSettings { rate_bit_s: -1.0, ..settings },
    ];
    for settings in wrong {
        let report = settings.check().unwrap_err();
        assert!(report.contains(" = ") && report.contains(": it ") || report.contains("share"), "{report}");
    }
}
