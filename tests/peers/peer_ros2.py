"""Eclipse Cyclone DDS reads what `nima-bridge-ros2` publishes of a running loop, with the types of ROS 2, and what it reads is what is recorded.
`NIMA_BRIDGE_ROS2` names the program."""

import itertools
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass

from harness import Peer


def types():
    """The types of ROS 2 as DDS knows them: their names in the place of those of Python's classes."""
    from cyclonedds.idl import IdlStruct
    from cyclonedds.idl.types import float64, int32, uint32

    @dataclass
    class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
        sec: int32
        nanosec: uint32

    @dataclass
    class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
        stamp: Time
        frame_id: str

    @dataclass
    class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
        x: float64
        y: float64
        z: float64

    @dataclass
    class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
        x: float64
        y: float64
        z: float64
        w: float64

    @dataclass
    class Pose(IdlStruct, typename="geometry_msgs::msg::dds_::Pose_"):
        position: Vector3
        orientation: Quaternion

    @dataclass
    class PoseStamped(IdlStruct, typename="geometry_msgs::msg::dds_::PoseStamped_"):
        header: Header
        pose: Pose

    @dataclass
    class Wrench(IdlStruct, typename="geometry_msgs::msg::dds_::Wrench_"):
        force: Vector3
        torque: Vector3

    @dataclass
    class WrenchStamped(IdlStruct, typename="geometry_msgs::msg::dds_::WrenchStamped_"):
        header: Header
        wrench: Wrench

    @dataclass
    class OperatingState(IdlStruct, typename="crtk_msgs::msg::dds_::OperatingState_"):
        header: Header
        state: str
        is_homed: bool
        is_busy: bool

    return PoseStamped, WrenchStamped, OperatingState


def graph_type():
    """Nodes that a participant of ROS 2 (Iron or newer) announces."""
    from cyclonedds.idl import IdlStruct
    from cyclonedds.idl.types import array, sequence, uint8

    @dataclass
    class Gid(IdlStruct, typename="rmw_dds_common::msg::dds_::Gid_"):
        data: array[uint8, 16]

    @dataclass
    class NodeEntitiesInfo(IdlStruct, typename="rmw_dds_common::msg::dds_::NodeEntitiesInfo_"):
        node_namespace: str
        node_name: str
        reader_gid_seq: sequence[Gid]
        writer_gid_seq: sequence[Gid]

    @dataclass
    class ParticipantEntitiesInfo(IdlStruct, typename="rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"):
        gid: Gid
        node_entities_info_seq: sequence[NodeEntitiesInfo]

    return ParticipantEntitiesInfo


# This computer alone, as ROS 2 sets it for LOCALHOST: no multicast, and participants found by their well-known ports.
LOOPBACK = """<CycloneDDS><Domain>
  <General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces><AllowMulticast>false</AllowMulticast></General>
  <Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>
    <Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>"""


