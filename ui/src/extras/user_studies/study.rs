//! Trials of a user study in the loop: from the sealed condition to a rig, from a simulated person to a scene, from a run to
//! a score.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, anyhow, bail};
use nima_core::impedance::Mode;
use nima_machine::{
    config::{ConfigError, RigConfig, text},
    messages::{Command, Fault, LoopState, Tick},
    runtime::{self, Assembly, VirtualClock},
};
use nima_recording::store::utc_now;
use nima_score::TaskFile;
use nima_screen::{objects::OfSimulation, recording};
use nima_session::sinks::Destination;
use nima_simulation::{ObjectFeed, SimulationPlan, scene::Scene};
use nima_user_study::{
    Condition, Mistakes, RunningTrial, StudyError, StudyFile, StudyStep, TrialEnding, TrialId, TrialPhase, UserStudy,
    simulated::SimulatedHand,
};
use nima_words::report_text::Remedy as _;

use crate::{extras::tasks::scoring::LiveScorer, shutdown::Leave};

/// Names of the templates.
pub(super) const READY: [&str; 2] = ["paper", "short"];
const STUDIES: [(&str, &str); 2] = [
    ("paper", include_str!("../../../../config/studies/paper.toml")),
    ("short", include_str!("../../../../config/studies/short.toml")),
];
/// Journal entry for a trial aborted by the operator.
pub(super) const GIVEN_UP: &str = "given up by the operator";
/// Journal entry for a trial that was stopped, whose loop ended, or whose window was closed.
pub(super) const STOPPED: &str = "stopped by the operator";
pub(super) const LOOP_ENDED: &str = "the loop ended";
pub(super) const CLOSED: &str = "the console was closed";
pub(super) const NOT_STARTED: &str = "the loop did not start";
const FAULT: &str = "the loop ended in a fault";
/// Timeout of the engagement, s.
const ENGAGES_S: f64 = 5.0;

/// Reason for the abort of a trial.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct TrialBreak {
    why: String,
    /// The kind of fault. Some occur only with force, so a blind study hides it.
    details: Option<String>,
    /// Whether the computer stalled briefly: such an attempt does not count.
    stalled: bool,
}

impl TrialBreak {
    pub(super) fn of(why: &str) -> Self {
        Self { why: why.to_owned(), details: None, stalled: false }
    }

    /// Returns the abort by this fault of a loop with this rate.
    pub(super) fn by(fault: Fault, rate_hz: f64) -> Self {
        let details = Some(fault.cause().to_owned());
        Self { why: FAULT.to_owned(), details, stalled: fault.is_short_stall(rate_hz) }
    }
}

/// Result of a trial.
pub(super) struct TrialRun {
    pub(super) trial: TrialId,
    /// `None` if it was aborted.
    pub(super) ending: Option<TrialEnding>,
    pub(super) completion_time_s: Option<f64>,
    /// Reason for the abort.
    pub(super) why: Option<String>,
}

/// Reads the template of this name, or a file.
pub(super) fn study_file(name: &str) -> anyhow::Result<StudyFile> {
    let (path, text) = text("study", name, &STUDIES)?;
    StudyFile::from_toml(&text).with_context(|| path.display().to_string())
}

/// Returns all errors of a study: its file, its scene, and conditions that its rig does not permit.
pub(super) fn mistakes(file: &StudyFile) -> Vec<String> {
    let mut wrong = file.check().err().map_or_else(Vec::new, |Mistakes(wrong)| wrong);
    wrong.extend(scene_of(file).err().map(|error| format!("{error:#}")));
    match RigConfig::load(&file.rig) {
        Err(error) => wrong.push(error.to_string()),
        Ok(rig) if wrong.is_empty() => wrong.extend(file.conditions.iter().filter_map(|condition| {
            let error = under(rig.clone(), condition).err()?;
            Some(format!("condition \"{}\": {error}", condition.name))
        })),
        Ok(_) => {}
    }
    wrong
}

pub(super) fn create(folder: &Path, file: &StudyFile) -> anyhow::Result<UserStudy> {
    let scene = scene_of(file)?;
    let rig = RigConfig::load(&file.rig)?;
    for condition in &file.conditions {
        under(rig.clone(), condition).with_context(|| format!("condition \"{}\"", condition.name))?;
    }
    let scene = toml::to_string(&scene).context("the scene cannot be written")?;
    Ok(UserStudy::create(folder, file, &scene, &utc_now())?)
}

