//! Detects which devices are being moved, pressed or pushed, so that a person can identify them.
//!
//! The noise of every value in a device's readings is learned while the device is at rest. A device is active while one of
//! its values changes by clearly more than its noise, and by more than accidental motion.

use nima_machine::rig::{
    CHANNELS, DEVICES_MAX, Gauge, GaugeSpread, Gauges, PartKind, RigPart, RosterEntry, checkup::min,
};

/// Blocks of 0.1 s from which the noise is learned before a change counts.
const LEARNING: u32 = 4;
/// Threshold, in standard deviations of the noise, for the distance of a block's mean from the rest position and for the
/// width of a block.
const APART: f64 = 4.0;
const WIDE: f64 = 10.0;
/// Learning rate of rest position and noise at rest, and of the noise of a device that never rests, per block.
const LEARN: f64 = 0.3;
const LEARN_MOVING: f64 = 0.02;
/// Time for which a device stays lit after its last change, s.
const LIT_S: f64 = 0.5;

/// One value of a device's readings.
#[derive(Clone, Copy, Debug, Default)]
struct UsualNumber {
    blocks: u32,
    /// Rest position.
    mean: f64,
    /// Standard deviation at rest.
    noise: f64,
}

impl UsualNumber {
    /// Returns the ratio of this block's change to the threshold; above 1, the change counts.
    fn follow(&mut self, block: &GaugeSpread, min: f64) -> f64 {
        if block.count == 0 {
            return 0.0;
        }
        let mean = block.mean;
        let noise = block.deviation();
        self.blocks += 1;
        if self.blocks <= LEARNING {
            self.mean = mean;
            // The device may move while it is learned, so the quietest block counts.
            self.noise = if self.blocks == 1 { noise } else { self.noise.min(noise) };
            return 0.0;
        }
        let apart = (mean - self.mean).abs() / (min + APART * self.noise);
        let wide = block.extent() / (min + WIDE * self.noise);
        let change = apart.max(wide);
        if change > 1.0 {
            // The new value may be the next rest position.
            self.mean = mean;
            self.noise += LEARN_MOVING * (noise - self.noise);
        } else {
            self.mean += LEARN * (mean - self.mean);
            self.noise += LEARN * (noise - self.noise);
        }
        change
    }
}

#[derive(Clone, Copy, Debug)]
struct DeviceActivity {
    kind: Option<PartKind>,
    channels: [UsualNumber; CHANNELS],
    /// Time of the last activity, s on the loop's clock, and the index of the value that changed.
    active: Option<(f64, usize)>,
}

impl DeviceActivity {
    fn follow(&mut self, gauge: &Gauge, at_s: f64) {
        let Some(kind) = self.kind else { return };
        let mut max = (1.0, None);
        for (channel, (usual, block)) in self.channels.iter_mut().zip(&gauge.channels).enumerate() {
            let change = usual.follow(block, min(kind, channel));
            if change > max.0 {
                max = (change, Some(channel));
            }
        }
        if let (_, Some(channel)) = max {
            self.active = Some((at_s, channel));
        }
    }
}

#[derive(Debug)]
pub struct Activity {
    devices: Box<[DeviceActivity; DEVICES_MAX]>,
    now_s: f64,
}

impl Activity {
    pub fn of(roster: &[RosterEntry]) -> Self {
        Self::of_kinds(|place| roster.get(place).and_then(|entry| entry.part).map(RigPart::kind))
    }

    fn of_kinds(kind: impl Fn(usize) -> Option<PartKind>) -> Self {
        let device =
            |place| DeviceActivity { kind: kind(place), channels: [UsualNumber::default(); CHANNELS], active: None };
        Self { devices: Box::new(std::array::from_fn(device)), now_s: 0.0 }
    }

    /// Adds a block; returns whether the set of lit devices has changed.
    pub fn follow(&mut self, gauges: &Gauges) -> bool {
        let before = self.lit_ones();
        self.now_s = gauges.to_s;
        for (device, gauge) in self.devices.iter_mut().zip(&gauges.devices) {
            device.follow(gauge, gauges.to_s);
        }
        self.lit_ones() != before
    }

    /// Returns the index of the value that lights this device now.
    pub fn lit(&self, place: usize) -> Option<usize> {
        let (at_s, channel) = self.devices.get(place)?.active?;
        (self.now_s - at_s <= LIT_S).then_some(channel)
    }

