//! `nima export --anonymous` removes person, time and place, and keeps every force.
use std::{collections::BTreeMap, path::Path, process::Command, time::UNIX_EPOCH};

use nima_recording::{
    messages::{
        JointStateEncoder,
        foxglove::{self, FrameTransform, FrameTransforms, Level, Log, SceneEntity, SceneUpdate},
    },
    session::{SessionReader, SessionWriter},
};
use prost::Message as _;

use crate::export::{done, refused, values};

/// Names planted wherever a person can enter one.
const PLANTED: [&str; 11] = [
    "Theatre seven",
    "grasper-of-Jane",
    "SN-4711-PLANTED",
    "jane.operator",
    "palpation-for-Jane",
    "jane-folder",
    "host-theatre-7",
    "network-of-Jane",
    "2026-08-21",
    MACHINE,
    LOGIN,
];
/// Names of the recording computer and its user, which no session contains.
const MACHINE: &str = "computer-of-jane";
const LOGIN: &str = "login-of-jane";

/// A line of the session.
const ENGAGED: &str = "right arm: from Ready to Engaged";

/// Returns a rig and a scene with planted names, and a session of them.
fn recorded(folder: &Path) -> String {
    let [rig_name, tool, serial, _, scene_name, place, ..] = PLANTED;
    let folder = folder.join(place);
    std::fs::create_dir(&folder).unwrap();
    let at = |name: &str| folder.join(name).display().to_string();
    let config = |kind: &str, name: &str| {
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../config").join(kind).join(name)).unwrap()
    };
    let named = |text: String, name: &str| {
        let line = text.lines().find(|line| line.starts_with("name = ")).unwrap();
        text.replace(line, &format!("name = \"{name}\" # {}", PLANTED[3]))
    };
    let rig = named(config("rigs", "simulated.toml"), rig_name);
    let wrist = format!("\n[simulated.right]\nserial_number = \"{serial}\"\ntool = \"{tool}\"\n");
    let rig = rig.split("\n[simulated").next().unwrap().to_owned() + &wrist;
    std::fs::write(at("rig.toml"), rig).unwrap();
    std::fs::write(at("scene.toml"), named(config("scenes", "bimanual.toml"), scene_name)).unwrap();
    let session = at("jane.mcap");
    let [rig, scene] = [at("rig.toml"), at("scene.toml")];
    let run = ["run", "--virtual", "--seconds", "3", "--rig", &rig, "--scene", &scene, "--record", &session, "--json"];
    let output = elsewhere(&run).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let bytes = all_bytes(Path::new(&session));
    assert!(found(&bytes).contains(&serial) && !found(&bytes).contains(&MACHINE) && !found(&bytes).contains(&LOGIN));
    session
}

/// The program run by another user on another computer, as far as a test can simulate that: all variables with names, and the
/// system's host name.
fn elsewhere(arguments: &[&str]) -> Command {
    let rename = format!("hostname {MACHINE} 2>/dev/null || echo {MACHINE} > /proc/sys/kernel/hostname; exec \"$@\"");
    let renames =
        Command::new("unshare").args(["-r", "--uts", "true"]).output().is_ok_and(|output| output.status.success());
    let mut command = if renames {
        let mut command = Command::new("unshare");
        command.args(["-r", "--uts", "sh", "-c", &rename, "sh", env!("CARGO_BIN_EXE_nima")]);
        command
    } else {
        Command::new(env!("CARGO_BIN_EXE_nima"))
    };
    for variable in ["USER", "LOGNAME", "USERNAME", "SUDO_USER"] {
        command.env(variable, LOGIN);
    }
    for variable in ["HOSTNAME", "HOST", "COMPUTERNAME"] {
        command.env(variable, MACHINE);
    }
    command.args(arguments).env("HOME", format!("/home/{LOGIN}")).env("NIMA_DATA_DIR", "/dev/null/no/such/folder");
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    command
}

