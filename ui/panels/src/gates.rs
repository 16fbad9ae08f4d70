//! The gates between model and hand in order, with their current effects, and the reason for a missing force.

use nima_core::safety::{EnergyMode, GATES, Gate as Which, Reason};
use nima_machine::{
    messages::{Fault, ForceSource, LoopState},
    rig::Side,
};
use nima_screen::{live::LiveState, widgets::Sign};
use nima_words::{
    report_text::{ShortText as _, gate_text, state_name, within},
    text,
};

/// A smaller force is not considered a contact, N.
const CONTACT_N: f64 = 0.1;

/// Returns the summary: the first closed gate, or that there is no problem.
pub(super) fn answer(live: &LiveState, side: Side) -> String {
    let is_free = live.figures.measured_n[side.index()].is_none_or(|measured_n| measured_n < CONTACT_N);
    why_no_force(live, side).unwrap_or_else(|| {
        if is_free {
            text::gates::FREE_MOTION.get().to_owned()
        } else {
            text::gates::rendered(live.figures.rendered_n[side.index()])
        }
    })
}

/// Returns the reason why this hand gets no force, or less than it should; `None` if there is no problem.
pub fn why_no_force(live: &LiveState, side: Side) -> Option<String> {
    let gates = &live.gates[side.index()];
    let hand = side.index();
    let rendered_n = live.figures.rendered_n[hand];
    let withheld_n = gates.withheld_n.get();
    let Some(tick) = live.tick_of(side) else { return Some(text::gates::NONE_STARTING.get().to_owned()) };
    let source = tick.force.source;
    let words = match tick.state {
        LoopState::Disconnected => text::gates::NONE_DEVICE_MISSING.get(),
        LoopState::Idle => return Some(why_idle(live, source)),
        LoopState::Ready => text::gates::NONE_GETTING_READY.get(),
        LoopState::Clutched => text::gates::NONE_CLUTCH.get(),
        LoopState::Stopped => text::gates::NONE_STOPPED.get(),
        LoopState::Faulted(Fault::OtherArm) => text::gates::NONE_OTHER_ARM.get(),
        LoopState::Faulted(_) => text::gates::NONE_FAULT.get(),
        LoopState::Engaged if !source.is_known() => return Some(text::gates::none_unknown(source.words())),
        LoopState::Engaged if gates.closed(Which::Validity) => text::gates::NONE_INVALID.get(),
        LoopState::Engaged if gates.closed(Which::Age) => text::gates::NONE_STALE.get(),
        LoopState::Engaged if live.figures.measured_n[hand].is_none_or(|measured_n| measured_n < CONTACT_N) => {
            return None;
        }
        LoopState::Engaged if gates.closed(Which::DeadBand) && withheld_n > 0.05 => {
            return Some(text::gates::withheld_by_dead_band(withheld_n));
        }
        LoopState::Engaged if live.gain() < 0.01 => text::gates::NONE_GAIN.get(),
        LoopState::Engaged if gates.closed(Which::Governor) => text::gates::LESS_GOVERNED.get(),
        LoopState::Engaged if gates.closed(Which::Energy) => text::gates::LESS_ENERGY.get(),
        LoopState::Engaged if rendered_n < 0.05 => {
            return Some(text::gates::on_its_way(live.delay_s() * 1e3));
        }
        LoopState::Engaged => return None,
    };
    Some(words.to_owned())
}

/// Returns the reason why no side is engaged: the first obstacle before pressing Engage.
fn why_idle(live: &LiveState, source: ForceSource) -> String {
    if live.is_shown_only() {
        return text::gates::NONE_IDLE_THEN.get().to_owned();
    }
    match live.engage_closed {
        _ if !source.is_usable() => text::gates::none_unknown(source.words()),
        Some(why) => text::gates::none_idle_closed(why),
        None => text::gates::NONE_IDLE.get().to_owned(),
    }
}

