//! A rig at another machine that is only watched.

use crate::language::{Text, told};

pub(in crate::console) const WATCHING: Text = Text::of("WATCHING", "WATCHING");
pub(in crate::console) const WATCHING_HOVER: Text = Text::of(
    "This window shows a rig at another machine, about a tenth of a second late; nothing in it can act on the rig",
    "This window shows a rig at another machine, about a tenth of a second late; nothing in it can act on the rig",
);
pub(in crate::console) const BLOCKED: Text = Text::of("Only at the rig's own console", "Only at the rig's own console");
pub(in crate::console) const CONNECTING: Text = Text::of("Connecting to the rig", "Connecting to the rig");
pub(in crate::console) const RESTS: Text =
    Text::of("The rig is shared, and no loop runs there now", "The rig is shared, and no loop runs there now");
pub(in crate::console) const NO_LINK: Text = Text::of(
    "The figures of the network are on the rig's own console",
    "The figures of the network are on the rig's own console",
);
pub(in crate::console) const SIMULATED: Text =
    Text::of("This rig has no devices: everything is simulated", "This rig has no devices: everything is simulated");
pub(in crate::console) const NOT_OF_DEVICES: Text = Text::of(
    "What each device counts and measures on its own, and the calibrations, are on the rig's own console",
    "What each device counts and measures on its own, and the calibrations, are on the rig's own console",
);

/// The title of the window.
pub(in crate::console) fn title(rig: &str) -> String {
    told!("{rig}: watching", "{rig}: watching")
}

/// Which rig.
pub(in crate::console) fn rig_and_scene(rig: &str, scene: &str) -> String {
    format!("{rig}, {scene}")
}

/// Nothing has come for some time.
pub(in crate::console) fn silent(seconds: f64) -> String {
    told!(
        "Nothing from the rig for {seconds:.0} s: what is shown is old",
        "Nothing from the rig for {seconds:.0} s: what is shown is old"
    )
}

/// The alarm at the rig.
pub(in crate::console) fn alarm(priority: &str, cause: &str) -> String {
    format!("{priority}: {cause}")
}