/// Returns the same session with names in every possible place of the file.
fn planted(session: &str, to: &Path) {
    let reader = SessionReader::open(Path::new(session)).unwrap();
    let all = PLANTED.join(" ");
    let mut writer = SessionWriter::create(to, &all).unwrap();
    let mut tables = reader.metadata().unwrap();
    let entries = BTreeMap::from(PLANTED.map(|name| (name.to_owned(), name.to_owned())));
    for (_, table) in &mut tables {
        table.extend(entries.clone());
        table.insert("clock".to_owned(), PLANTED[6].to_owned());
    }
    for name in ["calibrations right", "calibrations 4", "cut", "notes", PLANTED[7]] {
        tables.push((name.to_owned(), entries.clone()));
    }
    let verdict = |key: &str, value: &str| (key.to_owned(), value.to_owned());
    let verdicts = [
        verdict("gravity_verdict", "accepted"),
        verdict("gravity_error_n", "0.25"),
        verdict("gravity_poses", PLANTED[2]),
        verdict("network_verdict", PLANTED[3]),
    ];
    tables.push(("calibrations left".to_owned(), entries.clone().into_iter().chain(verdicts).collect()));
    for (name, table) in &tables {
        writer.metadata(name, table).unwrap();
    }
    for file in reader.attachments() {
        writer.attachment(&file.name, &file.media_type, file.log_time_ns, &reader.attachment(file).unwrap()).unwrap();
    }
    let wide: Vec<u8> = all.encode_utf16().flat_map(u16::to_le_bytes).collect();
    writer.attachment(&format!("{}.txt", PLANTED[3]), "text/plain", 5, all.as_bytes()).unwrap();
    writer.attachment("scene.txt", &all, 5, &wide).unwrap();
    let begin_ns = reader.statistics().times_ns.0;
    let channels: BTreeMap<_, _> = reader
        .channels()
        .iter()
        .map(|one| (one.id, writer.channel(&one.topic, one.encoding.clone()).unwrap()))
        .collect();
    let mut encoding = foxglove::encoding::<Log>();
    let log = writer.channel("log", encoding.clone()).unwrap();
    encoding.schema_data.clone_from(&wide);
    let other_log = writer.channel("log", encoding).unwrap();
    let own = writer.channel(PLANTED[6], foxglove::encoding::<Log>()).unwrap();
    let line = |message: &str, value: Option<Vec<u8>>| {
        let text = |which: usize| PLANTED[which].to_owned();
        let level = Level::Warning as i32;
        let message = message.to_owned();
        Log { message, level, name: text(1), file: text(5), line: 7, timestamp: None, value }.encode_to_vec()
    };
    for (channel, words) in [(log, &*all), (log, "command: gain 0.25"), (other_log, &all), (own, &all)] {
        writer.message(channel, begin_ns, &line(words, None)).unwrap();
    }
    // The text of a log line with a value is generated from the value.
    let lines = reader.messages(&["log"], 0..u64::MAX);
    let mut lines = lines.map(|message| Log::decode(message.unwrap().data()).unwrap());
    let engaged = lines.find(|line| line.message == ENGAGED).unwrap();
    writer.message(log, begin_ns, &line(&all, engaged.value)).unwrap();
    writer.message(log, begin_ns, &line("command: gain 0.25", Some(all.clone().into_bytes()))).unwrap();
    let names = ["right.measured.x_n", PLANTED[2]];
    let timing = writer.channel("timing", JointStateEncoder::encoding()).unwrap();
    let bytes = JointStateEncoder::new(PLANTED[3], &names).encode(begin_ns, &[1.0, 2.0], &[], &[]).unwrap().to_vec();
    writer.message(timing, begin_ns, &bytes).unwrap();
    let text = |which: usize| PLANTED[which].to_owned();
    let frame = FrameTransform { parent_frame_id: text(0), child_frame_id: text(1), ..FrameTransform::default() };
    let own_frame = FrameTransform { parent_frame_id: text(0), child_frame_id: "right.tip".into(), ..frame.clone() };
    let frames = writer.channel("frames", foxglove::encoding::<FrameTransforms>()).unwrap();
    writer.message(frames, begin_ns, &FrameTransforms { transforms: vec![frame, own_frame] }.encode_to_vec()).unwrap();
    let entity = SceneEntity { id: "right.forces".into(), frame_id: text(6), ..SceneEntity::default() };
    let arrows = writer.channel("arrows", foxglove::encoding::<SceneUpdate>()).unwrap();
    let scene = SceneUpdate { entities: vec![entity], ..SceneUpdate::default() };
    writer.message(arrows, begin_ns, &scene.encode_to_vec()).unwrap();
    for message in reader.messages(&[], 0..u64::MAX) {
        let message = message.unwrap();
        writer.message(channels[&message.channel()], message.log_time_ns(), message.data()).unwrap();
    }
    writer.finish().unwrap();
}

