//! The line to the machine with the arm.

use crate::language::Text;

pub(in crate::console) const LINK: Text = Text::of("link to the follower's machine", "link to the follower's machine");
pub(in crate::console) const ONE_MACHINE: Text =
    Text::of("Handle and arm are at this machine", "Handle and arm are at this machine");
pub(in crate::console) const HOW_TWO: Text = Text::of(
    "For an arm at another machine start nima follower there and nima console --follower HOST here. The panel Feedback \
     sets the delay of the simulated link.",
    "For an arm at another machine start nima follower there and nima console --follower HOST here. The panel Feedback \
     sets the delay of the simulated link.",
);
pub(in crate::console) const NOT_IN_SESSIONS: Text = Text::of(
    "A session does not hold the figures of the network",
    "A session does not hold the figures of the network",
);
pub(in crate::console) const NOTHING_YET: Text =
    Text::of("The link has not reported yet", "The link has not reported yet");
pub(in crate::console) const HOLDS: Text =
    Text::of("This console holds the follower", "This console holds the follower");
pub(in crate::console) const ASKED: Text =
    Text::of("Another console asks for the follower", "Another console asks for the follower");
pub(in crate::console) const WAITS: Text =
    Text::of("This console does not hold the follower", "This console does not hold the follower");
pub(in crate::console) const ASKS: Text = Text::of(
    "Asked for control; waiting for the other console's answer",
    "Asked for control; waiting for the other console's answer",
);
pub(in crate::console) const DENIED: Text =
    Text::of("The other console keeps the follower", "The other console keeps the follower");
pub(in crate::console) const CONTROL_HOVER: Text = Text::of(
    "One console at a time commands the follower. Another one gets it only if the first consents.",
    "One console at a time commands the follower. Another one gets it only if the first consents.",
);
pub(in crate::console) const ASK: Text = Text::of("Ask for control", "Ask for control");
pub(in crate::console) const ASK_HOVER: Text = Text::of(
    "The user of the console that holds the follower is asked. Nothing moves: after consent you engage here.",
    "The user of the console that holds the follower is asked. Nothing moves: after consent you engage here.",
);
pub(in crate::console) const WITHDRAW: Text = Text::of("Withdraw the question", "Withdraw the question");
pub(in crate::console) const WITHDRAW_HOVER: Text =
    Text::of("The other console is not asked any more", "The other console is not asked any more");
pub(in crate::console) const GIVE: Text = Text::of("Give control", "Give control");
pub(in crate::console) const GIVE_HOVER: Text = Text::of(
    "The other console commands the follower from now on; this one can ask for it again",
    "The other console commands the follower from now on; this one can ask for it again",
);
pub(in crate::console) const GIVE_AT_REST: Text =
    Text::of("Stop and release first: an engaged arm stays here", "Stop and release first: an engaged arm stays here");
pub(in crate::console) const KEEP: Text = Text::of("Keep control", "Keep control");
pub(in crate::console) const KEEP_HOVER: Text = Text::of(
    "The other console is told that you keep the follower",
    "The other console is told that you keep the follower",
);
pub(in crate::console) const CONTROL_ASKED_CAUSE: Text =
    Text::of("Another console asks for control of the follower", "Another console asks for control of the follower");
pub(in crate::console) const CONTROL_ASKED_CURE: Text =
    Text::of("Answer in the panel Link", "Answer in the panel Link");
pub(in crate::console) const DELAY_IS_MEASURED: Text = Text::of(
    "The delay is that of the network to the other machine, as measured; it cannot be set",
    "The delay is that of the network to the other machine, as measured; it cannot be set",
);
pub(in crate::console) const ONE_RIG: Text = Text::of(
    "This console uses the arm at another machine: close it, and start it without --follower to use another rig or \
     scene",
    "This console uses the arm at another machine: close it, and start it without --follower to use another rig or \
     scene",
);
