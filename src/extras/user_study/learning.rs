//! Learning of a participant: proficiency in practice, and the curve over all trials.

use nima_score::{LearningCurve, TrainingState};
use serde::Serialize;

use crate::{ParticipantProgress, StudyState};

#[derive(Clone, Debug, Serialize)]
pub struct LearningModel {
    /// Name of the participant.
    pub participant: String,
    pub practice: u32,
    /// Progress of practice; `None` without practice.
    pub standing: Option<TrainingState>,
    /// Completion times of all trials in order, practice first, s; `None` for a trial that was not completed.
    pub times_s: Vec<Option<f64>>,
    /// Curve through these times, if there are enough.
    pub curve: Option<LearningCurve>,
}

/// Returns the learning of every participant who has begun.
pub(crate) fn learning(state: &StudyState) -> Vec<LearningModel> {
    let began = state.participants().filter(|(_, progress)| progress.began);
    began.map(|(participant, progress)| of(participant, progress)).collect()
}

fn of(participant: &str, progress: &ParticipantProgress) -> LearningModel {
    let time_s = |made: &crate::CountedTrial| {
        let time_s = made.measures.as_ref().and_then(|measures| measures.get("completion_time_s").copied());
        time_s.unwrap_or(f64::NAN)
    };
    let times_s: Vec<f64> = progress.practice_s.iter().copied().chain(progress.trials.iter().map(time_s)).collect();
    LearningModel {
        participant: participant.to_owned(),
        practice: progress.practice_s.len() as u32,
        standing: progress.practice.as_ref().map(nima_score::Proficiency::standing),
        curve: LearningCurve::fit(&times_s),
        times_s: times_s.into_iter().map(|time_s| Some(time_s).filter(|time_s| time_s.is_finite())).collect(),
    }
}