/// One gate as displayed.
pub(super) struct GateView {
    pub(super) which: Which,
    pub(super) name: &'static str,
    fraction: f64,
    limits: bool,
    pub(super) note: String,
    pub(super) meaning: &'static str,
}

impl GateView {
    /// Returns its symbol and state.
    pub(super) fn standing(&self) -> (Sign, &'static str) {
        let acting = self.fraction > if self.limits { 0.05 } else { 0.5 };
        match (acting, self.limits) {
            (false, _) => (Sign::Disc, text::gates::OPEN.get()),
            (true, false) => (Sign::Square, text::gates::CLOSED.get()),
            (true, true) => (Sign::Ring, text::gates::LIMITING.get()),
        }
    }
}

/// Returns all gates, in the order of the chain.
pub(super) fn gates(live: &LiveState, side: Side) -> [GateView; GATES] {
    let gates = &live.gates[side.index()];
    Which::ALL.map(|which| {
        let [name, meaning] = gate_text(which);
        let fraction = match which {
            // A gain that is ramping does not count as a closed gate; a gain of zero does.
            Which::Gain => f64::from(u8::from(live.gain() < 0.01)),
            _ => gates.fraction(which),
        };
        let limits = matches!(which, Which::Slew | Which::Energy | Which::Ceiling | Which::Governor);
        GateView { which, name, fraction, limits, note: note(live, side, which), meaning }
    })
}

/// Returns the text next to a gate: its setting, or its current effect.
fn note(live: &LiveState, side: Side, which: Which) -> String {
    let gates = &live.gates[side.index()];
    let chain = &live.rig.gates;
    if which == Which::Permission {
        return within(state_name(live.tick_of(side).map_or(LoopState::Idle, |tick| tick.state)));
    }
    match which {
        Which::Age => text::gates::zero_after(chain.zero_after_s * 1e3),
        Which::DeadBand if live.gate_settings().static_hold => text::gates::DEAD_BAND_OFF.get().to_owned(),
        Which::DeadBand if gates.closed(Which::DeadBand) && gates.withheld_n.get() > 0.05 => {
            text::gates::withheld(gates.withheld_n.get())
        }
        Which::DeadBand => format!("{:.1} mm/s", live.gate_settings().dead_band_m_s * 1e3),
        Which::Gain => format!("{:.2}", live.gain()),
        Which::Slew => format!("{:.0} N/s", chain.slew_n_per_s),
        Which::Energy => stored(live, side),
        Which::Ceiling => format!("{:.1} N", chain.ceiling_n.min(chain.device_limit_n)),
        Which::Governor if chain.handle_kg <= 0.0 => text::gates::GOVERNOR_OFF.get().to_owned(),
        Which::Governor => text::gates::governed(100.0 * gates.governed.get()),
        // This gate has no setting.
        _ => String::new(),
    }
}

/// Returns the energy that the hand can still get back.
fn stored(live: &LiveState, side: Side) -> String {
    if live.gate_settings().energy == EnergyMode::Off {
        return text::gates::ENERGY_OFF.get().to_owned();
    }
    live.tick_of(side).map_or_else(String::new, |tick| text::gates::energy_left(tick.gates.stored_j * 1e3))
}

/// Returns how often the gate has acted since the loop was created, and the reason of the last time.
pub(super) fn history(live: &LiveState, side: Side, gate: Which) -> String {
    let Some(counts) = live.tick_of(side).map(|tick| tick.gates.counts) else { return String::new() };
    let acted = counts.acted[gate.index()];
    let fraction = counts.fraction(gate);
    let last = counts.last[gate.index()];
    match last {
        Reason::Open => text::gates::NEVER_ACTED.get().to_owned(),
        last => text::gates::acted(acted, 100.0 * fraction, last.words()),
    }
}

#[cfg(test)]
mod tests {
    use nima_machine::{config::RigConfig, messages::Tick, rig::SIDES};
    use nima_simulation::{SimulationPlan, run_virtual, scene::Scene};

