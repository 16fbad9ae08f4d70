//! Texts about a state, for another program.

use nima_core::safety::InterlockState;
use nima_machine::messages::LoopState;
use nima_words::{language::word, report_text::Remedy as _};

/// Returns the cause and remedy, sent next to the state's code; empty if the state needs no action.
pub(super) fn trouble_of(state: LoopState) -> String {
    match state {
        InterlockState::Faulted(fault) => format!("{}. {}", fault.cause(), fault.cure()),
        InterlockState::Stopped => {
            word("Stopped. Press Release stop, then engage again", "Angehalten. Halt lösen, dann neu koppeln")
                .to_owned()
        }
        InterlockState::Disconnected => word(
            "A device is missing or sends no data. See Devices",
            "Ein Gerät fehlt oder sendet nichts. Siehe Geräte",
        )
        .to_owned(),
        InterlockState::Idle | InterlockState::Ready | InterlockState::Engaged | InterlockState::Clutched => {
            String::new()
        }
    }
}
