//! The safety panel: the interlock and the row of gates.

use crate::language::{Text, text_format};

pub const NAME: Text = Text::of("Safety", "Sicherheit");
pub const MEANING: Text = Text::of(
    "Why there is no force: a force passes these gates in this order; a closed gate stops it, a limiting gate reduces \
     it. Below: the states of the interlock",
    "Warum keine Kraft da ist: eine Kraft durchläuft diese Sperren der Reihe nach; eine geschlossene hält sie auf, eine \
     begrenzende verringert sie. Darunter: die Zustände der Verriegelung",
);

pub const IDLE: Text = Text::of("Idle", "Leerlauf");
pub const READY: Text = Text::of("Ready", "Bereit");
pub const ENGAGED: Text = Text::of("Engaged", "Gekoppelt");
pub const CLUTCHED: Text = Text::of("Clutched", "Ausgekuppelt");
pub const STOPPED: Text = Text::of("Stopped", "Angehalten");
pub const FAULT: Text = Text::of("Fault", "Störung");
pub const WHY_ASKED: Text = Text::of("requested by the operator", "vom Bediener angefordert");
pub const WHY_CONNECTED: Text = Text::of("the devices are connected", "Geräte verbunden");
pub const WHY_DISCONNECTED: Text = Text::of("a device was lost", "ein Gerät fiel aus");
pub const WHY_AGREED: Text =
    Text::of("the drives are on, hand and tip are aligned", "Antriebe ein, Hand und Spitze ausgerichtet");
pub const WHY_CLUTCH: Text = Text::of("the clutch", "die Kupplung");
pub const WHY_LATE: Text = Text::of("the drives did not switch on in time", "Antriebe nicht rechtzeitig ein");
pub const WHY_ABSENT: Text = Text::of("no hand holds the handle", "keine Hand hält das Handgerät");
pub const SINCE_START: Text = Text::of("since the loop started", "seit Start der Regelung");
pub const INTERLOCK_HOVER: Text = Text::of(
    "Force and motion are possible in Engaged only. Stop and fault are latched: press Release stop to return to \
     Idle, then Engage. When a device reconnects, the loop returns to Idle. Nothing resumes automatically, \
     except that releasing the clutch returns to Engaged.",
    "Kraft und Bewegung gibt es nur im Zustand Gekoppelt. Halt und Störung sind verriegelt: Halt lösen führt in \
     den Leerlauf, dann koppeln. Ein wieder verbundenes Gerät führt in den Leerlauf. Nichts läuft von selbst \
     wieder an; nur das Loslassen der Kupplung führt zurück zu Gekoppelt.",
);
pub const FROM_ANY_STATE: Text = Text::of("from any state", "aus jedem Zustand");
pub const FORCE_HOVER: Text = Text::of(
    "Magnitude of the force that the mode requests now, and of the force that reaches the hand after all gates \
     (N)",
    "Betrag der Kraft, die der Modus jetzt anfordert, und der Kraft, die nach allen Sperren die Hand erreicht (N)",
);
pub const NO_DEVICE: Text = Text::of("No device", "Kein Gerät");
pub const WHY_FAULT: Text = Text::of("a fault", "eine Störung");
pub const ASKED: Text = Text::of("Requested", "Soll");
pub const HAND: Text = Text::of("In the hand", "In der Hand");
pub const NEVER: Text = Text::of("never", "nie");

/// Returns the suffix that names the side of a rig with two arms.
pub fn of_hand(side: &str) -> String {
    text_format!(", {side} hand", ", Hand {side}")
}

/// Returns the time at which the state was entered, s on the loop's clock, and the cause.
pub fn since(t_s: f64, why: &str) -> String {
    text_format!("since {t_s:.1} s: {why}", "seit {t_s:.1} s: {why}")
}

/// Returns the title of the diagram; `whose` is from [`of_hand`].
pub fn interlock(whose: &str, state: &str) -> String {
    text_format!("Interlock{whose}: {state}", "Verriegelung{whose}: {state}")
}

/// Returns a gate in one sentence; `whose` is from [`of_hand`].
pub fn gate(name: &str, whose: &str, standing: &str, ticks: u64) -> String {
    text_format!(
        "Gate {name}{whose}: {standing}, acted in {ticks} ticks",
        "Sperre {name}{whose}: {standing}, wirkte in {ticks} Takten"
    )
}
