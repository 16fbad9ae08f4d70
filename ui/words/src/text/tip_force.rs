//! The wizard that trains and checks the tip-force network.

use crate::language::{Text, text_format};

pub const PAPER: Text = Text::of("paper", "Artikel");
pub const STEP_READY: Text = Text::of("Ready", "Bereit");
pub const STEP_READY_HOVER: Text = Text::of(
    "Checks that everything needed for a recording is available",
    "Prüft, ob alles für eine Aufzeichnung da ist",
);
pub const STEP_RECORD: Text = Text::of("Record", "Aufzeichnen");
pub const STEP_RECORD_HOVER: Text = Text::of(
    "Work through the trocar while the sensor under the tissue measures the true force",
    "Durch den Trokar arbeiten, während der Sensor unter dem Gewebe die wahre Kraft misst",
);
pub const STEP_TRAIN: Text = Text::of("Train", "Trainieren");
pub const STEP_TRAIN_HOVER: Text = Text::of(
    "Trains the network on the recording; you can keep working in this window",
    "Trainiert das Netz mit der Aufzeichnung; das Fenster bleibt dabei benutzbar",
);
pub const STEP_CHECK_HOVER: Text = Text::of(
    "A new, short recording that was not used for training shows how accurate the network is",
    "Eine neue, kurze Aufzeichnung, die nicht ins Training ging, zeigt die Genauigkeit des Netzes",
);
pub const SIZE_SMALL: Text = Text::of("Small", "Klein");
pub const SIZE_USUAL: Text = Text::of("Default", "Standard");
pub const SIZE_LARGE: Text = Text::of("Large", "Groß");
pub const NEEDS_CORRESPONDENCE: Text =
    Text::of("The correspondence is unknown: calibrate it first", "Korrespondenz unbekannt: erst kalibrieren");
pub const NEEDS_RECORDING: Text = Text::of("Nothing is recorded yet", "Noch nichts aufgezeichnet");
pub const NEEDS_GOALS: Text = Text::of(
    "Some goals are not met yet",
    "Einige Ziele sind noch nicht \
 erreicht",
);
pub const NEEDS_TRAINING_END: Text =
    Text::of("Wait until the training has finished, or cancel it", "Das Ende des Trainings abwarten oder es abbrechen");