    use super::*;

    /// Returns a tick of this scene on the simulated rig at rest, without calibrations.
    fn idle(scene: &str) -> (LiveState, Tick) {
        let rig = RigConfig::load("simulated").unwrap();
        let scene = Scene::load(scene).unwrap();
        let plan =
            SimulationPlan { rig: rig.clone(), scene: scene.clone(), calibrations: Default::default(), engage: false };
        let mut last = None;
        run_virtual(&plan, 0.1, |tick| {
            last = Some(*tick);
            None
        })
        .unwrap();
        (LiveState::new(rig, scene), last.unwrap())
    }

    fn report(live: &mut LiveState, tick: &Tick) -> String {
        live.replay([].iter(), &[Some(*tick), None]);
        live.settle(0.1);
        why_no_force(live, Side::Right).unwrap()
    }

    #[test]
    fn press_engage_stands_only_where_it_can_be_pressed() {
        let (mut live, tick) = idle("peg_transfer");
        assert_eq!(why_no_force(&live, Side::Right).unwrap(), text::gates::NONE_STARTING.get());
        assert_eq!(report(&mut live, &tick), text::gates::NONE_IDLE.get());
        live.engage_closed = Some(text::start::OPEN_DISABLED_HOVER.get());
        let closed = report(&mut live, &tick);
        assert!(closed.contains("Close the calibration wizard") && !closed.contains("press Engage"), "{closed}");
        let mut past = LiveState::of_past(live.rig.clone(), live.scene.clone());
        assert_eq!(report(&mut past, &tick), text::gates::NONE_IDLE_THEN.get());
    }

    #[test]
    fn a_force_that_is_not_known_is_the_cause_before_all_that_follows_from_it() {
        let (mut live, tick) = idle("palpation");
        let report = report(&mut live, &tick);
        assert!(report.contains("the wrist sensor is not calibrated") && !report.contains("Engage"), "{report}");
        for source in ForceSource::UNUSABLE {
            let mut tick = tick;
            tick.force.source = source;
            tick.state = LoopState::Engaged;
            live.replay([].iter(), &[Some(tick), None]);
            assert!(why_no_force(&live, Side::Right).unwrap().contains(source.words()));
        }
    }

    #[test]
    fn an_unknown_force_is_no_number_on_the_screen_and_a_known_one_is_again() {
        let (mut live, mut tick) = idle("peg_transfer");
        let mut show = |live: &mut LiveState, force_n: Option<f64>, error_n: f64| {
            for _ in 0..200 {
                tick.t_s += 1e-3;
                tick.measured_n = nalgebra::Vector3::new(0.0, 0.0, force_n.unwrap_or(f64::NAN));
                tick.identification.horizon_error_n = [error_n; nima_core::impedance::SLOTS];
                live.replay([].iter(), &[Some(tick), None]);
            }
            live.settle(0.2);
            tick.t_s
        };
        show(&mut live, Some(1.5), 0.0);
        assert!(live.figures.horizon_n.iter().all(Option::is_none), "no prediction was judged yet");
        let known_s = show(&mut live, Some(1.5), 0.25);
        assert_eq!(live.figures.measured_n, [Some(1.5), None], "there is no left arm");
        assert!(live.figures.horizon_n.iter().all(Option::is_some));
        let unknown_s = show(&mut live, None, 0.25);
        assert_eq!((live.figures.measured_n, live.figures.horizon_n[0]), ([None; SIDES], None));
        let history = &live.history[Side::Right.index()];
        assert_eq!([known_s, unknown_s].map(|t_s| history.value_at(2, t_s - 0.05)), [Some(1.5), None]);
        assert!(history.value_at(5, unknown_s - 0.05).is_some(), "the force in the hand is known");
        show(&mut live, Some(0.0), 0.25);
        assert!(live.figures.measured_n[0].unwrap() < 1e-9, "zero is a fact again");
    }
}
