//! Texts: what another program is told of a state.

use nima_core::safety::State;
use nima_machine::messages::LoopState;

use crate::{language::word, words::Remedy as _};

/// What is wrong in a state, and what to do, beside a code for another program; nothing in a state in which all is well.
pub(super) fn trouble_of(state: LoopState) -> String {
    match state {
        State::Faulted(fault) => format!("{}. {}", fault.cause(), fault.cure()),
        State::Stopped => {
            word("Stopped. Press Release stop, then engage again", "Angehalten. Halt lösen, dann neu koppeln")
                .to_owned()
        }
        State::Disconnected => word(
            "A device is missing or sends no data. See Devices",
            "Ein Gerät fehlt oder sendet nichts. Siehe Geräte",
        )
        .to_owned(),
        State::Idle | State::Ready | State::Engaged | State::Clutched => String::new(),
    }
}
