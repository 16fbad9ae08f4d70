use std::path::Path;

use nima_simulation::scene::Scene;

use crate::{TaskFile, provide_tasks};

#[test]
fn the_task_of_a_scene_is_completed_and_a_wrong_one_is_refused_when_the_scene_is_loaded() {
    provide_tasks();
    let scene = Scene::load("rings").unwrap();
    let task = scene.task.as_ref().unwrap();
    assert_eq!(task.scored["time_limit_s"].as_float(), Some(300.0), "the default");
    let file = TaskFile::of(task).unwrap();
    assert_eq!(&file.to_scene().unwrap(), task);
    let text = toml::to_string(&scene).unwrap();
    assert_eq!(Scene::parse(Path::new("again.toml"), &text).unwrap(), scene);
    for (to, named) in [("time_limit_s = -1.0", "time_limit_s"), ("time_limit = 3.0", "time_limit")] {
        let changed = text.replace("time_limit_s = 300.0", to);
        assert_ne!(changed, text);
        let refused = Scene::parse(Path::new("changed.toml"), &changed).unwrap_err().to_string();
        assert!(refused.contains("changed.toml") && refused.contains(named), "{refused}");
    }
}
