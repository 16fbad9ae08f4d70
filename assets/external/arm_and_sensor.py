"""A simulated arm, and a force sensor at its tip that a hand pushes and releases.

    python3 arm_and_sensor.py 127.0.0.1 47201 47202 [SECONDS [ANGLES]]

The first port is for the arm, the second for the sensor. ANGLES are the initial joint angles, rad. The joints follow
their commands with a bandwidth of 10 Hz, and hold while NIMA Console is silent. At the end, or after Ctrl-C, the program
prints its counters as lines of JSON.
"""

import json
import math
import signal
import sys

from nima_device import ARM, SENSOR, Device, arm, every, sensor

PERIOD_S = 1e-3
# Angles with the instrument in its trocar, for the rig in docs/external-device.md.
START_RAD = (2.38, -1.34, -1.37, 1.91, -1.28, 1.68, 0.92)


def main(address, arm_port, sensor_port, seconds="inf", *angles):
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    start_rad = [float(angle) for angle in angles] or START_RAD
    the_arm = Device(ARM, address, int(arm_port), product="simulated arm", serial="A-1", joints=len(start_rad))
    the_sensor = Device(SENSOR, address, int(sensor_port), product="pushed sensor", serial="S-1")
    joint_rad, command, last_s = list(start_rad), None, 0.0
    try:
        for t_s in every(PERIOD_S, float(seconds)):
            step_s, last_s = max(t_s - last_s, 1e-6), t_s
            share = 1.0 - math.exp(-math.tau * 10.0 * step_s)
            speed_rad_s = [0.0] * len(joint_rad)
            if command and command.on:
                for joint, target_rad in enumerate(command.target_rad):
                    way_rad = (target_rad - joint_rad[joint]) * share
                    joint_rad[joint] += way_rad
                    speed_rad_s[joint] = way_rad / step_s
            command = the_arm.exchange(arm(joint_rad, joint_rad_s=speed_rad_s, on=bool(command and command.on)))
            the_sensor.exchange(sensor((0.0, 0.0, 1.0 + 0.5 * math.sin(3.0 * t_s))))
    except KeyboardInterrupt:
        pass
    for name, device in (("arm", the_arm), ("sensor", the_sensor)):
        counters = {name: getattr(device, name) for name in ("sent", "taken", "stale", "damaged", "silences")}
        print(json.dumps({"device": name, **counters}))
        device.close()


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(f"usage: {sys.argv[0]} ADDRESS ARM-PORT SENSOR-PORT [SECONDS [ANGLES]]")
    main(*sys.argv[1:])
