//! The start page: rig and scene.

use crate::language::{Text, told, word};

pub(in crate::console) const OPEN: Text = Text::of("Rig", "Rig");
pub(in crate::console) const OPEN_HOVER: Text = Text::of(
    "Choose a rig and a scene, make a rig, see what is plugged in. F6",
    "Choose a rig and a scene, make a rig, see what is plugged in. F6",
);
pub(in crate::console) const OPEN_DISABLED_HOVER: Text =
    Text::of("Close the calibration wizard or the study first", "Close the calibration wizard or the study first");
pub(in crate::console) const RIGS: Text = Text::of("1. Choose a rig", "1. Choose a rig");
pub(in crate::console) const RIGS_HOVER: Text = Text::of(
    "A rig is the set of devices and the settings of the loop",
    "A rig is the set of devices and the settings of the loop",
);
pub(in crate::console) const SCENES: Text = Text::of("2. Choose a scene", "2. Choose a scene");
pub(in crate::console) const SCENES_HOVER: Text = Text::of(
    "What a simulated or emulated rig works on. A real rig only shows it in the 3-D view.",
    "What a simulated or emulated rig works on. A real rig only shows it in the 3-D view.",
);
pub(in crate::console) const MISSING: Text = Text::of("Devices of this rig", "Devices of this rig");
pub(in crate::console) const MISSING_HOVER: Text = Text::of(
    "Whether each device of the chosen rig answers, and if not, why and what to do",
    "Whether each device of the chosen rig answers, and if not, why and what to do",
);
pub(in crate::console) const PLUGGED: Text = Text::of("Plugged into this computer", "Plugged into this computer");
pub(in crate::console) const PLUGGED_HOVER: Text = Text::of(
    "Found without opening anything; looked for again every two seconds",
    "Found without opening anything; looked for again every two seconds",
);
pub(in crate::console) const RECENT: Text = Text::of("Used last", "Used last");
pub(in crate::console) const BUILT_IN: Text = Text::of("Built in", "Built in");
pub(in crate::console) const YOURS: Text = Text::of("Yours", "Yours");
pub(in crate::console) const NEW_NAME: Text = Text::of("Name of a new rig", "Name of a new rig");
pub(in crate::console) const MAKE: Text = Text::of("Make a copy of the chosen rig", "Make a copy of the chosen rig");
pub(in crate::console) const MAKE_HOVER: Text = Text::of(
    "Writes a rig file with its comments into your folder of rigs; the chosen rig stays as it is",
    "Writes a rig file with its comments into your folder of rigs; the chosen rig stays as it is",
);
pub(in crate::console) const START: Text = Text::of("Start", "Start");
pub(in crate::console) const START_AGAIN: Text = Text::of("Start again", "Start again");
pub(in crate::console) const START_HOVER: Text =
    Text::of("Ends the loop and starts this rig, idle", "Ends the loop and starts this rig, idle");
pub(in crate::console) const BACK: Text = Text::of("Back", "Back");
pub(in crate::console) const BACK_HOVER: Text =
    Text::of("Back to the view; nothing changes", "Back to the view; nothing changes");
pub(in crate::console) const CHECK: Text = Text::of("Check the devices", "Check the devices");
pub(in crate::console) const CHECK_HOVER: Text = Text::of(
    "Opens each device for a moment; takes about a second",
    "Opens each device for a moment; takes about a second",
);
pub(in crate::console) const CHECKING: Text = Text::of("Checking the devices", "Checking the devices");
pub(in crate::console) const SIMULATED: Text = Text::of(
    "Everything is simulated: nothing needs to be plugged in",
    "Everything is simulated: nothing needs to be plugged in",
);
pub(in crate::console) const LED: Text =
    Text::of("1 device: a real handle leads the simulated rig", "1 device: a real handle leads the simulated rig");
pub(in crate::console) const EMULATED: Text = Text::of(
    "The emulators start with this rig: nothing needs to be plugged in",
    "The emulators start with this rig: nothing needs to be plugged in",
);
pub(in crate::console) const RUNNING: Text = Text::of("Running now", "Running now");
pub(in crate::console) const NOTHING_PLUGGED: Text =
    Text::of("No device that this program can use", "No device that this program can use");
pub(in crate::console) const STARTING: Text = Text::of("Starting", "Starting");
pub(in crate::console) const ENGAGED: Text =
    Text::of("Stop first: this rig is engaged", "Stop first: this rig is engaged");
pub(in crate::console) const ALL_THERE: Text = Text::of("Every device answers", "Every device answers");
pub(in crate::console) const NO_THREAD: Text =
    Text::of("the system gives no thread for the emulators", "the system gives no thread for the emulators");
pub(in crate::console) const NO_FOLDER: Text = Text::of(
    "There is no folder for your files: set NIMA_DATA_DIR",
    "There is no folder for your files: set NIMA_DATA_DIR",
);
pub(in crate::console) const NAME_FIRST: Text = Text::of(
    "Give it a name of letters, digits, blanks, dashes or underscores",
    "Give it a name of letters, digits, blanks, dashes or underscores",
);

pub(in crate::console) const WELCOME_WINDOW: Text = Text::of("Welcome", "Welcome");
pub(in crate::console) const WELCOME: Text =
    Text::of("Haptic teleoperation in laparoscopy", "Haptic teleoperation in laparoscopy");