class Reader:
    """A participant on this computer alone, and what it reads by topic, with the times of arrival."""

    def __init__(self, domain):
        from cyclonedds.core import Policy, Qos
        from cyclonedds.domain import Domain, DomainParticipant
        from cyclonedds.util import duration

        self.pose, self.wrench, self.state = types()
        history, reliable = Policy.History.KeepLast(100), Policy.Reliability.Reliable(duration(seconds=1))
        self.usual, self.late = Qos(reliable, history), Qos(reliable, history, Policy.Durability.TransientLocal)
        self.best_effort = Qos(Policy.Reliability.BestEffort, history)
        self.domain = Domain(domain, LOOPBACK)
        self.participant = DomainParticipant(domain)
        self.readers = {
            "right/measured_cp": self.reader("right/measured_cp", self.pose, self.usual),
            "left/measured_cp": self.reader("left/measured_cp", self.pose, self.best_effort),
            "right/setpoint_cp": self.reader("right/setpoint_cp", self.pose, self.usual),
            "right/measured_cf": self.reader("right/measured_cf", self.wrench, self.usual),
            "left/rendered_cf": self.reader("left/rendered_cf", self.wrench, self.usual),
            "right/operating_state": self.reader("right/operating_state", self.state, self.late),
        }

    def reader(self, name, kind, qos):
        from cyclonedds.sub import DataReader
        from cyclonedds.topic import Topic

        return DataReader(self.participant, Topic(self.participant, f"rt/nima/{name}", kind), qos=qos)

    def nodes(self):
        """Name, number of readers and of writers of each node in the graph."""
        from cyclonedds.sub import DataReader
        from cyclonedds.topic import Topic

        topic = Topic(self.participant, "ros_discovery_info", graph_type())
        reader, end, samples = DataReader(self.participant, topic, qos=self.late), time.time() + 5, []
        while not samples and time.time() < end:
            samples = reader.take(N=10)
            time.sleep(0.01)
        nodes = [node for sample in samples[-1:] for node in sample.node_entities_info_seq]
        return [(f"{one.node_namespace}/{one.node_name}", len(one.reader_gid_seq), len(one.writer_gid_seq)) for one in nodes]

    def listen(self, seconds):
        found, end = {name: [] for name in self.readers}, time.time() + seconds
        while time.time() < end:
            for name, reader in self.readers.items():
                found[name] += [(time.time(), sample) for sample in reader.take(N=100)]
            time.sleep(0.002)
        return found

    def state_before(self):
        """Whether a new reader receives the last state. A state is sent once a second anyway, so the first of three decides."""
        for _ in range(3):
            now, reader = time.time(), self.reader("right/operating_state", self.state, self.late)
            while not (samples := reader.take(N=1)):
                if time.time() > now + 5:
                    return False
                time.sleep(0.002)
            if seconds(samples[0].header) < now:
                return True
        return False

    def offered(self):
        """Publications and subscriptions of others: type and policies of each topic."""
        from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription
        from cyclonedds.core import Policy

        policies = [Policy.Reliability, Policy.Durability, Policy.History]

        def of(topic):
            ends = BuiltinDataReader(self.participant, topic).take(N=1000)
            theirs = [one for one in ends if one.participant_key != self.participant.guid]
            # Topics of ROS 2 begin so; those of discovery itself do not.
            theirs = [one for one in theirs if one.topic_name.startswith("rt/")]
            # Every node of ROS 2 has it.
            theirs = [one for one in theirs if one.topic_name != "rt/parameter_events"]
            return {one.topic_name[3:]: (one.type_name, [one.qos[policy] for policy in policies]) for one in theirs}

        return of(BuiltinTopicDcpsPublication), of(BuiltinTopicDcpsSubscription)


def documented():
    """The table of the quality of service in docs/bridges.md."""
    from cyclonedds.core import Policy

    def offers(topic, kind):
        durability = Policy.Durability.TransientLocal if topic == "operating_state" else Policy.Durability.Volatile
        return kind, [Policy.Reliability.Reliable(0), durability, Policy.History.KeepLast(1)]

    pose, wrench = "geometry_msgs::msg::dds_::PoseStamped_", "geometry_msgs::msg::dds_::WrenchStamped_"
    kinds = {
        "measured_cp": pose,
        "setpoint_cp": pose,
        "measured_cf": wrench,
        "rendered_cf": wrench,
        "operating_state": "crtk_msgs::msg::dds_::OperatingState_",
    }
    return {f"nima/{side}/{topic}": offers(topic, kind) for side in ("right", "left") for topic, kind in kinds.items()}


class Group:
    """Hears what participants of this domain say to every network of this computer, at the address where DDS looks for others."""

    def __init__(self, domain):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.bind(("", 7400 + 250 * domain))
        self.socket.setblocking(False)
        for index, _ in socket.if_nameindex():
            membership = socket.inet_aton("239.255.0.1") + bytes(4) + index.to_bytes(4, sys.byteorder)
            try:
                self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
            except OSError:
                pass  # a network that is down, or has no multicast

    def heard(self):
        try:
            return self.socket.recv(65536)
        except BlockingIOError:
            return None


def seconds(header):
    return header.stamp.sec + header.stamp.nanosec * 1e-9


