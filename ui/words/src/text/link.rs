//! The link to the machine with the arm.

use crate::language::Text;

pub const NAME: Text = Text::of("Link", "Verbindung");
pub const MEANING: Text = Text::of(
    "The network between this machine and the machine with the arm: delay, loss, clock, and which console \
     controls the follower",
    "Netzwerk zwischen diesem Rechner und dem des Arms: Verzögerung, Verlust, Uhr, und welche Konsole den \
     Folgearm steuert",
);

pub const LINK: Text = Text::of(
    "link to the follower's machine",
    "Verbindung zum Rechner des \
 Folgearms",
);
pub const ONE_MACHINE: Text =
    Text::of("Handle and arm are connected to this machine", "Handgerät und Arm sind an diesem Rechner");
pub const HOW_TWO: Text = Text::of(
    "For an arm at another machine, start nima follower there and nima console --follower HOST here. The \
     Feedback panel sets the delay of the simulated link.",
    "Für einen Arm an einem anderen Rechner dort nima follower und hier nima console --follower HOST starten. Die \
     Verzögerung der simulierten Verbindung stellt das Panel Rückkopplung ein.",
);
pub const NOT_IN_SESSIONS: Text =
    Text::of("A session does not contain the network statistics", "Eine Sitzung enthält keine Netzwerkwerte");
pub const DELAY_IS_MEASURED: Text = Text::of(
    "Measured delay of the network to the other machine; it cannot be set",
    "Gemessene Verzögerung des Netzes zum anderen Rechner; nicht einstellbar",
);
pub const ONE_RIG: Text = Text::of(
    "This console uses the arm on another machine. To use another rig or scene, close the console and start it \
     without --follower.",
    "Diese Konsole nutzt den Arm an einem anderen Rechner. Für einen anderen Aufbau oder eine andere Szene die \
     Konsole schließen und ohne --follower starten.",
);
