use super::*;
use crate::impairment::{Flap, ImpairedLine, ImpairmentJitter, ImpairmentSettings, LossModel};

/// Two streams with a line in each direction, on a virtual clock of 1 kHz.
struct Link {
    ends: [Box<NetworkStream>; 2],
    /// Lines from each end to the other.
    lines: [ImpairedLine; 2],
    /// Payloads received by each end: number and age (s).
    got: [Vec<(u64, f64)>; 2],
    steps: [u32; 2],
    /// The second end's clock minus the true one, s.
    offset_s: f64,
    tick: u32,
    len: usize,
    /// Length of every tenth payload.
    tenth_len: usize,
}

impl Link {
    fn new(settings: ImpairmentSettings, stream: StreamSettings, len: usize) -> Self {
        let (one, other) = NetworkStream::pair(&stream).unwrap();
        let lines = [ImpairedLine::new(settings, 1), ImpairedLine::new(settings, 2)];
        Self {
            ends: [Box::new(one), Box::new(other)],
            lines,
            got: [vec![], vec![]],
            steps: [0; 2],
            offset_s: 100.0,
            tick: 0,
            len,
            tenth_len: len,
        }
    }

    fn run(&mut self, length_s: f64) {
        let mut datagram = [0; DATAGRAM_MAX];
        for _ in 0..(length_s * 1e3) as u32 {
            let now_s = f64::from(self.tick) * 1e-3;
            self.tick += 1;
            for i in 0..2 {
                let local_s = now_s + if i == 1 { self.offset_s } else { 0.0 };
                while let Some((came_s, bytes)) = self.lines[1 - i].receive(now_s) {
                    let arrived_s = came_s - now_s + local_s;
                    if let Ok(accepted) = self.ends[i].receive(&bytes, arrived_s) {
                        self.steps[i] += u32::from(accepted.step.is_some());
                    }
                }
                let is_tenth = self.ends[i].payloads().is_multiple_of(10);
                let mut payload = vec![i as u8; if is_tenth { self.tenth_len } else { self.len }];
                payload[..8].copy_from_slice(&self.ends[i].payloads().to_le_bytes());
                if let SendResult::Datagram(len) = self.ends[i].send(local_s, Some(&payload), 0, &mut datagram) {
                    self.lines[i].send(now_s, &datagram[..len]);
                }
                self.ends[i].advance(local_s);
                while let Some(payload) = self.ends[i].take(local_s) {
                    assert_eq!(payload.bytes[..8], payload.number.to_le_bytes(), "content and number belong together");
                    assert!(payload.bytes[8..].iter().all(|&byte| byte == 1 - i as u8));
                    self.got[i].push((payload.number, payload.age_s));
                }
            }
        }
    }

    fn figures(&self, i: usize) -> SessionMeasurements {
        self.ends[i].figures(f64::from(self.tick) * 1e-3 + if i == 1 { self.offset_s } else { 0.0 })
    }
}

fn stream(rate_max_bit_s: f64) -> StreamSettings {
    StreamSettings { payload_max: 64, rate_max_bit_s, ..StreamSettings::default() }
}

#[test]
fn a_good_line_loses_nothing_and_knows_its_delay() {
    let settings = ImpairmentSettings {
        delay_s: 5e-3,
        jitter: ImpairmentJitter::Normal { deviation_s: 0.3e-3 },
        ..ImpairmentSettings::default()
    };
    let mut link = Link::new(settings, stream(1e6), 40);
    link.run(10.0);
    for i in 0..2 {
        assert!(link.got[i].windows(2).all(|pair| pair[1].0 == pair[0].0 + 1));
        assert!(link.got[i].len() > 9800, "{}", link.got[i].len());
        let figures = link.figures(i);
        assert_eq!((figures.counts.lost, figures.datagrams_lost, figures.steps), (0, 0, 0), "{figures:?}");
        let delays = figures.one_way.unwrap();
        assert!((delays.min_s - 5e-3).abs() < 0.2e-3 && figures.jitter_s().unwrap() < 1.5e-3, "{delays:?}");
        let playout_s = figures.playout_s.unwrap();
        assert!((playout_s - delays.p999_s - 0.5e-3).abs() < 0.1e-3, "{figures:?}");
        let clock = figures.clock.unwrap();
        let true_s = if i == 0 { 100.0 } else { -100.0 };
        assert!((clock.offset_s - true_s).abs() < 0.2e-3 && (clock.bound_s - 5e-3).abs() < 0.2e-3, "{clock:?}");
        assert!(figures.sent.rate_bit_s < 1.001e6, "{:?}", figures.sent);
        // Taking a payload in the tick in which it is due adds up to one tick.
        let steady = link.got[i].iter().skip(2000);
        assert!(steady.clone().all(|&(_, age_s)| (0.0..1.4e-3).contains(&(age_s - playout_s))), "{playout_s}");
    }
}

