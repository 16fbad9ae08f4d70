//! The Trade-off panel (computing time versus accuracy), and the strip below the gain slider.

use nima_study::stability_map::StabilityMapVerdict;
use nima_words::language::{Text, text_format, word};

pub(super) const CANCELLED: Text =
    Text::of("Cancelled. The earlier results were kept.", "Abgebrochen. Die früheren Ergebnisse bleiben.");
pub(super) const FAILED: Text =
    Text::of("The measurement failed. Try again.", "Messung fehlgeschlagen. Erneut versuchen.");
pub(super) const NOT_MEASURED: Text = Text::of(
    "Not measured yet. It takes a few seconds while the loop keeps running.",
    "Noch nicht gemessen. Dauert einige Sekunden; die Regelung läuft weiter.",
);
pub(super) const MEASURE_HOVER: Text = Text::of(
    "Runs every combination of mode, degree and window on six seconds of this scene, in a background thread \
     without real-time priority. Other load on this computer lengthens the times and makes their p99 uncertain.",
    "Rechnet jede Kombination aus Modus, Grad und Fenster auf sechs Sekunden dieser Szene, in einem Hintergrund-Thread \
     ohne Echtzeitpriorität. Andere Last auf diesem Rechner verlängert die Zeiten und macht ihr p99 unsicher.",
);
pub(super) const MEASURE: Text = Text::of("Measure on this machine…", "Auf diesem Rechner messen…");
pub(super) const CANCEL: Text = Text::of("Cancel", "Abbrechen");
pub(super) const CANCEL_HOVER: Text = Text::of(
    "Stops the measurement at once; earlier results are kept",
    "Bricht die Messung sofort ab; frühere Ergebnisse \
     bleiben",
);
pub(super) const FRONT: Text = Text::of(
    "Best choices, fastest first:",
    "Beste Kombinationen, schnellste \
 zuerst:",
);
pub(super) const FRONT_HOVER: Text = Text::of(
    "The Pareto front: every other choice takes more time or has a larger error. Only NIMA and Literal have a \
     degree; only these two and Linear have a window.",
    "Die Pareto-Front: jede andere Kombination braucht mehr Zeit oder hat einen größeren Fehler. Nur NIMA und Wörtlich \
     haben einen Grad, diese beiden und Linear ein Fenster.",
);
pub(super) const APPLY: Text = Text::of("Apply", "Anwenden");
pub(super) const APPLY_BY_RESTART: Text = Text::of(
    "Degree or window differs from the current one: the loop restarts and is then idle, without force. Press \
     Engage when you are ready.",
    "Grad oder Fenster weichen von den aktiven ab: die Regelung startet neu und ist dann im Leerlauf, ohne Kraft. \
     Koppeln, wenn alles bereit ist.",
);
pub(super) const APPLY_AT_ONCE: Text =
    Text::of("Applied to the running loop at once", "Wirkt sofort auf die laufende Regelung");
pub(super) const ON_FRONT: Text = Text::of(
    "\nNo other choice is both faster and more accurate",
    "\nKeine andere Kombination ist schneller und genauer",
);
pub(super) const TIME_AXIS: Text = Text::of("One tick (µs)", "Ein Takt (µs)");
pub(super) const APPLIED_BY_RESTART: Text = Text::of(
    "Applied. The loop was restarted and is idle: press Engage when you are ready.",
    "Angewendet. Die Regelung wurde neu gestartet und ist im Leerlauf: koppeln, wenn alles bereit ist.",
);
pub(super) const STABLE_GAIN_UNKNOWN: Text = Text::of(
    "Highest stable gain: known after the first contact",
    "Stabile Verstärkung: nach dem ersten Kontakt bekannt",
);
pub(super) const STABLE_GAIN_UNMEASURED: Text =
    Text::of("Highest stable gain: not measured in this mode", "Stabile Verstärkung: in diesem Modus nicht gemessen");
pub(super) const STABLE_GAIN_HOVER: Text = Text::of(
    "From simulations of a gripping hand that is pushed aside and must come to rest again, for the current mode \
     and delay and the stiffness of the current contact (N/m; between contacts, of the last one). Force is kept \
     at standstill and the energy gate is off, which is stricter than the default settings. Solid: stable. Thin: \
     at the limit. Hatched: the hand shakes.",
    "Aus Simulationen einer greifenden Hand, die ausgelenkt wird und wieder zur Ruhe kommen muss, für aktuellen Modus, \
     aktuelle Verzögerung und die Steifigkeit des jetzigen Kontakts (N/m; sonst des letzten). Kraft im Stillstand wird \
     gehalten, die Energiesperre ist aus: strenger als die Standardeinstellungen. Voll: stabil. Dünn: an der Grenze. \
     Schraffiert: die Hand zittert.",
);

pub(super) fn not_started(error: &impl std::fmt::Display) -> String {
    text_format!("The measurement could not be started: {error}", "Messung nicht gestartet: „{error}“")
}

pub(super) fn measured(percent: f32) -> String {
    text_format!("Trade-off measured: {percent:.0} %", "Abwägung gemessen: {percent:.0} %")
}

pub(super) fn applied(choice: &str) -> String {
    text_format!("Applied: {choice}", "Angewendet: {choice}")
}

pub(super) fn not_applied(reason: &str) -> String {
    text_format!("Not applied: {reason}", "Nicht angewendet: {reason}")
}

pub(super) fn point(name: &str, [median_us, p99_us]: [&str; 2], delay_ms: f64, [error_n, ratio]: [&str; 2]) -> String {
    text_format!(
        "{name}\none tick: median {median_us} µs, p99 {p99_us} µs\nmean error at {delay_ms:.0} ms: {error_n} N, \
         {ratio} x delayed DFR",
        "{name}\nein Takt: Median {median_us} µs, p99 {p99_us} µs\nmittlerer Fehler bei {delay_ms:.0} ms: {error_n} N, \
         {ratio} x verzögerte DFR"
    )
}

pub(super) fn error_axis(unit: &str) -> String {
    text_format!("Mean error ({unit})", "Mittlerer Fehler ({unit})")
}

pub(super) fn plot(points: usize) -> String {
    text_format!(
        "Trade-off plot: {points} points, time per tick versus prediction error",
        "Abwägungsdiagramm: {points} Punkte, Zeit eines Takts gegen Vorhersagefehler"
    )
}

pub(super) fn stable_up_to(verdict: StabilityMapVerdict, greatest: f64, stiffness_n_m: f64) -> String {
    let verdict = match verdict {
        StabilityMapVerdict::Stable => word("stable", "stabil"),
        StabilityMapVerdict::Marginal => word("at the limit", "an der Grenze"),
        StabilityMapVerdict::Unstable => word("unstable", "instabil"),
    };
    text_format!(
        "This gain is {verdict}; stable up to {greatest:.2} at {stiffness_n_m:.0} N/m",
        "Jetzt {verdict}; stabil bis {greatest:.2} bei {stiffness_n_m:.0} N/m"
    )
}
