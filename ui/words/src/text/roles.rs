//! The three views, and the script of the demonstration.

use crate::language::{Text, text_format};

pub const SURGEON: Text = Text::of("Surgeon", "Chirurg");
pub const TECHNICIAN: Text = Text::of("Technician", "Technik");
pub const DEMO: Text = Text::of("Demo", "Demo");
pub const SURGEON_HOVER: Text = Text::of(
    "The endoscope image, the forces with their ceiling, the gain and the alarms",
    "Endoskopbild, Kräfte mit Höchstkraft, Verstärkung und Alarme",
);
pub const TECHNICIAN_HOVER: Text = Text::of(
    "All panels: feedback, devices, calibration, gates, errors, degrees, timing and trade-off",
    "Alle Panels: Rückkopplung, Geräte, Kalibrierung, Sperren, Fehler, Grade, Timing und Abwägung",
);
pub const DEMO_HOVER: Text = Text::of(
    "A demonstration that runs and explains itself, on simulated rigs only",
    "Eine Vorführung, die selbst läuft und sich erklärt, nur auf simulierten Aufbauten",
);
pub const SWITCH_DISABLED_HOVER: Text =
    Text::of("Close the wizard or the study first", "Erst den Assistenten oder die Studie schließen");
pub const DEMO_START: Text = Text::of("What you see", "Was zu sehen ist");
pub const DEMO_START_CAPTION: Text = Text::of(
    "A hand moves an instrument from point to point and presses it into soft tissue. The ivory arrow is the force \
     measured at the instrument; the blue arrow is the force that the hand feels. The link delays all data by 50 \
     ms.",
    "Eine Hand führt ein Instrument von Punkt zu Punkt und drückt es in weiches Gewebe. Der elfenbeinfarbene Pfeil ist \
     die am Instrument gemessene Kraft, der blaue die Kraft, die die Hand spürt. Die Verbindung verzögert alle Daten \
     um 50 ms.",
);
pub const DEMO_DIRECT: Text = Text::of("Direct reflection", "Direkte Kraftreflexion");
pub const DEMO_DIRECT_CAPTION: Text = Text::of(
    "The delay is now 300 ms, and the measured force is sent unmodified: the blue arrow lags behind the ivory \
     arrow. The hand feels contacts that are already over and misses contacts that have just begun.",
    "Die Verzögerung ist jetzt 300 ms, und die gemessene Kraft kommt unverändert an: der blaue Pfeil läuft dem \
     elfenbeinfarbenen nach. Die Hand spürt Kontakte, die schon vorbei sind, und verpasst solche, die gerade begonnen \
     haben.",
);
pub const DEMO_LINEAR: Text = Text::of("Linear impedance", "Lineare Impedanz");
pub const DEMO_LINEAR_CAPTION: Text = Text::of(
    "The link now carries the tissue's impedance instead of the force: stiffness, damping and mass of the last \
     300 ms. The force is computed without delay from the hand's own motion. It is wrong if the impedance \
     has changed since.",
    "Statt der Kraft überträgt die Verbindung jetzt die Impedanz des Gewebes: Steifigkeit, Dämpfung und Masse der \
     letzten 300 ms. Die Kraft folgt ohne Verzögerung aus der Bewegung der Hand selbst. Sie ist falsch, wo sich \
     die Impedanz seither geändert hat.",
);
pub const DEMO_LITERAL: Text = Text::of("Nonlinear, as in the paper", "Nichtlinear, wie im Artikel");
pub const DEMO_LITERAL_CAPTION: Text = Text::of(
    "The paper's method: a polynomial of degree 1 to 5. It fits past data so closely that it predicts \
     poorly, and it renders no force while the hand is at rest. The gates keep its excessive forces from the \
     hand.",
    "Die Methode des Artikels: ein Polynom vom Grad 1 bis 5. Es passt sich vergangenen Daten so genau an, \
     dass es schlecht vorhersagt, und in Ruhe der Hand stellt es keine Kraft dar. Die Sperren halten überhöhte \
     Kräfte von der Hand fern.",
);
pub const DEMO_ANCHORED: Text = Text::of("Anchored", "Verankert");
pub const DEMO_ANCHORED_CAPTION: Text = Text::of(
    "The last measured force, corrected for the hand's motion since then, but only as far as earlier corrections \
     reduced the error. On the right, compare its error with direct reflection.",
    "Die letzte gemessene Kraft, korrigiert um die Handbewegung seither, und nur so weit, wie frühere Korrekturen den \
     Fehler verringert haben. Rechts den Fehler mit der direkten Kraftreflexion vergleichen.",
);
pub const DEMO_MATCHED: Text = Text::of("Matched", "Abgeglichen");
pub const DEMO_MATCHED_CAPTION: Text = Text::of(
    "Same delay, but no force crosses the link, only the tissue's parameters. The blue arrow is computed from \
     the hand's own motion, so a delayed force cannot kick the handle.",
    "Gleiche Verzögerung, doch keine Kraft geht über die Verbindung, nur die Parameter des Gewebes. Der blaue \
     Pfeil wird aus der Bewegung der Hand selbst berechnet, so kann keine verspätete Kraft stoßen.",
);
pub const DEMO_LET_GO: Text = Text::of("Letting go", "Loslassen");
pub const DEMO_LET_GO_CAPTION: Text = Text::of(
    "Direct reflection at 300 ms, without the governor. The hand lets go while pressing: the late force now \
     pushes a handle that no hand holds, and kicks it away.",
    "Direkte Kraftreflexion bei 300 ms, ohne Wächter. Die Hand lässt beim Drücken los: die verspätete Kraft schiebt \
     nun ein Handgerät, das niemand hält, und stößt es weg.",
);
pub const DEMO_GOVERNOR: Text = Text::of("The governor", "Der Wächter");
pub const DEMO_GOVERNOR_CAPTION: Text = Text::of(
    "The same with the last gate, the governor: it detects that no hand bears the force, brakes the handle \
     instead, and ends the feedback. The demonstration engages again when the hand is back.",
    "Dasselbe mit der letzten Sperre, dem Wächter: er erkennt, dass keine Hand die Kraft aufnimmt, bremst \
     stattdessen das Handgerät und beendet die Rückkopplung. Ist die Hand zurück, koppelt die Vorführung neu.",
);
pub const DEMO_YOUR_TURN: Text = Text::of("Your turn", "Selbst probieren");
pub const DEMO_YOUR_TURN_CAPTION: Text = Text::of(
    "Press M, or the button in the view, and move the instrument yourself: drag with the mouse, turn the wheel \
     for height, use the arrow keys for small steps. Press into the tissue and watch the arrows. The mode is now \
     Best of both, which mixes Anchored and Matched by their recent errors. With the rig \"desk\" you can use a \
     SpaceMouse.",
    "M oder die Schaltfläche in der Ansicht drücken und das Instrument selbst führen: mit der Maus ziehen, \
     Mausrad für die Höhe, Pfeiltasten für kleine Schritte. Ins Gewebe drücken und die Pfeile beobachten. Der \
     Modus ist jetzt Bestes aus beiden; er mischt Verankert und Abgeglichen nach ihren letzten Fehlern. Mit dem \
     Aufbau „desk“ geht auch eine SpaceMouse.",
);
pub const PLAY: Text = Text::of("Resume demo", "Demo fortsetzen");
pub const PLAY_HOVER: Text =
    Text::of("Continues with the next chapter automatically", "Geht selbst zum nächsten Kapitel weiter");
