//! One frame of the demonstration.

use nima_core::impedance::Mode;
use nima_machine::messages::{Command, LoopState};
use nima_screen::{live::LiveState, outbox::Outbox, scene3d::release_trail::ReleaseTrail};
use nima_words::{report_text::Remedy as _, text};

use super::{
    chapter_time::ChapterPace,
    letting_go::LettingGo,
    recovery::{PersonsStop, Recovery},
    script::{GovernorAction, SCRIPT, ScriptStep},
};

#[derive(Clone, Copy, Debug, Default)]
pub struct DemoState {
    pub(super) step: usize,
    pub(super) held: bool,
    pace: ChapterPace,
    /// The last step whose settings were sent to the loop.
    report: Option<usize>,
    before: Option<PreviousSettings>,
    letting_go: LettingGo,
    recovery: Option<Recovery>,
    stop: PersonsStop,
}

/// Settings before the demonstration.
#[derive(Clone, Copy, Debug)]
struct PreviousSettings {
    mode: Mode,
    delay_s: f64,
    compares: bool,
    static_hold: bool,
}

impl DemoState {
    /// Restores the previous settings.
    pub fn leave(&mut self, outbox: &mut Outbox) {
        let Self { mut letting_go, before, .. } = *self;
        self.begin_anew();
        letting_go.close(0.0, outbox);
        if let Some(PreviousSettings { mode, delay_s, compares, static_hold }) = before {
            outbox.push(Command::SetGovernor(true));
            outbox.push(Command::SetStaticHold(static_hold));
            outbox.push(Command::SetMode(mode));
            outbox.push(Command::SetDelay(delay_s));
            outbox.push(Command::Compare(compares));
        }
    }

    /// Restarts for another loop, with its own settings.
    pub fn begin_anew(&mut self) {
        *self = Self { step: self.step, held: self.held, ..Self::default() };
    }

    /// Advances to the newest tick. Paused while a visitor drives the instrument, by the pause button, or while the loop does
    /// not run.
    pub(super) fn play(&mut self, live: &LiveState, leading: bool, outbox: &mut Outbox) {
        let Some(tick) = live.first_tick() else { return };
        let passed_s = self.pace.passed_s(tick.t_s);
        self.stop.notice(live, tick.t_s, outbox);
        if outbox.holds_stop() {
            return;
        }
        self.recover(live, passed_s, outbox);
        // If the governor ended the engagement because the hand was opened, that is part of the demonstration.
        if live.state() != LoopState::Engaged && !self.letting_go.is_open() {
            return;
        }
        let before = self.enter(live, outbox);
        if !self.held && !leading {
            self.pace.count(passed_s);
        }
        if SCRIPT[self.step].lets_go.is_some() && !leading {
            self.letting_go.play(live, outbox);
        }
        if self.pace.is_over(SCRIPT[self.step].seconds) {
            let following = (1..=SCRIPT.len()).map(|ahead| (self.step + ahead) % SCRIPT.len());
            let possible = following.into_iter().find(|step| may_show(live, &SCRIPT[*step]));
            self.pace.go_on(SCRIPT[self.step].seconds);
            self.step = possible.unwrap_or_default();
        }
        if self.report != Some(self.step) {
            self.notify(live, before, outbox);
        }
    }

    /// Starts the demonstration, if it has not started; returns the previous settings.
    fn enter(&mut self, live: &LiveState, outbox: &mut Outbox) -> PreviousSettings {
        *self.before.get_or_insert_with(|| {
            let compares = outbox.compares(live);
            outbox.push(Command::Compare(true));
            let static_hold = live.gate_settings().static_hold;
            PreviousSettings { mode: live.mode(), delay_s: live.delay_s(), compares, static_hold }
        })
    }

    /// Sends the settings of the chapter to the loop.
    fn notify(&mut self, live: &LiveState, before: PreviousSettings, outbox: &mut Outbox) {
        let ScriptStep { mode, delay_s, lets_go, .. } = SCRIPT[self.step];
        self.letting_go.close(live.first_tick().map_or(0.0, |tick| tick.t_s), outbox);
        self.letting_go.travel_m = None;
        self.letting_go.trail = ReleaseTrail::default();
        // The previous chapter switched the governor off, or the next one needs it.
        if may_let_go(live) {
            outbox.push(Command::SetGovernor(lets_go != Some(GovernorAction::LeftOut)));
        }
        // If the force faded at standstill, there would be nothing to release.
        outbox.push(Command::SetStaticHold(lets_go.is_some() || before.static_hold));
        outbox.push(Command::SetMode(mode));
        outbox.push(Command::SetDelay(delay_s));
        self.report = Some(self.step);
    }

