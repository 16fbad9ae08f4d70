/* A simulated haptic handle: a spring moves a hand of 0.3 kg along a circle, and the hand feels the force of NIMA Console.
 *
 *   cc -O2 -o handle handle.c -lm && ./handle 127.0.0.1 47200 [SECONDS]
 *
 * For a real handle, replace the lines between the two marks. At the end, or after Ctrl-C, the program prints its
 * counters as one line of JSON. */
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

int main(int count, char **words) {
    const double period_s = 1e-3, mass_kg = 0.3, spring_n_m = 300.0, damping_ns_m = 10.0;
    double at_m[3] = {0}, speed_m_s[3] = {0}, largest_n = 0.0, round_trip_s = 0.0, longest_s = 0.0;
    nima_device device;
    if (count < 3 || nima_device_open(&device, NIMA_HANDLE, words[1], (uint16_t)atoi(words[2]), "spring hand", "H-1")) {
        fprintf(stderr, "usage: %s ADDRESS PORT [SECONDS]\n", words[0]);
        return 2;
    }
    const double seconds = count > 3 ? atof(words[3]) : INFINITY;
    signal(SIGINT, end);
    signal(SIGTERM, end);
    const uint64_t begin_us = nima_now_us();
    uint64_t due_us = begin_us, with_force = 0, missed = 0;
    nima_command command = {0};
    while (!ends && (double)(nima_now_us() - begin_us) * 1e-6 < seconds) {
        nima_reading reading = {0};
        /* ---- your device: measure, and apply the force of the newest command ---- */
        const double t_s = (double)(nima_now_us() - begin_us) * 1e-6;
        const double goal_m[3] = {0.01 * cos(1.9 * t_s), 0.01 * sin(1.9 * t_s), 0.0};
        for (int i = 0; i < 3; i++) {
            const double force_n =
                command.force_n[i] + spring_n_m * (goal_m[i] - at_m[i]) - damping_ns_m * speed_m_s[i];
            speed_m_s[i] += force_n / mass_kg * period_s;
            at_m[i] += speed_m_s[i] * period_s;
            reading.position_m[i] = at_m[i];
            reading.velocity_m_s[i] = speed_m_s[i];
        }
        reading.status = (uint16_t)(NIMA_HAS_VELOCITY | (command.on ? NIMA_ON : 0));
        /* ---- */
        if (nima_device_exchange(&device, &reading, &command)) {
            round_trip_s += command.round_trip_s;
            if (command.round_trip_s > longest_s) longest_s = command.round_trip_s;
        }
        const double felt_n = sqrt(command.force_n[0] * command.force_n[0] + command.force_n[1] * command.force_n[1] +
                                   command.force_n[2] * command.force_n[2]);
        with_force += felt_n > 0.0;
        if (felt_n > largest_n) largest_n = felt_n;
        for (due_us += 1000; due_us <= nima_now_us(); due_us += 1000) missed++;
        wait_until(due_us);
    }
    printf("{\"device\":\"handle\",\"sent\":%llu,\"taken\":%llu,\"stale\":%llu,\"damaged\":%llu,\"silences\":%llu,"
           "\"missed\":%llu,\"with_force\":%llu,\"largest_n\":%.3f,\"round_trip_ms\":%.3f,\"longest_ms\":%.3f}\n",
           (unsigned long long)device.sent, (unsigned long long)device.taken, (unsigned long long)device.stale,
           (unsigned long long)device.damaged, (unsigned long long)device.silences, (unsigned long long)missed,
           (unsigned long long)with_force, largest_n,
           device.taken ? round_trip_s / (double)device.taken * 1e3 : -1.0, longest_s * 1e3);
    nima_device_close(&device);
    return 0;
}
