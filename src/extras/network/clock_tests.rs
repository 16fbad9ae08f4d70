use nima_core::noise::Noise;

use super::*;

/// Simulation of two clocks and the network between them.
struct World {
    noise: Noise,
    clock: NetworkClock,
    /// Delay and jitter in each direction, s.
    delay_s: [f64; 2],
    jitter_s: f64,
    offset_s: f64,
    skew: f64,
    t_s: f64,
    report: Vec<ClockStep>,
}

impl World {
    fn new(seed: u64, delay_s: [f64; 2], jitter_s: f64) -> Self {
        let noise = Noise::new(seed);
        let clock = NetworkClock::default();
        Self { noise, clock, delay_s, jitter_s, offset_s: 1234.5, skew: 0.0, t_s: 10.0, report: Vec::new() }
    }

    fn theirs(&self, t_s: f64) -> f64 {
        t_s * (1.0 + self.skew) + self.offset_s
    }

    /// Runs this many seconds of exchanges at 1 kHz; returns the maximum error of the estimate in the last second, s.
    fn run(&mut self, length_s: f64) -> f64 {
        let end_s = self.t_s + length_s;
        let mut worst_s = 0.0_f64;
        while self.t_s < end_s {
            self.t_s += 1e-3;
            let jitter_s = self.jitter_s;
            let mut way_s = |delay_s: f64| delay_s + self.noise.gaussian().abs() * jitter_s;
            let there_s = way_s(self.delay_s[0]);
            let back_s = way_s(self.delay_s[1]);
            let received_s = self.t_s + there_s;
            let sent_s = self.t_s + there_s + 0.7e-3;
            let exchange = ClockExchange {
                origin_s: self.t_s,
                received_s: self.theirs(received_s),
                sent_s: self.theirs(sent_s),
                arrived_s: sent_s + back_s,
            };
            self.report.extend(self.clock.add(&exchange));
            if end_s - self.t_s < 1.0
                && let Some(estimate) = self.clock.estimate(self.t_s)
            {
                worst_s = worst_s.max((estimate.offset_s - (self.theirs(self.t_s) - self.t_s)).abs());
            }
        }
        worst_s
    }
}

#[test]
fn the_error_is_below_a_fifth_of_a_millisecond_with_jitter_and_skew() {
    let mut worst_s = 0.0_f64;
    for seed in 0..8 {
        for (delay_s, skew) in [(0.2e-3, 0.0), (5e-3, 5e-5), (72e-3, -1e-4)] {
            let mut world = World::new(seed, [delay_s; 2], 1e-3);
            world.skew = skew;
            let error_s = world.run(2.0);
            assert!(error_s < 0.4e-3, "after 2 s: {error_s} with a skew of {skew}");
            let error_s = world.run(28.0);
            worst_s = worst_s.max(error_s);
            let estimate = world.clock.estimate(world.t_s).unwrap();
            assert!((estimate.skew - skew).abs() < 2e-5, "{estimate:?}");
            assert!((estimate.bound_s - delay_s).abs() < 0.3e-3 && estimate.bound_s > error_s, "{estimate:?}");
            assert!(world.report.is_empty());
        }
    }
    println!("worst error {:.3} ms", worst_s * 1e3);
    assert!(worst_s < 0.2e-3, "{worst_s}");
}

#[test]
fn a_step_is_named_within_a_second_and_nothing_else_is_one() {
    let mut latest_s = 0.0_f64;
    for seed in 0..10 {
        for by_s in [5e-3, -5e-3, 50e-3, -2.0] {
            for (delay_s, jitter_s) in [(1e-3, 0.1e-3), (20e-3, 1e-3), (150e-3, 1e-3)] {
                let mut world = World::new(seed, [delay_s; 2], jitter_s);
                world.run(5.0 + 0.037 * f64::from(seed as u32));
                assert_eq!(world.report, []);
                let at_s = world.t_s;
                world.offset_s += by_s;
                world.run(1.0);
                let [step] = world.report[..] else { panic!("{by_s} with {jitter_s}: {:?}", world.report) };
                assert!((step.by_s - by_s).abs() < 0.3e-3 + 0.05 * by_s.abs(), "{step:?} of {by_s}");
                latest_s = latest_s.max(step.found_s - at_s);
                assert!(world.run(3.0) < 0.5e-3);
                assert_eq!((world.report.len(), world.clock.steps()), (1, 1));
            }
        }
    }
    println!("named after {latest_s:.2} s at most");
    assert!(latest_s < 1.0 + 0.16, "{latest_s}");
}

#[test]
fn a_large_step_is_named_also_with_much_jitter() {
    for seed in 0..10 {
        let mut world = World::new(seed, [50e-3; 2], 5e-3);
        world.run(20.0);
        world.offset_s += 50e-3;
        world.run(1.2);
        assert_eq!(world.report.len(), 1);
    }
}

#[test]
fn a_longer_way_and_heavy_jitter_are_no_step() {
    for seed in 0..10 {
        for jitter_s in [0.1e-3, 1e-3, 20e-3] {
            let mut world = World::new(seed, [10e-3; 2], jitter_s);
            world.run(3.0);
            for delay_s in [[30e-3, 10e-3], [30e-3, 25e-3], [5e-3, 25e-3], [10e-3, 10e-3]] {
                world.delay_s = delay_s;
                world.run(2.5);
            }
            assert_eq!(world.report, [], "seed {seed}, jitter {jitter_s}");
        }
    }
}

#[test]
fn what_is_no_number_is_ignored() {
    let mut clock = NetworkClock::default();
    let exchange = ClockExchange { origin_s: f64::NAN, received_s: 1.0, sent_s: 1.0, arrived_s: f64::INFINITY };
    assert_eq!(clock.add(&exchange), None);
    assert_eq!(clock.estimate(1.0), None);
}
