use std::sync::{Arc, Mutex};

use nima_recording::session::SessionReader;

use super::*;
use crate::sinks::{Audience, Destination, SessionSinks};

#[derive(Clone, Debug, Default)]
struct Listener(Arc<Mutex<(SessionHead, Vec<FilePart>)>>);

impl Listener {
    fn add(&self, part: FilePart) {
        self.0.lock().unwrap().1.push(part);
    }
}

impl Audience for Listener {
    fn begins(&mut self, program: &str, started_ns: u64) {
        self.0.lock().unwrap().0 = SessionHead::new(7, program, started_ns);
    }

    fn metadata(&mut self, name: &str, entries: &BTreeMap<String, String>) {
        self.add(FilePart::table(name, entries));
    }

    fn attachment(&mut self, time_ns: u64, attached: &AttachedFile) {
        self.add(FilePart::file(time_ns, attached));
    }

    fn channel(&mut self, topic: &str, encoding: &Encoding) {
        self.add(FilePart::channel(topic, encoding));
    }

    fn message(&mut self, channel: usize, log_time_ns: u64, data: &[u8]) {
        self.add(FilePart::message(channel, log_time_ns, data));
    }
}

const START_NS: u64 = 1_700_000_000_000_000_000;

/// Makes a session of 100 messages on two channels with a table in the middle; returns its head and its bundles of ten
/// parts.
fn made(path: &Path) -> (SessionHead, Vec<Bundle>) {
    let listener = Listener::default();
    let to = Destination { file: Some(path), audiences: vec![Box::new(listener.clone())] };
    let mut out = SessionSinks::create(to, "a test", START_NS).unwrap();
    let table = |key: &str| BTreeMap::from([(key.to_owned(), "2026-11-25T08:00:00Z".to_owned())]);
    out.metadata("session", &table("started")).unwrap();
    let rig = AttachedFile { name: "rig.toml".into(), media_type: "application/toml".into(), data: b"a = 1".to_vec() };
    out.attachment(START_NS, &rig).unwrap();
    let journal = Encoding { message_encoding: "nima-journal".into(), ..Encoding::default() };
    let channels = [out.channel(JOURNAL_TOPIC, journal).unwrap(), out.channel("log", Encoding::default()).unwrap()];
    for i in 0..100_u8 {
        out.message(channels[usize::from(i % 2)], START_NS + u64::from(i) * 1_000_000, &[i; 40]).unwrap();
        if i == 50 {
            out.metadata("calibrations 1", &table("made")).unwrap();
        }
    }
    out.finish().unwrap();
    let (head, parts) = listener.0.lock().unwrap().clone();
    let last = parts.len().div_ceil(10) - 1;
    let bundle = |(i, parts): (usize, &[FilePart])| Bundle::new(7, i as u64, parts.to_vec(), i == last);
    (head, parts.chunks(10).enumerate().map(bundle).collect())
}

/// Returns the whole content of a file.
fn content(path: &Path) -> String {
    let reader = SessionReader::open(path).unwrap();
    let messages: Vec<_> = reader
        .messages(&[], 0..u64::MAX)
        .map(|message| message.unwrap())
        .map(|message| (message.channel(), message.log_time_ns(), message.data().to_vec()))
        .collect();
    let files: Vec<_> = reader.attachments().iter().map(|one| reader.attachment(one).unwrap()).collect();
    let channels: Vec<_> = reader.channels().iter().map(|one| (one.topic.clone(), one.encoding.clone())).collect();
    format!("{} {channels:?} {files:?} {:?} {messages:?}", reader.library(), reader.metadata().unwrap())
}

fn sent(bundle: &Bundle) -> Bundle {
    Bundle::read(&bundle.pack()).unwrap()
}

#[test]
fn whoever_has_all_bundles_writes_the_same_session() {
    let folder = tempfile::tempdir().unwrap();
    let [original, copied] = ["a.mcap", "b.mcap"].map(|name| folder.path().join(name));
    let (head, bundles) = made(&original);
    let mut copy = Copy::create(&copied, &SessionHead::read(&head.pack()).unwrap(), &sent(&bundles[0])).unwrap();
    for bundle in &bundles[1..] {
        copy.add(&sent(bundle)).unwrap();
    }
    assert_eq!(copy.finish().unwrap(), 100);
    assert_eq!(content(&original), content(&copied));
}

#[test]
fn whoever_comes_late_writes_a_stretch_with_every_table_and_without_the_journal() {
    let folder = tempfile::tempdir().unwrap();
    let [original, copied] = ["a.mcap", "b.mcap"].map(|name| folder.path().join(name));
    let (mut head, bundles) = made(&original);
    for bundle in &bundles[..8] {
        head.outlive(bundle.clone());
    }
    assert!(head.lacks && head.first == 8);
    assert_eq!(head.table(&bundles[8], "session").unwrap()["started"], "2026-11-25T08:00:00Z");
    let mut copy = Copy::create(&copied, &SessionHead::read(&head.pack()).unwrap(), &sent(&bundles[8])).unwrap();
    for bundle in &bundles[9..] {
        copy.add(&sent(bundle)).unwrap();
    }
    copy.finish().unwrap();
    let reader = SessionReader::open(&copied).unwrap();
    let tables: BTreeMap<_, _> = reader.metadata().unwrap().into_iter().collect();
    assert!(tables.contains_key("calibrations 1") && tables.contains_key("session"), "{tables:?}");
    assert_eq!(tables[trim::TABLE][trim::BEGINNING], START_NS.to_string());
    assert!(reader.channels().iter().all(|channel| channel.topic != JOURNAL_TOPIC));
    let firsts: Vec<u8> = reader.messages(&[], 0..u64::MAX).map(|message| message.unwrap().data()[0]).collect();
    // Two tables, a file, two channels, and a table among 75 messages: the eighth batch begins with message 74.
    assert_eq!(firsts, (75..100).filter(|i| i % 2 == 1).collect::<Vec<u8>>());
}

#[test]
fn a_missing_bundle_another_version_and_damage_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let (head, bundles) = made(&folder.path().join("a.mcap"));
    let mut copy = Copy::create(&folder.path().join("b.mcap"), &head, &bundles[0]).unwrap();
    let gap = copy.add(&bundles[2]).unwrap_err();
    assert!(matches!(gap, CopyError::Gap { came: 2, due: 1 }), "{gap}");
    copy.add(&bundles[1]).unwrap();
    let other = Bundle { version: VERSION + 1, ..bundles[2].clone() };
    assert!(matches!(Bundle::read(&other.pack()), Err(CopyError::Version)));
    let mut random = fastrand::Rng::with_seed(3);
    for _ in 0..5000 {
        let mut bytes = bundles[3].pack();
        let place = random.usize(..bytes.len());
        bytes[place] = random.u8(..);
        Bundle::read(&bytes).ok();
    }
}
