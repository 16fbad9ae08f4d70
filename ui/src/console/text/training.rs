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
