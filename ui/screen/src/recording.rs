//! Starts the session file of a plan, for every command that runs a loop.

use std::{
    collections::BTreeMap,
    time::{SystemTime, UNIX_EPOCH},
};

use nima_machine::runtime::{ClockProfile, Tap, VirtualClock, tap};
use nima_recording::store::utc_now;
use nima_session::{
    SentenceChannel,
    recorder::{AttachedFile, RecordError, RecordingInfo, SessionRecorder},
    sinks::Destination,
};
use nima_simulation::SimulationPlan;
use nima_words::report_text::{event, happening, operation};

/// Texts of the log.
pub const WORDS: SentenceChannel = SentenceChannel { event, operation, happening };

pub const PROGRAM: &str = concat!("nima ", env!("CARGO_PKG_VERSION"));

/// Name of the attached rig file.
pub const RIG: &str = "rig.toml";
/// Name of the attached scene file.
pub const SCENE: &str = "scene.toml";

pub fn toml_file(name: &str, text: String) -> AttachedFile {
    AttachedFile { name: name.to_owned(), media_type: "application/toml".to_owned(), data: text.into_bytes() }
}

/// Starts the recording of a loop of this plan; the tap is for its [`nima_machine::runtime::Assembly`]. `clock`: the virtual
/// clock, `None` for the real one.
pub fn begin(
    to: Destination<'_>,
    plan: &SimulationPlan,
    clock: Option<VirtualClock>,
) -> Result<(Tap, SessionRecorder), RecordError> {
    let (tap, end) = tap();
    let recorder = SessionRecorder::start(to, about(plan, clock), plan.origin(), end)?;
    Ok((tap, recorder))
}

fn about(plan: &SimulationPlan, clock: Option<VirtualClock>) -> RecordingInfo {
    let started_ns = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64);
    let SimulationPlan { rig, scene, .. } = plan;
    let build = if cfg!(debug_assertions) { "debug" } else { "release" };
    let session = [
        ("program", PROGRAM.to_owned()),
        ("build", build.to_owned()),
        ("system", format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)),
        ("started", utc_now()),
        ("clock", if clock.is_some() { "virtual" } else { "real" }.to_owned()),
        ("rig", rig.name.clone()),
        ("scene", scene.name.clone()),
        ("seed", scene.seed.to_string()),
        ("rate_hz", rig.rate_hz.to_string()),
        ("mode", rig.mode.to_string()),
        ("delay_s", rig.delay_s.to_string()),
    ];
    // A replay does not need the profile or the seed, because the journal contains the times of the ticks.
    let late = clock.filter(|clock| clock.profile != ClockProfile::Perfect);
    let late = late.map(|clock| [("clock_profile", clock.profile.to_string()), ("clock_seed", clock.seed.to_string())]);
    let session = session.into_iter().chain(late.into_iter().flatten());
    let session = session.map(|(key, value)| (key.to_owned(), value)).collect();
    // The active settings, including changes from the command line.
    let texts = [(RIG, toml::to_string(&rig.clone().without_secrets())), (SCENE, toml::to_string(scene))];
    let file = |(name, text): (&str, Result<String, _>)| Some(toml_file(name, text.ok()?));
    RecordingInfo {
        program: PROGRAM.to_owned(),
        started_ns,
        metadata: BTreeMap::from([("session".to_owned(), session)]),
        files: texts.into_iter().filter_map(file).collect(),
        words: WORDS,
    }
}