pub(in crate::console) const WELCOME_WHAT: Text = Text::of(
    "A surgeon moves a handle, and a robot arm moves the instrument. This console measures the force at its tip, \
     predicts it across the delay of the link, limits it, and gives it back to the hand. What moves behind this window \
     is simulated.",
    "A surgeon moves a handle, and a robot arm moves the instrument. This console measures the force at its tip, \
     predicts it across the delay of the link, limits it, and gives it back to the hand. What moves behind this window \
     is simulated.",
);
pub(in crate::console) const WELCOME_NOT: Text = Text::of(
    "For research and teaching only. It is not a medical device: never use it on patients.",
    "For research and teaching only. It is not a medical device: never use it on patients.",
);
pub(in crate::console) const WELCOME_SIMULATED: Text =
    Text::of("Go on with the simulated rig", "Go on with the simulated rig");
pub(in crate::console) const WELCOME_SIMULATED_ABOUT: Text = Text::of(
    "It runs already. A tour of four steps shows the screen.",
    "It runs already. A tour of four steps shows the screen.",
);
pub(in crate::console) const WELCOME_DEMO: Text = Text::of("Watch the demonstration", "Watch the demonstration");
pub(in crate::console) const WELCOME_DEMO_ABOUT: Text = Text::of(
    "It explains the forces chapter by chapter, then it is your turn",
    "It explains the forces chapter by chapter, then it is your turn",
);
pub(in crate::console) const WELCOME_OWN: Text =
    Text::of("Choose or make a rig of your own", "Choose or make a rig of your own");
pub(in crate::console) const WELCOME_OWN_ABOUT: Text = Text::of(
    "Your devices, the paper's rig emulated, or another scene. It starts idle, and only you engage it.",
    "Your devices, the paper's rig emulated, or another scene. It starts idle, and only you engage it.",
);

pub(in crate::console) const ENDOSCOPE: Text = Text::of("Endoscope of this rig", "Endoscope of this rig");
pub(in crate::console) const ENDOSCOPE_HOVER: Text = Text::of(
    "Where the surgeon's picture comes from. What is typed is tried at once",
    "Where the surgeon's picture comes from. What is typed is tried at once",
);
pub(in crate::console) const ENDOSCOPE_ADDRESS: Text = Text::of("Address of the endoscope", "Address of the endoscope");
pub(in crate::console) const ENDOSCOPE_HINT: Text =
    Text::of("http://192.168.10.7:8080/stream", "http://192.168.10.7:8080/stream");
pub(in crate::console) const ENDOSCOPE_USE: Text =
    Text::of("Write this address into the rig", "Write this address into the rig");
pub(in crate::console) const ENDOSCOPE_REMOVE: Text =
    Text::of("Take the endoscope out of the rig", "Take the endoscope out of the rig");
pub(in crate::console) const ENDOSCOPE_USE_HOVER: Text = Text::of(
    "A built-in rig stays as it is: a copy of yours gets the address. Start it to see the picture in the surgeon's \
     view.",
    "A built-in rig stays as it is: a copy of yours gets the address. Start it to see the picture in the surgeon's \
     view.",
);
pub(in crate::console) const ENDOSCOPE_TYPING: Text =
    Text::of("Tried when you stop typing", "Tried when you stop typing");
pub(in crate::console) const ENDOSCOPE_OPENING: Text = Text::of("Opening it", "Opening it");
pub(in crate::console) const ENDOSCOPE_FORMS: Text = Text::of(
    "Give http://HOST:PORT/PATH, or the path of a .mjpeg, a JPEG or a folder of them",
    "Give http://HOST:PORT/PATH, or the path of a .mjpeg, a JPEG or a folder of them",
);
pub(in crate::console) const NO_ENDOSCOPE: Text =
    Text::of("None: the surgeon's view draws the field", "None: the surgeon's view draws the field");

/// An address that works: size of the picture, and pictures a second where it moves.
pub(in crate::console) fn endoscope_sends([width, height]: [usize; 2], rate_hz: Option<f64>) -> String {
    match rate_hz {
        Some(rate_hz) => told!(
            "Sends {width} x {height} pixels, {rate_hz:.0} pictures a second",
            "Sends {width} x {height} pixels, {rate_hz:.0} pictures a second"
        ),
        None => told!("One picture of {width} x {height} pixels", "One picture of {width} x {height} pixels"),
    }
}

/// The address is in the rig's file.
pub(in crate::console) fn endoscope_written(path: &str) -> String {
    told!("Written: {path}. Start it to use the address.", "Written: {path}. Start it to use the address.")
}

/// A rig in few words: what it runs on.
pub(in crate::console) fn of_devices(count: usize, emulated: bool) -> String {
    let devices =
        if count == 1 { word("1 device", "1 device").to_owned() } else { told!("{count} devices", "{count} devices") };
    if emulated { told!("{devices}, emulated", "{devices}, emulated") } else { devices }
}

/// A file that cannot be used.
pub(in crate::console) fn unusable(cause: &str) -> String {
    told!("Cannot be used: {cause}", "Cannot be used: {cause}")
}

/// The name is taken.
pub(in crate::console) fn taken(path: &std::path::Path) -> String {
    told!("There is a rig of this name: {}", "There is a rig of this name: {}", path.display())
}

/// Where a new rig file is.
pub(in crate::console) fn made(path: &std::path::Path) -> String {
    told!("Written: {}", "Written: {}", path.display())
}

/// The rig did not start; which one is running instead.
pub(in crate::console) fn not_started(cause: &str, instead: Option<&str>) -> String {
    match instead {
        Some(rig) => {
            told!("Not started: {cause}. {rig} is running again.", "Not started: {cause}. {rig} is running again.")
        }
        None => told!("Not started: {cause}. No rig is running.", "Not started: {cause}. No rig is running."),
    }
}

/// A device and its state.
pub(in crate::console) fn answers(name: &str, product: &str, serial: &str) -> String {
    format!("{name}: {product} {serial}").trim_end().to_owned()
}
