use std::{collections::BTreeSet, f64::consts::PI, fmt::Write, path::Path};

use nalgebra::Vector3;
use nima_core::{Side, task::TaskEvent};

use super::{task, trial};
use crate::{CatalogueDefinition, HandSample, MEASURES, Score, TaskFile};

#[test]
fn there_are_at_least_thirty_measures_with_names_of_their_own() {
    assert!(MEASURES.len() >= 30, "{}", MEASURES.len());
    let ids: BTreeSet<&str> = MEASURES.iter().map(|definition| definition.id).collect();
    assert_eq!(ids.len(), MEASURES.len());
    for definition in &MEASURES {
        assert!(definition.words.ends_with('.') && definition.definition.ends_with('.'), "{definition:?}");
        assert!(definition.words.len() < 90, "short: {}", definition.words);
        assert!(!definition.unit.is_empty() && !definition.source.is_empty(), "{definition:?}");
    }
    let keys: BTreeSet<String> = full("").measures().map(|measure| measure.key()).collect();
    assert_eq!(keys.len(), MEASURES.iter().map(|definition| 1 + usize::from(definition.per_hand)).sum::<usize>());
}

#[test]
fn the_score_like_that_of_fls_says_that_it_is_none() {
    let definition = MEASURES.iter().find(|definition| definition.id == "fls_like_score").unwrap();
    assert!(definition.words.starts_with("FLS-like, not an FLS score"));
}

/// `docs/reference/measures.md`, from the catalogue.
fn page() -> String {
    let mut page = String::from(
        "# Measures\n\nEvery measure of the [score](../score.md). `count` is a number of events, `1` a ratio. \"Per hand\": the id ends with \
         `_left` or `_right`.\n\nThis page is generated: change the catalogue in `src/extras/score/catalogue.rs`, then run \
         `NIMA_WRITE_DOCS=1 cargo test -p nima-score the_page`.\n\n\
         | id | per hand | unit | definition | source |\n|---|---|---|---|---|\n",
    );
    for CatalogueDefinition { id, words, unit, definition, source, per_hand } in MEASURES {
        let per_hand = if per_hand { "yes" } else { "-" };
        writeln!(page, "| `{id}` | {per_hand} | {unit} | {words} {definition} | {source} |").unwrap();
    }
    page
}

#[test]
fn the_page_of_the_measures_is_that_of_the_catalogue() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../docs/reference/measures.md");
    if std::env::var_os("NIMA_WRITE_DOCS").is_some() {
        std::fs::write(&path, page()).unwrap();
    }
    assert_eq!(std::fs::read_to_string(path).unwrap(), page(), "write the page again with NIMA_WRITE_DOCS=1");
}

#[test]
fn the_task_file_of_the_page_holds_the_defaults() {
    let page = include_str!("../../../../docs/score.md");
    let text = page.split("```toml").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let bare = TaskFile::from_toml("name = 'Six rings'\nkind = 'peg_transfer'").unwrap();
    assert_eq!(TaskFile::from_toml(text).unwrap(), bare);
}

/// Returns a trial with every kind of event.
fn full(more: &str) -> Score {
    let hands = |t_s: f64| {
        Side::ALL.map(|side| {
            let phase = if side == Side::Right { 1.0 } else { 0.0 };
            let angle = 2.0 * PI * 0.5 * t_s + phase;
            Some(HandSample {
                tip_m: Vector3::new(angle.sin(), (2.0 * angle).sin(), (3.0 * angle).sin()) * 0.05,
                jaw_rad: Some(angle.sin().abs()),
                force_n: Vector3::new(angle.sin(), angle.cos(), (3.0 * angle).sin()) * 4.0,
                rendered_n: Vector3::x(),
                engaged: true,
                in_view: true,
            })
        })
    };
    let events = Side::ALL.map(|side| {
        let lump = TaskEvent::LumpMarked { side, lump: Some(side.index()) };
        let grasp = TaskEvent::RingGrasped { ring: 0, side };
        [(1.0_f64, grasp), (2.0, lump), (4.0, TaskEvent::RingPlaced { ring: 0, side, peg: 1 })]
    });
    let mut events = events.concat();
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    trial(&task(more), 6.0, hands, &events)
}

#[test]
fn each_measure_is_measured_in_some_task() {
    let scores = ["", "kind = 'palpation'\nlumps = 3", "kind = 'wire_loop'"].map(full);
    for (k, measure) in scores[0].measures().enumerate() {
        let values = scores.iter().filter_map(|score| score.measures().nth(k)?.value);
        assert!(values.count() > 0, "{} is never measured", measure.key());
    }
}

#[test]
fn a_score_is_one_flat_object_in_json() {
    let score = full("");
    let json: serde_json::Value = serde_json::from_str(&serde_json::to_string(&score).unwrap()).unwrap();
    let object = json.as_object().unwrap();
    assert!(object.values().all(|value| value.is_number() || value.is_null()));
    assert_eq!(object["path_length_m_right"].as_f64(), score.of("path_length_m", Side::Right));
    assert!(object["lumps_found"].is_null() && object["completion_time_s"].as_f64() == Some(6.0));
}
