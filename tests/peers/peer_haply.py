"""The manufacturer's own client (`HaplyHardwareAPI`) against our emulated Inverse3: identity, forces, positions, velocities.

The emulated grip goes round a circle about the middle of the workspace and gives way by 1/300 m per newton.
"""

import math

import HaplyHardwareAPI

from harness import Emulator, Peer

CENTRE_M, RADIUS_M, RATE_RAD_S, SPRING_N_M = (0.0186, -0.153, 0.151), 0.01, 1.9, 300.0


def run(nima):
    peer = Peer("HaplyHardwareAPI")
    with Emulator(nima, "haply", "--set", "id=0A1B", "--set", "model=5", "--set", "firmware=7") as emulator:
        # The client does not keep its stream: it must live as long as the device.
        stream = HaplyHardwareAPI.SerialStream(emulator.endpoint)
        device = HaplyHardwareAPI.Inverse3(stream)
        identity = device.device_wakeup_dict()
        peer.check("device id", int(identity["device_id"]) == 0x0A1B, identity)
        for force in ([0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [0.0, -2.0, 3.0]):
            # The answer depends on the force of the same request.
            for _ in range(100):
                position, velocity = device.end_effector_force(force)
                offset = [p - c - f / SPRING_N_M for p, c, f in zip(position, CENTRE_M, force)]
                peer.near("radius", math.hypot(offset[0], offset[1]), RADIUS_M, 1e-5)
                peer.near("height", offset[2], 0.0, 1e-5)
                peer.near("speed", math.hypot(velocity[0], velocity[1]), RADIUS_M * RATE_RAD_S, 1e-5)
                across = offset[0] * velocity[0] + offset[1] * velocity[1]
                peer.near("motion along the circle", across / (RADIUS_M * RADIUS_M * RATE_RAD_S), 0.0, 0.01)
        # Left without a force.
        device.end_effector_force([0.0, 0.0, 0.0])
    return [peer]
