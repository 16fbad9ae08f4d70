//! The panel of the line to the machine with the arm.

use crate::language::Text;

pub(super) const NOTHING_YET: Text =
    Text::of("The link has not reported yet", "Die Verbindung hat noch nichts gemeldet");
pub(super) const HOLDS: Text = Text::of("This console holds the follower", "Diese Konsole steuert den Folgearm");
pub(super) const ASKED: Text =
    Text::of("Another console asks for the follower", "Eine andere Konsole fragt nach dem Folgearm");
pub(super) const WAITS: Text =
    Text::of("This console does not hold the follower", "Diese Konsole steuert den Folgearm nicht");
pub(super) const ASKS: Text = Text::of(
    "Asked for control; waiting for the other console's answer",
    "Steuerung angefragt; warten auf die Antwort der anderen Konsole",
);
pub(super) const DENIED: Text =
    Text::of("The other console keeps the follower", "Die andere Konsole behält den Folgearm");
pub(super) const CONTROL_HOVER: Text = Text::of(
    "One console at a time commands the follower. Another one gets it only if the first consents.",
    "Nur eine Konsole steuert den Folgearm. Eine andere bekommt ihn erst, wenn die erste zustimmt.",
);
pub(super) const ASK: Text = Text::of("Ask for control", "Steuerung anfragen");
pub(super) const ASK_HOVER: Text = Text::of(
    "The user of the console that holds the follower is asked. Nothing moves: after consent you engage here.",
    "Fragt an der Konsole, die den Folgearm steuert. Nichts bewegt sich: nach der Zustimmung hier koppeln.",
);
pub(super) const WITHDRAW: Text = Text::of("Withdraw the question", "Anfrage zurückziehen");
pub(super) const WITHDRAW_HOVER: Text =
    Text::of("The other console is not asked any more", "Die andere Konsole wird nicht mehr gefragt");
pub(super) const GIVE: Text = Text::of("Give control", "Steuerung abgeben");
pub(super) const GIVE_HOVER: Text = Text::of(
    "The other console commands the follower from now on; this one can ask for it again",
    "Ab jetzt steuert die andere Konsole den Folgearm; diese kann ihn wieder anfragen",
);
pub(super) const GIVE_AT_REST: Text = Text::of(
    "Stop and release first: an engaged arm stays here",
    "Erst anhalten und Halt lösen: ein gekoppelter Arm \
     bleibt hier",
);
pub(super) const KEEP: Text = Text::of("Keep control", "Steuerung behalten");
pub(super) const KEEP_HOVER: Text = Text::of(
    "The other console is told that you keep the follower",
    "Meldet der anderen Konsole, dass der Folgearm hier bleibt",
);
pub(super) const CONTROL_ASKED_CAUSE: Text = Text::of(
    "Another console asks for control of the follower",
    "Eine andere Konsole fragt die Steuerung des \
     Folgearms an",
);
pub(super) const CONTROL_ASKED_CURE: Text = Text::of("Answer in the panel Link", "Im Panel Verbindung antworten");