#[test]
fn a_third_of_the_datagrams_lost_costs_next_to_no_payload() {
    let loss = LossModel::Independent { fraction: 0.3 };
    let settings = ImpairmentSettings { delay_s: 20e-3, loss, ..ImpairmentSettings::default() };
    let mut link = Link::new(settings, stream(4e6), 32);
    link.run(3.0);
    let before = link.figures(0).counts;
    link.run(60.0);
    let figures = link.figures(0);
    let lost = figures.counts.lost - before.lost;
    let all = figures.counts.delivered - before.delivered;
    println!("lost {lost} of {all}; {:?}, loss {:.3}", figures.copies, figures.loss);
    assert!((0.25..0.36).contains(&figures.loss) && (0.25..0.36).contains(&figures.loss_there));
    assert!((8..=11).contains(&figures.copies.wanted) && figures.copies.limit == Limit::None, "{:?}", figures.copies);
    assert!((lost as f64) < 5e-4 * all as f64, "lost {lost} of {all}");
    assert!(figures.counts.recovered > 15_000);
    assert!(figures.sent.rate_bit_s < 4e6);
}

#[test]
fn the_limit_of_the_rate_is_kept_and_named() {
    let settings =
        ImpairmentSettings { loss: LossModel::Independent { fraction: 0.3 }, ..ImpairmentSettings::default() };
    for (len, rate_max_bit_s) in [(40, 1e6), (64, 1e6), (60, 0.4e6)] {
        let mut link = Link::new(settings, stream(rate_max_bit_s), len);
        link.run(10.0);
        let figures = link.figures(0);
        assert_eq!(figures.copies.limit, Limit::Rate, "{figures:?}");
        let rate_bit_s = figures.sent.bytes as f64 * 8.0 / 10.0;
        assert!(
            rate_bit_s < rate_max_bit_s + 1e3 && rate_bit_s > 0.8 * rate_max_bit_s,
            "{rate_bit_s} of {rate_max_bit_s}"
        );
        // Payloads that did not fit into the rate on their own are sent with the next one.
        assert!(len == 40 || figures.held > 100, "{figures:?}");
    }
}

/// Data of a follower: its force in every tick, and parameters in every tenth.
#[test]
fn long_payloads_arrive_although_the_rate_has_no_room_for_their_copies() {
    let settings = ImpairmentSettings {
        delay_s: 20e-3,
        loss: LossModel::Independent { fraction: 0.3 },
        ..ImpairmentSettings::default()
    };
    let mut link = Link::new(settings, StreamSettings::of_arms(1), 40);
    link.tenth_len = 350;
    link.run(5.0);
    link.got[0].clear();
    link.run(30.0);
    let figures = link.figures(0);
    let long = link.got[0].iter().filter(|(number, _)| number.is_multiple_of(10)).count();
    let all = link.got[0].len();
    let rate_bit_s = figures.received.rate_bit_s / (1.0 - figures.loss);
    println!("{long} of 3000 long ones, {all} of 30 000 in all, {:?}, {rate_bit_s:.0} bit/s", figures.copies);
    assert!(long > 1900, "{long} of 3000");
    assert!(all > 27_500, "{all} of 30 000");
    assert!(rate_bit_s < 2.1e6, "{rate_bit_s}");
}

#[test]
fn duplicates_reordering_and_jitter_change_nothing_but_the_delay() {
    let settings = ImpairmentSettings {
        delay_s: 10e-3,
        jitter: ImpairmentJitter::Pareto { mean_s: 1e-3, shape: 3.0 },
        overtakes: true,
        reorder: 0.05,
        reorder_s: 3e-3,
        duplicate: 0.2,
        ..ImpairmentSettings::default()
    };
    let mut link = Link::new(settings, stream(2e6), 40);
    link.run(20.0);
    for i in 0..2 {
        let counts = link.figures(i).counts;
        assert!(link.got[i].windows(2).all(|pair| pair[0].0 < pair[1].0), "in order, none twice");
        assert!(counts.lost < 20, "{counts:?}");
        let steady = &link.got[i][5000..];
        let steps = steady.windows(2).filter(|pair| (pair[0].1 - pair[1].1).abs() > 1.1e-3).count();
        assert!(steps < steady.len() / 200, "{steps} uneven ages");
    }
}

