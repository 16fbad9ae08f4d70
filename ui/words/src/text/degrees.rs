//! The panel that compares the chosen polynomial degrees.

use crate::language::{Text, text_format};

pub const NAME: Text = Text::of("Degrees", "Grade");
pub const MEANING: Text = Text::of(
    "Degree N of the polynomial f = M X between motion and force, chosen every tick from the last 300 ms",
    "Grad N des Polynoms f = M X zwischen Bewegung und Kraft, in jedem Takt aus den letzten 300 ms gewählt",
);

pub const KEY_OURS: Text = Text::of("this console", "diese Konsole");
pub const KEY_OURS_HOVER: Text = Text::of(
    "The highest power of the position in the model with the smallest recent prediction error; 0 means no correction",
    "Höchste Potenz der Position im Modell mit dem kleinsten jüngsten Vorhersagefehler; 0 heißt keine Korrektur",
);
pub const KEY_PAPER: Text = Text::of("the paper's rule", "Regel des Artikels");
pub const KEY_PAPER_HOVER: Text = Text::of(
    "The degree with the smallest error inside the window; 0 means that the window is not full yet",
    "Der Grad mit dem kleinsten Fehler im Fenster; 0 heißt, das Fenster ist noch nicht voll",
);
pub const NONLINEAR_OURS: Text = Text::of("Nonlinear, this console", "Nichtlinear, diese Konsole");
pub const NONLINEAR_OURS_HOVER: Text = Text::of(
    "Fraction of ticks in which degree 2 or higher had the smallest prediction error",
    "Anteil der Takte, in denen Grad 2 oder höher den kleinsten Vorhersagefehler hatte",
);
pub const NONLINEAR_PAPER: Text = Text::of("Nonlinear, the paper's rule", "Nichtlinear, Regel des Artikels");
pub const NONLINEAR_PAPER_HOVER: Text = Text::of(
    "Fraction of ticks in which degree 2 or higher had the smallest error inside the window. A higher degree \
     always fits the window at least as well, so this is near 100 % for any tissue. It is not evidence of \
     nonlinearity.",
    "Anteil der Takte, in denen Grad 2 oder höher den kleinsten Fehler im Fenster hatte. Ein höherer Grad passt immer \
     mindestens so gut ins Fenster, daher nahe 100 % für jedes Gewebe. Kein Beleg für Nichtlinearität.",
);
pub const CONDITION: Text = Text::of("Condition", "Kondition");
pub const CONDITION_HOVER: Text = Text::of(
    "Condition number of the scaled columns that predict best from the window, worst axis, no unit. 1 is \
     perfect; above 10 000 the columns can hardly be distinguished.",
    "Konditionszahl der skalierten Spalten, die aus dem Fenster am besten vorhersagen, schlechteste Achse, ohne \
     Einheit. 1 ist perfekt; über 10 000 sind die Spalten kaum zu unterscheiden.",
);
pub const RANK: Text = Text::of("Rank", "Rang");
pub const RANK_HOVER: Text = Text::of(
    "Number of motion columns that vary enough in the window to be identified, out of all columns (three per \
     degree: position, velocity, acceleration). The ridge regularization gives the others no weight. Used: \
     columns that predict best now.",
    "Zahl der Bewegungsspalten, die im Fenster genug variieren, um identifiziert zu werden, von allen Spalten (drei je \
     Grad: Position, Geschwindigkeit, Beschleunigung). Die Ridge-Regularisierung gibt den übrigen kein Gewicht. \
     Verwendet: Spalten, die jetzt am besten vorhersagen.",
);
pub const EXCITATION: Text = Text::of("Excitation", "Anregung");
pub const EXCITATION_HOVER: Text = Text::of(
    "How much the motion varies within the window: standard deviation of position (mm) and of velocity \
    (mm/s), all axes. Without motion nothing can be identified.",
    "Wie stark die Bewegung im Fenster variiert: Standardabweichung von Position (mm) und Geschwindigkeit (mm/s), alle \
     Achsen. Ohne Bewegung ist nichts identifizierbar.",
);
pub const NONE: Text = Text::of("none", "keiner");

pub const NONLINEAR_AXES: Text = Text::of("Nonlinear, x / y / z", "Nichtlinear, x / y / z");
pub const NONLINEAR_AXES_HOVER: Text = Text::of(
    "The paper's rule along each axis: fraction of ticks in which degree 2 or higher reproduced the force of the last \
     0.1 s best",
    "Regel des Artikels längs jeder Achse: Anteil der Takte, in denen Grad 2 oder höher die Kraft der letzten 0,1 s am \
     besten wiedergab",
);
pub const COST: Text = Text::of("Cost per tick", "Kosten je Takt");
pub const COST_HOVER: Text = Text::of(
    "While this panel is on the screen and the loop is engaged, the loop computes every mode. Shown: the time that \
     this adds to a tick, and the whole work of a tick (medians of the last ticks in contact). The force in the hand \
     does not change.",
    "Solange dieses Panel zu sehen und gekoppelt ist, berechnet die Regelung jeden Modus. Gezeigt: die Zeit, um die das \
     einen Takt verlängert, und die ganze Rechenzeit eines Takts (Mediane der letzten Takte mit Kontakt). Die Kraft in \
     der Hand ändert sich nicht.",
);
pub const ALL_AXES: Text = Text::of("All", "Alle");
pub const ALL_AXES_HOVER: Text =
    Text::of("Shows the degree chosen for all axes together", "Zeigt den für alle Achsen gemeinsam gewählten Grad");
pub const CONTACT: Text = Text::of("in contact", "im Kontakt");
pub const CONTACT_HOVER: Text = Text::of(
    "Counts only ticks with a measured force of 0.3 N or more",
    "Zählt nur Takte mit einer gemessenen Kraft ab 0,3 N",
);
pub const EXPORT: Text = Text::of("CSV", "CSV");
pub const EXPORT_HOVER: Text = Text::of(
    "Saves the fractions and the course over time as tables in the folder plots of the user's data",
    "Speichert die Anteile und den Verlauf als Tabellen im Ordner plots der Nutzerdaten",
);
pub const WAITS: Text = Text::of("Computed while the loop is engaged", "Berechnet, solange gekoppelt ist");

/// Returns what comparing adds to a tick and the whole work of a tick, us, as text.
pub fn cost(added: &str, whole: &str) -> String {
    text_format!("{added} of {whole} µs", "{added} von {whole} µs")
}

pub fn axis_hover(axis: &str) -> String {
    text_format!(
        "Shows the degree along {axis}, by the paper's rule",
        "Zeigt den Grad längs {axis}, Regel des Artikels"
    )
}

/// Returns the accessible name of the plot of the mean degree over time.
pub fn over_time(now: &str) -> String {
    text_format!("Degree over time. Last half second: {now}", "Grad über der Zeit. Letzte halbe Sekunde: {now}")
}

pub fn last_minutes(minutes: f64) -> String {
    text_format!("last {minutes:.0} min", "letzte {minutes:.0} min")
}

pub fn columns(rank: u8, of: usize, used: u8) -> String {
    text_format!("{rank} of {of} columns, {used} used", "{rank} von {of} Spalten, {used} verwendet")
}

pub fn chosen(fractions: &str) -> String {
    text_format!("Degrees chosen: {fractions}", "Gewählte Grade: {fractions}")
}
