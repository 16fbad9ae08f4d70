//! The panel that measures computing time against accuracy.

use crate::language::{Text, told};

pub(in crate::console) const CANCELLED: Text =
    Text::of("Cancelled. The earlier results were kept.", "Abgebrochen. Die früheren Ergebnisse bleiben.");
pub(in crate::console) const FAILED: Text =
    Text::of("The measurement failed. Try again.", "Messung fehlgeschlagen. Erneut versuchen.");
pub(in crate::console) const NOT_MEASURED: Text = Text::of(
    "Not measured yet. It takes a few seconds while the loop keeps running.",
    "Noch nicht gemessen. Dauert einige Sekunden; die Regelung läuft weiter.",
);
pub(in crate::console) const MEASURE_HOVER: Text = Text::of(
    "Runs every combination of mode, degree and window on six seconds of this scene, in a background \
    thread without real-time priority. Other work on this computer makes the times longer and their p99 \
    uncertain.",
    "Rechnet jede Kombination aus Modus, Grad und Fenster auf sechs Sekunden dieser Szene, in einem Hintergrund-Thread \
     ohne Echtzeitpriorität. Andere Last auf diesem Rechner verlängert die Zeiten und macht ihr p99 unsicher.",
);
pub(in crate::console) const MEASURE: Text = Text::of("Measure on this machine…", "Auf diesem Rechner messen…");
pub(in crate::console) const CANCEL: Text = Text::of("Cancel", "Abbrechen");
pub(in crate::console) const CANCEL_HOVER: Text = Text::of(
    "Stops measuring at once; earlier results are kept",
    "Bricht die Messung sofort ab; frühere Ergebnisse \
     bleiben",
);
pub(in crate::console) const FRONT: Text = Text::of(
    "Best choices, cheapest first:",
    "Beste Kombinationen, schnellste \
 zuerst:",
);
pub(in crate::console) const FRONT_HOVER: Text = Text::of(
    "The Pareto front: every other choice takes more time or has a larger error. Only NIMA and \
    literal have a degree, and these two and linear a window.",
    "Die Pareto-Front: jede andere Kombination braucht mehr Zeit oder hat einen größeren Fehler. Nur NIMA und Wörtlich \
     haben einen Grad, diese beiden und Linear ein Fenster.",
);
pub(in crate::console) const APPLY: Text = Text::of("Apply", "Anwenden");
pub(in crate::console) const APPLY_BY_RESTART: Text = Text::of(
    "Degree or window differ from those in use: the loop restarts and is then idle, without force. Press \
    Engage when you are ready.",
    "Grad oder Fenster weichen von den aktiven ab: die Regelung startet neu und ist dann im Leerlauf, ohne Kraft. \
     Koppeln, wenn alles bereit ist.",
);
pub(in crate::console) const APPLY_AT_ONCE: Text =
    Text::of("Applied to the running loop at once", "Wirkt sofort auf die laufende Regelung");
pub(in crate::console) const ON_FRONT: Text = Text::of(
    "\nNo other choice is both faster and more accurate",
    "\nKeine andere Kombination ist schneller und genauer",
);
pub(in crate::console) const TIME_AXIS: Text = Text::of("One tick (µs)", "Ein Takt (µs)");
pub(in crate::console) const APPLIED_BY_RESTART: Text = Text::of(
    "Applied. The loop was restarted and is idle: press Engage when you are ready.",
    "Angewendet. Die Regelung wurde neu gestartet und ist im Leerlauf: koppeln, wenn alles bereit ist.",
);

/// The background thread could not be started.
pub(in crate::console) fn not_started(error: &impl std::fmt::Display) -> String {
    told!("The measurement could not be started: {error}", "Messung nicht gestartet: {error}")
}

/// Progress of the measurement.
pub(in crate::console) fn measured(percent: f32) -> String {
    told!("Trade-off measured: {percent:.0} %", "Abwägung gemessen: {percent:.0} %")
}

/// The loop now uses this choice.
pub(in crate::console) fn applied(choice: &str) -> String {
    told!("Applied: {choice}", "Angewendet: {choice}")
}

/// The loop could not be restarted with the choice.
pub(in crate::console) fn not_applied(reason: &str) -> String {
    told!("Not applied: {reason}", "Nicht angewendet: {reason}")
}

/// All figures of a point.
pub(in crate::console) fn point(
    name: &str,
    [median_us, p99_us]: [&str; 2],
    delay_ms: f64,
    [error_n, ratio]: [&str; 2],
) -> String {
    told!(
        "{name}\none tick: median {median_us} µs, p99 {p99_us} µs\nmean error at {delay_ms:.0} ms: {error_n} N, \
         {ratio} x delayed DFR",
        "{name}\nein Takt: Median {median_us} µs, p99 {p99_us} µs\nmittlerer Fehler bei {delay_ms:.0} ms: {error_n} N, \
         {ratio} x verzögerte DFR"
    )
}

/// Title of the error axis.
pub(in crate::console) fn error_axis(unit: &str) -> String {
    told!("Mean error ({unit})", "Mittlerer Fehler ({unit})")
}

/// The plot in one sentence.
pub(in crate::console) fn plot(points: usize) -> String {
    told!(
        "Trade-off plot: {points} points, time of a tick against prediction error",
        "Abwägungsdiagramm: {points} Punkte, Zeit eines Takts gegen Vorhersagefehler"
    )
}
