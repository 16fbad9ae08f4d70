//! The gates in their fixed order: validity, age, dead band, gain, slew, ceiling.

use nalgebra::Vector3;

use super::DeadBand;

/// Limits and knobs of the chain. Defaults are the project's safe values.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ChainSettings {
    /// Feedback gain, 0 to 3.
    pub gain: f64,
    /// Fastest change of the gain, 1/s: a slider jump becomes a ramp.
    pub gain_rate_per_s: f64,
    /// Largest force that ever reaches the hand, N (norm of the vector).
    pub ceiling_n: f64,
    /// Fastest change of the force, N/s.
    pub slew_n_per_s: f64,
    /// Age beyond the link's own delay at which the force begins to fade, s.
    pub fade_after_s: f64,
    /// Age beyond the link's own delay at which it is zero, s.
    pub zero_after_s: f64,
    /// Speed below which nothing is rendered, m/s.
    pub dead_band_m_s: f64,
    /// Keep the force at standstill instead of fading it in the dead band.
    pub static_hold: bool,
}

impl Default for ChainSettings {
    fn default() -> Self {
        Self {
            gain: 1.0,
            gain_rate_per_s: 2.0,
            ceiling_n: 4.0,
            // 5 N within 10 ms: faster than a hand can feel as a ramp, slow enough that one bad sample moves 0.5 N.
            slew_n_per_s: 500.0,
            fade_after_s: 0.005,
            zero_after_s: 0.020,
            dead_band_m_s: 1e-3,
            static_hold: false,
        }
    }
}

/// Highest gain an operator can choose.
pub const MAX_GAIN: f64 = 3.0;

/// One force asking to reach the hand.
#[derive(Clone, Copy, Debug)]
pub struct Request {
    /// The force a mode asks for, N; `None` when the mode has nothing valid.
    pub force_n: Option<Vector3<f64>>,
    /// Age of the newest data behind it beyond the link's own delay, s.
    pub age_s: f64,
    /// Speed of the hand, m/s.
    pub speed_m_s: f64,
    /// The state machine allows force at all.
    pub permitted: bool,
}

/// What each gate did in one tick, in the order of the chain. `false` everywhere means the force passed untouched.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "one independent flag per gate is what it reports")]
pub struct GateReport {
    /// The loop is not engaged: no force.
    pub not_permitted: bool,
    /// The request was missing, not finite or not plausible: no force.
    pub invalid: bool,
    /// The data were older than allowed: faded or zero.
    pub stale: bool,
    /// Too slow a hand: the dead band took something off.
    pub dead_band: bool,
    /// How much force the dead band kept from the hand, N.
    pub withheld_n: f64,
    /// The gain in force in this tick.
    pub gain: f64,
    /// The slew limit held the force back.
    pub slew: bool,
    /// The ceiling cut the force.
    pub ceiling: bool,
}

impl GateReport {
    /// The first closed gate in one word, for a trace; `open` when the force passed untouched.
    pub const fn first_closed(&self) -> &'static str {
        match self {
            Self { not_permitted: true, .. } => "not_permitted",
            Self { invalid: true, .. } => "validity",
            Self { stale: true, .. } => "age",
            Self { dead_band: true, .. } => "dead_band",
            Self { slew: true, .. } => "slew",
            Self { ceiling: true, .. } => "ceiling",
            _ => "open",
        }
    }
}

/// The chain and its memory (gain ramp, last force, dead band).
#[derive(Clone, Debug)]
pub struct Chain {
    settings: ChainSettings,
    period_s: f64,
    gain: f64,
    last_n: Vector3<f64>,
    dead_band: DeadBand,
}

/// A request beyond this is a computing error, not a contact, N: it is refused, not clipped.
const PLAUSIBLE_N: f64 = 1e3;

