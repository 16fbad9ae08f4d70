//! Messages of ROS 2 in a recording; `session` tests the recording around them.
#![no_main]

use std::{fs, process};

use libfuzzer_sys::fuzz_target;
use nima_recording::{
    bag,
    csv::ColumnMapping,
    session::{Encoding, SessionWriter},
};

const FIELDS: [[&str; 2]; 4] = [
    ["geometry_msgs/msg/Pose", "position.x"],
    ["geometry_msgs/msg/WrenchStamped", "wrench.force.x"],
    ["sensor_msgs/msg/JointState", "position[1]"],
    ["sensor_msgs/msg/JointState", "effort.a"],
];

fuzz_target!(|bytes: &[u8]| {
    let path = std::env::temp_dir().join(format!("nima-fuzz-{}.mcap", process::id()));
    for [schema, field] in FIELDS {
        fs::remove_file(&path).ok();
        let encoding = Encoding {
            schema: schema.to_owned(),
            schema_encoding: "ros2msg".to_owned(),
            schema_data: Vec::new(),
            message_encoding: "cdr".to_owned(),
        };
        let mut writer = SessionWriter::create(&path, "ros2").expect("the folder can be written");
        let channel = writer.channel("/a", encoding).expect("the file can be written");
        for (tick, piece) in bytes.chunks(160).enumerate() {
            writer.message(channel, tick as u64 * 2_000_000, piece).expect("the file can be written");
        }
        writer.finish().expect("the file can be written");
        let mapping = ColumnMapping::parse(&[format!("x=/a.{field}"), format!("fx=/a.{field}")]).expect("a mapping");
        if let Ok(recording) = bag::read(&path, &mapping) {
            assert!(recording.samples.iter().all(|sample| sample.force_n.x.is_finite()));
        }
    }
});
