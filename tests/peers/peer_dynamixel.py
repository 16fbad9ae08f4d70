"""ROBOTIS's own SDK (dynamixel-sdk, and dynamixel_easy_sdk of the same wheel) against the emulated servos."""

import time

import dynamixel_sdk as sdk
from dynamixel_easy_sdk import connector as easy
from dynamixel_easy_sdk.dynamixel_error import DxlRuntimeError

from harness import Emulator, Peer

BAUD = 1_000_000
OK = sdk.COMM_SUCCESS


def singles(peer, port, packet):
    model, result, error = packet.ping(port, 1)
    peer.check("ping", (model, result, error) == (1020, OK, 0), (model, result, error))
    found, result = packet.broadcastPing(port)
    peer.check("broadcast ping", result == OK and sorted(found) == [1, 2, 3, 4], found)
    peer.check("models and firmware versions", all(found[k][0] == 1020 and found[k][1] == 48 for k in found), found)
    _, result, _ = packet.ping(port, 9)
    peer.check("no answer from an unused id", result == sdk.COMM_RX_TIMEOUT, result)
    value, result, error = packet.read2ByteTxRx(port, 2, 144)
    peer.check("voltage", (value, result, error) == (120, OK, 0), value)
    result, error = packet.write1ByteTxRx(port, 2, 65, 1)
    peer.check("write", (result, error) == (OK, 0), (result, error))
    peer.check("the written value is read back", packet.read1ByteTxRx(port, 2, 65)[0] == 1)
    first = packet.read2ByteTxRx(port, 1, 120)[0]
    time.sleep(0.1)
    later = packet.read2ByteTxRx(port, 1, 120)[0]
    peer.check("its clock counts milliseconds", 95 <= (later - first) % 32768 <= 400, (first, later))
    result, error = packet.regWriteTxRx(port, 3, 65, 1, [1])
    peer.check("reg write", (result, error) == (OK, 0), (result, error))
    peer.check("registered", packet.read1ByteTxRx(port, 3, 69)[0] == 1)
    peer.check("not carried out before the action", packet.read1ByteTxRx(port, 3, 65)[0] == 0)
    packet.action(port, sdk.BROADCAST_ID)
    peer.check("done", packet.read1ByteTxRx(port, 3, 65)[0] == 1)


def refusals(peer, port, packet):
    for what, address, size, value, expected in [
        ("read-only", 132, 4, 0, 7),
        ("unknown mode", 11, 1, 2, 4),
        ("beyond the limits", 116, 4, 5000, 6),
        ("read-only or no register", 14, 1, 0, 7),
    ]:
        result, error = getattr(packet, f"write{size}ByteTxRx")(port, 1, address, value)
        peer.check(what, (result, error) == (OK, expected), (result, error))
    packet.write1ByteTxRx(port, 1, 64, 1)
    result, error = packet.write1ByteTxRx(port, 1, 11, 4)
    peer.check("EEPROM while the torque is on", (result, error) == (OK, 7), (result, error))
    packet.write1ByteTxRx(port, 1, 64, 0)


def groups(peer, port, packet):
    write = sdk.GroupSyncWrite(port, packet, 84, 2)
    for k in range(1, 5):
        write.addParam(k, [100 * k & 0xFF, 100 * k >> 8])
    peer.check("sync write", write.txPacket() == OK)
    for what, make, run in [
        ("sync read", sdk.GroupSyncRead, "txRxPacket"),
        ("fast sync read", sdk.GroupSyncRead, "fastSyncRead"),
    ]:
        read = make(port, packet, 84, 2)
        for k in range(1, 5):
            read.addParam(k)
        result = getattr(read, run)()
        peer.check(what, result == OK, result)
        values = [read.getData(k, 84, 2) for k in range(1, 5)]
        peer.check(what + " values", values == [100, 200, 300, 400], values)
    bulk = sdk.GroupBulkWrite(port, packet)
    bulk.addParam(1, 65, 1, [0])
    bulk.addParam(2, 82, 2, [44, 1])
    peer.check("bulk write", bulk.txPacket() == OK)
    for what, run in [("bulk read", "txRxPacket"), ("fast bulk read", "fastBulkRead")]:
        read = sdk.GroupBulkRead(port, packet)
        read.addParam(1, 65, 1)
        read.addParam(2, 82, 2)
        result = getattr(read, run)()
        peer.check(what, result == OK, result)
        got = (read.getData(1, 65, 1), read.getData(2, 82, 2))
        peer.check(what + " values", got == (0, 300), got)