pub const NEEDS_NETWORK: Text = Text::of("No network is trained yet", "Noch kein Netz trainiert");
pub const NEEDS_CHECK: Text = Text::of("The network is not checked yet", "Das Netz ist noch nicht geprüft");
pub const RECORDING_DISCARDED: Text = Text::of(
    "The sensor, tool or correspondence has changed: the previous recording was discarded",
    "Sensor, Instrument oder Korrespondenz haben sich geändert: die alte Aufzeichnung wurde verworfen",
);
pub const CANCELLED: Text = Text::of("Cancelled. The recording is kept.", "Abgebrochen. Die Aufzeichnung bleibt.");
pub const NO_FOLDER: Text = Text::of(
    "No folder for the recording was found: set NIMA_DATA_DIR",
    "Kein Ordner für die Aufzeichnung gefunden: NIMA_DATA_DIR setzen",
);
pub const NETWORK_UNCHECKED: Text = Text::of("No checked network: go back", "Kein geprüftes Netz: zurückgehen");
pub const CHECK_TITLE: Text = Text::of("A new recording", "Neue Aufzeichnung");
pub const CHECK_HOVER: Text = Text::of(
    "Only data that were not used for training show how accurate the network is",
    "Nur Daten, die nicht ins Training gingen, zeigen die Genauigkeit des Netzes",
);
pub const RECORD_MORE: Text = Text::of("Record more", "Mehr aufzeichnen");
pub const RECORD_MORE_HOVER: Text = Text::of(
    "Goes back to the recording; new rows are added to the existing ones",
    "Geht zurück zur Aufzeichnung; neue Zeilen kommen zu den vorhandenen",
);
pub const CHECK_PROGRESS: Text = Text::of("Rows of the check", "Zeilen der Prüfung");
pub const CHECK_JUDGING: Text = Text::of("The network is being evaluated", "Das Netz wird bewertet");
pub const CHECK_PAUSED: Text = Text::of("Paused: press \"Resume check\"", "Pausiert: „Prüfung fortsetzen“ drücken");
pub const CHECK_DONE: Text = Text::of("The check is complete", "Prüfung vollständig");
pub const PAUSE: Text = Text::of("Pause", "Pause");
pub const CHECK_GO_ON: Text = Text::of("Resume check", "Prüfung fortsetzen");
pub const CHECK_AGAIN: Text = Text::of("Check again", "Erneut prüfen");
pub const CHECK_START: Text = Text::of("Start the check", "Prüfung starten");
pub const CHECK_WAIT: Text = Text::of("Wait for the result", "Ergebnis abwarten");
pub const VERDICT_HOVER: Text = Text::of(
    "Compared with the paper's results, on rows recorded after the training",
    "Verglichen mit den Werten des Artikels, auf Zeilen nach dem Training",
);
pub const VERDICT_OVERRIDE: Text = Text::of(
    "You can still accept it under your name in the next step",
    "Übernehmen unter eigenem Namen ist im nächsten Schritt möglich",
);
pub const DOUBT_HOVER: Text = Text::of(
    "Rows outside the range of the training data: there the network is not used and the fallback applies. At \
     most 10 % are allowed.",
    "Zeilen außerhalb des Bereichs der Trainingsdaten: dort gilt statt des Netzes der Ersatzwert. Höchstens 10 % sind \
     erlaubt.",
);
pub const ERRORS_HOVER: Text = Text::of(
    "All in N, along the axes of the wrist sensor (z along the shaft). MAE: mean absolute error. SD: \
    standard deviation of the error.",
    "Alle in N, entlang der Achsen des Handgelenksensors (z entlang des Schafts). MAE: mittlerer absoluter Fehler. SD: \
     Standardabweichung des Fehlers.",
);
pub const ERRORS_TITLE: Text =
    Text::of("Errors in N, per axis of the wrist sensor", "Fehler in N, je Achse des Handgelenksensors");
