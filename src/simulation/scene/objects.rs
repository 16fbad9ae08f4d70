//! Moving objects, and the scored task.

use nima_machine::config::{ConfigError, Ranges};

use super::{Scene, SceneTask};
use crate::{RINGS_MAX, physics::SettingError};

impl Scene {
    pub(super) fn validate_objects(&self, ranges: &Ranges<'_>) -> Result<(), ConfigError> {
        if let Some(objects) = &self.objects {
            let rings = objects.rings.len();
            ranges.check("objects.rings (count)", rings as f64, rings <= RINGS_MAX, format!("at most {RINGS_MAX}"))?;
            if let Err(SettingError { key, value, allowed }) = objects.validate() {
                ranges.check(key, value, false, allowed)?;
            }
        }
        if let Some(wire) = &self.wire {
            let others = if self.objects.is_some() { 2.0 } else { 1.0 };
            ranges.check(
                "number of [wire] and [objects]",
                others,
                self.objects.is_none(),
                "1: the tip has one tool",
            )?;
            if let Err(SettingError { key, value, allowed }) = wire.validate() {
                ranges.check(key, value, false, allowed)?;
            }
        }
        if let Some(SceneTask { mark_tolerance_m, .. }) = self.task {
            let is_good = SceneTask::MARK_TOLERANCES_M.contains(&mark_tolerance_m);
            ranges.check("task.mark_tolerance_m", mark_tolerance_m, is_good, "from 0 m to 0.05 m")?;
        }
        self.validate_lumps_of_the_task(ranges)
    }

    fn validate_lumps_of_the_task(&self, ranges: &Ranges<'_>) -> Result<(), ConfigError> {
        let (Some(lumps), Some(task)) = (self.lumps.as_ref().filter(|_| self.is_searched()), &self.task) else {
            return Ok(());
        };
        let there = lumps.list.len() + lumps.drawn.map_or(0, |drawn| drawn.count as usize);
        ranges.check("lumps.list (count)", there as f64, (1..=LUMPS_MAX).contains(&there), "1 to 64 in a palpation")?;
        let report = task.lumps.map_or(there, |report| report as usize);
        ranges.check("task.lumps", report as f64, report == there, "the number of lumps in the scene, or left out")
    }

    /// Sets the number of lumps in the task.
    pub(super) fn count_lumps(&mut self) {
        let count = self.placed_lumps().filter(|_| self.is_searched()).map(|lumps| lumps.list.len() as u32);
        if let Some(task) = &mut self.task {
            task.lumps = task.lumps.or(count);
        }
    }
}

/// Maximum number of lumps of a palpation.
const LUMPS_MAX: usize = 64;

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene::SCENES;

    /// Returns a built-in scene with one text replaced.
    fn changed(scene: &str, from: &str, to: &str) -> Result<Scene, ConfigError> {
        let text = SCENES.iter().find(|(name, _)| *name == scene).unwrap().1;
        assert!(text.contains(from), "{from}");
        Scene::parse(Path::new("changed.toml"), &text.replace(from, to))
    }

    #[test]
    fn the_task_knows_how_many_lumps_there_are_and_a_wrong_number_is_refused() {
        let scene = Scene::load("find_lumps").unwrap();
        assert!(scene.is_searched() && scene.is_played() && scene.is_drawn_by_lot());
        assert_eq!(scene.task.as_ref().unwrap().lumps, Some(scene.placed_lumps().unwrap().list.len() as u32));
        assert!(!Scene::load("lumps").unwrap().is_played(), "no task to find them");
        let report =
            |more: &str| changed("find_lumps", "kind = \"palpation\"", &format!("kind = \"palpation\"\n{more}"));
        assert!(report("lumps = 5").is_ok());
        assert!(report("lumps = 4").unwrap_err().to_string().contains("task.lumps"));
    }

    #[test]
    fn what_cannot_be_drawn_is_refused_with_its_key() {
        let refused = |from: &str, to: &str| changed("find_lumps", from, to).unwrap_err().to_string();
        assert!(refused("count = 5", "count = 31").contains("lumps.drawn.count"), "there is no room");
        assert!(refused("count = 5", "count = 0").contains("lumps.drawn.count"));
        assert!(refused("apart_m = 0.018", "apart_m = nan").contains("lumps.drawn.apart_m"));
        assert!(refused("margin_m = 0.012", "margin_m = 0.07").contains("lumps.drawn.margin_m"));
    }

    #[test]
    fn a_tip_has_one_tool_and_a_wire_is_refused_with_its_key() {
        let refused = |to: &str| changed("wire", "[task]", &format!("{to}\n[task]")).unwrap_err().to_string();
        assert!(refused("[objects]").contains("[wire] and [objects]"));
        let refused = changed("wire", "radius_m = 0.0008", "radius_m = 1.0").unwrap_err().to_string();
        assert!(refused.contains("wire.radius_m"), "{refused}");
    }
}
