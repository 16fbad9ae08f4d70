//! Bags that are written here, as ROS 2 and its tools write them.

use super::{codec::tests::CdrWriter, *};
use crate::session::{Encoding, SessionWriter};

fn encoding(schema: &str) -> Encoding {
    Encoding {
        schema: schema.to_owned(),
        schema_encoding: "ros2msg".to_owned(),
        schema_data: Vec::new(),
        message_encoding: CDR.to_owned(),
    }
}

/// Writes a bag with a force at 500 Hz and a pose at 100 Hz: the force is twice the position.
fn bag(path: &Path) {
    let mut writer = SessionWriter::create(path, "ros2").unwrap();
    let wrench = writer.channel("/ft/wrench", encoding("geometry_msgs/msg/WrenchStamped")).unwrap();
    let pose = writer.channel("/tool/pose", encoding("geometry_msgs/msg/PoseStamped")).unwrap();
    let begin_ns = 1_764_314_756_000_000_000_u64;
    for tick in 0..500_u64 {
        let time_ns = begin_ns + tick * 2_000_000;
        let along = tick as f64 * 1e-4;
        let stamped = || CdrWriter::new(false).header(time_ns);
        let force = stamped().f64s(&[0.0, 0.0, 2.0 * along, 0.0, 0.0, 0.0]);
        writer.message(wrench, time_ns + 700, &force.0).unwrap();
        if tick % 5 == 0 {
            let place = stamped().f64s(&[0.0, 0.0, along, 0.0, 0.0, 0.0, 1.0]);
            writer.message(pose, time_ns + 900, &place.0).unwrap();
        }
    }
    writer.finish().unwrap();
}

fn mapping(texts: &[&str]) -> ColumnMapping {
    ColumnMapping::parse(texts).unwrap()
}

#[test]
fn topics_of_different_rates_become_one_recording() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag_0.mcap");
    bag(&path);
    assert!(is_bag(&SessionReader::open(&path).unwrap()));
    let maps = mapping(&["z=/tool/pose.pose.position.z*1000", "fz=/ft/wrench.wrench.force.z"]);
    for place in [path.as_path(), folder.path()] {
        let recording = read(place, &maps).unwrap();
        assert_eq!((recording.axes.as_slice(), recording.rate_hz), (&[2][..], 500.0));
        assert!(recording.samples.len() > 490);
        for sample in &recording.samples {
            assert!((sample.force_n.x - 2e-3 * sample.position_m.x).abs() < 1e-9, "{sample:?}");
        }
    }
}

#[test]
fn a_look_shows_each_topic_at_its_times_and_the_rest_as_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag_0.mcap");
    bag(&path);
    let forces = read_signals(&path, &mapping(&["fz=/ft/wrench.wrench.force.z"])).unwrap();
    assert_eq!(
        (forces.rows.len(), forces.force_axes(), forces.position_axes()),
        (500, [false, false, true], [false; 3])
    );
    let both = read_signals(folder.path(), &mapping(&["z=/tool/pose.pose.position.z", "fz=/ft/wrench.wrench.force.z"]))
        .unwrap();
    assert!((both.rows[7].position_m.z - 7e-4).abs() < 1e-12 && both.rows[7].position_m.x.is_nan());
    assert!(both.rows[499].position_m.z.is_nan(), "no pose comes after the last one");
    assert!(read_signals(&path, &mapping(&[])).unwrap_err().to_string().contains("/tool/pose.pose.position.x"));
}

#[test]
fn what_is_missing_is_named_with_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag_0.mcap");
    bag(&path);
    let refused = |texts: &[&str]| read(&path, &mapping(texts)).unwrap_err().to_string();
    let none = refused(&[]);
    assert!(none.contains("/tool/pose.pose.position.x") && none.contains("/ft/wrench.wrench.force.x"), "{none}");
    let topic = refused(&["z=/other.pose.position.z", "fz=/ft/wrench.wrench.force.z"]);
    assert!(topic.contains("/other.pose.position.z") && topic.contains("/tool/pose"), "{topic}");
    assert!(refused(&["fz=/ft/wrench.wrench.force.z"]).contains("--map z_m is missing"));
    let empty = tempfile::tempdir().unwrap();
    assert!(read(empty.path(), &mapping(&["x=a.b"])).unwrap_err().to_string().contains("no .mcap file"));
    std::fs::write(empty.path().join("bag_0.mcap.zstd"), "").unwrap();
    assert!(read(empty.path(), &mapping(&["x=a.b"])).unwrap_err().to_string().contains("zstd -d"));
    std::fs::write(empty.path().join("bag_0.db3"), "").unwrap();
    assert!(read(empty.path(), &mapping(&["x=a.b"])).unwrap_err().to_string().contains("ros2 bag convert"));
}