pub const AXIS: Text = Text::of("Axis", "Achse");
pub const WRIST_ALONE_MAE: Text = Text::of("wrist force\nalone: MAE", "Handgelenk\nallein: MAE");
pub const FRICTION_MODEL_MAE: Text = Text::of("friction\nmodel: MAE", "Reibungs-\nmodell: MAE");
pub const NO_CONTACT_MEAN: Text = Text::of("no contact:\nmean (paper 0.02)", "kontaktfrei:\nMittel (Artikel 0.02)");
pub const NO_CONTACT_SD: Text = Text::of("no contact:\nSD (paper 0.03)", "kontaktfrei:\nSD (Artikel 0.03)");
pub const REGRESSION_TITLE: Text = Text::of("Predicted versus measured force", "Vorhergesagte gegen gemessene Kraft");
pub const REGRESSION_HOVER: Text = Text::of(
    "Each point is one row; without error, all points would be on the dashed line",
    "Jeder Punkt ist eine Zeile; ohne Fehler liegen alle auf der gestrichelten Linie",
);
pub const NO_CONTACT_TITLE: Text = Text::of("Predicted force without contact", "Vorhergesagte Kraft ohne Kontakt");
pub const NO_CONTACT_HOVER: Text = Text::of(
    "Without contact the predicted force should be zero",
    "Ohne Kontakt sollte die vorhergesagte Kraft null sein",
);
pub const MEASURED_AXIS: Text = Text::of("Measured (N)", "Gemessen (N)");
pub const PREDICTED_AXIS: Text = Text::of("Predicted (N)", "Vorhersage (N)");
pub const REGRESSION_PLOT: Text = Text::of(
    "Regression plot: predicted versus measured force, three axes",
    "Regressionsdiagramm: vorhergesagte gegen gemessene Kraft, drei Achsen",
);
pub const NO_CONTACT_AXIS: Text = Text::of("Predicted (N)", "Vorhersage (N)");
pub const FRACTION_AXIS: Text = Text::of("Rows (%)", "Anteil der Zeilen (%)");
pub const NO_CONTACT_PLOT: Text = Text::of(
    "Histogram of the predicted force without contact, three axes",
    "Histogramm der vorhergesagten Kraft ohne Kontakt, drei Achsen",
);
pub const SOURCE_WRIST: Text = Text::of("Wrist sensor", "Handgelenksensor");
pub const SOURCE_SILENT: Text = Text::of("no data; connect it", "keine Daten; verbinden");
pub const SOURCE_GRAVITY: Text = Text::of("Gravity", "Schwerkraft");
pub const SOURCE_NO_GRAVITY: Text = Text::of(
    "not calibrated; press \"Calibrate gravity…\" on the left",
    "nicht kalibriert; links „Schwerkraft kalibrieren…“ drücken",
);
pub const SOURCE_TISSUE: Text = Text::of("Sensor under the tissue", "Sensor unter dem Gewebe");
pub const SOURCE_TRACKER: Text = Text::of("Arm and tracker", "Arm und Tracker");
pub const SOURCE_NO_TRACKER: Text = Text::of(
    "the tracker does not see the marker, or the arm sends no data; clear the line of sight and check the arm",
    "der Tracker sieht den Marker nicht, oder der Arm sendet nichts; Sichtlinie freimachen und Arm prüfen",
);
pub const SOURCE_DEPTH: Text = Text::of("Depth through the trocar", "Tiefe durch den Trokar");
pub const SOURCE_NO_DEPTH: Text =
    Text::of("unknown; mount the trocar and check the arm", "unbekannt; Trokar montieren und Arm prüfen");
pub const CHECKS_TITLE: Text = Text::of("Before the recording", "Vor der Aufzeichnung");
pub const CHECKS_HOVER: Text = Text::of(
    "All six checks must pass before rows are recorded",
    "Erst nach allen sechs Prüfungen werden Zeilen \
     aufgezeichnet",
);
pub const CHECKS_TASK: Text = Text::of(
    "Put the tissue on its sensor, insert the instrument through the trocar, and hold its tip above the tissue",
    "Gewebe auf seinen Sensor legen, Instrument durch den Trokar führen und die Spitze über das Gewebe halten",
);
pub const SOURCE_CORRESPONDENCE: Text = Text::of("Correspondence", "Korrespondenz");
pub const SOURCE_NO_CORRESPONDENCE: Text = Text::of(
    "unknown; press \"Calibrate correspondence…\" on the left",
    "unbekannt; links „Korrespondenz kalibrieren…“ drücken",
);
pub const RECORD_HOVER: Text = Text::of(
    "The person at the arm follows these instructions. A pause keeps all rows.",
    "Diese Anweisungen gelten der Person am Arm. Eine Pause erhält alle Zeilen.",
);
pub const RECORD_TITLE: Text = Text::of("Do this now", "Jetzt ausführen");
pub const TRAIN_ANYWAY: Text = Text::of("Train anyway", "Trotzdem trainieren");
pub const TRAIN_ANYWAY_HOVER: Text = Text::of(
    "Trains on the rows recorded so far. Such a network is not proven: you can accept it only under your name.",
    "Trainiert mit den bisherigen Zeilen. Ein solches Netz ist nicht belegt: nur unter eigenem Namen zu übernehmen.",
);
pub const TRAIN_ANYWAY_DISABLED_HOVER: Text =
    Text::of("Only for an incomplete recording", "Nur bei unvollständiger Aufzeichnung");
