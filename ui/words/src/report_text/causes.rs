//! Texts about the ready check: causes and remedies of failed checks.

use nima_core::{calibration::gravity::NotChecked, kinematics::START_MISS_M};
use nima_machine::{
    messages::{Fault, Refusal, Watchdog},
    ready::ReadyCause,
    rig::{Roster, Side},
};

use super::{
    Remedy as _, cure_of_refusal,
    findings::finding_text,
    names::role_name,
    quoted,
    ready::with,
    refused_because, sentence, side_word,
    sides::{arm_stuck, exchanged, handle_askew, handle_pulls, handle_stuck, marker_stuck, no_push, trocar_moved},
};
use crate::language::{Text, text_format, word};

/// Returns the cause and remedy of a failed point.
pub fn cause_text(cause: &ReadyCause, roster: &Roster) -> [String; 2] {
    let words: [Text; 2] = match *cause {
        ReadyCause::Missing { place } => return missing(place, roster),
        ReadyCause::Found { place, ref finding } => return found(place, finding, roster),
        ReadyCause::BiasUnseen(why) => return bias_unseen(why),
        ReadyCause::OtherFault(fault) => return other_fault(fault),
        ReadyCause::Refused(why) => return refused(why),
        ReadyCause::ForceUnknown(source) => return refused(Refusal::ForceUnknown(source)),
        ReadyCause::Missed { fraction } => return missed(fraction),
        ReadyCause::LoopClock { by_s } => return clocks_apart(by_s),
        ReadyCause::BiasMoved { by_n, limit_n } => return bias_moved(by_n, limit_n),
        ReadyCause::Exchanged(exchange) => return exchanged(exchange),
        ReadyCause::ArmStuck { by_m } => return arm_stuck(by_m),
        ReadyCause::MarkerStuck { by_m } => return marker_stuck(by_m),
        ReadyCause::NoPush { max_n } => return no_push(max_n),
        ReadyCause::PushAskew { by_deg } => return askew(by_deg),
        ReadyCause::HandlePulls { by_m } => return handle_pulls(by_m),
        ReadyCause::HandleForce { force_n } | ReadyCause::Force { force_n } => return unwanted_force(force_n),
        ReadyCause::HandleStuck { by_m } => return handle_stuck(by_m),
        ReadyCause::HandleAskew { by_deg } => return handle_askew(by_deg),
        ReadyCause::BesideTrocar { miss_m } => return beside(miss_m),
        ReadyCause::TrocarMoved { by_m } => return trocar_moved(by_m),
        ReadyCause::OtherCeiling { in_force_n, in_file_n } => return other_ceiling(in_force_n, in_file_n),
        ReadyCause::HalfStop(side) => return half_stop(side),
        ReadyCause::LateBite { after_s } => return late(after_s),
        ReadyCause::Engaged(side) => return engaged(side),
        ReadyCause::NoGauges => NO_GAUGES,
        ReadyCause::NoTicks => NO_TICKS,
        ReadyCause::DateBehind => DATE_BEHIND,
        ReadyCause::Uncalibrated => UNCALIBRATED,
        ReadyCause::NoRigFile => NO_RIG_FILE,
        ReadyCause::NoStop => [Text::of("No stop was detected", "Kein Halt erkannt"), STOP_CURE],
        ReadyCause::NotReleased(why) => return not_released(why),
        ReadyCause::NoBite(Watchdog::Loop) => NO_BITE_LOOP,
        ReadyCause::NoBite(Watchdog::Source) => NO_BITE_SOURCE,
        ReadyCause::NoBite(Watchdog::Link) => NO_BITE_LINK,
    };
    words.map(|words| words.get().to_owned())
}

const NO_GAUGES: [Text; 2] = [
    Text::of("The devices reported no statistics", "Die Geräte lieferten keine Kennzahlen"),
    Text::of("See the Devices panel, then check again", "Siehe Panel Geräte, dann neu prüfen"),
];

const NO_TICKS: [Text; 2] = [
    Text::of("The control loop sends no data", "Die Regelung sendet nichts"),
    Text::of("Restart the console", "Konsole neu starten"),
];

const DATE_BEHIND: [Text; 2] = [
    Text::of("A calibration is dated in the future", "Eine Kalibrierung ist in die Zukunft datiert"),
    Text::of("Set this computer's date and time", "Datum und Uhrzeit dieses Rechners stellen"),
];

