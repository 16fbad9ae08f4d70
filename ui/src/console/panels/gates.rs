//! "Why is there no force?": the gates between model and hand, in their order, and what each does just now.

use crate::console::text;
use egui::{Button, Color32, Label, RichText, Ui, vec2};
use nima::{
    device::Side,
    runtime::Fault,
    safety::{EnergyMode, Gate as Which, Reason},
    teleop::LoopState,
};

use crate::console::{
    live::Live,
    rolling::Fading,
    scene3d::side_name,
    theme,
    widgets::{Sign, sign_ui, small},
};

/// Below this there is no contact worth rendering, N.
const CONTACT_N: f64 = 0.1;

/// Whose gates are told.
#[derive(Clone, Copy, Debug)]
pub struct GatesState {
    side: Side,
}

impl Default for GatesState {
    fn default() -> Self {
        Self { side: Side::Right }
    }
}

/// The panel.
pub fn gates_ui(ui: &mut Ui, live: &Live, state: &mut GatesState) {
    if live.is_bimanual() {
        ui.horizontal(|ui| {
            for side in [Side::Left, Side::Right] {
                let name = text::common::hand(side_name(side));
                let button = Button::selectable(state.side == side, name).frame_when_inactive(true);
                let meaning = text::gates::gates_of(side.word());
                if ui.add(button.min_size(vec2(104.0, 26.0))).on_hover_text(meaning).clicked() {
                    state.side = side;
                }
            }
        });
    } else {
        state.side = Side::Right;
    }
    ui.add(Label::new(RichText::new(answer(live, state.side)).font(theme::strong(14.0))).wrap());
    ui.add_space(2.0);
    // Nine rows that are to be seen at once.
    ui.spacing_mut().item_spacing.y = 1.0;
    ui.spacing_mut().interact_size.y = 20.0;
    for gate in gates(live, state.side) {
        gate_ui(ui, live, state.side, &gate);
    }
}

/// The answer in one sentence: the first closed gate, or that nothing is wrong.
fn answer(live: &Live, side: Side) -> String {
    why_no_force(live, side).unwrap_or_else(|| match live.figures {
        figures if figures.measured_n[side.index()] < CONTACT_N => text::gates::FREE_MOTION_NO_CONTACT.to_owned(),
        figures => text::gates::there_is(figures.rendered_n[side.index()]),
    })
}

/// Why this hand feels nothing, or less than it should; `None` where nothing is wrong.
pub fn why_no_force(live: &Live, side: Side) -> Option<String> {
    let (gates, hand) = (&live.gates[side.index()], side.index());
    let (measured_n, rendered_n) = (live.figures.measured_n[hand], live.figures.rendered_n[hand]);
    let withheld_n = gates.withheld_n.get();
    let words = match live.tick_of(side).map_or(LoopState::Idle, |tick| tick.state) {
        LoopState::Disconnected => text::gates::NO_FORCE_A_DEVICE,
        LoopState::Idle => text::gates::NO_FORCE_THE_LOOP,
        LoopState::Ready => text::gates::NO_FORCE_YET_THE,
        LoopState::Clutched => text::gates::NO_FORCE_THE_CLUTCH,
        LoopState::Stopped => text::gates::NO_FORCE_STOPPED_BY,
        LoopState::Faulted(Fault::OtherArm) => text::gates::NO_FORCE_THE_OTHER,
        LoopState::Faulted(_) => text::gates::NO_FORCE_STOPPED_BY_A,
        LoopState::Engaged if closed(gates.released) => text::gates::NO_FORCE_THE_HAND,
        LoopState::Engaged if closed(gates.invalid) => text::gates::NO_FORCE_THE_MODE,
        LoopState::Engaged if closed(gates.stale) => text::gates::NO_FORCE_THE_DATA,
        LoopState::Engaged if measured_n < CONTACT_N => return None,
        LoopState::Engaged if closed(gates.dead_band) && withheld_n > 0.05 => {
            return Some(text::gates::withheld_by_dead_band(withheld_n));
        }
        LoopState::Engaged if live.gain() < 0.01 => text::gates::NO_FORCE_THE_GAIN,
        LoopState::Engaged if closed(gates.energy) => text::gates::LESS_FORCE_THE_HAND,
        LoopState::Engaged if rendered_n < 0.05 => {
            return Some(text::gates::on_its_way(live.delay_s() * 1e3));
        }
        LoopState::Engaged => return None,
    };
    Some(words.to_owned())
}

/// One gate as the screen tells it.
pub(super) struct Gate {
    pub(super) which: Which,
    pub(super) name: &'static str,
    share: f64,
    limits: bool,
    pub(super) note: String,
    pub(super) meaning: &'static str,
}

impl Gate {
    /// Its sign and its word.
    pub(super) fn standing(&self) -> (Sign, &'static str) {
        let acting = self.share > if self.limits { 0.05 } else { 0.5 };
        match (acting, self.limits) {
            (false, _) => (Sign::Disc, "open"),
            (true, false) => (Sign::Square, "closed"),
            (true, true) => (Sign::Ring, "limiting"),
        }
    }
}