/// Returns the scene of a study, with its task and its number of rings.
pub(super) fn scene_of(file: &StudyFile) -> anyhow::Result<Scene> {
    let mut scene = Scene::load(&file.scene)?;
    if let Some(task) = &file.task {
        scene.task = Some(task.to_scene()?);
    }
    if let Some(rings) = file.rings {
        let Some(objects) = &mut scene.objects else { bail!("rings = {rings}: scene \"{}\" has none", scene.name) };
        if objects.rings.len() < rings as usize {
            bail!("rings = {rings}: scene \"{}\" has {}", scene.name, objects.rings.len());
        }
        objects.rings.truncate(rings as usize);
    }
    if scene.task.is_none() {
        bail!(
            "scene \"{}\" has no task: add a table [task] to the study file, with name, kind and time_limit_s",
            scene.name
        );
    }
    Ok(scene)
}

/// Returns the same rig under a condition.
pub(super) fn under(mut rig: RigConfig, condition: &Condition) -> Result<RigConfig, ConfigError> {
    rig.delay_s = condition.delay_ms.unwrap_or(0.0) * 1e-3;
    // Without force feedback, compute the force with the cheapest mode; the gain then removes it.
    rig.mode = condition.mode.unwrap_or(Mode::Dfr);
    rig.gates.gain = if condition.no_force { 0.0 } else { condition.gain.unwrap_or(1.0) };
    rig.identification.own_motion = condition.own_motion.unwrap_or(rig.identification.own_motion);
    rig.validate()?;
    Ok(rig)
}

/// Returns the hand of the scene, with other random sequences in each trial.
pub(super) fn plain_hand(study: &UserStudy, participant: &str) -> anyhow::Result<SimulatedHand> {
    let scene = scene_in(study)?;
    // Count trials and interruptions, so that a repetition differs.
    let of = study.state().progress(participant).map_or(0, |one| u64::from(one.interruptions));
    let seed = scene.seed.wrapping_add(u64::from(made(study, participant).0) + 1000 * of);
    let nima_simulation::scene::SceneHand { pace, tremor_m, intended_n, .. } = scene.hand;
    Ok(SimulatedHand { pace, tremor_m, intended_n, seed })
}

/// Returns the numbers of trials of a participant, practice included: in total, and since the last break.
pub(super) fn made(study: &UserStudy, participant: &str) -> (u32, u32) {
    let progress = study.state().progress(participant);
    progress.map_or((0, 0), |one| ((one.practice_s.len() + one.trials.len()) as u32, one.since_break()))
}

fn scene_in(study: &UserStudy) -> anyhow::Result<Scene> {
    Ok(Scene::parse(&scene_file(study), study.scene())?)
}

pub(super) fn scene_file(study: &UserStudy) -> PathBuf {
    study.folder().join("scene.toml")
}

/// Returns the scene for a trial on this rig, with this hand, its random sequences, and its task.
pub(super) fn scene_for(study: &UserStudy, rig: &RigConfig, hand: &SimulatedHand) -> anyhow::Result<(Scene, TaskFile)> {
    let mut scene = scene_in(study)?;
    scene.hand.pace = hand.pace;
    scene.hand.tremor_m = hand.tremor_m;
    scene.seed = hand.seed;
    scene.hand.intended_n = hand.intended_n;
    let task =
        TaskFile::of(scene.task.as_ref().context("the scene of the study has no task: choose a scene with a task")?)?;
    Ok((scene.mounted_at(rig)?, task))
}

/// Records the end of a trial, with the reason of an abort in `why`.
pub(super) fn close(
    study: &mut UserStudy,
    running: RunningTrial,
    why: Option<TrialBreak>,
    scoring: Option<LiveScorer>,
) -> Result<TrialRun, StudyError> {
    let trial = running.trial();
    let score = scoring.and_then(LiveScorer::end);
    let ended = score.as_ref().and_then(|score| Some((TrialEnding::of(score.outcome())?, score)));
    match (why, ended) {
        (None, Some((ending, score))) => {
            study.end_trial(running, ending, score, &utc_now())?;
            let completion_time_s = score.value("completion_time_s");
            Ok(TrialRun { trial, ending: Some(ending), completion_time_s, why: None })
        }
        (why, _) => {
            let TrialBreak { why, details, stalled } =
                why.unwrap_or_else(|| TrialBreak::of("the loop was never engaged"));
            if stalled {
                study.abort_stalled_trial(running, &why, details.as_deref(), &utc_now())?;
            } else {
                study.abort_trial(running, &why, details.as_deref(), &utc_now())?;
            }
            Ok(TrialRun { trial, ending: None, completion_time_s: None, why: Some(why) })
        }
    }
}

