//! The line to the machine with the arm.

use crate::language::Text;

pub(in crate::console) const LINK: Text = Text::of(
    "link to the follower's machine",
    "Verbindung zum Rechner des \
 Folgearms",
);
pub(in crate::console) const ONE_MACHINE: Text =
    Text::of("Handle and arm are at this machine", "Handgerät und Arm sind an diesem Rechner");
pub(in crate::console) const HOW_TWO: Text = Text::of(
    "For an arm at another machine start nima follower there and nima console --follower HOST here. The panel Feedback \
     sets the delay of the simulated link.",
    "Für einen Arm an einem anderen Rechner dort nima follower und hier nima console --follower HOST starten. Die \
     Verzögerung der simulierten Verbindung stellt das Panel Rückkopplung ein.",
);
pub(in crate::console) const NOT_IN_SESSIONS: Text =
    Text::of("A session does not hold the figures of the network", "Eine Sitzung enthält keine Netzwerkwerte");
pub(in crate::console) const NOTHING_YET: Text =
    Text::of("The link has not reported yet", "Die Verbindung hat noch nichts gemeldet");
pub(in crate::console) const HOLDS: Text =
    Text::of("This console holds the follower", "Diese Konsole steuert den Folgearm");
pub(in crate::console) const ASKED: Text =
    Text::of("Another console asks for the follower", "Eine andere Konsole fragt nach dem Folgearm");
pub(in crate::console) const WAITS: Text =
    Text::of("This console does not hold the follower", "Diese Konsole steuert den Folgearm nicht");
pub(in crate::console) const ASKS: Text = Text::of(
    "Asked for control; waiting for the other console's answer",
    "Steuerung angefragt; warten auf die Antwort der anderen Konsole",
);
pub(in crate::console) const DENIED: Text =
    Text::of("The other console keeps the follower", "Die andere Konsole behält den Folgearm");
pub(in crate::console) const CONTROL_HOVER: Text = Text::of(
    "One console at a time commands the follower. Another one gets it only if the first consents.",
    "Nur eine Konsole steuert den Folgearm. Eine andere bekommt ihn erst, wenn die erste zustimmt.",
);
pub(in crate::console) const ASK: Text = Text::of("Ask for control", "Steuerung anfragen");
pub(in crate::console) const ASK_HOVER: Text = Text::of(
    "The user of the console that holds the follower is asked. Nothing moves: after consent you engage here.",
    "Fragt an der Konsole, die den Folgearm steuert. Nichts bewegt sich: nach der Zustimmung hier koppeln.",
);
pub(in crate::console) const WITHDRAW: Text = Text::of("Withdraw the question", "Anfrage zurückziehen");
pub(in crate::console) const WITHDRAW_HOVER: Text =
    Text::of("The other console is not asked any more", "Die andere Konsole wird nicht mehr gefragt");
pub(in crate::console) const GIVE: Text = Text::of("Give control", "Steuerung abgeben");
pub(in crate::console) const GIVE_HOVER: Text = Text::of(
    "The other console commands the follower from now on; this one can ask for it again",
    "Ab jetzt steuert die andere Konsole den Folgearm; diese kann ihn wieder anfragen",
);
pub(in crate::console) const GIVE_AT_REST: Text = Text::of(
    "Stop and release first: an engaged arm stays here",
    "Erst anhalten und Halt lösen: ein gekoppelter Arm \
     bleibt hier",
);
pub(in crate::console) const KEEP: Text = Text::of("Keep control", "Steuerung behalten");
pub(in crate::console) const KEEP_HOVER: Text = Text::of(
    "The other console is told that you keep the follower",
    "Meldet der anderen Konsole, dass der Folgearm hier bleibt",
);
pub(in crate::console) const CONTROL_ASKED_CAUSE: Text = Text::of(
    "Another console asks for control of the follower",
    "Eine andere Konsole fragt die Steuerung des \
     Folgearms an",
);
pub(in crate::console) const CONTROL_ASKED_CURE: Text =
    Text::of("Answer in the panel Link", "Im Panel Verbindung antworten");
pub(in crate::console) const DELAY_IS_MEASURED: Text = Text::of(
    "The delay is that of the network to the other machine, as measured; it cannot be set",
    "Gemessene Verzögerung des Netzes zum anderen Rechner; nicht einstellbar",
);
pub(in crate::console) const ONE_RIG: Text = Text::of(
    "This console uses the arm at another machine: close it, and start it without --follower to use another rig or \
     scene",
    "Diese Konsole nutzt den Arm an einem anderen Rechner: für einen anderen Aufbau oder eine andere Szene schließen \
     und ohne --follower starten",
);