fn closed(share: Fading) -> bool {
    share.get() > 0.5
}

/// All of them, in the order of the chain.
pub(super) fn gates(live: &Live, side: Side) -> [Gate; 9] {
    let (gates, chain) = (&live.gates[side.index()], &live.rig.gates);
    let gate = |which, name, share: Fading, limits, note, meaning| Gate {
        which,
        name,
        share: share.get(),
        limits,
        note,
        meaning,
    };
    let mut dead_band = gate(
        Which::DeadBand,
        text::gates::DEAD_BAND,
        gates.dead_band,
        false,
        format!("{:.1} mm/s", live.gate_settings().dead_band_m_s * 1e3),
        text::gates::CLOSED_WHILE_THE_HAND,
    );
    if live.gate_settings().static_hold {
        text::gates::OFF_FORCE_IS_KEPT.clone_into(&mut dead_band.note);
    } else if closed(gates.dead_band) && gates.withheld_n.get() > 0.05 {
        dead_band.note = text::gates::withheld(gates.withheld_n.get());
    }
    let mut gain = Fading::default();
    gain.push(f64::from(u8::from(live.gain() < 0.01)), 0.0, 1.0);
    [
        gate(
            Which::Permission,
            text::gates::ENGAGED,
            gates.not_permitted,
            false,
            live.tick_of(side).map_or(LoopState::Idle, |tick| tick.state).word().to_lowercase(),
            text::gates::CLOSED_UNLESS_THE_LOOP,
        ),
        gate(
            Which::Release,
            text::gates::HAND,
            gates.released,
            false,
            if chain.handle_kg > 0.0 { String::new() } else { text::gates::OFF_HANDLE_S_MASS.to_owned() },
            text::gates::CLOSED_WHEN_THE_HANDLE,
        ),
        gate(
            Which::Validity,
            text::gates::VALID,
            gates.invalid,
            false,
            String::new(),
            text::gates::CLOSED_WHEN_THE_MODE,
        ),
        gate(
            Which::Age,
            text::gates::AGE,
            gates.stale,
            false,
            text::gates::zero_after(chain.zero_after_s * 1e3),
            text::gates::FADES_THE_FORCE_WHEN,
        ),
        dead_band,
        gate(
            Which::Gain,
            text::gates::GAIN,
            gain,
            false,
            format!("{:.2}", live.gain()),
            text::gates::THE_OPERATOR_S_FACTOR,
        ),
        gate(
            Which::Slew,
            text::gates::SLEW,
            gates.slew,
            true,
            format!("{:.0} N/s", chain.slew_n_per_s),
            text::gates::LIMITS_HOW_FAST_THE,
        ),
        gate(
            Which::Energy,
            text::gates::ENERGY,
            gates.energy,
            true,
            stored(live, side),
            text::gates::LETS_THE_HAND_GET,
        ),
        gate(
            Which::Ceiling,
            text::gates::CEILING,
            gates.ceiling,
            true,
            format!("{:.1} N", chain.ceiling_n.min(chain.device_limit_n)),
            text::gates::THE_LARGEST_FORCE_THAT,
        ),
    ]
}

/// What the hand may still get back.
fn stored(live: &Live, side: Side) -> String {
    if live.gate_settings().energy == EnergyMode::Off {
        return "off".to_owned();
    }
    live.tick_of(side).map_or_else(String::new, |tick| text::gates::energy_left(tick.gates.stored_j * 1e3))
}

/// How often the gate acted since the loop was made, and why it last did.
pub(super) fn history(live: &Live, side: Side, gate: Which) -> String {
    let Some(counts) = live.tick_of(side).map(|tick| tick.gates.counts) else { return String::new() };
    let (acted, share, last) = (counts.acted[gate.index()], counts.share(gate), counts.last[gate.index()]);
    match last {
        Reason::Open => text::gates::IT_HAS_NOT_ACTED.to_owned(),
        last => text::gates::acted(acted, 100.0 * share, last.words()),
    }
}

fn gate_ui(ui: &mut Ui, live: &Live, side: Side, gate: &Gate) {
    let (what, word) = gate.standing();
    let acting = what != Sign::Disc;
    let colour = if acting { theme::now().text } else { theme::now().engaged.gamma_multiply(0.75) };
    let row = ui.horizontal(|ui| {
        ui.set_height(20.0);
        sign_ui(ui, what, 5.0, colour);
        let ink: Color32 = if acting { theme::now().text } else { theme::now().text_weak };
        ui.label(RichText::new(gate.name).color(ink));
        ui.label(RichText::new(word).color(ink));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| ui.label(small(&gate.note)));
    });
    row.response.on_hover_text(format!("{} {}", gate.meaning, history(live, side, gate.which)));
}