const UNCALIBRATED: [Text; 2] = [
    Text::of(
        "No gravity calibration exists for this sensor and tool",
        "Für diesen Sensor mit diesem Instrument fehlt die Schwerkraft-Kalibrierung",
    ),
    Text::of("Calibrate gravity, then check again", "Schwerkraft kalibrieren, dann neu prüfen"),
];

const NO_RIG_FILE: [Text; 2] = [
    Text::of("The rig file cannot be read", "Die Aufbaudatei ist nicht lesbar"),
    Text::of(
        "Restore the rig file, then restart the console",
        "Aufbaudatei wiederherstellen, dann Konsole neu starten",
    ),
];

const NO_BITE_LOOP: [Text; 2] = [
    Text::of(
        "The test silenced the loop, but the supervisor did not react",
        "Der Test ließ die Regelung schweigen, aber die Überwachung reagierte nicht",
    ),
    Text::of("Do not engage; restart the console", "Nicht koppeln; Konsole neu starten"),
];

const NO_BITE_SOURCE: [Text; 2] = [
    Text::of(
        "The test withheld measurements, but no fault was raised",
        "Der Test hielt Messwerte zurück, aber keine Störung trat auf",
    ),
    Text::of("Do not engage; restart the console", "Nicht koppeln; Konsole neu starten"),
];

const NO_BITE_LINK: [Text; 2] = [
    Text::of(
        "The test silenced the link, but no fault was raised",
        "Der Test ließ die Verbindung schweigen, aber keine Störung trat auf",
    ),
    Text::of("Do not engage; restart the console", "Nicht koppeln; Konsole neu starten"),
];

fn other_fault(fault: Fault) -> [String; 2] {
    [
        text_format!("A different fault was raised: {}", "Eine andere Störung trat auf: {}", fault.cause()),
        fault.cure().to_owned(),
    ]
}

fn refused(why: Refusal) -> [String; 2] {
    [
        text_format!("The loop refused the test: {}", "Die Regelung lehnte den Test ab: {}", refused_because(why)),
        sentence(cure_of_refusal(why)),
    ]
}

fn missed(fraction: f64) -> [String; 2] {
    with(
        text_format!("{:.1} % of the periods were missed", "{:.1} % der Takte wurden versäumt", 100.0 * fraction),
        CLOSE_PROGRAMS.get(),
    )
}

fn clocks_apart(by_s: f64) -> [String; 2] {
    with(
        text_format!(
            "The clocks of the loop and of this computer drifted apart by {by_s:.2} s",
            "Die Uhren von Regelung und Rechner liefen um {by_s:.2} s auseinander"
        ),
        CLOSE_PROGRAMS.get(),
    )
}

fn bias_moved(by_n: f64, limit_n: f64) -> [String; 2] {
    with(
        text_format!(
            "{by_n:.2} N remain at rest (limit {limit_n:.2} N)",
            "{by_n:.2} N bleiben in Ruhe (Grenze {limit_n:.2} N)"
        ),
        word(
            "Make sure that nothing touches the tool; if the force remains, calibrate gravity again",
            "Sicherstellen, dass nichts das Instrument berührt; bleibt es, Schwerkraft neu kalibrieren",
        ),
    )
}

fn unwanted_force(force_n: f64) -> [String; 2] {
    with(
        text_format!(
            "A force of {force_n:.2} N was commanded where none is allowed",
            "{force_n:.2} N wurden befohlen, wo keine Kraft sein darf"
        ),
        word(
            "Do not engage; report this with the record of the check",
            "Nicht koppeln; mit dem Protokoll der Prüfung melden",
        ),
    )
}

fn other_ceiling(in_force_n: f64, in_file_n: f64) -> [String; 2] {
    with(
        text_format!(
            "The force ceiling in use is {in_force_n:.2} N; the rig file has {in_file_n:.2} N",
            "Die aktive Höchstkraft ist {in_force_n:.2} N; laut Aufbaudatei {in_file_n:.2} N"
        ),
        word("Restart the console to apply the rig file", "Konsole neu starten, damit die Aufbaudatei gilt"),
    )
}

fn half_stop(side: Side) -> [String; 2] {
    with(
        text_format!(
            "The {} arm did not stop together with the other arm",
            "Arm {} hielt nicht mit dem anderen an",
            side_word(side)
        ),
        STOP_CURE.get(),
    )
}

