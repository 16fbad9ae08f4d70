//! Initial layouts for viewing a session in Foxglove and `PlotJuggler`, attached to every session.

use std::fmt::Write as _;

use nima_machine::rig::{SIDES, Side};
use serde_json::{Value, json};

use crate::{
    recorder::AttachedFile,
    topics::{ARROWS_TOPIC, FORCES, FRAMES_TOPIC, LOG_TOPIC, MARKS_TOPIC, OF_GATES, RINGS_TOPIC, gates},
};

/// Name of the attachment.
pub const FOXGLOVE: &str = "layout.foxglove.json";
/// Name of the attachment.
pub const PLOTJUGGLER: &str = "layout.plotjuggler.xml";

const AXES: [&str; 3] = ["x", "y", "z"];
/// The forces of a plot with their colours: at the tissue, after the link, in the hand.
const CURVES: [(&str, &str); 3] = [("measured", "#2f6fb4"), ("delayed", "#8a8f98"), ("rendered", "#d2641e")];

/// Returns both layouts, for a session of these arms.
pub(crate) fn layouts(sides: [bool; SIDES]) -> [AttachedFile; 2] {
    let file = |name: &str, media_type: &str, text: String| AttachedFile {
        name: name.to_owned(),
        media_type: media_type.to_owned(),
        data: text.into_bytes(),
    };
    let sides: Vec<Side> = Side::ALL.into_iter().filter(|side| sides[side.index()]).collect();
    [
        file(FOXGLOVE, "application/json", format!("{:#}\n", foxglove(&sides))),
        file(PLOTJUGGLER, "application/xml", plotjuggler(&sides)),
    ]
}

/// Returns the index of a force in the message of its topic.
fn place(curve: &str, axis: &str) -> Option<usize> {
    FORCES.iter().position(|name| *name == format!("{curve}.{axis}_n"))
}

fn foxglove(sides: &[Side]) -> Value {
    let mut panels = serde_json::Map::new();
    let mut columns = Vec::new();
    for side in sides {
        let mut column = Vec::new();
        for axis in AXES {
            let id = format!("Plot!{}-{axis}", side.word());
            let path = |(curve, colour): &(&str, &str)| {
                let value = format!("{}/forces.effort[{}]", side.word(), place(curve, axis)?);
                let label = format!("{curve} {axis} (N)");
                Some(
                    json!({"value": value, "label": label, "color": colour, "enabled": true, "timestampMethod": "receiveTime"}),
                )
            };
            let paths: Vec<Value> = CURVES.iter().filter_map(path).collect();
            let title = format!("{} arm, force along {axis}", side.word());
            panels.insert(
                id.clone(),
                json!({
                    "title": title, "paths": paths, "showLegend": true, "legendDisplay": "floating", "isSynced": true,
                    "showXAxisLabels": true, "showYAxisLabels": true, "xAxisVal": "timestamp"
                }),
            );
            column.push(Value::from(id));
        }
        let id = format!("StateTransitions!{}", side.word());
        if let Some(state) = gates().position(|name| name == OF_GATES[OF_GATES.len() - 1]) {
            let path = format!("{}/gates.position[{state}]", side.word());
            let label = format!("{} arm: 2 ready, 3 engaged, 5 stopped, 6 fault", side.word());
            panels.insert(
                id.clone(),
                json!({"paths": [{"value": path, "label": label, "timestampMethod": "receiveTime"}], "isSynced": true}),
            );
            column.push(Value::from(id));
        }
        columns.push(split("column", column));
    }
    panels.insert(
        "3D!scene".to_owned(),
        json!({"followMode": "follow-none", "topics": {ARROWS_TOPIC: {"visible": true}, FRAMES_TOPIC: {"visible": true}, RINGS_TOPIC: {"visible": true}, MARKS_TOPIC: {"visible": true}}}),
    );
    panels.insert("RosOut!log".to_owned(), json!({"topicToRender": LOG_TOPIC}));
    columns.push(split("column", vec!["3D!scene".into(), "RosOut!log".into()]));
    json!({
        "configById": panels, "globalVariables": {}, "userNodes": {}, "playbackConfig": {"speed": 1},
        "layout": split("row", columns)
    })
}