def compare(peer, found, truth):
    times = sorted(truth)
    for name, samples in found.items():
        peer.check(f"{name} comes", len(samples) > (2 if "state" in name else 300), len(samples))

    def row(header):
        peer.check("frame", header.frame_id == "world", header.frame_id)
        stamp_ns = header.stamp.sec * 10**9 + header.stamp.nanosec
        nearest = min(times, key=lambda time_ns: abs(time_ns - stamp_ns))
        peer.check("a stamp of a tick", abs(nearest - stamp_ns) < 1000, stamp_ns - nearest)
        return truth[nearest]

    for name, of in [("right/measured_cp", "right.tip"), ("left/measured_cp", "left.tip"), ("right/setpoint_cp", "right.leader")]:
        for _, sample in found[name][::40]:
            expected, turn = row(sample.header), sample.pose.orientation
            for axis in "xyz":
                peer.near(f"{name}, m", getattr(sample.pose.position, axis), expected[f"{of}.{axis}_m"], 1e-7)
            peer.near("a unit quaternion", turn.x**2 + turn.y**2 + turn.z**2 + turn.w**2, 1.0, 1e-5)
    for name, of in [("right/measured_cf", "right.measured"), ("left/rendered_cf", "left.rendered")]:
        largest = 0
        for _, sample in found[name][::40]:
            expected = row(sample.header)
            for axis in "xyz":
                force = getattr(sample.wrench.force, axis)
                peer.near(f"{name}, N", force, expected[f"{of}.{axis}_n"], 1e-12)
                largest = max(largest, abs(force))
        peer.check(f"{name} is a force that was felt", largest > 0.05, largest)
    # Before the loop runs, its state is unknown.
    states = set(itertools.dropwhile("UNKNOWN".__eq__, [sample.state for _, sample in found["right/operating_state"]]))
    peer.check("the arm is engaged", "ENABLED" in states and states <= {"ENABLED", "PAUSED", "DISABLED"}, states)
    stamps = [seconds(sample.header) for _, sample in found["right/measured_cp"]]
    gap = max(second - first for first, second in zip(stamps, stamps[1:]))
    ages = sorted(at - seconds(sample.header) for at, sample in found["right/measured_cp"])
    late = [(age - ages[0]) * 1e3 for age in ages]
    p50, p99 = late[len(late) // 2], late[len(late) * 99 // 100]
    print(f"Cyclone DDS: {len(ages)} poses in 10 s, later than the first of them by {p50:.1f} ms (p50), {p99:.1f} ms (p99); at most {gap * 1e3:.0f} ms between two")


def run(nima):
    peer = Peer("Cyclone DDS (ROS 2's topics)")
    bridge = os.environ.get("NIMA_BRIDGE_ROS2")
    if not bridge:
        peer.skip("nima-bridge-ros2 is built by ./dev ros2 alone")
        return [peer]
    from peer_igtl import recorded, started

    domain = os.getpid() % 200
    group, reader = Group(domain), Reader(domain)
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "ros2.mcap"
        command = [nima, "run", "--scene", "bimanual", "--igtl"]
        process, host, port = started([*command, "127.0.0.1:0", "--record", path, "--seconds", "14"])
        publishes = subprocess.Popen([bridge, "--from", f"{host}:{port}", "--domain", str(domain)])
        try:
            found = reader.listen(10)
            peer.check("who comes late learns the state", reader.state_before())
            publications, subscriptions = reader.offered()
            nodes = reader.nodes()
            # Its own ten topics, and the parameter events of every node.
            peer.check("its node is in the graph, with its topics", nodes == [("/nima/nima_bridge_ros2", 0, 11)], nodes)
            told = process.communicate()[1]
            peer.check("the run ends well", process.returncode == 0, told)
            between = [sample.state for _, sample in reader.listen(1.5)["right/operating_state"]]
            peer.check("no state stays when the run has ended", between[-1:] == ["UNKNOWN"], between)
            # The next run, at the same address.
            process, _, _ = started([*command, f"{host}:{port}", "--seconds", "6"])
            again = reader.listen(4)
            told = process.communicate()[1]
            peer.check("the next run ends well", process.returncode == 0, told)
            peer.check("the bridge still runs", publishes.poll() is None, publishes.poll())
        finally:
            publishes.kill()
            publishes.wait()
        compare(peer, found, recorded(path))
    for name, samples in again.items():
        peer.check(f"{name} is also sent by the next run", len(samples) > (1 if "state" in name else 50), len(samples))
    peer.check("engaged again", "ENABLED" in [sample.state for _, sample in again["right/operating_state"]])
    peer.check("topics, types and quality of service", publications == documented(), publications)
    peer.check("it subscribes to nothing", subscriptions == {}, subscriptions)
    peer.check("no word to another network", group.heard() is None)
    return [peer]
