//! The leader's end: computes a force from the newest packet and the leader's own motion.

use nalgebra::Vector3;

use super::{
    Mode, SLOTS,
    damper::Damper,
    messages::{LinkPacket, Posture, RenderedForces, active},
    method::Leaders,
    settings::{ImpedanceSettings, MAX_DELAY_S, OwnMotion, SettingsError},
    track::{MotionTrack, usable_position},
};
use crate::signal::DelayLine;

/// Renders a force from the received packets and the leader's motion. Nothing is allocated after construction.
///
/// ```
/// use nalgebra::Vector3;
/// use nima_core::impedance::{Mode, LinkPacket, Renderer, ImpedanceSettings};
///
/// let mut renderer = Renderer::new(&ImpedanceSettings::default())?;
/// let here = Vector3::zeros();
/// assert_eq!(renderer.step(&here, None).force(Mode::Dfr), None, "no packet, no force");
///
/// let parcel = LinkPacket { t_s: 0.0, force_n: Vector3::new(0.0, 0.0, 1.5), fresh: true, ..LinkPacket::BLANK };
/// assert_eq!(renderer.step(&here, Some(&parcel)).force(Mode::Dfr), Some(parcel.force_n), "dfr reflects the received force");
/// # Ok::<(), nima_core::impedance::SettingsError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Renderer {
    settings: ImpedanceSettings,
    delay_ticks: usize,
    track: MotionTrack,
    postures: DelayLine<Posture>,
    leaders: Leaders,
    /// Dampers for the modes that render from the handle's own motion, so that they do not drive the hand.
    dampers: Vec<(Mode, Damper)>,
    parcel_t_s: f64,
    waiting: usize,
}

impl Renderer {
    /// Allocates all memory, including the ring buffers for [`MAX_DELAY_S`].
    ///
    /// # Errors
    /// The name of the first setting that is out of its range.
    pub fn new(settings: &ImpedanceSettings) -> Result<Self, SettingsError> {
        settings.validate()?;
        let max_delay = (MAX_DELAY_S * settings.rate_hz).ceil() as usize;
        let is_handle = settings.own_motion == OwnMotion::Handle;
        let damped = Mode::ALL.into_iter().filter(|mode| is_handle && mode.is_damped());
        Ok(Self {
            delay_ticks: settings.delay_ticks(settings.delay_s),
            track: MotionTrack::new(settings),
            // Twice: the age of a packet may exceed the programmed delay by as much while the link is late.
            postures: DelayLine::new(2 * max_delay, Posture::BLANK),
            leaders: Leaders::new(settings),
            dampers: damped.map(|mode| (mode, Damper::new(settings.rate_hz))).collect(),
            parcel_t_s: f64::NEG_INFINITY,
            waiting: 0,
            settings: settings.clone(),
        })
    }

    /// Renders one tick.
    ///
    /// `position_m`: the leader's motion mapped into the workspace frame (m); a non-finite one is bridged like a lost
    /// sample. `parcel`: the newest packet from the link, one delay old on arrival. Without a newer packet (`None`, or
    /// the same or an older one again) the age of the last packet increases with each tick, and the correction
    /// continues from the same anchor.
    pub fn step(&mut self, position_m: &Vector3<f64>, parcel: Option<&LinkPacket>) -> RenderedForces {
        let position = usable_position(active(position_m, self.settings.axes), &self.settings.scales);
        let now = self.track.step(position);
        let x = self.track.paper_x();
        self.postures.push(now);

        let Some(parcel) = parcel.filter(|parcel| parcel.t_s.is_finite()) else {
            self.waiting = self.waiting.saturating_add(1);
            // The leaders store an entry even without a force, so that their delay lines stay in step with time.
            self.leaders.each().for_each(|leader| leader.keep(&[None; SLOTS], 0.0));
            return RenderedForces::default();
        };
        // A repeated or older packet is waiting time: its motion is no longer the newest at the other end.
        if parcel.t_s > self.parcel_t_s {
            self.parcel_t_s = parcel.t_s;
            self.waiting = 0;
        } else {
            self.waiting = self.waiting.saturating_add(1);
        }
        // If there has not been that much motion yet, anchor at the current tick, which means no correction.
        let age = self.delay_ticks.saturating_add(self.waiting);
        let then = self.postures.get(age).unwrap_or(&now);
        let mut forces = self.leaders.render(parcel, [&now, then], &x, age);
        for leader in self.leaders.each() {
            leader.keep(&forces, now.stance.pace);
            // Judged once per packet: a repeated one would count the same error again.
            if self.waiting == 0 {
                leader.judge(parcel, age);
            }
        }
        // After all modes are rendered, so that mixtures use undamped forces.
        for (mode, damper) in &mut self.dampers {
            let force_n = &mut forces[mode.index()];
            *force_n = force_n.map(|force_n| damper.step(&now.stance, force_n));
        }
        RenderedForces::new(&forces)
    }

    /// Changes the programmed delay, exact to one sample, at most [`MAX_DELAY_S`].
    pub fn set_delay(&mut self, delay_s: f64) {
        self.delay_ticks = self.settings.delay_ticks(delay_s);
        // Packets of a longer link have earlier time stamps than the last one, but they are still new.
        self.parcel_t_s = f64::NEG_INFINITY;
        self.waiting = 0;
    }

    pub fn reset(&mut self) {
        self.track.reset();
        self.postures.clear();
        self.leaders.each().for_each(|leader| leader.reset());
        self.dampers.iter_mut().for_each(|(_, damper)| damper.reset());
        self.parcel_t_s = f64::NEG_INFINITY;
        self.waiting = 0;
    }
}
