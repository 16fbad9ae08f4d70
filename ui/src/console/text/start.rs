//! The start page: rig and scene.

pub(in crate::console) const OPEN: &str = "Rig";
pub(in crate::console) const OPEN_HOVER: &str = "Choose a rig and a scene, make a rig, see what is plugged in. F6";
pub(in crate::console) const OPEN_DISABLED_HOVER: &str = "Close the calibration wizard or the study first";
pub(in crate::console) const RIGS: &str = "1. Choose a rig";
pub(in crate::console) const RIGS_HOVER: &str = "A rig is the set of devices and the settings of the loop";
pub(in crate::console) const SCENES: &str = "2. Choose a scene";
pub(in crate::console) const SCENES_HOVER: &str =
    "What a simulated or emulated rig works on. A real rig only shows it in the 3-D view.";
pub(in crate::console) const MISSING: &str = "Devices of this rig";
pub(in crate::console) const MISSING_HOVER: &str =
    "Whether each device of the chosen rig answers, and if not, why and what to do";
pub(in crate::console) const PLUGGED: &str = "Plugged into this computer";
pub(in crate::console) const PLUGGED_HOVER: &str = "Found without opening anything; looked for again every two seconds";
pub(in crate::console) const RECENT: &str = "Used last";
pub(in crate::console) const BUILT_IN: &str = "Built in";
pub(in crate::console) const YOURS: &str = "Yours";
pub(in crate::console) const NEW_NAME: &str = "Name of a new rig";
pub(in crate::console) const MAKE: &str = "Make a copy of the chosen rig";
pub(in crate::console) const MAKE_HOVER: &str =
    "Writes a rig file with its comments into your folder of rigs; the chosen rig stays as it is";
pub(in crate::console) const START: &str = "Start";
pub(in crate::console) const START_AGAIN: &str = "Start again";
pub(in crate::console) const START_HOVER: &str = "Ends the loop and starts this rig, idle";
pub(in crate::console) const BACK: &str = "Back";
pub(in crate::console) const BACK_HOVER: &str = "Back to the view; nothing changes";
pub(in crate::console) const CHECK: &str = "Check the devices";
pub(in crate::console) const CHECK_HOVER: &str = "Opens each device for a moment; takes about a second";
pub(in crate::console) const CHECKING: &str = "Checking the devices";
pub(in crate::console) const SIMULATED: &str = "Everything is simulated: nothing needs to be plugged in";
pub(in crate::console) const LED: &str = "1 device: a real handle leads the simulated rig";
pub(in crate::console) const EMULATED: &str = "The emulators start with this rig: nothing needs to be plugged in";
pub(in crate::console) const RUNNING: &str = "Running now";
pub(in crate::console) const NOTHING_PLUGGED: &str = "No device that this program can use";
pub(in crate::console) const STARTING: &str = "Starting";
pub(in crate::console) const ENGAGED: &str = "Stop first: this rig is engaged";
pub(in crate::console) const ALL_THERE: &str = "Every device answers";
pub(in crate::console) const NO_THREAD: &str = "the system gives no thread for the emulators";
pub(in crate::console) const NO_FOLDER: &str = "There is no folder for your files: set NIMA_DATA_DIR";
pub(in crate::console) const NAME_FIRST: &str = "Give it a name of letters, digits, blanks, dashes or underscores";

pub(in crate::console) const WELCOME_WINDOW: &str = "Welcome";
pub(in crate::console) const WELCOME: &str = "Haptic teleoperation in laparoscopy";
pub(in crate::console) const WELCOME_WHAT: &str = "A surgeon moves a handle, and a robot arm moves the instrument. This console measures the force at its tip, \
     predicts it across the delay of the link, limits it, and gives it back to the hand. What moves behind this window is simulated.";
pub(in crate::console) const WELCOME_NOT: &str =
    "For research and teaching only. It is not a medical device: never use it on patients.";
pub(in crate::console) const WELCOME_SIMULATED: &str = "Go on with the simulated rig";
pub(in crate::console) const WELCOME_SIMULATED_ABOUT: &str = "It runs already. A tour of four steps shows the screen.";
pub(in crate::console) const WELCOME_DEMO: &str = "Watch the demonstration";
pub(in crate::console) const WELCOME_DEMO_ABOUT: &str =
    "It explains the forces chapter by chapter, then it is your turn";
pub(in crate::console) const WELCOME_OWN: &str = "Choose or make a rig of your own";
pub(in crate::console) const WELCOME_OWN_ABOUT: &str =
    "Your devices, the paper's rig emulated, or another scene. It starts idle, and only you engage it.";

pub(in crate::console) const ENDOSCOPE: &str = "Endoscope of this rig";
pub(in crate::console) const ENDOSCOPE_HOVER: &str =
    "Where the surgeon's picture comes from. What is typed is tried at once";
pub(in crate::console) const ENDOSCOPE_ADDRESS: &str = "Address of the endoscope";
pub(in crate::console) const ENDOSCOPE_HINT: &str = "http://192.168.10.7:8080/stream";
pub(in crate::console) const ENDOSCOPE_USE: &str = "Write this address into the rig";
pub(in crate::console) const ENDOSCOPE_REMOVE: &str = "Take the endoscope out of the rig";
pub(in crate::console) const ENDOSCOPE_USE_HOVER: &str = "A built-in rig stays as it is: a copy of yours gets the address. Start it to see the picture in the surgeon's view.";
pub(in crate::console) const ENDOSCOPE_TYPING: &str = "Tried when you stop typing";
pub(in crate::console) const ENDOSCOPE_OPENING: &str = "Opening it";
pub(in crate::console) const ENDOSCOPE_FORMS: &str =
    "Give http://HOST:PORT/PATH, or the path of a .mjpeg, a JPEG or a folder of them";
pub(in crate::console) const NO_ENDOSCOPE: &str = "None: the surgeon's view draws the field";

/// An address that works: size of the picture, and pictures a second where it moves.
pub(in crate::console) fn endoscope_sends([width, height]: [usize; 2], rate_hz: Option<f64>) -> String {
    match rate_hz {
        Some(rate_hz) => format!("Sends {width} x {height} pixels, {rate_hz:.0} pictures a second"),
        None => format!("One picture of {width} x {height} pixels"),
    }
}

/// The address is in the rig's file.
pub(in crate::console) fn endoscope_written(path: &str) -> String {
    format!("Written: {path}. Start it to use the address.")
}

/// A rig in few words: what it runs on.
pub(in crate::console) fn of_devices(count: usize, emulated: bool) -> String {
    let devices = if count == 1 { "1 device".to_owned() } else { format!("{count} devices") };
    if emulated { format!("{devices}, emulated") } else { devices }
}

/// A file that cannot be used.
pub(in crate::console) fn unusable(cause: &str) -> String {
    format!("Cannot be used: {cause}")
}

/// The name is taken.
pub(in crate::console) fn taken(path: &std::path::Path) -> String {
    format!("There is a rig of this name: {}", path.display())
}

/// Where a new rig file is.
pub(in crate::console) fn made(path: &std::path::Path) -> String {
    format!("Written: {}", path.display())
}

/// The rig did not start; which one is running instead.
pub(in crate::console) fn not_started(cause: &str, instead: Option<&str>) -> String {
    match instead {
        Some(rig) => format!("Not started: {cause}. {rig} is running again."),
        None => format!("Not started: {cause}. No rig is running."),
    }
}

/// A device and its state.
pub(in crate::console) fn answers(name: &str, product: &str, serial: &str) -> String {
    format!("{name}: {product} {serial}").trim_end().to_owned()
}
