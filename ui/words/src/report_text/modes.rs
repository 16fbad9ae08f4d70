//! Texts: the rendering modes.

use nima_core::impedance::{Baseline, MODES, Mode};

use crate::language::word;

/// The modes for everyone, in the order in which they are offered: the default, and the two to compare it with.
pub const EVERYDAY: [Mode; 3] = [Mode::Best, Mode::Matched, Mode::Dfr];

/// The program's other modes, in the order in which they are offered.
pub const OF_RESEARCH: [Mode; MODES - EVERYDAY.len()] = [Mode::Anchored, Mode::Nima, Mode::Literal, Mode::Linear];

/// All of these modes, in the order in which they are compared.
pub const COMPARED: [Mode; MODES] =
    [Mode::Best, Mode::Matched, Mode::Anchored, Mode::Dfr, Mode::Nima, Mode::Linear, Mode::Literal];

/// Returns the name of a mode on a button.
pub fn mode_name(mode: Mode) -> &'static str {
    words(mode)[0]
}

/// Returns the explanation of a mode, one sentence.
pub fn mode_meaning(mode: Mode) -> &'static str {
    words(mode)[1]
}

/// Returns the meaning of a mode in one short line.
pub fn mode_line(mode: Mode) -> &'static str {
    match mode {
        Mode::Best => word("Predicts the force; recommended", "Sagt die Kraft voraus; empfohlen"),
        Mode::Matched => word("The force of a tissue model", "Die Kraft eines Gewebemodells"),
        Mode::Dfr => word("The measured force, delayed", "Die gemessene Kraft, verzögert"),
        Mode::Anchored => word("The last force, corrected for the motion", "Letzte Kraft, um die Bewegung korrigiert"),
        Mode::Nima => word("The paper's polynomials, predictive", "Polynome des Artikels, vorausschauend"),
        Mode::Literal => word("Exactly as in the paper", "Genau wie im Artikel"),
        Mode::Linear => word("As Literal, always of degree 1", "Wie Wörtlich, immer Grad 1"),
        Mode::Baseline(_) => word("For comparison, named in the rig file", "Zum Vergleich, in der Aufbaudatei genannt"),
    }
}

/// Returns the name and explanation. Methods of other authors appear on the screen only if the rig file names one.
fn words(mode: Mode) -> [&'static str; 2] {
    match mode {
        Mode::Literal => [
            word("Literal", "Wörtlich"),
            word(
                "Exactly as in the paper: renders M X from the hand's own motion, with the degree that has the \
                 smallest error inside the window. Renders no force at standstill.",
                "Genau wie im Artikel: stellt M X aus der Bewegung der Hand dar, mit dem Grad, der im Fenster den \
                 kleinsten Fehler hat. Im Stillstand keine Kraft.",
            ),
        ],
        Mode::Linear => [
            word("Linear", "Linear"),
            word(
                "The paper's linear predecessor: like Literal, but always with degree 1",
                "Der lineare Vorgänger im Artikel: wie Wörtlich, aber immer mit Grad 1",
            ),
        ],
        Mode::Dfr => [
            word("Direct (DFR)", "Direkt (DFR)"),
            word(
                "Direct force reflection: the measured force, delayed by the link",
                "Direkte Kraftreflexion: die gemessene Kraft, durch die Verbindung verzögert",
            ),
        ],
        Mode::Anchored => [
            word("Anchored", "Verankert"),
            word(
                "The last measured force, corrected by the identified impedance for the hand's motion since then. \
    Where a correction does not reduce the error, it is plain direct reflection.",
                "Die letzte gemessene Kraft, mit der identifizierten Impedanz um die Handbewegung seither korrigiert. \
                 Wo eine Korrektur den Fehler nicht senkt, reine direkte Reflexion.",
            ),
        ],
        Mode::Matched => [
            word("Matched", "Abgeglichen"),
            word(
                "Only the tissue's parameters cross the link; the force is computed from the hand's own motion, \
                 so a delayed force cannot kick the handle",
                "Nur die Parameter des Gewebes gehen über die Verbindung; die Kraft wird aus der Bewegung der \
                 Hand berechnet, so kann keine verspätete Kraft stoßen",
            ),
        ],
        Mode::Nima => [
            word("NIMA", "NIMA"),
            word(
                "The paper's polynomials under the rules of Matched: a constant, a fixed origin, ridge \
                 regularization, and degrees judged by prediction error",
                "Die Polynome des Artikels nach den Regeln von Abgeglichen: Konstante, fester Ursprung, \
                 Ridge-Regularisierung, Grade nach Vorhersagefehler beurteilt",
            ),
        ],
        Mode::Best => [
            word("Best of both", "Bestes aus beiden"),
            word(
                "Anchored and Matched, mixed on each axis by their prediction errors at the leader during the \
                 last second; the default",
                "Verankert und Abgeglichen, je Achse gemischt nach ihrem Vorhersagefehler am Führungsgerät in \
                 der letzten Sekunde; Vorgabe",
            ),
        ],
        Mode::Baseline(baseline) => of_baseline(baseline),
    }
}

fn of_baseline(baseline: Baseline) -> [&'static str; 2] {
    match baseline {
        Baseline::ModelMediated => [
            word("Model-mediated", "Modellvermittelt"),
            word(
                "For comparison: a Hunt-Crossley contact is identified at the tissue; its parameters cross the \
                 link, and the force is computed from the hand's own motion",
                "Zum Vergleich: am Gewebe wird ein Hunt-Crossley-Kontakt identifiziert; seine Parameter gehen \
                 über die Verbindung, die Kraft wird aus der Bewegung der Hand berechnet",
            ),
        ],
        Baseline::Waves => [
            word("Wave variables", "Wellenvariablen"),
            word(
                "For comparison: force and velocity come back as a wave and are decoded with the hand's own velocity",
                "Zum Vergleich: Kraft und Geschwindigkeit kommen als Welle zurück und werden mit der Geschwindigkeit \
                 der Hand dekodiert",
            ),
        ],
        Baseline::Passivity => [
            word("Time-domain passivity", "Zeitbereichs-Passivität"),
            word(
                "For comparison: direct reflection with damping whenever the hand would receive more energy than \
                 the tissue has returned",
                "Zum Vergleich: direkte Reflexion mit Dämpfung, wann immer die Hand mehr Energie bekäme, als das \
                 Gewebe zurückgab",
            ),
        ],
        Baseline::Kalman => [
            word("Kalman", "Kalman"),
            word(
                "For comparison: a Kalman filter of the force and its rate, extrapolated over the delay",
                "Zum Vergleich: Kalman-Filter der Kraft und ihrer Änderungsrate, über die Verzögerung extrapoliert",
            ),
        ],
        Baseline::Autoregressive => [
            word("Autoregressive", "Autoregressiv"),
            word(
                "For comparison: the force predicted from its own past values by an autoregressive model",
                "Zum Vergleich: die Kraft, aus ihrer eigenen Vergangenheit mit einem autoregressiven Modell \
                 vorhergesagt",
            ),
        ],
        Baseline::Increments => [
            word("Increments", "Inkremente"),
            word(
                "For comparison: the delayed force plus its change, from the change of motion and the trend of the \
                 force by recursive least squares",
                "Zum Vergleich: die verzögerte Kraft und ihre Änderung, aus der Änderung der Bewegung und dem Trend der \
                 Kraft mit rekursiven kleinsten Quadraten",
            ),
        ],
    }
}
