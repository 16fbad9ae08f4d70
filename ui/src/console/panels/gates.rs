//! The panel "Why no force?": the gates between model and hand in order, and the present effect of each.

use egui::{Button, Color32, Label, RichText, TextStyle, Ui, vec2};
use nima_core::safety::{EnergyMode, GATES, Gate as Which, Reason};
use nima_machine::{
    messages::{Fault, LoopState},
    rig::Side,
};

use crate::words::{side_word, state_name, within};
use crate::{
    console::{
        live::Live,
        scene3d::side_name,
        text, theme,
        widgets::{Sign, fitting_style, sign_ui, small},
    },
    words::{Words as _, gate_words},
};

/// A smaller force is not considered a contact, N.
const CONTACT_N: f64 = 0.1;

/// State of the panel: the selected side.
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
                let meaning = text::gates::gates_of(side_word(side));
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
    // Little spacing, so that all nine rows are visible.
    ui.spacing_mut().item_spacing.y = 1.0;
    ui.spacing_mut().interact_size.y = 20.0;
    for gate in gates(live, state.side) {
        gate_ui(ui, live, state.side, &gate);
    }
}

/// The summary: the first closed gate, or that nothing is wrong.
fn answer(live: &Live, side: Side) -> String {
    why_no_force(live, side).unwrap_or_else(|| match live.figures {
        figures if figures.measured_n[side.index()] < CONTACT_N => text::gates::FREE_MOTION.get().to_owned(),
        figures => text::gates::rendered(figures.rendered_n[side.index()]),
    })
}

/// Why this hand gets no force, or less than it should; `None` if nothing is wrong.
pub fn why_no_force(live: &Live, side: Side) -> Option<String> {
    let (gates, hand) = (&live.gates[side.index()], side.index());
    let (measured_n, rendered_n) = (live.figures.measured_n[hand], live.figures.rendered_n[hand]);
    let withheld_n = gates.withheld_n.get();
    let words = match live.tick_of(side).map_or(LoopState::Idle, |tick| tick.state) {
        LoopState::Disconnected => text::gates::NONE_DEVICE_MISSING.get(),
        LoopState::Idle => text::gates::NONE_IDLE.get(),
        LoopState::Ready => text::gates::NONE_GETTING_READY.get(),
        LoopState::Clutched => text::gates::NONE_CLUTCH.get(),
        LoopState::Stopped => text::gates::NONE_STOPPED.get(),
        LoopState::Faulted(Fault::OtherArm) => text::gates::NONE_OTHER_ARM.get(),
        LoopState::Faulted(_) => text::gates::NONE_FAULT.get(),
        LoopState::Engaged if gates.closed(Which::Validity) => text::gates::NONE_INVALID.get(),
        LoopState::Engaged if gates.closed(Which::Age) => text::gates::NONE_STALE.get(),
        LoopState::Engaged if measured_n < CONTACT_N => return None,
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

/// One gate as displayed.
pub(super) struct Gate {
    pub(super) which: Which,
    pub(super) name: &'static str,
    share: f64,
    limits: bool,
    pub(super) note: String,
    pub(super) meaning: &'static str,
}

impl Gate {
    /// Its symbol and the word for it.
    pub(super) fn standing(&self) -> (Sign, &'static str) {
        let acting = self.share > if self.limits { 0.05 } else { 0.5 };
        match (acting, self.limits) {
            (false, _) => (Sign::Disc, text::gates::OPEN.get()),
            (true, false) => (Sign::Square, text::gates::CLOSED.get()),
            (true, true) => (Sign::Ring, text::gates::LIMITING.get()),
        }
    }
}

/// All of them, in the order of the chain.
pub(super) fn gates(live: &Live, side: Side) -> [Gate; GATES] {
    let gates = &live.gates[side.index()];
    Which::ALL.map(|which| {
        let [name, meaning] = gate_words(which);
        let share = match which {
            // A ramp of the gain does not count as a closed gate; a gain of zero does.
            Which::Gain => f64::from(u8::from(live.gain() < 0.01)),
            _ => gates.share(which),
        };
        let limits = matches!(which, Which::Slew | Which::Energy | Which::Ceiling | Which::Governor);
        Gate { which, name, share, limits, note: note(live, side, which), meaning }
    })
}

/// Text beside a gate: its setting, or its present effect.
fn note(live: &Live, side: Side, which: Which) -> String {
    let (gates, chain) = (&live.gates[side.index()], &live.rig.gates);
    match which {
        Which::Permission => within(state_name(live.tick_of(side).map_or(LoopState::Idle, |tick| tick.state))),
        Which::Validity => String::new(),
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
    }
}

/// Energy that the hand may still get back.
fn stored(live: &Live, side: Side) -> String {
    if live.gate_settings().energy == EnergyMode::Off {
        return text::gates::ENERGY_OFF.get().to_owned();
    }
    live.tick_of(side).map_or_else(String::new, |tick| text::gates::energy_left(tick.gates.stored_j * 1e3))
}

/// How often the gate has acted since the loop was created, and why it acted last.
pub(super) fn history(live: &Live, side: Side, gate: Which) -> String {
    let Some(counts) = live.tick_of(side).map(|tick| tick.gates.counts) else { return String::new() };
    let (acted, share, last) = (counts.acted[gate.index()], counts.share(gate), counts.last[gate.index()]);
    match last {
        Reason::Open => text::gates::NEVER_ACTED.get().to_owned(),
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
        let font = fitting_style(ui, &gate.note, &TextStyle::Small, ui.available_width());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| ui.label(small(&gate.note).font(font)));
    });
    row.response.on_hover_text(format!("{}\n{}", gate.meaning, history(live, side, gate.which)));
}
