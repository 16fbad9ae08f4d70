//! Names and descriptions of the built-in rigs and scenes, and names of the computer's ports: files and libraries contain
//! them in English.

use crate::language::Text;

const KNOWN: &[Text] = &[
    Text::of("Simulated rig", "Simulierter Aufbau"),
    Text::of("Desk rig", "Tischaufbau"),
    Text::of("Haply desk", "Tisch mit Haply"),
    Text::of("Emulated rig", "Emulierter Aufbau"),
    Text::of("Paper rig", "Aufbau des Artikels"),
    Text::of("Six points on soft tissue", "Sechs Punkte auf weichem Gewebe"),
    Text::of(
        "A hand moves an instrument from point to point and presses into soft tissue at each.",
        "Eine Hand führt ein Instrument von Punkt zu Punkt und drückt es jeweils in weiches Gewebe.",
    ),
    Text::of("Two hands on soft tissue", "Zwei Hände auf weichem Gewebe"),
    Text::of(
        "Two hands with two instruments: each moves from point to point on its side and presses into soft tissue.",
        "Zwei Hände, zwei Instrumente: jedes geht auf seiner Seite von Punkt zu Punkt und drückt in weiches Gewebe.",
    ),
    Text::of("Rings on pegs", "Ringe auf Stäben"),
    Text::of(
        "Peg transfer: carry six rings to the other side and back; each ring changes hands in mid-air.",
        "Peg-Transfer: sechs Ringe auf die andere Seite und zurück bringen; jeder wird in der Luft übergeben.",
    ),
    Text::of("Find the lumps", "Knoten suchen"),
    Text::of(
        "Palpation: find and mark five stiff lumps that are hidden in soft tissue.",
        "Palpation: fünf harte Knoten, in weichem Gewebe verborgen, finden und markieren.",
    ),
    Text::of("Loop along a wire", "Schlaufe am Draht"),
    Text::of(
        "Guide a loop along a bent wire, from its free end to the goal, without touching it.",
        "Eine Schlaufe vom freien Ende eines gebogenen Drahts ans Ziel führen, ohne ihn zu berühren.",
    ),
    Text::of("Free motion", "Freie Bewegung"),
    Text::of(
        "A hand moves an instrument in free space: every force rendered here is an error.",
        "Eine Hand bewegt ein Instrument ohne Kontakt: jede hier dargestellte Kraft ist ein Fehler.",
    ),
    Text::of("Hidden lumps", "Verborgene Knoten"),
    Text::of(
        "A hand strokes over soft tissue that contains invisible stiff lumps.",
        "Eine Hand streicht über weiches Gewebe mit unsichtbaren harten Knoten.",
    ),
    Text::of("Palpation through a trocar", "Palpation durch einen Trokar"),
    Text::of(
        "Soft tissue, measured at the wrist: weight, friction in the trocar and tissue force together, as on a real rig.",
        "Weiches Gewebe, am Handgelenk gemessen: Gewicht, Reibung im Trokar und Gewebekraft zusammen, wie am echten Aufbau.",
    ),
    Text::of("Gravity calibration", "Schwerkraftkalibrierung"),
    Text::of(
        "A person turns the tool to the poses shown on the screen; nothing touches it.",
        "Eine Person dreht das Werkzeug in die gezeigten Lagen; nichts berührt es.",
    ),
    Text::of("Sensor correspondence", "Zuordnung der Sensoren"),
    Text::of(
        "The paper's Experiment 1: without a body wall, the tool pushes tissue on a second sensor.",
        "Versuch 1 des Artikels: ohne Bauchdecke drückt das Werkzeug auf Gewebe über einem zweiten Sensor.",
    ),
    Text::of("Tip force isolation", "Trennung der Spitzenkraft"),
    Text::of(
        "The paper's Experiment 2: through the trocar, the tool pushes tissue on a second sensor.",
        "Versuch 2 des Artikels: durch den Trokar drückt das Werkzeug auf Gewebe über einem zweiten Sensor.",
    ),
    Text::of("No contact", "Ohne Kontakt"),
    Text::of(
        "Motion through the trocar in free space: any tip force reported here is an error.",
        "Bewegung durch den Trokar ohne Kontakt: jede hier gemeldete Spitzenkraft ist ein Fehler.",
    ),
    Text::of("serial port", "serielle Schnittstelle"),
    Text::of("not on USB", "nicht an USB"),
    Text::of("other input device", "anderes Eingabegerät"),
    Text::of("library", "Bibliothek"),
    Text::of("Force Dimension haptic device", "Haptisches Gerät von Force Dimension"),
];

/// Returns a text of a file in the language of the window; a text that a user wrote stays unchanged.
pub fn of_file(words: &str) -> &str {
    KNOWN.iter().find(|text| text.english() == words).map_or(words, |text| text.get())
}