#[test]
fn a_step_of_a_clock_is_named_within_a_second_by_both() {
    for by_s in [50e-3, -50e-3, 5e-3] {
        let settings = ImpairmentSettings {
            delay_s: 15e-3,
            jitter: ImpairmentJitter::Normal { deviation_s: 0.5e-3 },
            ..ImpairmentSettings::default()
        };
        let mut link = Link::new(settings, stream(1e6), 40);
        link.run(5.0);
        assert_eq!(link.steps, [0; 2]);
        link.offset_s += by_s;
        link.run(1.0);
        assert_eq!(link.steps, [1; 2], "{by_s}");
        let found = link.ends[0].clock().step().unwrap();
        assert!((found.by_s - by_s).abs() < 1e-3, "{found:?}");
        link.run(3.0);
        let late = link.figures(0).counts.late;
        link.run(3.0);
        assert!(link.figures(0).counts.late - late < 20, "all is as before");
        assert_eq!(link.steps, [1; 2]);
    }
}

#[test]
fn after_an_outage_the_stream_goes_on_where_it_is() {
    let flap = Some(Flap { down_s: 0.8, every_s: 4.0 });
    let settings = ImpairmentSettings { delay_s: 20e-3, flap, ..ImpairmentSettings::default() };
    let mut link = Link::new(settings, stream(1e6), 40);
    link.run(40.0);
    let figures = link.figures(0);
    assert!((7000..8100).contains(&figures.counts.lost), "{:?}", figures.counts);
    assert!(figures.copies.wanted <= 3, "copies do not help: {:?}", figures.copies);
    assert!(link.got[0].iter().all(|&(_, age_s)| age_s < 25e-3), "no old payload is delivered");
    assert!(figures.playout_s.unwrap() < 21e-3, "{figures:?}");
    assert_eq!(figures.steps, 0);
}

#[test]
fn directions_can_differ() {
    let mut link = Link::new(ImpairmentSettings::default(), stream(2e6), 40);
    link.lines[0] = ImpairedLine::new(ImpairmentSettings { delay_s: 30e-3, ..ImpairmentSettings::default() }, 1);
    link.lines[1] = ImpairedLine::new(
        ImpairmentSettings {
            delay_s: 10e-3,
            loss: LossModel::Independent { fraction: 0.1 },
            ..ImpairmentSettings::default()
        },
        2,
    );
    link.run(10.0);
    let [one, other] = [link.figures(0), link.figures(1)];
    assert!(one.loss > 0.08 && one.loss_there < 0.01 && other.loss < 0.01 && other.loss_there > 0.08);
    let clock = one.clock.unwrap();
    assert!((clock.round_trip_s - 40e-3).abs() < 2e-3, "{clock:?}");
    // The delays of the two directions cannot be distinguished; the bound states the maximum error.
    assert!((clock.offset_s - 100.0).abs() <= clock.bound_s, "{clock:?}");
}

/// Sends forged, changed and repeated datagrams of a session; returns how many were accepted.
fn attack(rounds: u32, seed: u64) -> u64 {
    let (mut one, mut other) = NetworkStream::pair(&stream(1e9)).unwrap();
    let mut rng = fastrand::Rng::with_seed(seed);
    let mut datagram = [0; DATAGRAM_MAX];
    let mut kept: Vec<Vec<u8>> = Vec::new();
    let mut accepted = 0;
    let mut payloads = 0_u32;
    for round in 0..rounds {
        let now_s = f64::from(round) * 1e-4;
        if round % 100 == 0 {
            let SendResult::Datagram(len) = one.send(now_s, Some(&[9; 40]), 0, &mut datagram) else {
                panic!("not sent")
            };
            other.receive(&datagram[..len], now_s).expect("the true one");
            kept.push(datagram[..len].to_vec());
            if kept.len() > 4000 {
                kept.remove(0);
            }
            other.advance(now_s);
            while other.take(now_s).is_some() {
                payloads += 1;
            }
        }
        let mut forged = kept[rng.usize(..kept.len())].clone();
        match rng.u32(..5) {
            0 => {}
            1 => {
                let at = rng.usize(6..forged.len());
                forged[at] ^= 1 << rng.u32(..8);
            }
            2 => forged.truncate(rng.usize(..forged.len())),
            3 => forged = (0..rng.usize(..1300)).map(|_| rng.u8(..)).collect(),
            _ => {
                forged[6..10].copy_from_slice(&rng.u32(..).to_le_bytes());
            }
        }
        accepted += u64::from(other.receive(&forged, now_s).is_ok());
    }
    assert!(payloads + 20 >= rounds / 100, "the stream continues: {payloads}");
    accepted
}