/// Returns all bytes of a session: the raw file, and its decompressed content.
pub(crate) fn all_bytes(path: &Path) -> Vec<u8> {
    let reader = SessionReader::open(path).unwrap();
    let mut bytes = std::fs::read(path).unwrap();
    for channel in reader.channels() {
        let encoding = &channel.encoding;
        for text in [&channel.topic, &encoding.schema, &encoding.schema_encoding, &encoding.message_encoding] {
            bytes.extend(text.as_bytes());
        }
        bytes.extend(&encoding.schema_data);
    }
    for (name, table) in reader.metadata().unwrap() {
        bytes.extend(format!("{name} {table:?}").into_bytes());
    }
    for file in reader.attachments() {
        bytes.extend(format!("{} {} ", file.name, file.media_type).into_bytes());
        bytes.extend(reader.attachment(file).unwrap());
    }
    for message in reader.messages(&[], 0..u64::MAX) {
        bytes.extend(message.unwrap().data());
    }
    bytes
}

fn contains(bytes: &[u8], sought: &[u8]) -> bool {
    memchr::memmem::find(bytes, sought).is_some()
}

/// Returns the names found in these bytes, in either encoding.
fn found(bytes: &[u8]) -> Vec<&'static str> {
    let mut sought = PLANTED.to_vec();
    sought.extend(["Jane", "PLANTED", "jane"]);
    let is_in = |name: &&str| {
        let wide: Vec<u8> = name.encode_utf16().flat_map(u16::to_le_bytes).collect();
        [name.as_bytes(), &wide].iter().any(|sought| contains(bytes, sought))
    };
    sought.into_iter().filter(is_in).collect()
}

