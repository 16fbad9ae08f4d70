//! The follower's end: computes a packet from samples, and reports the expected accuracy.

use nalgebra::Vector3;

use super::{
    Mode, SLOTS,
    features::ImpedanceFeatures,
    literal::LiteralSolver,
    messages::{IdentificationReport, LinkPacket, Posture, Sample, active},
    method::{Followers, Leaders, MethodInput},
    settings::{ImpedanceSettings, MAX_DELAY_S, ModeSet, SettingsError},
    solution::ImpedanceSolution,
    track::{MotionTrack, usable_force, usable_position},
};
use crate::signal::{DelayLine, Lanes, settled};

/// Time constant of the report's running errors (s).
/// Half a second is readable on the screen and short enough to follow one contact.
const ERROR_MEMORY_S: f64 = 0.5;

/// Identifies the impedance in a sliding window, one [`Sample`] per tick.
///
/// Each tick produces a [`LinkPacket`] for the link and an [`IdentificationReport`] for the screen. Nothing is
/// allocated after construction.
///
/// The follower presses a spring of 100 N/m. 50 ms later its packet arrives at the leader, which renders the force for
/// its own motion:
///
/// ```
/// use nalgebra::Vector3;
/// use nima_core::impedance::{Identifier, Mode, LinkPacket, Renderer, Sample, ImpedanceSettings};
///
/// let settings = ImpedanceSettings { rate_hz: 1000.0, delay_s: 0.05, ..ImpedanceSettings::default() };
/// let (mut follower, mut leader) = (Identifier::new(&settings)?, Renderer::new(&settings)?);
/// let mut link: Vec<LinkPacket> = Vec::new();
/// let mut worst_n = 0.0_f64;
/// for tick in 0..2000 {
///     let t_s = f64::from(tick) * 1e-3;
///     let position_m = Vector3::new(0.0, 0.0, 0.01 * (6.0 * t_s).sin());
///     let force_n = position_m * -100.0;
///     follower.step(&Sample { t_s, position_m, force_n });
///     link.push(*follower.parcel());
///     let arrived = link.len().checked_sub(51).map(|newest| &link[newest]);
///     let rendered = leader.step(&position_m, arrived);
///     if t_s > 1.0 {
///         let force = rendered.force(Mode::Anchored).expect("a valid force after the first window");
///         worst_n = worst_n.max((force - force_n).norm());
///     }
/// }
/// // Holding the delayed force would be wrong by up to 0.3 N.
/// assert!(worst_n < 0.1, "{worst_n} N");
/// # Ok::<(), nima_core::impedance::SettingsError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Identifier {
    settings: ImpedanceSettings,
    delay_ticks: usize,
    track: MotionTrack,
    last_t_s: f64,
    last_force_n: Lanes,
    computed: ModeSet,
    /// Ticks since the last informative sample.
    idle_ticks: usize,
    followers: Followers,
    /// Leader parts that use the follower's own motion.
    leaders: Leaders,
    sent: DelayLine<(LinkPacket, Posture)>,
    forget: f64,
    parcel: LinkPacket,
    report: IdentificationReport,
}

impl Identifier {
    /// Allocates all memory, including the ring buffers for [`MAX_DELAY_S`].
    ///
    /// # Errors
    /// The name of the first setting that is out of its range.
    pub fn new(settings: &ImpedanceSettings) -> Result<Self, SettingsError> {
        settings.validate()?;
        let delay_ticks = settings.delay_ticks(settings.delay_s);
        let max_delay = (MAX_DELAY_S * settings.rate_hz).ceil() as usize;
        Ok(Self {
            delay_ticks,
            track: MotionTrack::new(settings),
            last_t_s: f64::NEG_INFINITY,
            last_force_n: Lanes::ZERO,
            computed: settings.modes,
            idle_ticks: 0,
            followers: Followers::new(settings, delay_ticks),
            leaders: Leaders::new(settings),
            sent: DelayLine::new(max_delay, (LinkPacket::BLANK, Posture::BLANK)),
            forget: 1.0 - libm::exp(-1.0 / (ERROR_MEMORY_S * settings.rate_hz)),
            parcel: LinkPacket { modes: settings.modes, ..LinkPacket::BLANK },
            report: IdentificationReport { modes: settings.modes, ..IdentificationReport::BLANK },
            settings: settings.clone(),
        })
    }

    /// From now on, computes only these modes, if they are in the settings (and delayed reflection, which costs
    /// nothing). An added mode restarts learning; an omitted mode costs nothing. Nothing is allocated.
    pub fn compute(&mut self, modes: ModeSet) {
        let modes = modes.with(Mode::Dfr).and(self.settings.modes);
        let before = std::mem::replace(&mut self.computed, modes);
        let begins = |mode: Mode| modes.contains(mode) && !before.contains(mode);
        for follower in self.followers.each().filter(|follower| follower.begins(before, modes)) {
            follower.reset();
        }
        self.leaders.each().for_each(|leader| leader.compute(before, modes));
        self.idle_ticks = 0;
        let LinkPacket { t_s, force_n, fresh, .. } = self.parcel;
        self.parcel = LinkPacket { t_s, force_n, fresh, modes, ..LinkPacket::BLANK };
        let IdentificationReport { t_s, learnt, failures, mut horizon_error_n, .. } = self.report;
        for mode in self.settings.modes.modes().filter(|mode| begins(*mode) || !modes.contains(*mode)) {
            horizon_error_n[mode.index()] = 0.0;
        }
        self.report =
            IdentificationReport { t_s, modes, learnt, failures, horizon_error_n, ..IdentificationReport::BLANK };
    }