pub const HOLD: Text = Text::of("Pause demo", "Demo pausieren");
pub const HOLD_HOVER: Text = Text::of(
    "Stays in this chapter; the control loop keeps running",
    "Bleibt in diesem Kapitel; die Regelung läuft weiter",
);
pub const NOTE_REAL_RIG: Text = Text::of(
    "The demonstration runs on simulated rigs only: on a real rig, mode and delay never change automatically",
    "Die Vorführung läuft nur auf simulierten Aufbauten: auf einem echten ändern sich Modus und Verzögerung nie von \
     selbst",
);
pub const NOTE_IDLE: Text = Text::of(
    "The loop is idle. Press Engage to continue the demonstration.",
    "Regelung im Leerlauf. Zum Fortsetzen der Vorführung koppeln.",
);
pub const NOTE_STOPPED: Text = Text::of(
    "Stopped: no force, no motion. The demonstration waits until you press Release stop, then Engage.",
    "Angehalten: keine Kraft, keine Bewegung. Die Vorführung wartet, bis der Halt gelöst und gekoppelt wird.",
);
/// Reason why the loop ended an engagement without a fault.
pub const HAND_GONE: Text = Text::of(
    "The governor detected no hand on the handle and ended the engagement",
    "Der Wächter fand keine Hand am Handgerät und hat die Kopplung beendet",
);
pub const NOT_ENGAGED_IN_TIME: Text =
    Text::of("The loop did not engage in time", "Die Regelung hat nicht rechtzeitig gekoppelt");