/// Runs the next trial on the simulated rig with a simulated hand, on the virtual clock. Returns its number, but not its
/// condition.
pub(super) fn run_virtual(
    study: &mut UserStudy,
    participant: &str,
    hand: &SimulatedHand,
    leave: &Leave,
) -> anyhow::Result<TrialRun> {
    let rig = RigConfig::load(&study.plan().rig)?;
    if !rig.has_simulated_hand() {
        bail!("rig \"{}\" has devices, which need the real clock: --virtual is for simulated rigs", rig.name);
    }
    let (scene, task) = scene_for(study, &rig, hand)?;
    let mut plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: true };
    if !plan.may_engage() {
        bail!("scene \"{}\" cannot be engaged: the force at the instrument's tip is unknown", plan.scene.name);
    }
    let running = study.begin_trial(participant, true, &utc_now())?;
    // The reason would reveal the condition. It can only be that the rig has changed since `new`.
    plan.rig = under(plan.rig, running.condition()).map_err(|_| {
        anyhow!("the rig of the study no longer permits this condition: check whether its file was changed")
    })?;
    let recorded =
        running.session().map(|file| recording::begin(Destination::file(file), &plan, Some(VirtualClock::PERFECT)));
    let (tap, recorder) = recorded.transpose()?.unzip();
    let (assembly, mut watched) = plan.watched()?;
    if let Some((recorder, watched)) = recorder.as_ref().zip(watched.as_mut().and_then(ObjectFeed::another)) {
        recorder.watch(OfSimulation::source(&plan, watched));
    }
    let mut scoring = LiveScorer::new(&task, watched);
    let mut fault = None;
    let each = |tick: &Tick| {
        scoring.tick(tick);
        if let LoopState::Faulted(found) = tick.state {
            fault.get_or_insert(found);
        }
        (scoring.trial.is_over() || fault.is_some() || leave.is_asked()).then_some(Command::Shutdown)
    };
    runtime::run_virtual(Assembly { tap, ..assembly }, task.time_limit_s + ENGAGES_S, each);
    let recorded = recorder.map_or(Ok(()), |mut recorder| {
        recorder.end();
        recorder.finish().map(drop)
    });
    let why = match (fault, leave.is_asked()) {
        (_, true) => Some(TrialBreak::of(GIVEN_UP)),
        (Some(fault), _) => Some(TrialBreak::by(fault, plan.rig.rate_hz)),
        _ => None,
    };
    let ran = close(study, running, why, Some(scoring))?;
    recorded.context("the trial is in the journal, but its recording is incomplete")?;
    Ok(ran)
}

impl TrialRun {
    /// Returns the text without the condition, and without the result unless it is to be shown.
    pub(super) fn as_text(&self, shows_result: bool) -> String {
        let Self { trial, ending, completion_time_s, why } = self;
        let what = if trial.phase == TrialPhase::Practice { "practice trial" } else { "trial" };
        let how = match (ending, completion_time_s, why) {
            (Some(_), ..) if !shows_result => "ended (result hidden)".to_owned(),
            (_, Some(time_s), _) => format!("completed in {time_s:.1} s"),
            (Some(TrialEnding::OutOfTime), ..) => "the time limit is reached".to_owned(),
            (.., Some(why)) => format!("aborted ({why})"),
            _ => "ended".to_owned(),
        };
        format!("{what} {}: {how}", trial.number)
    }
}

/// Returns the text of the next step within a sentence.
pub(super) fn next_text(step: &StudyStep) -> String {
    format!("next: {step}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_short_stall_of_the_computer_does_not_count_as_an_attempt() {
        for (fault, stalled) in [
            (Fault::LoopStalled { periods: 500 }, true),
            (Fault::LoopStalled { periods: 1001 }, false),
            (Fault::SourceSilent, false),
        ] {
            assert_eq!(TrialBreak::by(fault, 1000.0).stalled, stalled, "{fault:?}");
        }
        assert!(!TrialBreak::of(STOPPED).stalled);
    }
}