/// Arranges panels of equal size side by side, or one below the other.
fn split(direction: &str, mut panels: Vec<Value>) -> Value {
    let first = if panels.is_empty() { Value::Null } else { panels.remove(0) };
    if panels.is_empty() {
        return first;
    }
    let percent = 100.0 / (panels.len() + 1) as f64;
    json!({"direction": direction, "splitPercentage": percent, "first": first, "second": split(direction, panels)})
}

fn plotjuggler(sides: &[Side]) -> String {
    let mut out = String::from(
        "<?xml version='1.0' encoding='UTF-8'?>\n<root>\n <tabbed_widget parent=\"main_window\" name=\"Main Window\">\n",
    );
    for side in sides.iter().map(|side| side.word()) {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "  <Tab tab_name=\"{side} arm, forces (N)\" containers=\"1\">\n   <Container>");
        let sizes = ["0.333333"; AXES.len()].join(";");
        let _ = writeln!(out, "    <DockSplitter orientation=\"-\" count=\"{}\" sizes=\"{sizes}\">", AXES.len());
        for axis in AXES {
            let _ = writeln!(out, "     <DockArea name=\"along {axis}\">");
            out.push_str("      <plot mode=\"TimeSeries\" style=\"Lines\" flip_x=\"false\" flip_y=\"false\">\n       <limitY/>\n");
            for (curve, colour) in CURVES {
                let name = format!("{side}/forces/{side}.{curve}.{axis}_n/effort");
                let _ = writeln!(out, "       <curve name=\"{name}\" color=\"{colour}\"/>");
            }
            out.push_str("      </plot>\n     </DockArea>\n");
        }
        out.push_str("    </DockSplitter>\n   </Container>\n  </Tab>\n");
    }
    out.push_str(
        "  <currentTabIndex index=\"0\"/>\n </tabbed_widget>\n <use_relative_time_offset enabled=\"1\"/>\n</root>\n",
    );
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the topics and fields that a Foxglove layout uses.
    fn asked(layout: &Value) -> Vec<String> {
        let panels = layout["configById"].as_object().unwrap();
        let of = |panel: &Value| {
            let paths = panel["paths"].as_array().cloned().unwrap_or_default();
            paths.into_iter().map(|path| path["value"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
        };
        panels.values().flat_map(of).collect()
    }

    #[test]
    fn every_panel_of_the_layout_has_a_place_and_shows_what_is_recorded() {
        for sides in [[true, false], [true, true]] {
            let count = sides.iter().filter(|side| **side).count();
            let [foxglove, _] = layouts(sides);
            let layout: Value = serde_json::from_slice(&foxglove.data).unwrap();
            let tree = layout["layout"].to_string();
            for id in layout["configById"].as_object().unwrap().keys() {
                assert!(tree.contains(&format!("\"{id}\"")), "{id} has no place");
            }
            let asked = asked(&layout);
            assert_eq!(asked.len(), count * 10);
            for place in [0, 3, 9] {
                assert!(asked.contains(&format!("right/forces.effort[{place}]")), "{asked:?}");
            }
        }
    }

    #[test]
    fn the_curves_of_the_other_layout_are_recorded_names() {
        let [_, file] = layouts([true, true]);
        let text = String::from_utf8(file.data).unwrap();
        let names: Vec<String> = crate::topics::plots()
            .into_iter()
            .flat_map(|(topic, names, _)| names.into_iter().map(move |name| format!("\"{topic}/{name}/effort\"")))
            .collect();
        let curves: Vec<&str> = text.lines().filter_map(|line| line.trim().strip_prefix("<curve name=")).collect();
        assert_eq!(curves.len(), 18);
        for curve in curves {
            assert!(names.iter().any(|name| curve.starts_with(name.as_str())), "{curve}");
        }
    }
}