pub const ROWS: Text = Text::of("Rows", "Zeilen");
pub const RECORD_FIRST_STEP: Text = Text::of(
    "Then press \"Start recording\": first, the sensor under the tissue is set to zero",
    "Dann „Aufzeichnung starten“ drücken: zuerst wird der Sensor unter dem Gewebe genullt",
);
pub const RECORD_COMPLETE: Text = Text::of(
    "All goals are met: continue to the training, or record more",
    "Alle Ziele erreicht: weiter zum Training, oder mehr aufzeichnen",
);
pub const RECORD_PAUSED: Text =
    Text::of("Paused: press \"Resume recording\"", "Pausiert: „Aufzeichnung fortsetzen“ drücken");
pub const ADVICE_LATER: Text = Text::of("Then", "Danach");
pub const ADVICE_NOW: Text = Text::of("To do", "Noch zu tun");
pub const RECORD_START: Text = Text::of("Start recording", "Aufzeichnung starten");
pub const GOALS_TITLE: Text = Text::of("Goals", "Ziele");
pub const GOALS_HOVER: Text = Text::of(
    "The recording must cover all conditions of later use: meet all of these goals",
    "Die Aufzeichnung muss alle Bedingungen des Einsatzes abdecken: alle Ziele erreichen",
);
pub const TILT_X: Text = Text::of("towards x", "nach x");
pub const TILT_Y: Text = Text::of("towards y (deg)", "nach y (deg)");
pub const FORCE_ACROSS: Text = Text::of("across the shaft", "quer zum Schaft");
pub const FORCE_ALONG: Text = Text::of("along the shaft (N)", "entlang des Schafts (N)");
pub const TRAVEL_DEPTH: Text = Text::of("depth through the trocar", "Tiefe durch den Trokar");
pub const TRAVEL_SPEED: Text = Text::of("inward speed (mm/s)", "Tempo einwärts (mm/s)");
pub const COVERAGE_HOVER: Text = Text::of(
    "The more rows a field contains, the brighter it is. The network is reliable only where rows were recorded.",
    "Je mehr Zeilen ein Feld enthält, desto heller ist es. Das Netz ist nur dort zuverlässig, wo Zeilen \
     aufgezeichnet sind.",
);
pub const COVERAGE_TITLE: Text =
    Text::of("Coverage of the recording (brighter: more rows)", "Abdeckung der Aufzeichnung (heller: mehr Zeilen)");
pub const MAP_TILT: Text = Text::of("Tilt of the shaft", "Neigung des Schafts");
pub const MAP_FORCE: Text = Text::of("Force at the tip", "Kraft an der Spitze");
pub const MAP_TRAVEL: Text = Text::of("Motion through the trocar", "Bewegung durch den Trokar");
pub const TRAIN_HOVER: Text = Text::of(
    "Trains four networks in parallel, each tested on a different part of the recording",
    "Trainiert vier Netze parallel, jedes auf einem anderen Teil der Aufzeichnung getestet",
);
pub const TRAIN_DATA: Text = Text::of("Recording", "Aufzeichnung");
pub const TRAIN_DATA_HOVER: Text =
    Text::of("Saved to a file before the training starts", "Vor dem Training in einer Datei gespeichert");
