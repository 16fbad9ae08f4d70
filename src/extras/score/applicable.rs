//! The measures that a kind of task can have, for selection in a form.

use crate::CatalogueDefinition;
use nima_core::task::TaskKind;

const PEG_TRANSFER: [&str; 12] = [
    "time_to_first_grasp_s",
    "lifts",
    "transfers",
    "rings_placed",
    "drops",
    "drops_in_view",
    "drops_out_of_view",
    "rings_knocked_off",
    "path_economy",
    "jaw_openings",
    "jaw_openings_per_min",
    "fls_like_score",
];
const PALPATION: [&str; 4] = ["lumps_found", "lumps_false", "lumps_missed", "lump_peak_force_n"];
const WIRE_LOOP: [&str; 2] = ["wire_touches", "wire_touch_time_s"];
/// Measures of a task that can be completed.
const WITH_END: [&str; 3] = ["completion_time_s", "time_over_reference", "out_of_view_share"];
/// Measures that compare both hands.
const OF_BOTH: [&str; 4] = ["transfers", "force_share", "bimanual_dexterity", "both_move_share"];

impl CatalogueDefinition {
    /// Returns whether a trial of this kind, done with one hand or with two, can have this measure.
    pub fn is_of(&self, kind: TaskKind, two_hands: bool) -> bool {
        let of = |ids: &[&str]| ids.contains(&self.id);
        let fits = match kind {
            _ if of(&PEG_TRANSFER) => kind == TaskKind::PegTransfer,
            _ if of(&PALPATION) => kind == TaskKind::Palpation,
            _ if of(&WIRE_LOOP) => kind == TaskKind::WireLoop,
            _ => kind != TaskKind::Free || !of(&WITH_END),
        };
        fits && (two_hands || !of(&OF_BOTH))
    }
}

#[cfg(test)]
mod tests {
    use nima_core::{
        Side,
        task::{TaskEvent, TimedTaskEvent},
    };

    use super::*;
    use crate::{HandSample, MEASURES, ScoreSample, Scorer, TaskFile};

    /// Returns the measures of a trial with every kind of event.
    fn measured(kind: TaskKind) -> Vec<&'static str> {
        let task = format!("name = 'x'\nkind = {}\nlumps = 2", serde_json::to_string(&kind).unwrap());
        let mut scorer = Scorer::new(&TaskFile::from_toml(&task).unwrap());
        let [side, other] = Side::ALL;
        let events = [
            TaskEvent::Begun,
            TaskEvent::RingGrasped { ring: 0, side },
            TaskEvent::RingLifted { ring: 0, side },
            TaskEvent::RingTransferred { ring: 0, to: other },
            TaskEvent::RingPlaced { ring: 0, side: other, peg: 6 },
            TaskEvent::LumpMarked { side, lump: Some(0) },
            TaskEvent::WireTouched { side },
        ];
        let mut happen = events.iter().enumerate();
        for tick in 0..6000_u32 {
            let t_s = f64::from(tick) * 1e-3;
            let round = |phase: f64| (1.5 * t_s + phase).sin();
            let hand = HandSample {
                tip_m: [0.02 * round(0.0), 0.02 * round(1.0), 0.01 * round(2.0)].into(),
                jaw_rad: Some(0.3 + 0.3 * round(0.5)),
                force_n: [0.0, 0.0, 1.0 + round(0.3)].into(),
                rendered_n: [0.0, 0.0, 1.0].into(),
                engaged: true,
                in_view: true,
            };
            if tick % 700 == 0
                && let Some((_, event)) = happen.next()
            {
                scorer.happening(&TimedTaskEvent { t_s, event: *event });
            }
            scorer.sample(&ScoreSample { t_s, hands: [Some(hand), Some(hand)] });
        }
        scorer.happening(&TimedTaskEvent { t_s: 6.0, event: TaskEvent::Ended });
        let score = scorer.finish();
        let has = |definition: &&CatalogueDefinition| {
            let of_hand = |side| score.of(definition.id, side).is_some();
            if definition.per_hand { Side::ALL.into_iter().any(of_hand) } else { score.value(definition.id).is_some() }
        };
        MEASURES.iter().filter(has).map(|definition| definition.id).collect()
    }

    #[test]
    fn what_a_trial_of_a_kind_has_is_of_this_kind() {
        for kind in [TaskKind::Free, TaskKind::PegTransfer, TaskKind::Palpation, TaskKind::WireLoop] {
            let has = measured(kind);
            for definition in &MEASURES {
                // Jaw motion and paths between events are known in any kind of trial here, and a free trial is ended by
                // hand.
                let known_here = ["path_economy", "jaw_openings", "jaw_openings_per_min", "completion_time_s"];
                if !known_here.contains(&definition.id) {
                    assert_eq!(
                        definition.is_of(kind, true),
                        has.contains(&definition.id),
                        "{kind:?}: {}",
                        definition.id
                    );
                }
            }
        }
    }

    #[test]
    fn one_hand_has_no_measure_of_both() {
        let of = |id: &str, two| MEASURES.iter().find(|one| one.id == id).unwrap().is_of(TaskKind::PegTransfer, two);
        assert!(of("transfers", true) && !of("transfers", false) && of("drops", false));
    }
}
