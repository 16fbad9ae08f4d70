//! Converts the loop's time to LSL time.

/// The loop's clock may run slower than LSL's by this factor. Far more than any crystal, because too small a value
/// would let the offset lag behind for ever.
const DRIFT: f64 = 1e-3;

/// The estimate is used after ticks have been received for this long, s, because the first ones are often late.
const SETTLES_S: f64 = 0.2;

/// Estimated from the arrival of ticks; the smallest delay counts.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LslLoopClock {
    /// Offset of LSL time from the loop's time, s, and the time of its last observation, s.
    offset_s: Option<(f64, f64)>,
    /// Time of the first observation, s.
    since_s: Option<f64>,
}

impl LslLoopClock {
    /// Notes that a tick of this time (s) arrived at this LSL time, s.
    pub(super) fn note(&mut self, t_s: f64, now_s: f64) {
        let offset_s = now_s - t_s;
        let min_s = self.offset_s.map_or(offset_s, |(min_s, at_s)| offset_s.min(min_s + DRIFT * (now_s - at_s)));
        self.offset_s = Some((min_s, now_s));
        self.since_s.get_or_insert(now_s);
    }

    /// Returns the LSL time once the estimate is reliable.
    pub(super) fn settled(&self, t_s: f64) -> Option<f64> {
        let since_s = self.since_s?;
        let (_, now_s) = self.offset_s?;
        self.at(t_s).filter(|_| now_s - since_s >= SETTLES_S)
    }

    /// Returns the LSL time of a time of the loop, s.
    pub(super) fn at(&self, t_s: f64) -> Option<f64> {
        self.offset_s.map(|(offset_s, _)| t_s + offset_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stamp_is_right_to_a_fraction_of_a_millisecond_however_late_ticks_are_known() {
        let mut clock = LslLoopClock::default();
        assert_eq!((clock.at(1.0), clock.settled(1.0)), (None, None));
        for tick in 0..20_000_u32 {
            let t_s = f64::from(tick) * 1e-3;
            // The disk delayed the recorder by half a second; usually a tick arrives within 0.3 ms. The first ones wait
            // for the file to be created.
            let late_s = match tick {
                0..50 => 0.05 - t_s,
                1000..1500 => 1.5 - t_s,
                _ => f64::from(tick % 4) * 1e-4,
            };
            clock.note(t_s, 5000.0 + t_s + late_s);
            let Some(at_s) = clock.settled(t_s) else { continue };
            assert!(tick >= 150);
            let error_s = at_s - 5000.0 - t_s;
            assert!((-1e-9..6e-4).contains(&error_s), "tick {tick}: {error_s} s");
        }
        assert!(clock.settled(0.0).is_some());
    }
}
