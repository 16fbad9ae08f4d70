//! The Link panel.

use nima_words::language::Text;

pub(super) const NOTHING_YET: Text =
    Text::of("The link has not reported yet", "Die Verbindung hat noch nichts gemeldet");
pub(super) const HOLDS: Text = Text::of("This console controls the follower", "Diese Konsole steuert den Folgearm");
pub(super) const ASKED: Text =
    Text::of("Another console requests control", "Eine andere Konsole fragt die Steuerung an");
pub(super) const WAITS: Text =
    Text::of("This console does not control the follower", "Diese Konsole steuert den Folgearm nicht");
pub(super) const ASKS: Text = Text::of(
    "Control requested; waiting for the other console's response",
    "Steuerung angefragt; warten auf die Antwort der anderen Konsole",
);
pub(super) const DENIED: Text = Text::of("The other console keeps control", "Die andere Konsole behält die Steuerung");
pub(super) const CONTROL_HOVER: Text = Text::of(
    "One console at a time controls the follower. Another console gets control only if the first one consents.",
    "Nur eine Konsole steuert den Folgearm. Eine andere bekommt ihn erst, wenn die erste zustimmt.",
);
pub(super) const ASK: Text = Text::of("Request control", "Steuerung anfragen");
pub(super) const ASK_HOVER: Text = Text::of(
    "Sends a request to the console that controls the follower. Nothing moves: after consent, engage here.",
    "Fragt an der Konsole, die den Folgearm steuert. Nichts bewegt sich: nach der Zustimmung hier koppeln.",
);
pub(super) const WITHDRAW: Text = Text::of("Withdraw request", "Anfrage zurückziehen");
pub(super) const WITHDRAW_HOVER: Text =
    Text::of("Cancels the request to the other console", "Zieht die Anfrage an die andere Konsole zurück");
pub(super) const GIVE: Text = Text::of("Give control", "Steuerung abgeben");
pub(super) const GIVE_HOVER: Text = Text::of(
    "The other console controls the follower from now on; this console can request control again",
    "Ab jetzt steuert die andere Konsole den Folgearm; diese kann ihn wieder anfragen",
);
pub(super) const GIVE_AT_REST: Text = Text::of(
    "Press Stop, then Release stop first: an engaged arm stays here",
    "Erst Halt, dann Halt lösen drücken: ein gekoppelter Arm bleibt hier",
);
pub(super) const KEEP: Text = Text::of("Keep control", "Steuerung behalten");
pub(super) const KEEP_HOVER: Text = Text::of(
    "Declines the request; the follower stays with this console",
    "Lehnt die Anfrage ab; der Folgearm bleibt bei dieser Konsole",
);
pub(super) const CONTROL_ASKED_CAUSE: Text = Text::of(
    "Another console requests control of the follower",
    "Eine andere Konsole fragt die Steuerung des \
     Folgearms an",
);
pub(super) const CONTROL_ASKED_CURE: Text =
    Text::of("Answer in the Link panel (F2)", "Im Panel Verbindung (F2) antworten");