    /// Adds one sample.
    ///
    /// A sample with non-finite or absurd numbers, or whose time does not advance, is counted as rejected: it does not
    /// enter the window, its motion is bridged, and its force is replaced by the last good one.
    pub fn step(&mut self, sample: &Sample) {
        let axes = self.settings.axes;
        let advancing = sample.t_s.is_finite() && sample.t_s > self.last_t_s;
        let position = usable_position(active(&sample.position_m, axes), &self.settings.scales).filter(|_| advancing);
        let force = usable_force(active(&sample.force_n, axes), &self.settings.scales).filter(|_| advancing);
        let good = position.is_some() && force.is_some();
        if advancing {
            self.last_t_s = sample.t_s;
        }
        // A missing force is replaced by the last one so that every history keeps one entry per tick; `fresh` marks it.
        self.last_force_n = force.unwrap_or(self.last_force_n);
        self.report.t_s = self.last_t_s;

        let now = self.track.step(position);
        let good = good && !self.track.is_bridged();
        self.report.failures.samples += u64::from(!good);
        let x = self.track.paper_x();
        let usable = good && self.track.settled();
        let learn = !self.rests(good);
        self.report.resting = !learn;
        self.report.learnt += u64::from(learn && good);

        self.begin_packet(good, learn);
        let seen = MethodInput {
            posture: &now,
            x: &x,
            force_n: self.last_force_n,
            good,
            usable,
            learn,
            // This tick's packet is stored afterwards, so the packet from `delay_ticks` ago is one place nearer.
            sent: self.sent.get(self.delay_ticks.max(1) - 1).map(|(parcel, _)| parcel),
        };
        for follower in self.followers.each().filter(|follower| follower.serves(self.computed)) {
            follower.take(&seen, &mut self.parcel, &mut self.report);
        }
        self.sent.push((self.parcel, now));
        self.predict(&now, &x, good);
    }

    /// Writes the sample into the packet, to which the methods then add their parts.
    fn begin_packet(&mut self, good: bool, learn: bool) {
        self.parcel.t_s = self.last_t_s;
        self.parcel.force_n = self.last_force_n.vector();
        self.parcel.fresh = good;
        self.parcel.resting = !learn;
    }

    /// Returns whether the samples are uninformative: no force was measured or rendered for the length of a window.
    fn rests(&mut self, good: bool) -> bool {
        let rest_n = self.settings.rest_n;
        let within = |force_n: &Vector3<f64>| force_n.norm_squared() <= rest_n * rest_n;
        let idle = rest_n > 0.0
            && (!good || within(&self.last_force_n.vector()))
            && self.report.prediction_n.iter().all(within);
        self.idle_ticks = if idle { self.idle_ticks.saturating_add(1) } else { 0 };
        self.idle_ticks > 2 * self.settings.block()
    }

    /// Computes the force of every mode for this tick from the packet that is one delay old, and its running error.
    fn predict(&mut self, now: &Posture, x: &ImpedanceFeatures, good: bool) {
        let arrived = self.sent.get(self.delay_ticks).filter(|(parcel, _)| parcel.t_s.is_finite());
        let forces = arrived
            .map_or([None; SLOTS], |(parcel, then)| self.leaders.render(parcel, [now, then], x, self.delay_ticks));
        for leader in self.leaders.each() {
            leader.keep(&forces, now.stance.pace);
            if let Some((parcel, _)) = arrived {
                leader.judge(parcel, self.delay_ticks);
            }
        }
        for mode in self.settings.modes.modes() {
            let force = forces[mode.index()];
            self.report.prediction_n[mode.index()] = force.unwrap_or_default().vector();
            self.report.prediction_valid[mode.index()] = force.is_some();
            // For a mode that renders nothing, the error is the whole force; before the first arrival nothing is
            // evaluated.
            if good && self.computed.contains(mode) && forces[Mode::Dfr.index()].is_some() {
                let error_n = (self.last_force_n - force.unwrap_or_default()).norm();
                let mean = &mut self.report.horizon_error_n[mode.index()];
                *mean = settled(*mean + self.forget * (error_n - *mean));
            }
        }
    }

    pub fn parcel(&self) -> &LinkPacket {
        &self.parcel
    }

    pub fn report(&self) -> &IdentificationReport {
        &self.report
    }

    /// Returns every nested solution on the newest window, in scaled columns (N); `None` unless both anchored and
    /// literal are computed.
    pub fn solution(&self) -> Option<&ImpedanceSolution> {
        self.followers.find(|follower| follower.nested())
    }

    /// Returns the paper's solutions of every degree on the newest window; `None` if neither literal nor linear is
    /// computed.
    pub fn literal(&self) -> Option<&LiteralSolver> {
        self.followers.find(|follower| follower.paper())
    }

    /// Changes the programmed delay, exact to one sample, at most [`MAX_DELAY_S`]. The evaluation of anchored rendering
    /// restarts.
    pub fn set_delay(&mut self, delay_s: f64) {
        self.delay_ticks = self.settings.delay_ticks(delay_s);
        self.followers.each().for_each(|follower| follower.set_delay(self.delay_ticks));
    }

    pub fn reset(&mut self) {
        self.track.reset();
        self.last_t_s = f64::NEG_INFINITY;
        self.last_force_n = Lanes::ZERO;
        self.idle_ticks = 0;
        self.followers.each().for_each(|follower| follower.reset());
        self.leaders.each().for_each(|leader| leader.reset());
        self.sent.clear();
        self.parcel = LinkPacket { modes: self.computed, ..LinkPacket::BLANK };
        self.report = IdentificationReport { modes: self.computed, ..IdentificationReport::BLANK };
    }
}