pub const TRAIN_CANCEL: Text = Text::of("Cancel training", "Training abbrechen");
pub const TRAIN_AGAIN: Text = Text::of("Train again", "Neu trainieren");
pub const TRAIN_START: Text = Text::of("Start training", "Training starten");
pub const TRAIN_DISABLED_HOVER: Text = Text::of("Record first", "Erst aufzeichnen");
pub const TRAIN_PROGRESS: Text = Text::of("Training", "Training");
pub const LOSS_HOVER: Text = Text::of(
    "Mean square error divided by the variance of the forces; 1 means that nothing was learned. \
    The held-out curve counts: its rows are not used to train that network.",
    "Mittlerer quadratischer Fehler, geteilt durch die Varianz der Kräfte; 1 heißt: nichts gelernt. Es zählt die \
     Testkurve: mit ihren Zeilen wird dieses Netz nicht trainiert.",
);
pub const LOSS_TITLE: Text = Text::of("Loss of each network, by epoch", "Verlust je Netz und Epoche");
pub const SIZE: Text = Text::of("Size", "Größe");
pub const SIZE_HOVER: Text = Text::of(
    "Neurons in the hidden layers. Published results are for the default size.",
    "Neuronen der verborgenen Schichten. Publizierte Werte gelten für die Standardgröße.",
);
pub const TRAIN_STARTING: Text = Text::of("saving the recording", "Aufzeichnung wird gespeichert");
pub const TRAIN_NOT_STARTED: Text = Text::of("not started", "nicht gestartet");
pub const TRAINED_TITLE: Text = Text::of("Trained", "Trainiert");
pub const TRAINED_HOVER: Text = Text::of("This network is used in the check", "Dieses Netz geht in die Prüfung");
pub const ENSEMBLE: Text = Text::of("Ensemble", "Ensemble");
pub const ENSEMBLE_HOVER: Text = Text::of(
    "The result is the mean of all networks; where they disagree, it is marked as uncertain",
    "Das Ergebnis ist der Mittelwert aller Netze; wo sie sich widersprechen, gilt es als unsicher",
);
pub const HELD_OUT_LOSS: Text = Text::of("Held-out loss", "Testverlust");
pub const HELD_OUT_LOSS_HOVER: Text = Text::of(
    "Mean of all networks; 1 means that nothing was learned",
    "Mittelwert aller Netze; 1 heißt: nichts gelernt",
);
pub const TRAINED_STALE: Text = Text::of(
    "New rows were recorded since then: train again to use all rows",
    "Seither neue Zeilen aufgezeichnet: neu trainieren, um alle zu nutzen",
);
pub const EPOCH_AXIS: Text = Text::of("Epoch", "Epoche");
pub const LOSS_AXIS: Text =
    Text::of("Mean square error (1: nothing learned)", "Mittl. quadr. Fehler (1: nichts gelernt)");
pub const JOB_FAILED: Text = Text::of("Failed. Try again.", "Fehlgeschlagen. Erneut versuchen.");
pub const PHASE_FULL: Text =
    Text::of("the recording is full; continue to the training", "Aufzeichnung voll; weiter zum Training");
pub const PHASE_WRIST_SILENT: Text = Text::of(
    "not recording: the wrist sensor sends no data; connect it",
    "keine Aufzeichnung: Handgelenksensor sendet nichts; verbinden",
);
pub const PHASE_NOT_MOVED: Text =
    Text::of("waiting; move the instrument in or out by 2 mm", "wartet; Instrument 2 mm hinein- oder herausbewegen");
pub const TASK_WORK: Text = Text::of(
    "Work where the task will be done: in and out, sideways, slowly and quickly, with and without contact",
    "Dort arbeiten, wo die Aufgabe stattfindet: hinein und heraus, seitwärts, langsam und schnell, mit und ohne \
     Kontakt",
);
pub const TASK_WORK_FREE: Text = Text::of(
    "Move in and out and sideways, slowly and quickly, without touching the tissue",
    "Hinein, heraus und seitwärts bewegen, langsam und schnell, ohne das Gewebe zu berühren",
);
pub const TASK_REST: Text =
    Text::of("Lift the tip off the tissue and hold it still", "Spitze vom Gewebe abheben und stillhalten");
pub const DOUBT: Text = Text::of("Uncertain", "Unsicher");
pub const TRAIN_STOPPING: Text = Text::of("stopping", "wird beendet");
pub const TRAIN_DONE: Text = Text::of("done", "fertig");
pub const RECORD_GO_ON: Text = Text::of("Resume recording", "Aufzeichnung fortsetzen");
pub const PHASE_PAUSED: Text = Text::of("paused", "pausiert");
pub const PHASE_RECORDING: Text = Text::of("recording", "zeichnet auf");

pub fn not_judged(error: &str) -> String {
    text_format!("The network could not be evaluated: {error}", "Das Netz ließ sich nicht bewerten: {error}")
}