    /// Recovers from a problem that occurred while the demonstration ran. A loop that was already in a fault is left alone.
    fn recover(&mut self, live: &LiveState, passed_s: f64, outbox: &mut Outbox) {
        let state = live.state();
        if state.is_latched() {
            // The loop has closed the hand again.
            self.letting_go = LettingGo::default();
        }
        let now_s = live.first_tick().map_or(0.0, |tick| tick.t_s);
        let is_over = !matches!(state, LoopState::Faulted(_) | LoopState::Idle) || self.letting_go.explains_idle(now_s);
        if is_over || self.before.is_none() || self.stop.holds() || !may_recover(live) {
            self.recovery = None;
            return;
        }
        if self.recovery.is_none() {
            self.recovery = Recovery::of(live);
            if self.recovery.is_some() {
                self.go_to(self.step);
                self.report = None;
            }
        }
        if let Some(recovery) = &mut self.recovery {
            recovery.step(state, passed_s, outbox);
        }
    }

    /// Returns whether something changes with time although the loop is idle: the hand comes back, or a fault is
    /// explained.
    pub const fn moves(&self) -> bool {
        self.letting_go.is_open() || self.recovery.is_some()
    }

    /// Shows this chapter from its start.
    pub(super) const fn go_to(&mut self, step: usize) {
        self.step = step;
        self.pace.begin();
    }

    /// Returns the progress of the chapter, 0 to 1.
    pub(super) const fn progress(&self) -> f64 {
        self.pace.progress(SCRIPT[self.step].seconds)
    }

    /// Returns the trail of the last released handle in this chapter.
    pub(super) const fn trail(&self) -> ReleaseTrail {
        self.letting_go.trail
    }

    /// Returns the explanation of the chapter, or the reason why the demonstration waits, with the remedy.
    pub(super) fn caption(&self, live: &LiveState) -> String {
        let chapter = || SCRIPT[self.step].words.get().to_owned();
        if !may_play(live) {
            return text::roles::NOTE_REAL_RIG.get().to_owned();
        }
        if let Some(recovery) = &self.recovery {
            return recovery.words();
        }
        let words = match live.state() {
            LoopState::Engaged => chapter(),
            LoopState::Idle if self.letting_go.is_open() => chapter(),
            LoopState::Idle => text::roles::NOTE_IDLE.get().to_owned(),
            LoopState::Stopped => text::roles::NOTE_STOPPED.get().to_owned(),
            LoopState::Faulted(fault) => {
                let cause = live.first_fault().unwrap_or(fault).cause();
                text::roles::fault_waits(cause, self.stop.holds())
            }
            LoopState::Ready | LoopState::Clutched | LoopState::Disconnected => {
                text::roles::NOTE_NOT_ENGAGED.get().to_owned()
            }
        };
        let went = self.letting_go.travel_m.map(|travel_m| text::roles::handle_went(1e3 * travel_m));
        went.map_or_else(|| words.clone(), |went| format!("{words} {went}"))
    }
}

/// Returns whether the rig is simulated or emulated, so that no one can be hurt. An arm at another machine may be real.
pub(super) fn may_play(live: &LiveState) -> bool {
    live.rig.is_harmless() && live.line.is_none()
}

/// Returns whether the hand is simulated, and may therefore release the handle or be driven by mouse.
fn may_let_go(live: &LiveState) -> bool {
    live.rig.has_simulated_hand()
}

/// Returns whether the demonstration may leave a fault and engage: the rig has no device, here or at another machine.
fn may_recover(live: &LiveState) -> bool {
    may_play(live) && live.rig.devices.is_none() && live.rig.desk.is_none()
}

/// Returns whether this chapter can be shown on the rig.
fn may_show(live: &LiveState, step: &ScriptStep) -> bool {
    why_not_shown(live, step).is_none()
}

/// Returns the reason why this chapter cannot be shown on the rig.
pub(super) fn why_not_shown(live: &LiveState, step: &ScriptStep) -> Option<&'static str> {
    if !may_play(live) {
        return Some(text::roles::NOTE_REAL_RIG.get());
    }
    let needs_hand = step.lets_go.is_some() || step.is_driven;
    (needs_hand && !may_let_go(live)).then_some(text::commands::SIMULATED_HAND_ONLY.get())
}