def motion(peer, port, packet):
    before = packet.read4ByteTxRx(port, 4, 132)[0]
    time.sleep(1.0)
    swayed = packet.read4ByteTxRx(port, 4, 132)[0]
    peer.check("the shaft moves without torque", before != swayed, (before, swayed))
    for goal, p in [(2600, 800), (1500, 800)]:
        packet.write2ByteTxRx(port, 4, 84, p)
        packet.write1ByteTxRx(port, 4, 64, 1)
        packet.write4ByteTxRx(port, 4, 116, goal)
        time.sleep(1.5)
        peer.near("goal reached", packet.read4ByteTxRx(port, 4, 132)[0], goal, 15)
    packet.write1ByteTxRx(port, 4, 64, 0)
    # The stuffing of an answer: bytes that contain the mark of a header.
    for k, value in enumerate([0xFF, 0xFF, 0xFD, 0xFD]):
        packet.write1ByteTxRx(port, 4, 230 + k, value)
    data, result, error = packet.readTxRx(port, 4, 230, 4)
    peer.check("stuffed answer", (result, error, list(data)) == (OK, 0, [0xFF, 0xFF, 0xFD, 0xFD]), data)


def faults(peer, port, packet, emulator):
    emulator.fault("device-fault")
    packet.ping(port, 1)
    _, result, error = packet.ping(port, 1)
    peer.check("alert", (result, error) == (OK, 0x80), (result, error))
    peer.check("overload", packet.read1ByteTxRx(port, 1, 70)[0] == 0x20)
    emulator.fault("none")
    peer.check("reboot", packet.reboot(port, 1)[0] == OK)
    time.sleep(0.5)
    _, result, error = packet.ping(port, 1)
    peer.check("torque after the reboot", (result, error) == (OK, 0), (result, error))
    packet.write1ByteTxRx(port, 1, 98, 5)
    packet.write1ByteTxRx(port, 1, 64, 1)
    time.sleep(0.5)
    peer.check("watchdog", packet.read1ByteTxRx(port, 1, 98)[0] == 0xFF)
    result, error = packet.write4ByteTxRx(port, 1, 116, 2048)
    peer.check("goals are locked", (result, error) == (OK, 4), (result, error))
    packet.write1ByteTxRx(port, 1, 98, 0)
    packet.write1ByteTxRx(port, 1, 64, 0)
    emulator.fault("bad-checksum")
    result = packet.ping(port, 2)[1]
    peer.check("bad checksum", result in (sdk.COMM_RX_CORRUPT, sdk.COMM_RX_TIMEOUT), result)
    emulator.fault("silence")
    peer.check("silence", packet.ping(port, 2)[1] == sdk.COMM_RX_TIMEOUT)
    emulator.fault("none")
    peer.check("answers again", packet.ping(port, 2)[1] == OK)
    peer.check("factory reset", packet.factoryReset(port, 3, 0x02)[0] == OK)
    time.sleep(0.5)
    peer.check("the return delay has its factory value", packet.read1ByteTxRx(port, 3, 9)[0] == 250)


def official(nima):
    peer = Peer("dynamixel-sdk")
    with Emulator(nima, "dynamixel") as emulator:
        port, packet = sdk.PortHandler(emulator.endpoint), sdk.PacketHandler(2.0)
        peer.check("open", port.openPort() and port.setBaudRate(BAUD))
        singles(peer, port, packet)
        refusals(peer, port, packet)
        groups(peer, port, packet)
        motion(peer, port, packet)
        faults(peer, port, packet, emulator)
        peer.check("another speed", port.setBaudRate(57_600))
        peer.check("is not understood", packet.ping(port, 1)[1] == sdk.COMM_RX_TIMEOUT)
        port.closePort()
    return peer


def easy_sdk(nima):
    peer = Peer("dynamixel_easy_sdk")
    with Emulator(nima, "dynamixel", "--set", "model=1200") as emulator:
        bus = easy.Connector(emulator.endpoint, BAUD)
        motors = bus.createAllMotors()
        peer.check("all motors", [motor.id for motor in motors] == [1, 2, 3, 4])
        motor = bus.createMotor(2)
        peer.check("model number", motor.model_number == 1200, motor.model_number)
        peer.check("current limit", motor.getCurrentLimit() == 1750, motor.getCurrentLimit())
        motor.setOperatingMode(easy_mode().EXTENDED_POSITION)
        motor.setPositionPGain(500)
        motor.enableTorque()
        motor.setGoalPosition(5000)
        time.sleep(2.0)
        # Proportional alone: the load of the swaying hand leaves it about 22 short.
        peer.near("goal reached", motor.getPresentPosition(), 5000, 40)
        try:
            motor.connector.write1ByteData(2, 11, 3)
            peer.check("EEPROM while the torque is on", False)
        except DxlRuntimeError:
            peer.check("EEPROM while the torque is on", True)
        motor.disableTorque()
        peer.check("torque off", motor.isTorqueOn() == 0)
    return peer


def easy_mode():
    from dynamixel_easy_sdk.data_types import OperatingMode

    return OperatingMode


def run(nima):
    return [official(nima), easy_sdk(nima)]
