"""A real session: every topic of its file is read by the libraries of MCAP and compared with `nima export`; and the same messages live, by a
WebSocket client (only where the program was built with the feature `live`)."""

import csv
import json
import math
import pathlib
import struct
import subprocess
import tempfile
import threading

from harness import Peer

# Columns of the exported table, and where their numbers are in a session.
COLUMNS = {
    "tip": ("poses", "position", ["x_m", "y_m", "z_m"]),
    "leader": ("poses", "position", ["leader_x_m", "leader_y_m", "leader_z_m"]),
    "measured": ("forces", "effort", ["fx_n", "fy_n", "fz_n"]),
    "delayed": ("forces", "effort", ["delayed_x_n", "delayed_y_n", "delayed_z_n"]),
    "asked": ("forces", "effort", ["asked_x_n", "asked_y_n", "asked_z_n"]),
    "rendered": ("forces", "effort", ["rendered_x_n", "rendered_y_n", "rendered_z_n"]),
}
PLOTS = ["forces", "poses", "gates", "identification"]


def nima_ok(nima, *arguments):
    subprocess.run([nima, *arguments], check=True, stdout=subprocess.DEVNULL)


def read(path):
    """Decoded messages by topic, with their times."""
    from mcap.reader import make_reader
    from mcap_protobuf.decoder import DecoderFactory as Protobuf
    from mcap_ros2.decoder import DecoderFactory as Ros2

    found = {}
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[Ros2(), Protobuf()])
        topics = sorted({channel.topic for channel in reader.get_summary().channels.values()})
        plotted = [topic for topic in topics if topic != "nima/journal"]
        for _, channel, message, decoded in reader.iter_decoded_messages(topics=plotted):
            found.setdefault(channel.topic, []).append((message.log_time, message.data, decoded))
        attachments = {one.name: one.data for one in reader.iter_attachments()}
    return topics, found, attachments


def value(path, messages, field):
    """Value at a path of a layout, such as `right/forces.effort[3]`."""
    at = int(field[field.index("[") + 1 : -1])
    return getattr(messages[path][-1][2], field[: field.index("[")])[at]


def file_peer(nima, path, folder):
    peer = Peer("mcap, mcap-ros2-support, mcap-protobuf-support (a session of two arms)")
    topics, found, attachments = read(path)
    sides = ["left", "right"]
    expected = [f"{side}/{plot}" for side in sides for plot in PLOTS] + ["frames", "forces", "log", "timing", "nima/journal"]
    peer.check("topics", set(expected) <= set(topics) | {"frames", "forces"}, topics)
    peer.check("every topic has messages", all(found.get(topic) for topic in topics if topic != "nima/journal"), topics)
    for side in sides:
        table = pathlib.Path(folder) / f"{side}.csv"
        nima_ok(nima, "export", path, "--out", table, "--arm", side)
        with open(table, newline="") as file:
            rows = list(csv.DictReader(file))
        for plot in ["forces", "poses"]:
            messages = found[f"{side}/{plot}"]
            peer.check(f"{side}/{plot}: a message for each row", len(messages) == len(rows), (len(messages), len(rows)))
            for row, (log_ns, _, message) in zip(rows, messages):
                stamp = message.header.stamp
                peer.check("time", int(row["time_ns"]) == log_ns == stamp.sec * 10**9 + stamp.nanosec, row["time_ns"])
                for name, (of, field, columns) in COLUMNS.items():
                    if of == plot:
                        places = [message.name.index(f"{side}.{name}.{axis}") for axis in axes(field)]
                        numbers = [getattr(message, field)[place] for place in places]
                        cells = [row[column] for column in columns]
                        peer.check(f"{name}, every bit", all(map(is_same, numbers, cells)), row["time_ns"])
    layout = json.loads(attachments["layout.foxglove.json"])
    paths = [one["value"] for panel in layout["configById"].values() for one in panel.get("paths", [])]
    for one in paths:
        topic, field = one.split(".")
        peer.check("a path of the layout leads to a number", isinstance(value(topic, found, field), float), one)
    from xml.etree import ElementTree

    curves = [curve.get("name") for curve in ElementTree.fromstring(attachments["layout.plotjuggler.xml"]).iter("curve")]
    for curve in curves:
        topic, name, field = curve.rsplit("/", 2)
        _, _, message = found[topic][-1]
        peer.check("a curve of the layout is recorded", name in message.name and len(getattr(message, field)) > 0, curve)
    peer.check("layouts show both arms", len(paths) == 20 and len(curves) == 18, (len(paths), len(curves)))
    return peer


def is_same(number, cell):
    """An unknown value is NaN in a session and an empty cell in a table."""
    return math.isnan(number) if cell == "" else number == float(cell)


def axes(field):
    return ["x_n", "y_n", "z_n"] if field == "effort" else ["x_m", "y_m", "z_m"]


def watch(address, messages, channels, failed):
    """Subscribes to everything and returns all messages until the server ends: (topic, time, bytes)."""
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect

    try:
        with connect(address, subprotocols=["foxglove.sdk.v1"], max_size=None) as socket:
            for text in socket:
                if isinstance(text, bytes):
                    subscription, time_ns = struct.unpack_from("<IQ", text, 1)
                    messages.append((channels[subscription]["topic"], time_ns, text[13:]))
                    continue
                told = json.loads(text)
                if told["op"] == "advertise":
                    for channel in told["channels"]:
                        channels[channel["id"]] = channel
                    wish = [{"id": channel["id"], "channelId": channel["id"]} for channel in told["channels"]]
                    socket.send(json.dumps({"op": "subscribe", "subscriptions": wish}))
    except ConnectionClosed:
        pass
    except Exception as error:
        failed.append(error)


def live_peer(nima, folder):
    peer = Peer("websockets (a session while it happens)")
    path = pathlib.Path(folder) / "live.mcap"
    command = [nima, "run", "--live", "127.0.0.1:0", "--record", path, "--scene", "bimanual", "--seconds", "8"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    line = process.stderr.readline()
    if "this build has no `--live`" in line:
        process.wait()
        return peer.skip("this program was built without the feature live") or peer
    peer.check("says where", "live at ws://127.0.0.1:" in line, line)
    address = line.split("live at ")[1].split(": open")[0]
    messages, channels, failed = [], {}, []
    watching = threading.Thread(target=watch, args=(address, messages, channels, failed))
    watching.start()
    process.stderr.read()
    peer.check("the run ends well", process.wait() == 0, process.returncode)
    watching.join(10)
    peer.check("the client saw no error", not failed, failed)
    topics, found, _ = read(path)
    advertised = sorted(channel["topic"] for channel in channels.values())
    peer.check("all topics but the journal", advertised == [topic for topic in topics if topic != "nima/journal"], advertised)
    recorded = {(topic, time_ns, bytes(data)) for topic, all_of in found.items() for time_ns, data, _ in all_of}
    for message in messages:
        peer.check("what is live is what is recorded, to the bit", message in recorded, message[:2])
    forces = [time_ns for topic, time_ns, _ in messages if topic == "right/forces"]
    between = [time_ns for time_ns, _, _ in found["right/forces"] if forces[0] <= time_ns <= forces[-1]]
    peer.check("nothing is left out from the first message on", forces == between, (len(forces), len(between)))
    peer.check("and the first comes at once", len(forces) > 5_000, len(forces))
    return peer


def run(nima):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "session.mcap"
        nima_ok(nima, "run", "--virtual", "--seconds", "3", "--scene", "bimanual", "--record", path)
        return [file_peer(nima, path, folder), live_peer(nima, folder)]
