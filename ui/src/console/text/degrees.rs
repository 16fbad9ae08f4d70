//! The panel that compares the chosen polynomial degrees.

use crate::language::{Text, text_format};

pub(in crate::console) const KEY_OURS: Text = Text::of("this console", "diese Konsole");
pub(in crate::console) const KEY_OURS_HOVER: Text = Text::of(
    "The highest power of the position in the model with the smallest recent prediction error; 0 means no correction",
    "Höchste Potenz der Position im Modell mit dem kleinsten jüngsten Vorhersagefehler; 0 heißt keine Korrektur",
);
pub(in crate::console) const KEY_PAPER: Text = Text::of("the paper's rule", "Regel des Artikels");
pub(in crate::console) const KEY_PAPER_HOVER: Text = Text::of(
    "The degree with the smallest error inside the window; 0 means that the window is not full yet",
    "Der Grad mit dem kleinsten Fehler im Fenster; 0 heißt, das Fenster ist noch nicht voll",
);
pub(in crate::console) const NONLINEAR_OURS: Text = Text::of("Nonlinear, this console", "Nichtlinear, diese Konsole");
pub(in crate::console) const NONLINEAR_OURS_HOVER: Text = Text::of(
    "Fraction of ticks in which degree 2 or higher had the smallest prediction error",
    "Anteil der Takte, in denen Grad 2 oder höher den kleinsten Vorhersagefehler hatte",
);
pub(in crate::console) const NONLINEAR_PAPER: Text =
    Text::of("Nonlinear, the paper's rule", "Nichtlinear, Regel des Artikels");
pub(in crate::console) const NONLINEAR_PAPER_HOVER: Text = Text::of(
    "Fraction of ticks in which degree 2 or higher had the smallest error inside the window. A higher degree \
     always fits the window at least as well, so this is near 100 % for any tissue. It is not evidence of \
     nonlinearity. Computed only while all modes are compared.",
    "Anteil der Takte, in denen Grad 2 oder höher den kleinsten Fehler im Fenster hatte. Ein höherer Grad passt immer \
     mindestens so gut ins Fenster, daher nahe 100 % für jedes Gewebe. Kein Beleg für Nichtlinearität. Nur berechnet, \
     solange alle Modi verglichen werden.",
);
pub(in crate::console) const CONDITION: Text = Text::of("Condition", "Kondition");
pub(in crate::console) const CONDITION_HOVER: Text = Text::of(
    "Condition number of the scaled columns that predict best from the window, worst axis, no unit. 1 is \
     perfect; above 10 000 the columns can hardly be distinguished. Computed only while all modes are compared.",
    "Konditionszahl der skalierten Spalten, die aus dem Fenster am besten vorhersagen, schlechteste Achse, ohne \
     Einheit. 1 ist perfekt; über 10 000 sind die Spalten kaum zu unterscheiden. Nur berechnet, solange alle Modi \
     verglichen werden.",
);
pub(in crate::console) const RANK: Text = Text::of("Rank", "Rang");
pub(in crate::console) const RANK_HOVER: Text = Text::of(
    "Number of motion columns that vary enough in the window to be identified, out of all columns (three per \
     degree: position, velocity, acceleration). The ridge regularization gives the others no weight. Used: \
     columns that predict best now. Computed only while all modes are compared.",
    "Zahl der Bewegungsspalten, die im Fenster genug variieren, um identifiziert zu werden, von allen Spalten (drei je \
     Grad: Position, Geschwindigkeit, Beschleunigung). Die Ridge-Regularisierung gibt den übrigen kein Gewicht. \
     Verwendet: Spalten, die jetzt am besten vorhersagen. Nur berechnet, solange alle Modi verglichen werden.",
);
pub(in crate::console) const EXCITATION: Text = Text::of("Excitation", "Anregung");
pub(in crate::console) const EXCITATION_HOVER: Text = Text::of(
    "How much the motion varies within the window: standard deviation of position (mm) and of velocity \
    (mm/s), all axes. Without motion nothing can be identified. Computed only while \
    all modes are compared.",
    "Wie stark die Bewegung im Fenster variiert: Standardabweichung von Position (mm) und Geschwindigkeit (mm/s), alle \
     Achsen. Ohne Bewegung ist nichts identifizierbar. Nur berechnet, solange alle Modi verglichen werden.",
);
pub(in crate::console) const NOT_COMPUTED: Text = Text::of("not computed", "nicht berechnet");
pub(in crate::console) const NONE: Text = Text::of("none", "keiner");

pub(in crate::console) fn last_minutes(minutes: f64) -> String {
    text_format!("last {minutes:.0} min", "letzte {minutes:.0} min")
}

pub(in crate::console) fn columns(rank: u8, of: usize, used: u8) -> String {
    text_format!("{rank} of {of} columns, {used} used", "{rank} von {of} Spalten, {used} verwendet")
}

pub(in crate::console) fn chosen(fractions: &str) -> String {
    text_format!("Degrees chosen: {fractions}", "Gewählte Grade: {fractions}")
}

pub(in crate::console) fn both(ours: &str, papers: &str) -> String {
    text_format!("This console  {ours}\nPaper's rule  {papers}", "Diese Konsole  {ours}\nRegel des Artikels  {papers}")
}
