//! The tour, the list of keys, and the glossary.

use crate::language::{Text, text_format};

pub const STEP_BACK: Text = Text::of("Step back", "Schritt zurück");
pub const FIRST_STEP: Text = Text::of("This is the first step", "Dies ist der erste Schritt");
pub const NEXT_STEP: Text = Text::of("Next step", "Nächster Schritt");
pub const BEGIN: Text = Text::of("Start", "Beginnen");
pub const SKIP_THE_TOUR: Text = Text::of("Skip tour", "Überspringen");

pub fn step_of(step: usize, steps: usize) -> String {
    text_format!("{step} of {steps}", "{step} von {steps}")
}

/// Title and text of each step.
pub const TOUR: [(Text, Text); 4] = [
    (
        Text::of("Three views of one loop", "Drei Ansichten einer Regelung"),
        Text::of(
            "Surgeon, Technician and Demo: click above, or press F1, F2 or F3. A view changes only the display, \
             never the behaviour of the control loop. Only Demo changes the mode automatically, and only on \
             simulated rigs.",
            "Chirurg, Technik und Demo: oben klicken oder F1, F2, F3 drücken. Eine Ansicht ändert nur die Anzeige, nie \
             das Verhalten der Regelung. Nur Demo ändert den Modus selbsttätig, und nur bei simulierten Aufbauten.",
        ),
    ),
    (
        Text::of("The stop", "Der Halt"),
        Text::of(
            "Stop is always at the top right, and on Space and Escape. It switches force and motion off at once, \
             and they stay off. To restart, press Release stop, then Engage.",
            "Halt ist immer oben rechts und auf Leertaste und Escape. Er schaltet Kraft und Bewegung sofort ab, \
             und das bleibt so. Neu starten: Halt lösen, dann koppeln.",
        ),
    ),
    (
        Text::of("Two forces", "Zwei Kräfte"),
        Text::of(
            "Measured at the instrument: a line with one arrowhead. Rendered to the hand: a beaded line with two \
             arrowheads. Arrows, bars and traces use the same two styles.",
            "Am Instrument gemessen: Linie mit einer Pfeilspitze. In der Hand dargestellt: Perlenlinie mit zwei \
             Pfeilspitzen. Pfeile, Balken und Verläufe folgen denselben zwei Stilen.",
        ),
    ),
    (
        Text::of("Help on hover", "Hilfe am Zeiger"),
        Text::of(
            "Hold the pointer over any number to see its unit, its frame and its meaning. M: drive the instrument by \
             mouse. E: mark a moment in the traces. F4: keys and glossary. Ctrl P: every command by its name.",
            "Der Zeiger auf einer Zahl zeigt Einheit, Koordinatensystem und Bedeutung. M: Instrument mit der Maus \
             steuern. E: Moment in den Verläufen markieren. F4: Tasten und Glossar. Ctrl P: jeder Befehl über den \
             Namen.",
        ),
    ),
];

