"""Eclipse Cyclone DDS reads what `nima-bridge-ros2` publishes of a running loop, with the types of ROS 2, and what it reads is what is recorded.
`NIMA_BRIDGE_ROS2` names the program."""

import os
import pathlib
import subprocess
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


# This computer alone, as ROS 2 sets it for LOCALHOST: no multicast, and participants found by their well-known ports.
LOOPBACK = """<CycloneDDS><Domain>
  <General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces><AllowMulticast>false</AllowMulticast></General>
  <Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>
    <Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>"""


def listen(domain, seconds):
    """All samples by topic, with the times of their arrival."""
    from cyclonedds.core import Policy, Qos
    from cyclonedds.domain import Domain, DomainParticipant
    from cyclonedds.sub import DataReader
    from cyclonedds.topic import Topic
    from cyclonedds.util import duration

    pose, wrench, state = types()
    configured = Domain(domain, LOOPBACK)
    participant = DomainParticipant(domain)
    usual = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(100))
    late = Qos(
        Policy.Reliability.Reliable(duration(seconds=1)), Policy.Durability.TransientLocal, Policy.History.KeepLast(100)
    )
    readers = {}
    for name, kind, qos in [
        ("right/measured_cp", pose, usual),
        ("left/measured_cp", pose, usual),
        ("right/setpoint_cp", pose, usual),
        ("right/measured_cf", wrench, usual),
        ("right/operating_state", state, late),
    ]:
        readers[name] = DataReader(participant, Topic(participant, f"rt/nima/{name}", kind), qos=qos)
    found, end = {name: [] for name in readers}, time.time() + seconds
    while time.time() < end:
        for name, reader in readers.items():
            found[name] += [(time.time(), sample) for sample in reader.take(N=100)]
        time.sleep(0.005)
    return found


def run(nima):
    peer = Peer("Cyclone DDS (ROS 2's topics)")
    bridge = os.environ.get("NIMA_BRIDGE_ROS2")
    if not bridge:
        peer.skip("nima-bridge-ros2 is built by ./dev ros2 alone")
        return [peer]
    from peer_igtl import recorded, started

    domain = os.getpid() % 200
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "ros2.mcap"
        command = [nima, "run", "--igtl", "127.0.0.1:0", "--record", path, "--scene", "bimanual", "--seconds", "14"]
        process, host, port = started(command)
        publishes = subprocess.Popen([bridge, "--from", f"{host}:{port}", "--domain", str(domain)])
        try:
            found = listen(domain, 11)
        finally:
            publishes.kill()
            publishes.wait()
        peer.check("the run ends well", process.wait() == 0, process.returncode)
        truth = recorded(path)
    times = sorted(truth)
    for name, samples in found.items():
        peer.check(f"{name} comes", len(samples) > (2 if "state" in name else 300), len(samples))

    def row(header):
        stamp_ns = header.stamp.sec * 10**9 + header.stamp.nanosec
        nearest = min(times, key=lambda time_ns: abs(time_ns - stamp_ns))
        peer.check("a stamp of a tick", abs(nearest - stamp_ns) < 1000, stamp_ns - nearest)
        return truth[nearest]

    for name, of in [("right/measured_cp", "right.tip"), ("left/measured_cp", "left.tip"), ("right/setpoint_cp", "right.leader")]:
        for _, sample in found[name][::40]:
            expected, turn = row(sample.header), sample.pose.orientation
            peer.check("frame", sample.header.frame_id == "world", sample.header.frame_id)
            for axis in "xyz":
                peer.near(f"{name}, m", getattr(sample.pose.position, axis), expected[f"{of}.{axis}_m"], 1e-7)
            peer.near("a unit quaternion", turn.x**2 + turn.y**2 + turn.z**2 + turn.w**2, 1.0, 1e-5)
    for _, sample in found["right/measured_cf"][::40]:
        expected = row(sample.header)
        for axis in "xyz":
            peer.near("measured_cf, N", getattr(sample.wrench.force, axis), expected[f"right.measured.{axis}_n"], 1e-12)
    states = {sample.state for _, sample in found["right/operating_state"]}
    peer.check("the arm is engaged", "ENABLED" in states and states <= {"ENABLED", "PAUSED", "DISABLED"}, states)
    ages = sorted(at - sample.header.stamp.sec - sample.header.stamp.nanosec * 1e-9 for at, sample in found["right/measured_cp"])
    late = [(age - ages[0]) * 1e3 for age in ages]
    print(f"Cyclone DDS: {len(ages)} poses, later than the first by {late[len(late) // 2]:.1f} ms (p50), {late[len(late) * 99 // 100]:.1f} ms (p99)")
    return [peer]