#[test]
fn no_name_and_no_date_is_left_and_every_force_is() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let session = recorded(folder.path());
    let full = at("planted.mcap");
    planted(&session, &full);
    assert_eq!(found(&all_bytes(&full)).len(), PLANTED.len() + 3, "all of them are in the session");

    let out = at("a.mcap");
    let part = at("b.mcap");
    let text = |path: &Path| path.display().to_string();
    let exported = elsewhere(&["export", &text(&full), "--out", &text(&out), "--anonymous"]).output().unwrap();
    assert!(exported.status.success(), "{}", String::from_utf8_lossy(&exported.stderr));
    done(&["export", &text(&full), "--out", &text(&part), "--anonymous", "--from", "1", "--to", "2"]);
    for path in [&out, &part] {
        let bytes = all_bytes(path);
        assert_eq!(found(&bytes), [""; 0], "{}", path.display());
        let begin_ns = SessionReader::open(&full).unwrap().statistics().times_ns.0;
        let tables = SessionReader::open(Path::new(&session)).unwrap().metadata().unwrap();
        let day = tables.iter().find_map(|(_, table)| Some(table.get("started")?[..10].to_owned())).unwrap();
        assert!(!contains(&bytes, day.as_bytes()), "{day}");
        // A message's time stamp has its seconds in 32 bits.
        let second = i32::try_from(begin_ns / 1_000_000_000).unwrap().to_le_bytes();
        assert!(!contains(&bytes, &second), "{}", path.display());
        assert_eq!(path.metadata().unwrap().modified().unwrap(), UNIX_EPOCH);
    }
    let [whole, anonymous, stretch] = [&full, &out, &part].map(|path| SessionReader::open(path).unwrap());
    let begin_ns = whole.statistics().times_ns.0;
    assert_eq!(anonymous.statistics().times_ns.0, 0);
    for topic in ["right/forces", "left/forces", "right/poses", "left/poses", "right/gates"] {
        let bits = |reader: &SessionReader, since_ns: u64| -> BTreeMap<u64, Vec<(String, u64)>> {
            let row = |(time_ns, row): (u64, BTreeMap<String, f64>)| {
                (time_ns - since_ns, row.into_iter().map(|(name, value)| (name, value.to_bits())).collect())
            };
            values(reader, topic).into_iter().map(row).collect()
        };
        let expected = bits(&whole, begin_ns);
        assert!(expected.len() == 3000 && expected == bits(&anonymous, 0), "{topic}");
        let inside: BTreeMap<_, _> =
            expected.range(1_000_000_000..2_000_000_000).map(|(k, v)| (*k, v.clone())).collect();
        assert!(inside.len() == 1000 && inside == bits(&stretch, 0), "{topic} in the stretch");
    }
    let of = |reader: &SessionReader, topic: &str| reader.messages(&[topic], 0..u64::MAX).count();
    assert_eq!(of(&anonymous, "timing") + 1, of(&whole, "timing"), "all but the planted one");
    for topic in ["frames", "arrows", "right/identification", "log"] {
        assert!(of(&anonymous, topic) > 5 && of(&anonymous, topic) + 2 >= of(&whole, topic), "{topic}");
    }
    let tables = anonymous.metadata().unwrap();
    let left = &tables.iter().rev().find(|(name, _)| name == "calibrations left").unwrap().1;
    let report: Vec<_> = left.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect();
    assert_eq!(report, [("gravity_error_n", "0.25"), ("gravity_verdict", "accepted")]);
    let lines: Vec<Log> = anonymous
        .messages(&["log"], 0..u64::MAX)
        .map(|message| Log::decode(message.unwrap().data()).unwrap())
        .collect();
    let report = |words: &str| lines.iter().filter(|line| line.message == words).count();
    assert_eq!((report("command: gain 0.25"), report("(withheld)"), report(ENGAGED)), (0, 4, 2));
    assert!(lines.iter().all(|line| line.name == "nima" && line.file.is_empty()) && lines.len() > 6, "{lines:?}");
}

#[test]
fn an_anonymous_session_has_a_report_and_a_table_and_can_be_cut_again() {
    let folder = tempfile::tempdir().unwrap();
    let session = recorded(folder.path());
    let at = |name: &str| folder.path().join(name).display().to_string();
    let out = at("a.mcap");
    let again = at("again.mcap");
    let one = at("one.csv");
    let both = at("both.csv");
    refused(
        &["export", &session, "--out", &one, "--arm", "left", "--anonymous"],
        "--anonymous applies only to sessions",
    );
    done(&["export", &session, "--out", &out, "--anonymous", "--from", "0.5"]);
    done(&["export", &out, "--out", &again, "--from", "1"]);
    for (session, table) in [(&session, &one), (&again, &both)] {
        done(&["export", session, "--out", table, "--arm", "left", "--from", "1"]);
    }
    let rows = |table: &str| {
        let text = std::fs::read_to_string(table).unwrap();
        // Omit the second column, the time since 1970.
        let row = |line: &str| {
            line.split(',').enumerate().filter(|(i, _)| *i != 1).map(|(_, cell)| cell.to_owned()).collect()
        };
        text.lines().map(row).collect::<Vec<Vec<String>>>()
    };
    assert!(rows(&one).len() == 2001 && rows(&one) == rows(&both), "times and values are those of the session");
    refused(&["replay", &out], "no journal");
    let pages = at("pages");
    done(&["report", &out, "--out", &pages]);
    let page = std::fs::read(folder.path().join("pages/report.html")).unwrap();
    assert_eq!(found(&page), [""; 0]);
    let page = String::from_utf8(page).unwrap();
    assert!(page.contains("Anonymous session") && page.contains("Forces of the left arm over time"));
    let path = folder.path().display().to_string();
    assert!(!page.contains(&path), "the page contains no folder");
}