#[test]
fn a_recording_that_was_cut_is_read_and_its_fault_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag_0.mcap");
    bag(&path);
    let maps = mapping(&["z=/tool/pose.pose.position.z", "fz=/ft/wrench.wrench.force.z"]);
    assert_eq!((missing(&path).unwrap(), read_signals(&path, &maps).unwrap().notes), (Vec::new(), Vec::new()));
    let bytes = std::fs::read(&path).unwrap();
    // The last byte belongs to the end of the file: all messages are readable.
    std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
    for place in [path.as_path(), folder.path()] {
        let lines = missing(place).unwrap();
        assert!(lines.iter().any(|line| line.contains("truncated")), "{lines:?}");
        assert_eq!(read_signals(place, &maps).unwrap().notes, lines);
    }
}

/// Writes joint states of an arm, of a gripper on the same topic, and one unknown angle; the clock goes by `time_ns`.
fn joint_states(path: &Path, time_ns: impl Fn(u64) -> u64) {
    let mut writer = SessionWriter::create(path, "ros2").unwrap();
    let joints = writer.channel("/joint_states", encoding("sensor_msgs/msg/JointState")).unwrap();
    let wrench = writer.channel("/ft/wrench", encoding("geometry_msgs/msg/WrenchStamped")).unwrap();
    for tick in 0..100_u64 {
        let stamped = || CdrWriter::new(false).header(1_764_314_756_000_000_000 + time_ns(tick));
        let state = |name: &str, rad: f64| stamped().u32(1).text(name).u32(1).f64s(&[rad]).u32(0).u32(0);
        let rad = if tick == 50 { f64::NAN } else { tick as f64 };
        writer.message(joints, tick * 2_000_000, &state("elbow", rad).0).unwrap();
        writer.message(joints, tick * 2_000_000 + 1, &state("finger", 7.0).0).unwrap();
        let force = stamped().f64s(&[0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        writer.message(wrench, tick * 2_000_000 + 2, &force.0).unwrap();
    }
    writer.finish().unwrap();
}

#[test]
fn a_joint_that_only_some_messages_have_is_read_from_these() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag_0.mcap");
    joint_states(&path, |tick| tick * 2_000_000);
    let maps = mapping(&["z=/joint_states.position.elbow", "fz=/ft/wrench.wrench.force.z"]);
    let looked = read_signals(&path, &maps).unwrap();
    assert_eq!((looked.rows.len(), looked.rows[49].position_m.z), (100, 49.0));
    assert!(looked.rows[50].position_m.z.is_nan(), "an angle that the publisher does not know stays unknown");
    let recording = read(&path, &maps).unwrap();
    assert!(recording.samples.iter().all(|sample| sample.position_m.x.is_finite()));
    let none = read(&path, &mapping(&["z=/joint_states.position.knee", "fz=/ft/wrench.wrench.force.z"]));
    assert!(none.unwrap_err().to_string().contains("/joint_states.position.knee"));
}

#[test]
fn messages_that_are_compressed_one_by_one_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag_0.mcap");
    let mut writer = SessionWriter::create(&path, "ros2").unwrap();
    let wrench = writer.channel("/ft/wrench", encoding("geometry_msgs/msg/WrenchStamped")).unwrap();
    writer.message(wrench, 1, &[&ZSTD_MAGIC[..], &[0; 8]].concat()).unwrap();
    writer.finish().unwrap();
    let words = read_signals(&path, &mapping(&["fz=/ft/wrench.wrench.force.z"])).unwrap_err().to_string();
    assert!(words.contains("compressed separately") && words.contains("ros2 bag convert"), "{words}");
}

#[test]
fn messages_that_overtake_each_other_are_read_in_the_order_of_their_times() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag_0.mcap");
    joint_states(&path, |tick| (tick ^ 1) * 2_000_000);
    let maps = mapping(&["z=/joint_states.position.elbow", "fz=/ft/wrench.wrench.force.z"]);
    let looked = read_signals(&path, &maps).unwrap();
    assert_eq!(looked.rows.len(), 100);
    for (number, row) in looked.rows.iter().enumerate().filter(|(number, _)| number / 2 != 25) {
        let written = [number as f64 * 0.002, (number ^ 1) as f64];
        assert!((row.t_s - written[0]).abs() < 1e-9 && (row.position_m.z - written[1]).abs() < 1e-9, "{row:?}");
    }
}

#[test]
fn a_clock_that_was_set_back_is_named_and_nothing_is_sorted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag_0.mcap");
    joint_states(&path, |tick| if tick < 60 { tick * 2_000_000 } else { (tick - 40) * 2_000_000 });
    let maps = mapping(&["z=/joint_states.position.elbow", "fz=/ft/wrench.wrench.force.z"]);
    for refused in [read(&path, &maps).unwrap_err(), read_signals(&path, &maps).unwrap_err()] {
        let words = refused.to_string();
        assert!(words.contains("steps back by 0.078 s, 0.118 s after") && words.contains("split"), "{words}");
    }
}