fn late(after_s: f64) -> [String; 2] {
    with(
        text_format!(
            "The fault was raised after {after_s:.2} s, too late",
            "Die Störung kam nach {after_s:.2} s, zu spät"
        ),
        CLOSE_PROGRAMS.get(),
    )
}

fn engaged(side: Side) -> [String; 2] {
    with(
        text_format!(
            "The {} arm was engaged during the check",
            "Arm {} wurde während der Prüfung gekoppelt",
            side_word(side)
        ),
        word("Set both arms to idle, then check again", "Beide Arme in Leerlauf setzen, dann neu prüfen"),
    )
}

fn not_released(why: Option<Refusal>) -> [String; 2] {
    let Some(why) = why else {
        return with(
            word("The stop or the fault was not released in time", "Halt oder Störung wurde nicht rechtzeitig gelöst")
                .to_owned(),
            word("Press Release stop, then check again", "Halt lösen drücken, dann neu prüfen"),
        );
    };
    [
        text_format!("The release was refused: {}", "Das Lösen wurde abgelehnt: {}", refused_because(why)),
        sentence(cure_of_refusal(why)),
    ]
}

const CLOSE_PROGRAMS: Text = Text::of(
    "Close other programs or grant real-time priority (see the Timing panel), then check again",
    "Andere Programme schließen oder Echtzeitpriorität gewähren (Panel Timing), dann neu prüfen",
);
const STOP_CURE: Text = Text::of(
    "Do not engage; check the key, pedal or button that you use to stop",
    "Nicht koppeln; Taste, Pedal oder Knopf für den Halt prüfen",
);

fn name(place: usize, roster: &Roster) -> String {
    roster.get(place).map_or_else(|| word("a device", "Gerät").to_owned(), |entry| role_name(entry.role))
}

fn missing(place: usize, roster: &Roster) -> [String; 2] {
    let trouble = roster.get(place).and_then(|entry| entry.view.report().trouble);
    let name = name(place, roster);
    match trouble {
        Some(trouble) => {
            let why = quoted(&trouble);
            [text_format!("No connection to the {name}: {why}", "{name} fehlt: {why}"), trouble.cure()]
        }
        None => with(
            text_format!("No connection to the {name}, or an interrupted one", "{name} fehlt oder fällt aus"),
            word("Check plug, cable and power; see Devices", "Stecker, Kabel und Strom prüfen; siehe Geräte"),
        ),
    }
}

fn found(place: usize, finding: &nima_machine::rig::checkup::CheckupFinding, roster: &Roster) -> [String; 2] {
    let kind = roster.get(place).and_then(|entry| entry.part).map(nima_machine::rig::RigPart::kind);
    let Some(kind) = kind else {
        return with(
            word("A device has a problem", "Ein Gerät hat ein Problem").to_owned(),
            word("See the Devices panel", "Siehe Panel Geräte"),
        );
    };
    let [cause, cure] = finding_text(kind, finding);
    [format!("{}: {cause}", sentence(&name(place, roster))), cure]
}

fn bias_unseen(why: NotChecked) -> [String; 2] {
    let [why, cure] = match why {
        NotChecked::NoSample => [
            word("no data from the sensor", "keine Daten vom Sensor"),
            word(
                "Check the sensor's cable and the arm, then check again",
                "Sensorkabel und Arm prüfen, dann neu prüfen",
            ),
        ],
        NotChecked::Moving => [
            word("the tool moved", "das Instrument bewegte sich"),
            word("Let the tool hang still, then check again", "Instrument ruhig hängen lassen, dann neu prüfen"),
        ],
        NotChecked::Touched => [
            word("something touched the tool", "etwas berührte das Instrument"),
            word(
                "Remove whatever touches the tool, then check again",
                "Entfernen, was das Instrument berührt, dann neu prüfen",
            ),
        ],
        NotChecked::InTrocar => [
            word("the instrument was in the trocar", "das Instrument steckte im Trokar"),
            word(
                "Take the instrument out of the trocar, then check again",
                "Instrument aus dem Trokar nehmen, dann neu prüfen",
            ),
        ],
        NotChecked::Engaged => [
            word("the arm was engaged", "der Arm war gekoppelt"),
            word("Set both arms to idle, then check again", "Beide Arme in Leerlauf setzen, dann neu prüfen"),
        ],
    };
    [text_format!("The bias could not be checked: {why}", "Der Nullpunkt war nicht prüfbar: {why}"), cure.to_owned()]
}

