"""A simulated haptic handle: a spring moves a hand of 0.3 kg along a circle, and the hand feels the force of NIMA Console.

    python3 handle.py 127.0.0.1 47200 [SECONDS]

For a real handle, replace the lines between the two marks. At the end, or after Ctrl-C, the program prints its counters
as one line of JSON.
"""

import json
import math
import signal
import sys

from nima_device import HANDLE, Device, every, handle

PERIOD_S, MASS_KG, SPRING_N_M, DAMPING_NS_M = 1e-3, 0.3, 300.0, 10.0


def main(address, port, seconds="inf"):
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    device = Device(HANDLE, address, int(port), product="spring hand", serial="H-1")
    at_m, speed_m_s, command = [0.0] * 3, [0.0] * 3, None
    largest_n, with_force, turns, last_s = 0.0, 0, 0, 0.0
    try:
        for t_s in every(PERIOD_S, float(seconds)):
            # ---- your device: measure, and apply the force of the newest command ----
            step_s, last_s = min(t_s - last_s, 5 * PERIOD_S), t_s
            goal_m = (0.01 * math.cos(1.9 * t_s), 0.01 * math.sin(1.9 * t_s), 0.0)
            for i in range(3):
                felt_n = command.force_n[i] if command else 0.0
                force_n = felt_n + SPRING_N_M * (goal_m[i] - at_m[i]) - DAMPING_NS_M * speed_m_s[i]
                speed_m_s[i] += force_n / MASS_KG * step_s
                at_m[i] += speed_m_s[i] * step_s
            reading = handle(at_m, velocity_m_s=tuple(speed_m_s), on=bool(command and command.on))
            # ----
            command = device.exchange(reading)
            felt_n = math.hypot(*command.force_n)
            largest_n, with_force, turns = max(largest_n, felt_n), with_force + (felt_n > 0.0), turns + 1
    except KeyboardInterrupt:
        pass
    counters = {name: getattr(device, name) for name in ("sent", "taken", "stale", "damaged", "silences")}
    rate_hz = turns / last_s if last_s else 0.0
    print(json.dumps({"device": "handle", **counters, "with_force": with_force, "largest_n": largest_n, "rate_hz": rate_hz}))
    device.close()


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(f"usage: {sys.argv[0]} ADDRESS PORT [SECONDS]")
    main(*sys.argv[1:])
