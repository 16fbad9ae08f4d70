"""The Python libraries of MCAP on a session file: every topic is read, and every value compared with the tables beside the file."""

import csv
import pathlib
import subprocess
import tempfile
import time

from harness import Peer

SIGNALS = 150


def rows(path):
    with open(path, newline="") as table:
        return list(csv.reader(table))


def by_topic(path, factories, **options):
    from mcap.reader import make_reader

    found = {}
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=factories)
        for _, channel, message, decoded in reader.iter_decoded_messages(**options):
            found.setdefault(channel.topic, []).append((message.log_time, message.publish_time, decoded))
    return found


def stamp_ns(stamp):
    return stamp.seconds * 10**9 + stamp.nanos


def file_peer(path):
    """Header, summary, attachments and metadata; and all records one after the other, with their checksums."""
    from mcap.reader import make_reader
    from mcap.records import Chunk, Message
    from mcap.stream_reader import StreamReader

    peer = Peer("mcap 1.6.0")
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        topics = sorted(channel.topic for channel in summary.channels.values())
        peer.check("topics", topics == ["/forces", "/frames", "/inputs", "/left/signals", "/log", "/right/signals"], topics)
        peer.check("library", reader.get_header().library.startswith("nima "), reader.get_header())
        counted = summary.statistics.message_count
        read = [(channel.topic, message) for _, channel, message in reader.iter_messages()]
        peer.check("the messages are as many as the statistics say", len(read) == counted, (len(read), counted))
        times = [message.log_time for _, message in read]
        peer.check("in the order of their times", times == sorted(times))
        own = [message for topic, message in read if topic == "/inputs"]
        peer.check("own bytes", all(m.data == m.sequence.to_bytes(8, "little") for m in own), own[:2])
        attachments = [(one.name, one.media_type, one.data) for one in reader.iter_attachments()]
        peer.check("attachment", attachments == [("rig.toml", "text/plain", b"rate_hz = 1000.0\n")], attachments)
        metadata = [(one.name, one.metadata) for one in reader.iter_metadata()]
        peer.check("metadata", metadata == [("session", {"rig": "made up", "scene": "none"})], metadata)
        middle = times[len(times) // 2]
        part = list(reader.iter_messages(topics=["/log"], start_time=times[0], end_time=middle))
        peer.check("a part of one topic", all(times[0] <= m.log_time < middle for *_, m in part) and len(part) > 3)
    with open(path, "rb") as file:
        linear = sum(isinstance(record, Message) for record in StreamReader(file, validate_crcs=True).records)
    peer.check("one after the other", linear == counted, linear)
    with open(path, "rb") as file:
        chunks = [one for one in StreamReader(file, emit_chunks=True).records if isinstance(one, Chunk)]
    longest = max(one.message_end_time - one.message_start_time for one in chunks)
    peer.check("no chunk is longer than half a second", longest < 500_000_000, longest)
    return peer


def ros2_peer(path):
    from mcap_ros2.decoder import DecoderFactory

    peer = Peer("mcap-ros2-support 0.6.0")
    expected = rows(path.with_suffix(".csv"))
    end = int(expected[-1][0]) + 1
    found = by_topic(path, [DecoderFactory()], topics=["/left/signals", "/right/signals"], end_time=end)
    for arm, side in enumerate(["left", "right"]):
        names = [f"{side}.signal_{signal:03}.x_n" for signal in range(SIGNALS)]
        messages = found[f"/{side}/signals"]
        peer.check(f"{side}: a message for each row", len(messages) == len(expected), len(messages))
        for row, (log_ns, publish_ns, message) in zip(expected, messages):
            values = [float(text) for text in row[1 + arm * SIGNALS : 1 + (arm + 1) * SIGNALS]]
            stamp = message.header.stamp
            same = log_ns == publish_ns == int(row[0]) == stamp.sec * 10**9 + stamp.nanosec
            peer.check(f"{side}: times", same, (row[0], log_ns, publish_ns, stamp))
            whole = message.header.frame_id == "world" and message.name == names and list(message.effort) == values
            peer.check(f"{side}: names and values, every bit", whole, row[0])
            peer.check(f"{side}: nothing else", len(message.position) == len(message.velocity) == 0)
    return peer


def protobuf_peer(path):
    from mcap_protobuf.decoder import DecoderFactory

    peer = Peer("mcap-protobuf-support 0.6.0")
    poses, lines = rows(path.with_suffix(".poses.csv")), rows(path.with_suffix(".log.csv"))
    end = int(rows(path.with_suffix(".csv"))[-1][0]) + 1
    found = by_topic(path, [DecoderFactory()], topics=["/frames", "/forces", "/log"], end_time=end)
    peer.check("frames", len(found["/frames"]) == len(poses), len(found["/frames"]))
    peer.check("arrows", len(found["/forces"]) == len(poses), len(found["/forces"]))
    for row, (log_ns, _, frames), (_, _, scene) in zip(poses, found["/frames"], found["/forces"]):
        numbers = [float(text) for text in row[1:]]
        (one,) = frames.transforms
        peer.check("frame: times", log_ns == int(row[0]) == stamp_ns(one.timestamp), row[0])
        peer.check("frame: names", (one.parent_frame_id, one.child_frame_id) == ("world", "left.tip"), one)
        place = [one.translation.x, one.translation.y, one.translation.z]
        peer.check("frame: place", place == numbers[:3] and one.rotation.w == 1.0, one)
        (entity,) = scene.entities
        (arrow,) = entity.arrows
        at = arrow.pose.position
        peer.check("arrow: times", stamp_ns(entity.timestamp) == int(row[0]), entity)
        peer.check("arrow: place", [at.x, at.y, at.z] == numbers[3:] and entity.frame_id == "world", entity)
        shape = (arrow.shaft_length, arrow.shaft_diameter, arrow.head_length, arrow.head_diameter, arrow.color.g)
        peer.check("arrow: shape", shape == (0.05, 0.002, 0.01, 0.004, 0.5) and entity.frame_locked, arrow)
        peer.check("arrow: unused parts are empty", len(entity.cubes) == len(scene.deletions) == 0)
    peer.check("log", len(found["/log"]) == len(lines), len(found["/log"]))
    for row, (log_ns, _, line) in zip(lines, found["/log"]):
        peer.check("log: times", log_ns == int(row[0]) == stamp_ns(line.timestamp), row)
        level = line.DESCRIPTOR.enum_types_by_name["Level"].values_by_number[line.level].name
        peer.check("log: text", (line.message, line.name, level) == (row[1], "right", "WARNING"), line)
    return peer


def killed_peer(writer, folder):
    """A process that writes is killed; its files are read by the index and one record after the other, unrepaired."""
    from mcap.reader import make_reader
    from mcap.records import Message
    from mcap.stream_reader import StreamReader

    peer = Peer("mcap 1.6.0 (files of killed processes)")
    for number in range(10):
        path = pathlib.Path(folder) / f"killed{number}.mcap"
        process = subprocess.Popen([writer, path, "600"], stdout=subprocess.DEVNULL)
        while not path.exists():
            time.sleep(0.001)
        time.sleep(0.1 + 0.037 * number)
        process.kill()
        process.wait()
        with open(path, "rb") as file:
            reader = make_reader(file, validate_crcs=True)
            counted = reader.get_summary().statistics.message_count
            times = [message.log_time for *_, message in reader.iter_messages(topics=["/inputs"])]
            peer.check("killed: every tick up to the end", times == list(range(times[0], times[0] + len(times) * 10**6, 10**6)))
            total = sum(1 for _ in reader.iter_messages())
            peer.check("killed: by the index", total == counted, (total, counted))
        with open(path, "rb") as file:
            linear = sum(isinstance(record, Message) for record in StreamReader(file, validate_crcs=True).records)
        # A chunk may be in the data before it is in the index.
        peer.check("killed: one after the other", counted <= linear <= counted + 3_000, (counted, linear))
    return peer


def run(nima):
    writer = pathlib.Path(nima).with_name("examples") / "session"
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "session.mcap"
        subprocess.run([writer, path], check=True, stdout=subprocess.DEVNULL)
        return [file_peer(path), ros2_peer(path), protobuf_peer(path), killed_peer(writer, folder)]
