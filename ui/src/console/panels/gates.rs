//! "Why is there no force?": the gates between model and hand, in their order, and what each does just now.

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
                let name = format!("{} hand", side_name(side));
                let button = Button::selectable(state.side == side, name).frame_when_inactive(true);
                let meaning = format!("Tells why there is no force in the {} hand.", side.word());
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
        figures if figures.measured_n[side.index()] < CONTACT_N => {
            "Free motion: no contact, nothing to render.".to_owned()
        }
        figures => format!("There is: {:.1} N in the hand.", figures.rendered_n[side.index()]),
    })
}

/// Why this hand feels nothing, or less than it should; `None` where nothing is wrong.
pub fn why_no_force(live: &Live, side: Side) -> Option<String> {
    let (gates, hand) = (&live.gates[side.index()], side.index());
    let (measured_n, rendered_n) = (live.figures.measured_n[hand], live.figures.rendered_n[hand]);
    let withheld_n = gates.withheld_n.get();
    let words = match live.tick_of(side).map_or(LoopState::Idle, |tick| tick.state) {
        LoopState::Disconnected => "No force: a device is missing (see the devices).",
        LoopState::Idle => "No force: the loop is idle. Press Engage.",
        LoopState::Ready => "No force yet: the drives are coming on.",
        LoopState::Clutched => "No force: the clutch is pressed, the hand moves freely.",
        LoopState::Stopped => "No force: stopped by the operator.",
        LoopState::Faulted(Fault::OtherArm) => "No force: the other arm was stopped by a fault.",
        LoopState::Faulted(_) => "No force: stopped by a fault.",
        LoopState::Engaged if closed(gates.released) => {
            "No force: the hand has let go. It comes back when the contact has ended."
        }
        LoopState::Engaged if closed(gates.invalid) => "No force: the mode has nothing valid to render.",
        LoopState::Engaged if closed(gates.stale) => "No force: the data are too old.",
        LoopState::Engaged if measured_n < CONTACT_N => return None,
        LoopState::Engaged if closed(gates.dead_band) && withheld_n > 0.05 => {
            return Some(format!("{withheld_n:.1} N not rendered (dead band)"));
        }
        LoopState::Engaged if live.gain() < 0.01 => "No force: the gain is zero.",
        LoopState::Engaged if closed(gates.energy) => "Less force: the hand would get back more energy than it gave.",
        LoopState::Engaged if rendered_n < 0.05 => {
            return Some(format!("On its way: the link is {:.0} ms late.", live.delay_s() * 1e3));
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
        "Dead band",
        gates.dead_band,
        false,
        format!("{:.1} mm/s", live.gate_settings().dead_band_m_s * 1e3),
        "Closed while the hand is slower than this. At standstill an impedance cannot be told from a constant force.",
    );
    if live.gate_settings().static_hold {
        "off: force is kept".clone_into(&mut dead_band.note);
    } else if closed(gates.dead_band) && gates.withheld_n.get() > 0.05 {
        dead_band.note = format!("{:.1} N not rendered", gates.withheld_n.get());
    }
    let mut gain = Fading::default();
    gain.push(f64::from(u8::from(live.gain() < 0.01)), 0.0, 1.0);
    [
        gate(
            Which::Permission,
            "Engaged",
            gates.not_permitted,
            false,
            live.tick_of(side).map_or(LoopState::Idle, |tick| tick.state).word().to_lowercase(),
            "Closed unless the loop is engaged. Stop closes it at once.",
        ),
        gate(
            Which::Release,
            "Hand",
            gates.released,
            false,
            if chain.handle_kg > 0.0 { String::new() } else { "off: handle's mass unknown".to_owned() },
            "Closed when the handle flies off as it does without a hand, until the contact has ended or the loop is engaged anew.",
        ),
        gate(
            Which::Validity,
            "Valid",
            gates.invalid,
            false,
            String::new(),
            "Closed when the mode asks for nothing, for something not finite, or for more than 1000 N.",
        ),
        gate(
            Which::Age,
            "Age",
            gates.stale,
            false,
            format!("zero after {:.0} ms", chain.zero_after_s * 1e3),
            "Fades the force when data are older than the link's own delay, to zero after this time.",
        ),
        dead_band,
        gate(Which::Gain, "Gain", gain, false, format!("{:.2}", live.gain()), "The operator's factor. Closed at zero."),
        gate(
            Which::Slew,
            "Slew",
            gates.slew,
            true,
            format!("{:.0} N/s", chain.slew_n_per_s),
            "Limits how fast the force may change, so that no step kicks the hand.",
        ),
        gate(
            Which::Energy,
            "Energy",
            gates.energy,
            true,
            stored(live, side),
            "Lets the hand get back what it gave and a little more: takes the force along its motion away when that is used up.",
        ),
        gate(
            Which::Ceiling,
            "Ceiling",
            gates.ceiling,
            true,
            format!("{:.1} N", chain.ceiling_n.min(chain.device_limit_n)),
            "The largest force that ever reaches the hand, never above what the device can give.",
        ),
    ]
}

/// What the hand may still get back.
fn stored(live: &Live, side: Side) -> String {
    if live.gate_settings().energy == EnergyMode::Off {
        return "off".to_owned();
    }
    live.tick_of(side).map_or_else(String::new, |tick| format!("{:.0} mJ left", tick.gates.stored_j * 1e3))
}

/// How often the gate acted since the loop was made, and why it last did.
pub(super) fn history(live: &Live, side: Side, gate: Which) -> String {
    let Some(counts) = live.tick_of(side).map(|tick| tick.gates.counts) else { return String::new() };
    let (acted, share, last) = (counts.acted[gate.index()], counts.share(gate), counts.last[gate.index()]);
    match last {
        Reason::Open => "It has not acted so far.".to_owned(),
        last => format!("Acted on {acted} ticks ({:.1} %); the last time: {}.", 100.0 * share, last.words()),
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
