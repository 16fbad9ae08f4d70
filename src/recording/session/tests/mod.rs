//! Session files: intact, damaged, and read by other programs.

mod bad_files;
mod files;
mod full_disk;
mod images;
mod killed;
mod peer;
mod torn;

use std::collections::BTreeMap;

use super::*;

fn plain_text() -> Encoding {
    Encoding { message_encoding: "text".into(), ..Encoding::default() }
}

fn json(schema: &str) -> Encoding {
    let schema_data = br#"{"type": "object"}"#.to_vec();
    Encoding {
        schema: schema.into(),
        schema_encoding: "jsonschema".into(),
        schema_data,
        message_encoding: "json".into(),
    }
}

fn values() -> BTreeMap<String, String> {
    [("rig", "emulated"), ("scene", "foam")].map(|(key, value)| (key.to_owned(), value.to_owned())).into()
}

/// Returns everything that our reader finds, checked against its own statistics.
fn ours(reader: &SessionReader) -> peer::PeerMessage {
    let report: Result<peer::PeerMessage, ReadError> = reader
        .messages(&[], 0..u64::MAX)
        .map(|message| {
            message.map(|message| {
                let channel = reader.channels().iter().find(|channel| channel.id == message.channel()).unwrap();
                (channel.topic.clone(), message.log_time_ns(), message.data().to_vec())
            })
        })
        .collect();
    let report = report.unwrap();
    for attachment in reader.attachments() {
        assert_eq!(reader.attachment(attachment).unwrap().len() as u64, attachment.size);
    }
    assert_eq!(reader.metadata().unwrap().len(), reader.statistics().metadata as usize);
    assert_eq!(report.len() as u64, reader.statistics().messages);
    report
}