#[test]
fn forged_changed_and_repeated_datagrams_are_never_accepted() {
    assert_eq!(attack(300_000, 1), 0);
}

#[test]
#[ignore = "a minute: ./dev figures"]
fn figures_of_a_hundred_million_forged_datagrams() {
    assert_eq!(attack(100_000_000, 2), 0);
}

#[test]
#[ignore = "random loops"]
fn fuzz_datagrams() {
    nima_testing::fuzz::rounds(|seed| assert_eq!(attack(20_000, seed), 0));
}

/// Prints the table of docs/results/stream.md: the performance to expect on various links.
#[test]
#[ignore = "ten seconds: ./dev figures"]
fn figures_of_lines() {
    let bursts = |burst_s| LossModel::Bursts { fraction: 0.05, burst_s };
    let pareto = ImpairmentJitter::Pareto { mean_s: 2e-3, shape: 3.0 };
    let normal = |deviation_s| ImpairmentJitter::Normal { deviation_s };
    let lines = [
        ("one room", 0.2e-3, normal(0.05e-3), LossModel::None),
        ("one building", 2e-3, normal(0.5e-3), LossModel::Independent { fraction: 0.001 }),
        ("10 ms", 10e-3, normal(1e-3), LossModel::Independent { fraction: 0.01 }),
        ("50 ms", 50e-3, normal(5e-3), LossModel::Independent { fraction: 0.01 }),
        ("150 ms", 150e-3, normal(5e-3), LossModel::Independent { fraction: 0.05 }),
        ("50 ms, long tail", 50e-3, pareto, LossModel::Independent { fraction: 0.01 }),
        ("50 ms, 10 % lost", 50e-3, normal(1e-3), LossModel::Independent { fraction: 0.1 }),
        ("50 ms, 30 % lost", 50e-3, normal(1e-3), LossModel::Independent { fraction: 0.3 }),
        ("50 ms, 30 % lost, jitter 20 ms", 50e-3, normal(20e-3), LossModel::Independent { fraction: 0.3 }),
        ("50 ms, 5 % lost in bursts of 10 ms", 50e-3, normal(1e-3), bursts(10e-3)),
        ("50 ms, 5 % lost in bursts of 50 ms", 50e-3, normal(1e-3), bursts(50e-3)),
    ];
    for overtakes in [false, true] {
        println!("datagrams may overtake each other: {overtakes}");
        for (name, delay_s, jitter, loss) in lines {
            let settings = ImpairmentSettings { delay_s, jitter, overtakes, loss, ..ImpairmentSettings::default() };
            let mut link = Link::new(settings, stream(4e6), 40);
            link.run(60.0);
            let before = link.figures(0).counts;
            link.run(60.0);
            let figures = link.figures(0);
            let all = figures.counts.delivered - before.delivered;
            let lost = figures.counts.lost - before.lost;
            let late = (figures.counts.late - before.late) as f64 / all as f64 * 100.0;
            let error_s = figures.clock.map_or(f64::NAN, |clock| (clock.offset_s - link.offset_s).abs());
            println!(
                "| {name} | {:.1} | {late:.2} | {:.3} | {} | {:.2} | {:.2} |",
                figures.playout_s.unwrap_or(f64::NAN) * 1e3,
                lost as f64 / (all + lost) as f64 * 100.0,
                figures.copies.used,
                figures.sent.rate_bit_s * 1e-6,
                error_s * 1e3,
            );
            assert!(all > 30_000 && figures.steps == 0, "{name}: {figures:?}");
        }
    }
}
