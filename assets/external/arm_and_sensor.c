/* A simulated arm, and a force sensor at its tip that a hand pushes and releases.
 *
 *   cc -O2 -o arm_and_sensor arm_and_sensor.c -lm && ./arm_and_sensor 127.0.0.1 47201 47202 [SECONDS [ANGLES]]
 *
 * The first port is for the arm, the second for the sensor. ANGLES are the initial joint angles, rad. For an arm of six
 * joints, compile with -DNIMA_JOINTS=6. The joints follow their commands with a bandwidth of 10 Hz, and brake while NIMA
 * Console is silent. At the end, or after Ctrl-C, the program prints its counters as lines of JSON. */
#define _POSIX_C_SOURCE 200809L
#include "nima_device.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>

static volatile sig_atomic_t ends;

static void end(int signal) {
    (void)signal;
    ends = 1;
}

static void wait_until(uint64_t at_us) {
    const uint64_t now_us = nima_now_us();
    if (at_us <= now_us) return;
    const struct timespec rest = {(time_t)((at_us - now_us) / 1000000u), (long)((at_us - now_us) % 1000000u) * 1000};
    nanosleep(&rest, NULL);
}

static void tell(const char *name, const nima_device *device) {
    printf("{\"device\":\"%s\",\"sent\":%llu,\"taken\":%llu,\"stale\":%llu,\"damaged\":%llu,\"silences\":%llu}\n", name,
           (unsigned long long)device->sent, (unsigned long long)device->taken, (unsigned long long)device->stale,
           (unsigned long long)device->damaged, (unsigned long long)device->silences);
}

int main(int count, char **words) {
    /* Angles with the instrument in its trocar, for the rig in docs/external-device.md. */
    static const double gen3_rad[7] = {2.38, -1.34, -1.37, 1.91, -1.28, 1.68, 0.92};
    double joint_rad[NIMA_JOINTS];
    const double share = 1.0 - exp(-6.283 * 10.0 * 1e-3);
    nima_device arm, sensor;
    for (int joint = 0; joint < NIMA_JOINTS; joint++)
        joint_rad[joint] = count == 5 + NIMA_JOINTS ? atof(words[5 + joint]) : gen3_rad[joint];
    if (count < 4 || (count > 5 && count != 5 + NIMA_JOINTS) || nima_device_open(&arm, NIMA_ARM, words[1], (uint16_t)atoi(words[2]), "simulated arm", "A-1") ||
        nima_device_open(&sensor, NIMA_SENSOR, words[1], (uint16_t)atoi(words[3]), "pushed sensor", "S-1")) {
        fprintf(stderr, "usage: %s ADDRESS ARM-PORT SENSOR-PORT [SECONDS [%d ANGLES]]\n", words[0], NIMA_JOINTS);
        return 2;
    }
    const double seconds = count > 4 ? atof(words[4]) : INFINITY;
    signal(SIGINT, end);
    signal(SIGTERM, end);
    const uint64_t begin_us = nima_now_us();
    uint64_t due_us = begin_us;
    nima_command command = {0}, answer;
    while (!ends && (double)(nima_now_us() - begin_us) * 1e-6 < seconds) {
        const double t_s = (double)(nima_now_us() - begin_us) * 1e-6;
        nima_reading of_arm = {0}, of_sensor = {0};
        for (int joint = 0; joint < NIMA_JOINTS; joint++) {
            /* Off: the joints hold their positions. */
            const double way_rad = command.on ? (command.target_rad[joint] - joint_rad[joint]) * share : 0.0;
            joint_rad[joint] += way_rad;
            of_arm.joint_rad[joint] = joint_rad[joint];
            of_arm.joint_rad_s[joint] = way_rad * 1e3;
        }
        of_arm.status = command.on ? NIMA_ON : 0;
        nima_device_exchange(&arm, &of_arm, &command);
        of_sensor.force_n[2] = 1.0 + 0.5 * sin(3.0 * t_s);
        of_sensor.temperature_c = 25.0;
        nima_device_exchange(&sensor, &of_sensor, &answer);
        for (due_us += 1000; due_us <= nima_now_us();) due_us += 1000;
        wait_until(due_us);
    }
    tell("arm", &arm);
    tell("sensor", &sensor);
    nima_device_close(&arm);
    nima_device_close(&sensor);
    return 0;
}
