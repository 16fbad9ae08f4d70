//! How far a trial of a training scene has come.

/// While lumps are looked for: how many places were marked, and the keys while the instrument is led.
pub(in crate::console) fn lumps_marked(marked: u32, is_led: bool) -> String {
    let keys = if is_led { " (X marks, D ends the trial, N begins it anew)" } else { "" };
    format!("Places marked: {marked}{keys}")
}

/// After the trial.
pub(in crate::console) fn lumps_found(found: u32, lumps: u32, mark_false: u32) -> String {
    format!("Lumps found: {found} of {lumps}, false marks: {mark_false}")
}

/// On the wire.
pub(in crate::console) fn wire(touches: u32, share: f64, ended: bool, is_led: bool) -> String {
    let keys = if is_led { " (N begins the trial anew)" } else { "" };
    if ended {
        return format!("Goal reached, touches: {touches}{keys}");
    }
    format!("Way to the goal: {:.0} %, touches: {touches}{keys}", 100.0 * share)
}

pub(in crate::console) const JAWS_ABOVE: &str = "above a ring";
pub(in crate::console) const JAWS_AROUND: &str = "around a ring";
pub(in crate::console) const JAWS_HOLD: &str = "holds a ring";

/// The instrument that is led, and what its jaws do with a ring.
pub(in crate::console) fn jaws(side: &str, with_ring: Option<&str>) -> String {
    let with_ring = with_ring.map(|words| format!(" {words}")).unwrap_or_default();
    format!("{side} instrument{with_ring}")
}

/// Peg transfer: `led` from [`jaws`], and how many rings were handed over in mid-air, put on pegs, and dropped.
pub(in crate::console) fn rings(led: Option<&str>, [passed, placed, dropped]: [u32; 3], ended: bool) -> String {
    let done = if ended { "Task done. " } else { "" };
    let led = led.map(|words| format!("{words}. ")).unwrap_or_default();
    format!("{done}{led}Rings: passed {passed}, placed {placed}, dropped {dropped}")
}

pub(in crate::console) const CHOOSE_MATCHED: &str =
    "Two hands on one ring need the mode Matched: with this one the loop ends in a fault";
