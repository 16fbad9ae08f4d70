//! The Trade-off panel.

use crate::language::Text;
pub const NAME: Text = Text::of("Trade-off", "Abwägung");
pub const MEANING: Text = Text::of(
    "Computing time of one tick of identification (µs, on this computer) against the mean prediction \
    error (N), for every mode, degree and window. Measured on a recording of this scene, at the rig's \
    rate and the link's delay.",
    "Rechenzeit eines Identifikationstakts (µs, auf diesem Rechner) über dem mittleren Vorhersagefehler (N), für jeden \
     Modus, Grad und jedes Fenster. Gemessen an einer Aufzeichnung dieser Szene, mit der Rate des Aufbaus und der \
     Verzögerung der Verbindung.",
);