    fn lit_ones(&self) -> [Option<usize>; DEVICES_MAX] {
        std::array::from_fn(|place| self.lit(place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two handles, two sensors, a pedal.
    const KINDS: [PartKind; 5] =
        [PartKind::Handle, PartKind::Handle, PartKind::Sensor, PartKind::Sensor, PartKind::Pedal];

    struct Fixture {
        activity: Activity,
        samples: u64,
        block: u32,
    }

    impl Fixture {
        fn new() -> Self {
            let activity = Activity::of_kinds(|place| KINDS.get(place).copied());
            let mut this = Self { activity, samples: 0, block: 0 };
            for _ in 0..20 {
                assert!(this.block(|_, _, _| 0.0).is_empty(), "its own noise does not count as a change");
            }
            this
        }

        /// Creates one block of every device: noise, plus the offset of `moved` at a time (s). Returns the lit devices
        /// with their channels.
        fn block(&mut self, moved: impl Fn(usize, usize, f64) -> f64) -> Vec<(usize, usize)> {
            let from_s = f64::from(self.block) * 0.1;
            self.block += 1;
            let mut gauges = Gauges { from_s, to_s: from_s + 0.1, devices: [Gauge::NONE; DEVICES_MAX] };
            for sample in 0..100 {
                let t_s = from_s + f64::from(sample) * 1e-3;
                for (place, kind) in KINDS.into_iter().enumerate() {
                    for channel in 0..9 {
                        self.samples += 1;
                        // Pseudo-random and uniform, without a pattern within a block.
                        let even = (self.samples * self.samples % 9973) as f64 / 9973.0 - 0.5;
                        let noise = if kind == PartKind::Pedal { 0.0 } else { 0.6 * min(kind, channel) * even };
                        gauges.devices[place].channels[channel].add(1.0 + noise + moved(place, channel, t_s));
                    }
                }
            }
            self.activity.follow(&gauges);
            (0..KINDS.len()).filter_map(|place| Some((place, self.activity.lit(place)?))).collect()
        }
    }

    #[test]
    fn the_handle_that_is_moved_lights_up_and_no_other() {
        for hand in [0, 1] {
            let mut bench = Fixture::new();
            let since_s = 2.0;
            // Moves 1 cm back and forth, twice per second.
            let to_and_fro = |place, channel, t_s: f64| {
                if (place, channel) == (hand, 1) { 0.01 * (12.6 * (t_s - since_s)).sin() } else { 0.0 }
            };
            for _ in 0..10 {
                assert_eq!(bench.block(to_and_fro), [(hand, 1)]);
            }
            let lit = (0..10).map(|_| bench.block(|_, _, _| 0.0).len()).collect::<Vec<_>>();
            assert_eq!((lit[2], lit[9]), (1, 0), "it goes out half a second later: {lit:?}");
        }
    }

    #[test]
    fn a_push_that_stays_is_seen_once_and_a_slow_one_too() {
        let mut bench = Fixture::new();
        let pushed = |place, channel, _| if (place, channel) == (3, 2) { 2.0 } else { 0.0 };
        assert_eq!(bench.block(pushed), [(3, 2)]);
        let still: Vec<_> = (0..20).map(|_| bench.block(pushed).len()).collect();
        assert_eq!(still[19], 0, "a load that rests does not count as a change: {still:?}");
        let mut bench = Fixture::new();
        // 3 N per second.
        let rising = |place, channel, t_s: f64| if (place, channel) == (2, 0) { 3.0 * (t_s - 2.0) } else { 0.0 };
        let seen: Vec<_> = (0..10).map(|_| bench.block(rising)).collect();
        assert!(seen[3..].iter().all(|lit| lit == &[(2, 0)]), "{seen:?}");
    }

    #[test]
    fn a_pedal_lights_up_when_it_is_pressed_and_when_it_is_released() {
        let mut bench = Fixture::new();
        let pressed = |place, _, _| if place == 4 { 1.0 } else { 0.0 };
        assert_eq!(bench.block(pressed)[0].0, 4);
        (0..10).for_each(|_| drop(bench.block(pressed)));
        assert_eq!(bench.activity.lit(4), None);
        assert_eq!(bench.block(|_, _, _| 0.0)[0].0, 4);
    }

    #[test]
    fn a_device_that_shakes_all_the_time_becomes_quiet() {
        let mut bench = Fixture::new();
        let shaking = |place, channel, t_s: f64| {
            if (place, channel) == (2, 0) { (300.0 * t_s).sin() } else { 0.0 }
        };
        assert_eq!(bench.block(shaking), [(2, 0)]);
        (0..300).for_each(|_| drop(bench.block(shaking)));
        assert_eq!(bench.activity.lit(2), None);
    }
}