pub const NOTE_NOT_ENGAGED: Text = Text::of("The loop is not engaged yet", "Die Regelung ist noch nicht gekoppelt");
pub const NOTE_CHOOSE_SIMULATED: Text = Text::of(
    "To see it, start the console with a simulated rig",
    "Dafür die Konsole mit einem simulierten Aufbau \
     starten",
);
pub const MEASURED: Text = Text::of("measured at the instrument", "am Instrument gemessen");
pub const RENDERED: Text = Text::of("rendered to the hand", "in der Hand dargestellt");
pub const BARS_HOVER: Text = Text::of(
    "Magnitude of the force measured at the instrument and of the force rendered to the hand (N). The mark is \
     the force ceiling, the largest force that can reach the hand.",
    "Betrag der am Instrument gemessenen und der in der Hand dargestellten Kraft (N). Die Marke ist die Höchstkraft, \
     die größte Kraft, die die Hand erreichen kann.",
);

pub const FIGURES_HOVER: Text = Text::of(
    "How much of the force reaches the hand, and how often each degree of the polynomial was identified in the last \
     minutes",
    "Wie viel der Kraft die Hand erreicht, und wie oft in den letzten Minuten jeder Grad des Polynoms identifiziert wurde",
);

/// Returns the gain, and the name of the degree beside it.
pub fn gain_and_degree(gain: f64) -> String {
    text_format!("Gain {gain:.2}; degree (bars: how often)", "Verstärkung {gain:.2}; Grad (Balken: wie oft)")
}

/// Returns the accessible name of the bars of the degrees.
pub fn degrees(percents: &str) -> String {
    text_format!("Degrees 1 to 5 in the last minutes: {percents}", "Grade 1 bis 5 der letzten Minuten: {percents}")
}

/// Returns the travel of a released handle, at the end of its drawn trail.
pub fn travel(travel_mm: f64) -> String {
    format!("{travel_mm:.0} mm")
}

/// Returns the travel of the handle since its release, mm.
pub fn handle_went(travel_mm: f64) -> String {
    if travel_mm < 10.0 {
        text_format!("The handle moved {travel_mm:.1} mm.", "Weg des Handgeräts: {travel_mm:.1} mm.")
    } else {
        text_format!("The handle moved {travel_mm:.0} mm.", "Weg des Handgeräts: {travel_mm:.0} mm.")
    }
}

pub fn recovers_from_fault(cause: &str, left_s: f64) -> String {
    let what = text_format!(
        "Fault: {cause}. The loop removed force and motion at once",
        "Störung: {cause}. Die Regelung hat Kraft und Bewegung sofort weggenommen"
    );
    recovers(&what, left_s)
}

pub fn recovers(what: &str, left_s: f64) -> String {
    if left_s > 0.0 {
        text_format!(
            "{what}. Nothing here is real: the chapter restarts in {left_s:.0} s, unless you press Stop.",
            "{what}. Hier ist nichts echt: das Kapitel beginnt in {left_s:.0} s neu, außer bei Halt."
        )
    } else {
        text_format!(
            "{what}. Nothing here is real: the chapter restarts as soon as the loop permits it.",
            "{what}. Hier ist nichts echt: das Kapitel beginnt neu, sobald die Regelung es erlaubt."
        )
    }
}

/// Returns a fault that only a person releases: `stopped` if Stop was pressed, otherwise because the rig has devices.
pub fn fault_waits(cause: &str, stopped: bool) -> String {
    if stopped {
        text_format!(
            "Fault: {cause}. Stop was pressed, so the demonstration waits until you press Release stop, then Engage.",
            "Störung: {cause}. Halt wurde gedrückt, deshalb wartet die Vorführung, bis der Halt gelöst und gekoppelt wird."
        )
    } else {
        text_format!(
            "Fault: {cause}. No force, no motion. Press Release stop, then Engage.",
            "Störung: {cause}. Keine Kraft, keine Bewegung. Halt lösen, dann koppeln."
        )
    }
}

/// Returns the hover text of a view, with its key.
pub fn meaning_and_key(meaning: &str, key: &str) -> String {
    text_format!("{meaning}\nKey {key}", "{meaning}\nTaste {key}")
}

/// `measured` and `rendered` have their units, or are "unknown".
pub fn hand(name: &str, measured: &str, rendered: &str, ceiling_n: f64) -> String {
    text_format!(
        "{name}: measured {measured}, rendered {rendered}, ceiling {ceiling_n:.0} N",
        "{name}: gemessen {measured}, dargestellt {rendered}, Höchstkraft {ceiling_n:.0} N"
    )
}

pub fn ceiling(ceiling_n: f64) -> String {
    text_format!("ceiling {ceiling_n:.0} N", "Höchstkraft {ceiling_n:.0} N")
}

/// Returns the text for a ceiling that acts.
pub fn limited(ceiling_n: f64) -> String {
    text_format!("limited to {ceiling_n:.0} N", "auf {ceiling_n:.0} N begrenzt")
}