fn askew(by_deg: f64) -> [String; 2] {
    let what = if by_deg > 150.0 {
        word("its sign is wrong", "Vorzeichen falsch")
    } else {
        word("its axes are wrong, or the push went in another direction", "Achsen oder Druckrichtung falsch")
    };
    with(
        text_format!(
            "The push was measured {by_deg:.0} degrees off: {what}",
            "Der Druck wurde {by_deg:.0} Grad daneben gemessen: {what}"
        ),
        word(
            "Repeat the push in the requested direction; if the error remains, calibrate the sensor mount and \
             gravity again",
            "Druck in der verlangten Richtung wiederholen; bleibt es, Sensormontage und Schwerkraft neu kalibrieren",
        ),
    )
}

fn beside(miss_m: f64) -> [String; 2] {
    let cause = if miss_m.is_finite() {
        text_format!(
            "The shaft misses the trocar by {:.0} mm (limit {:.0} mm)",
            "Der Schaft verfehlt den Trokar um {:.0} mm (Grenze {:.0} mm)",
            1e3 * miss_m,
            1e3 * START_MISS_M
        )
    } else {
        word("The instrument is not inserted in its trocar", "Das Instrument geht nicht durch den Trokar").to_owned()
    };
    with(
        cause,
        word(
            "Insert the instrument through its trocar; if it is inserted, the trocar has moved: calibrate the \
             trocar",
            "Instrument durch den Trokar führen; ist es darin, hat sich der Trokar bewegt: Trokar kalibrieren",
        ),
    )
}

#[cfg(test)]
mod tests {
    use nima_machine::rig::SideSwap;

    use super::*;

    #[test]
    fn no_sentence_ends_with_a_full_stop_and_each_cause_says_what_to_do() {
        let causes = [
            ReadyCause::Missing { place: 0 },
            ReadyCause::Missed { fraction: 0.02 },
            ReadyCause::DateBehind,
            ReadyCause::BiasMoved { by_n: 0.5, limit_n: 0.2 },
            ReadyCause::BiasUnseen(NotChecked::Touched),
            ReadyCause::NoPush { max_n: 0.1 },
            ReadyCause::Exchanged(SideSwap::Handles),
            ReadyCause::Exchanged(SideSwap::Arms),
            ReadyCause::Exchanged(SideSwap::Sensors),
            ReadyCause::Exchanged(SideSwap::Servos),
            ReadyCause::Exchanged(SideSwap::Markers),
            ReadyCause::Exchanged(SideSwap::Trocars),
            ReadyCause::ArmStuck { by_m: 0.0 },
            ReadyCause::MarkerStuck { by_m: 0.0 },
            ReadyCause::PushAskew { by_deg: 178.0 },
            ReadyCause::PushAskew { by_deg: 88.0 },
            ReadyCause::HandlePulls { by_m: 0.01 },
            ReadyCause::HandleStuck { by_m: 0.0 },
            ReadyCause::HandleAskew { by_deg: 90.0 },
            ReadyCause::BesideTrocar { miss_m: f64::INFINITY },
            ReadyCause::BesideTrocar { miss_m: 0.012 },
            ReadyCause::TrocarMoved { by_m: 0.003 },
            ReadyCause::OtherCeiling { in_force_n: 4.0, in_file_n: 3.0 },
            ReadyCause::NoStop,
            ReadyCause::HalfStop(Side::Left),
            ReadyCause::NoBite(Watchdog::Loop),
            ReadyCause::NoBite(Watchdog::Source),
            ReadyCause::NoBite(Watchdog::Link),
            ReadyCause::Engaged(Side::Right),
        ];
        let mut report: Vec<_> = causes.iter().map(|cause| cause_text(cause, &Roster::new())).collect();
        assert!(report.iter().flatten().all(|words| !words.is_empty() && !words.ends_with('.')), "{report:?}");
        report.sort();
        report.dedup();
        assert_eq!(report.len(), causes.len(), "no two say the same");
        assert!(report.iter().any(|[cause, _]| cause.contains("sign is wrong")));
    }
}