pub fn not_trained(error: &str) -> String {
    text_format!("Not trained: {error}. The recording is kept.", "Nicht trainiert: {error}. Die Aufzeichnung bleibt.")
}

pub fn state(phase: &str) -> String {
    text_format!("State: {phase}", "Zustand: {phase}")
}

pub fn check_task(work_s: f64, free_s: f64) -> String {
    text_format!(
        "{work_s:.0} s of work on the tissue, then {free_s:.0} s without touching it",
        "{work_s:.0} s Arbeit am Gewebe, dann {free_s:.0} s ohne Berührung"
    )
}

pub fn verdict(reason: &str) -> String {
    text_format!("Verdict: {reason}", "Urteil: {reason}")
}

pub fn doubt(percent: f64, rows: usize) -> String {
    text_format!("{percent:.1} % of {rows} rows", "{percent:.1} % von {rows} Zeilen")
}

pub fn no_thread(error: &impl std::fmt::Display) -> String {
    text_format!("The background task could not be started: {error}", "Hintergrundaufgabe nicht gestartet: „{error}“")
}

pub fn not_written(path: &std::path::Path, error: &impl std::fmt::Display) -> String {
    text_format!(
        "The recording could not be written to {}: {error}",
        "Die Aufzeichnung ließ sich nicht nach {} schreiben: „{error}“",
        path.display()
    )
}

pub fn trained_on_too_little(goal: &str) -> String {
    text_format!(
        "the recording used for training is incomplete ({goal}); record more",
        "die Trainingsaufzeichnung ist unvollständig ({goal}); mehr aufzeichnen"
    )
}

pub fn rows_and_seconds(rows: usize, seconds: f64, paper_rows: usize, paper_s: f64) -> String {
    text_format!(
        "{rows}, {seconds:.0} s (paper: {paper_rows}, {paper_s:.0} s)",
        "{rows}, {seconds:.0} s (Artikel: {paper_rows}, {paper_s:.0} s)"
    )
}

pub fn advice(when: &str, advice: &str, goal: &str) -> String {
    format!("{when}: {advice} ({goal})")
}

pub fn nothing_taken(why: &str) -> String {
    text_format!("not recording: {why}", "keine Aufzeichnung: {why}")
}

pub fn taking_zero(percent: f64) -> String {
    text_format!(
        "setting the sensor under the tissue to zero: {percent:.0} %",
        "Sensor unter dem Gewebe wird genullt: {percent:.0} %"
    )
}

pub fn networks_on_rows(networks: usize, rows: usize) -> String {
    text_format!("{networks} networks on {rows} rows", "{networks} Netze mit {rows} Zeilen")
}

pub fn not_complete(goal: &str) -> String {
    text_format!(
        "The recording is incomplete ({goal}): you can accept this network only under your name",
        "Die Aufzeichnung ist unvollständig ({goal}): dieses Netz nur unter eigenem Namen zu übernehmen"
    )
}

pub fn held_out(network: usize) -> String {
    text_format!("{network} held out", "{network} Test")
}

pub fn training(network: usize) -> String {
    text_format!("{network} training", "{network} Training")
}

pub fn losses(networks: usize, epochs: usize) -> String {
    text_format!(
        "Losses of {networks} networks over {epochs} epochs",
        "Verluste von {networks} Netzen über {epochs} Epochen"
    )
}

pub fn rows_of(rows: usize, asked: usize) -> String {
    text_format!("{rows} of {asked}", "{rows} von {asked}")
}

pub fn rows_and_time(rows: usize, seconds: f64) -> String {
    text_format!("{rows} rows, {seconds:.0} s", "{rows} Zeilen, {seconds:.0} s")
}

pub fn time_left(percent: f64, elapsed_s: f64, left_s: f64) -> String {
    text_format!(
        "{percent:.0} %, {elapsed_s:.0} s, at most {left_s:.0} s left",
        "{percent:.0} %, {elapsed_s:.0} s, höchstens noch {left_s:.0} s"
    )
}
