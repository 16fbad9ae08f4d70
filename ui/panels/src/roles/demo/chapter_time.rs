//! Duration of a chapter on the loop's clock.
//!
//! Everything that a chapter shows happens on that clock: the hand's motion, the contacts, the delay. On the real clock it is
//! also the viewer's time, however rarely the window is drawn. A simulated loop that runs slower than real time makes a
//! chapter longer by the same factor, so that a viewer sees the same motions and contacts in it.

/// Maximum time between frames that show motion, s. A longer gap is a pause: the viewer saw a still image, or no window.
pub(super) const PAUSE_S: f64 = 1.0;
/// Minimum time for which a viewer sees a chapter in motion, s: its pauses count, but they never skip it. That is one contact
/// of the simulated hand, and the time to read a dozen words.
const SEEN_MIN_S: f64 = 4.0;

/// Time of the current chapter.
#[derive(Clone, Copy, Debug, Default)]
#[expect(clippy::struct_field_names, reason = "what they share is the unit")]
pub(super) struct ChapterPace {
    /// Time of the tick in the previous frame, s.
    last_s: Option<f64>,
    /// Time since the chapter started, pauses included, s.
    shown_s: f64,
    /// The part of that time in which the chapter was seen in motion, s.
    seen_s: f64,
}

impl ChapterPace {
    /// Returns the time since the previous frame, s.
    pub(super) fn passed_s(&mut self, now_s: f64) -> f64 {
        let last_s = self.last_s.replace(now_s).unwrap_or(now_s);
        (now_s - last_s).max(0.0)
    }

    pub(super) const fn begin(&mut self) {
        self.shown_s = 0.0;
        self.seen_s = 0.0;
    }

    /// Starts the chapter after one of this length (s), which ended between two frames: time beyond its end counts for the
    /// next chapter, so that a round takes the same time at every frame rate. A pause does not count.
    pub(super) fn go_on(&mut self, seconds: f64) {
        let over_s = self.shown_s - seconds;
        self.begin();
        self.shown_s = if over_s <= PAUSE_S { over_s } else { 0.0 };
    }

    /// The chapter was shown for this time, s.
    pub(super) const fn count(&mut self, passed_s: f64) {
        self.shown_s += passed_s;
        self.seen_s += passed_s.min(PAUSE_S);
    }

    /// Returns whether a chapter of this length (s) is over.
    pub(super) fn is_over(&self, seconds: f64) -> bool {
        self.shown_s >= seconds && self.seen_s >= SEEN_MIN_S.min(seconds)
    }

    /// Returns the progress of a chapter of this length (s), 0 to 1.
    pub(super) const fn progress(&self, seconds: f64) -> f64 {
        (self.shown_s / seconds).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the lengths of six chapters of 14 s, s, drawn at these times, s.
    fn lengths_s(drawn_s: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut pace = ChapterPace::default();
        let mut began_s = 0.0;
        let mut lengths_s = Vec::new();
        for now_s in drawn_s {
            pace.count_to(now_s);
            if pace.is_over(14.0) {
                lengths_s.push(now_s - began_s);
                began_s = now_s;
                pace.go_on(14.0);
            }
        }
        lengths_s.truncate(6);
        lengths_s
    }

    impl ChapterPace {
        fn count_to(&mut self, now_s: f64) {
            let passed_s = self.passed_s(now_s);
            self.count(passed_s);
        }
    }

    #[test]
    fn a_chapter_takes_its_time_at_every_frame_rate() {
        for rate_hz in [0.4, 2.0, 10.0, 32.0, 60.0, 144.0] {
            let lengths_s = lengths_s((0..100_000).map(|frame| f64::from(frame) / rate_hz));
            let frame_s = 1.0 / rate_hz + 1e-6;
            let all_s = lengths_s.iter().sum::<f64>();
            assert_eq!(lengths_s.len(), 6);
            assert!(lengths_s.iter().all(|length_s| (length_s - 14.0).abs() <= frame_s), "{rate_hz} Hz: {lengths_s:?}");
            // If frames are farther apart than a pause, each chapter restarts.
            let late_s = if rate_hz < 1.0 { 6.0 * frame_s } else { frame_s };
            assert!((84.0 - 1e-6..=84.0 + late_s).contains(&all_s), "{rate_hz} Hz: {all_s} s");
        }
    }

    #[test]
    fn a_pause_neither_skips_a_chapter_nor_makes_it_longer() {
        let with_pause = |from_s: f64, pause_s: f64| {
            let frames = (0..10_000).map(|frame| f64::from(frame) / 30.0);
            lengths_s(frames.map(move |t_s| if t_s > from_s { t_s + pause_s } else { t_s }))
        };
        // The pause fits into the chapter's time.
        assert!(with_pause(5.0, 6.0).iter().all(|length_s| (length_s - 14.0).abs() < 0.05));
        // The chapter had been shown for 5 s: it ends with the pause, and the next one gets its full time.
        let [first_s, second_s, ..] = with_pause(5.0, 60.0)[..] else { panic!() };
        assert!((first_s - 65.0).abs() < 0.1 && (second_s - 14.0).abs() < 0.1, "{first_s} s, {second_s} s");
        // The chapter had just started: it is shown before the next one.
        let [first_s, second_s, ..] = with_pause(0.0, 60.0)[..] else { panic!() };
        assert!((first_s - 63.0).abs() < 0.1 && (second_s - 14.0).abs() < 0.1, "{first_s} s, {second_s} s");
    }
}