/// Terms of the field and of this program, with their explanations.
pub const GLOSSARY: [(Text, Text); 25] = [
    (
        Text::of("Anchored", "Verankert"),
        Text::of(
            "A mode of this console: the last measured force, corrected for the hand's motion since then as far \
             as earlier corrections reduced the error.",
            "Ein Modus dieser Konsole: die letzte gemessene Kraft, korrigiert um die Handbewegung seither, \
             soweit frühere Korrekturen den Fehler verringerten.",
        ),
    ),
    (
        Text::of("Ceiling", "Höchstkraft"),
        Text::of("The largest force that can reach the hand, N.", "Die größte Kraft, die die Hand erreichen kann, N."),
    ),
    (
        Text::of("Clutch", "Kupplung"),
        Text::of(
            "While it is pressed, the hand moves freely and the follower holds still.",
            "Gedrückt ist die Hand frei beweglich und der Folgearm steht still.",
        ),
    ),
    (
        Text::of("Condition", "Kondition"),
        Text::of(
            "How well the columns of a model can be distinguished; 1 is perfect, above 10 000 hardly at all.",
            "Wie gut die Spalten eines Modells unterscheidbar sind; 1 ist perfekt, über 10 000 kaum noch.",
        ),
    ),
    (
        Text::of("Correspondence", "Korrespondenz"),
        Text::of(
            "The rotation between the sensor under the tissue and the sensor at the wrist.",
            "Die Drehung zwischen dem Sensor unter dem Gewebe und dem am Handgelenk.",
        ),
    ),
    (
        Text::of("Dead band", "Totband"),
        Text::of(
            "Hand speed below which no force is rendered: at standstill an impedance cannot be identified.",
            "Handgeschwindigkeit, unter der keine Kraft dargestellt wird: im Stillstand ist eine Impedanz nicht \
             identifizierbar.",
        ),
    ),
    (
        Text::of("Degree", "Grad"),
        Text::of(
            "N of the polynomial between motion and force; 0 means no correction.",
            "N des Polynoms zwischen Bewegung und Kraft; 0 heißt keine Korrektur.",
        ),
    ),
    (
        Text::of("Delay", "Verzögerung"),
        Text::of(
            "Time that a measurement takes from the follower to the hand, one way, ms.",
            "Zeit, die eine Messung vom Folgearm zur Hand braucht, einfacher Weg, ms.",
        ),
    ),
    (
        Text::of("DFR", "DFR"),
        Text::of(
            "Direct force reflection: the measured force, delayed by the link.",
            "Direkte Kraftreflexion: die gemessene Kraft, um die Verbindung verzögert.",
        ),
    ),
    (
        Text::of("Excitation", "Anregung"),
        Text::of(
            "How much the motion in the window varies. Without motion nothing can be identified.",
            "Wie stark die Bewegung im Fenster variiert. Ohne Bewegung ist nichts identifizierbar.",
        ),
    ),
    (
        Text::of("Follower", "Folgearm"),
        Text::of("The robot arm with the instrument.", "Der Roboterarm mit dem Instrument."),
    ),
    (
        Text::of("Gain", "Verstärkung"),
        Text::of(
            "Ratio of the force in the hand to the force that the mode requests, no unit.",
            "Verhältnis der Kraft in der Hand zu der vom Modus verlangten, ohne Einheit.",
        ),
    ),
    (
        Text::of("Gate", "Sperre"),
        Text::of(
            "A safety function between the model and the hand that can reduce or stop the force.",
            "Eine Sicherheitsfunktion zwischen Modell und Hand, die die Kraft verringern oder aufhalten kann.",
        ),
    ),
    (
        Text::of("Held out", "Testdaten"),
        Text::of(
            "Data that were not used for a fit and therefore show its true error.",
            "Daten, die nicht in den Fit eingehen und daher seinen wahren Fehler zeigen.",
        ),
    ),
    (
        Text::of("Prediction horizon", "Vorhersagehorizont"),
        Text::of(
            "The link's delay: how far ahead of its newest data the leader predicts the force.",
            "Die Verzögerung der Verbindung: wie weit über seine neuesten Daten hinaus das Führungsgerät die Kraft \
             vorhersagt.",
        ),
    ),
    (
        Text::of("IMA, NIMA", "IMA, NIMA"),
        Text::of(
            "(Nonlinear) impedance matching: the link carries the tissue's impedance instead of the force.",
            "(Nichtlineare) Impedanzanpassung: die Verbindung überträgt die Impedanz des Gewebes statt der Kraft.",
        ),
    ),
    (
        Text::of("Interlock", "Verriegelung"),
        Text::of(
            "The only part that permits force and motion: a state machine.",
            "Der Zustandsautomat, der als einziger Kraft und Bewegung freigibt.",
        ),
    ),
    (
        Text::of("Leader", "Führungsgerät"),
        Text::of("The haptic device in the hand.", "Das haptische Gerät in der Hand."),
    ),
    (
        Text::of("Measured", "Gemessen"),
        Text::of("The force at the tip of the instrument now, N.", "Die Kraft an der Instrumentenspitze jetzt, N."),
    ),
    (
        Text::of("Missed", "Versäumt"),
        Text::of(
            "Periods that the control loop missed because it was late; counted and skipped, never caught up.",
            "Takte, die die Regelung wegen Verspätung versäumt hat; gezählt und übersprungen, nie nachgeholt.",
        ),
    ),
    (
        Text::of("Rendered", "Dargestellt"),
        Text::of(
            "The force commanded to the hand after all gates, N.",
            "Die der Hand nach allen Sperren befohlene Kraft, N.",
        ),
    ),
    (
        Text::of("Tip force", "Kraft an der Spitze"),
        Text::of(
            "The force at the tip, estimated from the wrist sensor without gravity and without the trocar's friction, \
             N.",
            "Aus dem Handgelenksensor geschätzt, ohne Schwerkraft und ohne die Reibung des Trokars, N.",
        ),
    ),
    (
        Text::of("Trocar", "Trokar"),
        Text::of(
            "The port through which the instrument enters the body; the remote centre of its motion.",
            "Der Zugang, durch den das Instrument in den Körper führt; der ferne Drehpunkt seiner Bewegung.",
        ),
    ),
    (
        Text::of("World", "Welt"),
        Text::of(
            "The frame of all forces and positions (kbf in the paper): z up, the tissue at rest at z = 0. Forces act \
             on the instrument.",
            "Koordinatensystem aller Kräfte und Positionen (kbf im Artikel): z nach oben, ruhendes Gewebe bei z = 0. \
             Kräfte wirken auf das Instrument.",
        ),
    ),
    (
        Text::of("Wrench", "Kraftschraube"),
        Text::of(
            "Force and torque together, as the wrist sensor measures them.",
            "Kraft und Drehmoment zusammen, wie der Handgelenksensor sie misst.",
        ),
    ),
];

pub const KEYS_HEADING: Text = Text::of("Keys", "Tasten");
pub const WORDS_HEADING: Text = Text::of("Terms", "Begriffe");

pub const GLOSSARY_WINDOW: Text = Text::of("Glossary", "Glossar");
pub const TOUR_WINDOW: Text = Text::of("Tour", "Rundgang");