impl Chain {
    /// A chain for a loop of this period (s). Settings outside their ranges are pulled into them.
    pub fn new(settings: ChainSettings, period_s: f64) -> Self {
        let mut chain = Self {
            settings,
            period_s,
            gain: 0.0,
            last_n: Vector3::zeros(),
            dead_band: DeadBand::new(settings.dead_band_m_s),
        };
        chain.set_gain(settings.gain);
        chain.set_dead_band(settings.dead_band_m_s);
        chain.gain = chain.settings.gain;
        chain
    }

    /// Settings in force.
    pub const fn settings(&self) -> &ChainSettings {
        &self.settings
    }

    /// Chooses the gain to ramp to, 0 to [`MAX_GAIN`]; anything else is pulled in, NaN is ignored.
    pub fn set_gain(&mut self, gain: f64) {
        if !gain.is_nan() {
            self.settings.gain = gain.clamp(0.0, MAX_GAIN);
        }
    }

    /// Chooses the dead band, m/s, 0 to 0.1; anything else is pulled in, NaN is ignored.
    pub fn set_dead_band(&mut self, threshold_m_s: f64) {
        if !threshold_m_s.is_nan() {
            self.settings.dead_band_m_s = threshold_m_s.clamp(0.0, 0.1);
            self.dead_band.threshold_m_s = self.settings.dead_band_m_s;
        }
    }

    /// Keeps the force at standstill (true) or fades it in the dead band (false).
    pub const fn set_static_hold(&mut self, hold: bool) {
        self.settings.static_hold = hold;
    }

    /// Forgets the last force, so that the next one starts from zero.
    pub fn reset(&mut self) {
        self.last_n = Vector3::zeros();
    }

    /// Sends one request through all gates; gives the force for the hand (N) and what each gate did.
    pub fn step(&mut self, request: &Request) -> (Vector3<f64>, GateReport) {
        let mut report = GateReport::default();
        self.ramp_gain();
        report.gain = self.gain;
        let asked = Self::admitted(request, &mut report);
        let aged = asked * self.freshness(request.age_s, &mut report);
        let moving = self.past_dead_band(aged, request.speed_m_s, &mut report);
        if !request.permitted || report.invalid {
            // A stop is a stop: no ramp down, the slew limit does not apply to letting go.
            self.last_n = Vector3::zeros();
            return (self.last_n, report);
        }
        let slewed = self.slewed(moving * self.gain, &mut report);
        self.last_n = self.under_ceiling(slewed, &mut report);
        (self.last_n, report)
    }

    fn ramp_gain(&mut self) {
        let step = self.settings.gain_rate_per_s * self.period_s;
        self.gain += (self.settings.gain - self.gain).clamp(-step, step);
    }

    fn admitted(request: &Request, report: &mut GateReport) -> Vector3<f64> {
        report.not_permitted = !request.permitted;
        match request.force_n {
            Some(force_n) if force_n.iter().all(|f| f.is_finite()) && force_n.amax() <= PLAUSIBLE_N => force_n,
            _ => {
                report.invalid = true;
                Vector3::zeros()
            }
        }
    }

    fn freshness(&self, age_s: f64, report: &mut GateReport) -> f64 {
        let ChainSettings { fade_after_s, zero_after_s, .. } = self.settings;
        if age_s <= fade_after_s {
            return 1.0;
        }
        report.stale = true;
        // Written so that a NaN age falls through to zero.
        if age_s < zero_after_s { (zero_after_s - age_s) / (zero_after_s - fade_after_s) } else { 0.0 }
    }

    fn past_dead_band(&mut self, force_n: Vector3<f64>, speed_m_s: f64, report: &mut GateReport) -> Vector3<f64> {
        let share = self.dead_band.step(speed_m_s);
        if self.settings.static_hold || share >= 1.0 {
            return force_n;
        }
        report.dead_band = true;
        report.withheld_n = force_n.norm() * (1.0 - share);
        force_n * share
    }

    fn slewed(&self, force_n: Vector3<f64>, report: &mut GateReport) -> Vector3<f64> {
        let step = force_n - self.last_n;
        let most = self.settings.slew_n_per_s * self.period_s;
        if step.norm() <= most {
            return force_n;
        }
        report.slew = true;
        self.last_n + step * (most / step.norm())
    }

