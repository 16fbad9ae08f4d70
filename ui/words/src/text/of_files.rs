//! Names and descriptions of the built-in rigs and scenes, and words of the computer's devices: files and libraries contain
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
        "A hand leads an instrument from point to point and presses into soft tissue at each.",
        "Eine Hand führt ein Instrument von Punkt zu Punkt und drückt es jeweils in weiches Gewebe.",
    ),
    Text::of("Two hands on soft tissue", "Zwei Hände auf weichem Gewebe"),
    Text::of(
        "Two hands, two instruments: each goes from point to point on its own side and presses into soft tissue.",
        "Zwei Hände, zwei Instrumente: jedes geht auf seiner Seite von Punkt zu Punkt und drückt in weiches Gewebe.",
    ),
    Text::of("Rings on pegs", "Ringe auf Stäben"),
    Text::of(
        "Peg transfer: six rings go over to the other side and back; each changes hands in mid-air.",
        "Peg-Transfer: sechs Ringe kommen auf die andere Seite und zurück; jeder wird in der Luft übergeben.",
    ),
    Text::of("Find the lumps", "Knoten suchen"),
    Text::of(
        "Palpation: five stiff lumps are hidden in soft tissue; the hand feels for them and marks them.",
        "Palpation: in weichem Gewebe sind fünf harte Knoten verborgen; die Hand ertastet und markiert sie.",
    ),
    Text::of("Loop along a wire", "Schlaufe am Draht"),
    Text::of(
        "A loop is led along a bent wire from its free end to the goal, without touching it.",
        "Eine Schlaufe wird vom freien Ende eines gebogenen Drahts ans Ziel geführt, ohne ihn zu berühren.",
    ),
    Text::of("Free motion", "Freie Bewegung"),
    Text::of(
        "The same hand and instrument in free space: every force that is rendered here is an error.",
        "Hand und Instrument ohne Kontakt: jede hier dargestellte Kraft ist ein Fehler.",
    ),
    Text::of("Hidden lumps", "Verborgene Knoten"),
    Text::of(
        "A hand feels its way over soft tissue with stiff lumps in it that nobody sees.",
        "Eine Hand tastet weiches Gewebe ab, in dem harte Knoten unsichtbar sind.",
    ),
    Text::of("Palpation through a trocar", "Palpation durch einen Trokar"),
    Text::of(
        "Soft tissue, felt at the wrist: weight, seal friction and tissue together, as on a real rig.",
        "Weiches Gewebe, am Handgelenk gemessen: Gewicht, Reibung der Dichtung und Gewebe zusammen, wie am echten Aufbau.",
    ),
    Text::of("Gravity calibration", "Schwerkraftkalibrierung"),
    Text::of(
        "Somebody turns the tool into the poses that the screen asks for; nothing touches it.",
        "Eine Person dreht das Werkzeug in die verlangten Lagen; nichts berührt es.",
    ),
    Text::of("Sensor correspondence", "Zuordnung der Sensoren"),
    Text::of(
        "The paper's Experiment 1: no body wall, the tool pushes tissue that lies on a second sensor.",
        "Versuch 1 des Artikels: ohne Bauchdecke, das Werkzeug drückt auf Gewebe, das auf einem zweiten Sensor liegt.",
    ),
    Text::of("Tip force isolation", "Trennung der Spitzenkraft"),
    Text::of(
        "The paper's Experiment 2: through the trocar onto tissue that lies on a second sensor.",
        "Versuch 2 des Artikels: durch den Trokar auf Gewebe, das auf einem zweiten Sensor liegt.",
    ),
    Text::of("No contact", "Ohne Kontakt"),
    Text::of(
        "Through the trocar in free space: any tip force reported here is an error.",
        "Durch den Trokar ohne Kontakt: jede hier gemeldete Spitzenkraft ist ein Fehler.",
    ),
    Text::of("serial port", "serielle Schnittstelle"),
    Text::of("not on USB", "nicht an USB"),
    Text::of("other input device", "anderes Eingabegerät"),
    Text::of("library", "Bibliothek"),
    Text::of("Force Dimension haptic device", "Haptisches Gerät von Force Dimension"),
];

/// Returns words of a file in the language of the window; those that a user wrote stay as they are.
pub fn of_file(words: &str) -> &str {
    KNOWN.iter().find(|text| text.english() == words).map_or(words, |text| text.get())
}