    fn under_ceiling(&self, force_n: Vector3<f64>, report: &mut GateReport) -> Vector3<f64> {
        let norm = force_n.norm();
        if norm <= self.settings.ceiling_n {
            return force_n;
        }
        report.ceiling = true;
        force_n * (self.settings.ceiling_n / norm)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn request(force_n: Vector3<f64>) -> Request {
        Request { force_n: Some(force_n), age_s: 0.0, speed_m_s: 0.1, permitted: true }
    }

    #[test]
    fn a_modest_force_passes_untouched_once_the_slew_has_caught_up() {
        let mut chain = Chain::new(ChainSettings::default(), 1e-3);
        let asked = Vector3::new(1.0, -0.5, 2.0);
        for _ in 0..100 {
            chain.step(&request(asked));
        }
        let (force_n, report) = chain.step(&request(asked));
        assert!((force_n - asked).norm() < 1e-12);
        assert_eq!(report.first_closed(), "open");
    }

    #[test]
    fn silence_fades_after_5_ms_and_is_zero_at_20_ms() {
        let settings = ChainSettings { slew_n_per_s: 1e9, ..ChainSettings::default() };
        let mut chain = Chain::new(settings, 1e-3);
        let at = |chain: &mut Chain, age_s| chain.step(&Request { age_s, ..request(Vector3::z()) }).0.z;
        assert!((at(&mut chain, 0.005) - 1.0).abs() < 1e-12);
        let halfway = at(&mut chain, 0.0125);
        assert!((halfway - 0.5).abs() < 1e-12, "{halfway}");
        assert!(at(&mut chain, 0.020).abs() < 1e-12);
        assert!(at(&mut chain, f64::NAN).abs() < 1e-12);
    }

    #[test]
    fn a_stop_takes_the_force_away_at_once() {
        let mut chain = Chain::new(ChainSettings::default(), 1e-3);
        for _ in 0..100 {
            chain.step(&request(Vector3::z() * 3.0));
        }
        let (force_n, report) = chain.step(&Request { permitted: false, ..request(Vector3::z() * 3.0) });
        assert!(force_n.norm() < 1e-15);
        assert_eq!(report.first_closed(), "not_permitted");
    }

    #[test]
    fn the_dead_band_says_how_much_it_withholds() {
        let mut chain = Chain::new(ChainSettings::default(), 1e-3);
        let held = Request { speed_m_s: 0.0, ..request(Vector3::z() * 1.4) };
        let (force_n, report) = chain.step(&held);
        assert!(force_n.norm() < 1e-15 && (report.withheld_n - 1.4).abs() < 1e-12);
        chain.set_static_hold(true);
        for _ in 0..10 {
            chain.step(&held);
        }
        assert!((chain.step(&held).0.z - 1.4).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn no_sequence_of_requests_breaches_ceiling_or_slew(
            requests in prop::collection::vec(
                (prop::array::uniform3(prop::num::f64::ANY), prop::num::f64::ANY, prop::num::f64::ANY, any::<bool>(), 0.0..5.0f64),
                1..200,
            ),
        ) {
            let settings = ChainSettings::default();
            let mut chain = Chain::new(settings, 1e-3);
            let mut last = Vector3::<f64>::zeros();
            for (force, age_s, speed_m_s, permitted, gain) in requests {
                chain.set_gain(gain);
                let (now, _) = chain.step(&Request { force_n: Some(Vector3::from(force)), age_s, speed_m_s, permitted });
                prop_assert!(now.iter().all(|f| f.is_finite()));
                prop_assert!(now.norm() <= settings.ceiling_n * (1.0 + 1e-12));
                let rise = now.norm() - last.norm();
                prop_assert!(rise <= settings.slew_n_per_s * 1e-3 * (1.0 + 1e-9), "rise {rise}");
                last = now;
            }
        }
    }
}
