/* Connects your own handle, arm or force sensor to NIMA Console: one datagram in each direction per period (protocol 1).
 *
 *   nima_device device;
 *   if (nima_device_open(&device, NIMA_HANDLE, "127.0.0.1", 47200, "my handle", "1") != 0) return 1;
 *   for (;;) {                                  // about 1000 times a second
 *       nima_reading reading = {0};             // enter your device's measurements, SI units
 *       nima_command command;
 *       nima_device_exchange(&device, &reading, &command);
 *       // execute `command`; it is off and zero while NIMA Console is silent
 *   }
 *
 * All functions are `static inline`, allocate no memory and never wait. POSIX or Windows (link with ws2_32). C99 and C++.
 * Wire format and rules: docs/external-device.md. Licence: MIT OR Apache-2.0. Research use only. */
#ifndef NIMA_DEVICE_H
#define NIMA_DEVICE_H

#include <stdint.h>
#include <string.h>
#include <time.h>
#ifdef _WIN32
#include <winsock2.h>
#include <ws2tcpip.h>
#else
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>
#endif

/* Kinds of devices. */
enum { NIMA_HANDLE = 1, NIMA_ARM = 2, NIMA_SENSOR = 3 };

/* Bits of `status`. */
enum {
    NIMA_ON = 1, /* the force is on, or the arm follows `target_rad`; set it only while that is true */
    NIMA_FAULT = 1 << 1, /* your device has a fault; put its code into `fault` */
    NIMA_THROTTLED = 1 << 2, NIMA_OVERRANGE = 1 << 3, NIMA_INVALID = 1 << 4, NIMA_RAW = 1 << 5, /* sensor */
    NIMA_HAS_ORIENTATION = 1 << 8, NIMA_HAS_VELOCITY = 1 << 9, NIMA_HAS_GRIPPER = 1 << 10, /* handle */
    NIMA_HAS_ACCELERATION = 1 << 11, NIMA_HAS_ANGULAR_VELOCITY = 1 << 12 /* sensor */
};

/* For an arm of six joints: compile with -DNIMA_JOINTS=6. */
#ifndef NIMA_JOINTS
#define NIMA_JOINTS 7
#endif
#define NIMA_BYTES_MAX 260
/* The device switches off after this time without a command. NIMA Console refuses a handle or an arm whose time exceeds
 * the limit in the rig file (20 ms). */
#define NIMA_WATCHDOG_US 20000u

/* Measurements of your device, in its own frame; only the fields of its kind are sent. */
typedef struct {
    uint16_t status, fault;
    uint32_t buttons;
    double position_m[3], orientation_wxyz[4], velocity_m_s[3], gripper_rad;       /* handle */
    double joint_rad[NIMA_JOINTS], joint_rad_s[NIMA_JOINTS], joint_nm[NIMA_JOINTS]; /* arm: continuous angles */
    double force_n[3], torque_nm[3], acceleration_m_s2[3], angular_velocity_rad_s[3], temperature_c; /* sensor */
} nima_reading;

/* Command to your device. All zero unless `on`. */
typedef struct {
    int heard; /* the newest command of NIMA Console arrived within the watchdog's time */
    int on;    /* switch the force on, or follow `target_rad`; otherwise: no force, hold or brake */
    double force_n[3], gripper_n;   /* handle: on the hand, in the frame of the readings */
    double target_rad[NIMA_JOINTS]; /* arm */
    double round_trip_s;            /* from our datagram to the answer that acknowledges it; < 0 if unknown */
} nima_command;

typedef struct {
#ifdef _WIN32
    SOCKET socket;
#else
    int socket;
#endif
    int kind;
    uint32_t session, sequence, peer_sequence;
    uint64_t peer_us, heard_us, watchdog_us; /* newest command: time stamp, arrival, time limit */
    nima_command command;
    char product[24], serial[16];
    /* Numbers of datagrams sent, commands accepted, outdated or repeated commands, damaged datagrams, and silences. */
    uint64_t sent, taken, stale, damaged, silences;
} nima_device;

/* Time of a clock that is never set, us; never 0. */
static inline uint64_t nima_now_us(void) {
#ifdef _WIN32
    LARGE_INTEGER count, rate;
    QueryPerformanceCounter(&count);
    QueryPerformanceFrequency(&rate);
    return (uint64_t)((double)count.QuadPart * 1e6 / (double)rate.QuadPart) + 1;
#else
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u + 1;
#endif
}

static inline uint32_t nima_crc32(const uint8_t *bytes, size_t count) {
    static const uint32_t table[16] = {
        0x00000000, 0x1db71064, 0x3b6e20c8, 0x26d930ac, 0x76dc4190, 0x6b6b51f4, 0x4db26158, 0x5005713c,
        0xedb88320, 0xf00f9344, 0xd6d6a3e8, 0xcb61b38c, 0x9b64c2b0, 0x86d3d2d4, 0xa00ae278, 0xbdbdf21c};
    uint32_t crc = 0xffffffffu;
    for (size_t i = 0; i < count; i++) {
        crc = table[(crc ^ bytes[i]) & 15] ^ (crc >> 4);
        crc = table[(crc ^ (bytes[i] >> 4)) & 15] ^ (crc >> 4);
    }
    return ~crc;
}

static inline void nima_put(uint8_t **at, uint64_t value, int bytes) {
    for (int i = 0; i < bytes; i++) *(*at)++ = (uint8_t)(value >> (8 * i));
}

static inline void nima_put_numbers(uint8_t **at, const double *numbers, int count) {
    for (int i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, &numbers[i], 8);
        nima_put(at, bits, 8);
    }
}

static inline uint64_t nima_take(const uint8_t *at, int bytes) {
    uint64_t value = 0;
    for (int i = 0; i < bytes; i++) value |= (uint64_t)at[i] << (8 * i);
    return value;
}

static inline double nima_take_number(const uint8_t *at) {
    uint64_t bits = nima_take(at, 8);
    double number;
    memcpy(&number, &bits, 8);
    return number;
}

/* Opens a device of this kind; NIMA Console is at this IPv4 address and port. Returns 0, or -1 on failure. */
static inline int nima_device_open(nima_device *device, int kind, const char *address, uint16_t port,
                                   const char *product, const char *serial) {
    struct sockaddr_in to;
    memset(device, 0, sizeof *device);
    memset(&to, 0, sizeof to);
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    if (kind < NIMA_HANDLE || kind > NIMA_SENSOR || inet_pton(AF_INET, address, &to.sin_addr) != 1) return -1;
#ifdef _WIN32
    WSADATA data;
    u_long nonblocking = 1;
    if (WSAStartup(MAKEWORD(2, 2), &data) != 0) return -1;
    device->socket = socket(AF_INET, SOCK_DGRAM, 0);
    if (device->socket == INVALID_SOCKET) return -1;
    ioctlsocket(device->socket, FIONBIO, &nonblocking);
#else
    device->socket = socket(AF_INET, SOCK_DGRAM, 0);
    if (device->socket < 0) return -1;
    fcntl(device->socket, F_SETFL, O_NONBLOCK);
#endif
    /* From now on, only datagrams from this address are received. */
    if (connect(device->socket, (struct sockaddr *)&to, sizeof to) != 0) return -1;
    device->kind = kind;
    device->watchdog_us = NIMA_WATCHDOG_US;
    device->session = (uint32_t)(nima_now_us() * 2654435761u) ^ (uint32_t)time(NULL) ^ (uint32_t)(uintptr_t)device;
    strncpy(device->product, product ? product : "", sizeof device->product - 1);
    strncpy(device->serial, serial ? serial : "", sizeof device->serial - 1);
    return 0;
}

static inline void nima_device_close(nima_device *device) {
#ifdef _WIN32
    closesocket(device->socket);
#else
    close(device->socket);
#endif
}

static inline void nima_device_send(nima_device *device, const nima_reading *reading) {
    uint8_t wire[NIMA_BYTES_MAX], *at = wire;
    const int numbers = device->kind == NIMA_HANDLE ? 11 : device->kind == NIMA_ARM ? 3 * NIMA_JOINTS : 13;
    memcpy(at, "NIMX", 4);
    at += 4;
    nima_put(&at, 1, 1);
    nima_put(&at, (uint64_t)device->kind, 1);
    nima_put(&at, (uint64_t)(40 + 8 * numbers), 2);
    nima_put(&at, device->session, 4);
    nima_put(&at, ++device->sequence, 4);
    nima_put(&at, nima_now_us(), 8);
    nima_put(&at, device->peer_us, 8);
    nima_put(&at, NIMA_WATCHDOG_US, 4);
    nima_put(&at, reading->status, 2);
    nima_put(&at, reading->fault, 2);
    nima_put(&at, reading->buttons, 4);
    nima_put(&at, 0, 4);
    memcpy(at, device->product, 24);
    memcpy(at + 24, device->serial, 16);
    at += 40;
    if (device->kind == NIMA_HANDLE) {
        nima_put_numbers(&at, reading->position_m, 3);
        nima_put_numbers(&at, reading->orientation_wxyz, 4);
        nima_put_numbers(&at, reading->velocity_m_s, 3);
        nima_put_numbers(&at, &reading->gripper_rad, 1);
    } else if (device->kind == NIMA_ARM) {
        nima_put_numbers(&at, reading->joint_rad, NIMA_JOINTS);
        nima_put_numbers(&at, reading->joint_rad_s, NIMA_JOINTS);
        nima_put_numbers(&at, reading->joint_nm, NIMA_JOINTS);
    } else {
        nima_put_numbers(&at, reading->force_n, 3);
        nima_put_numbers(&at, reading->torque_nm, 3);
        nima_put_numbers(&at, reading->acceleration_m_s2, 3);
        nima_put_numbers(&at, reading->angular_velocity_rad_s, 3);
        nima_put_numbers(&at, &reading->temperature_c, 1);
    }
    nima_put(&at, nima_crc32(wire, (size_t)(at - wire)), 4);
    /* If no program receives yet, the datagram is lost, and the next one tries again. */
    if (send(device->socket, (const char *)wire, (size_t)(at - wire), 0) > 0) device->sent++;
}

/* Parses one command; returns 0 if the bytes are not a valid, new command. */
static inline int nima_device_take(nima_device *device, const uint8_t *wire, size_t count, uint64_t now_us) {
    const int numbers = device->kind == NIMA_HANDLE ? 4 : device->kind == NIMA_ARM ? NIMA_JOINTS : 0;
    const size_t body = 48 + 8 * (size_t)numbers;
    if (count != body + 4 || memcmp(wire, "NIMX", 4) != 0 || wire[4] != 1 || wire[5] != (0x80 | device->kind) ||
        nima_crc32(wire, body) != nima_take(wire + body, 4)) {
        device->damaged++;
        return 0;
    }
    const uint32_t ahead = (uint32_t)nima_take(wire + 12, 4) - device->peer_sequence;
    const uint64_t echo_us = nima_take(wire + 24, 8);
    /* Refuse commands for another program, repeated or reordered commands, and answers to an outdated reading. */
    if (nima_take(wire + 8, 4) != device->session || (device->command.heard && (ahead == 0 || ahead > 0x7fffffffu)) ||
        echo_us + device->watchdog_us < now_us) {
        device->stale++;
        return 0;
    }
    device->peer_sequence = (uint32_t)nima_take(wire + 12, 4);
    device->peer_us = nima_take(wire + 16, 8);
    device->heard_us = now_us;
    const uint64_t watchdog_us = nima_take(wire + 32, 4);
    device->watchdog_us = watchdog_us > 0 && watchdog_us < NIMA_WATCHDOG_US ? watchdog_us : NIMA_WATCHDOG_US;
    memset(&device->command, 0, sizeof device->command);
    device->command.heard = 1;
    device->command.on = (int)nima_take(wire + 36, 2) & NIMA_ON;
    device->command.round_trip_s = (double)(now_us - echo_us) * 1e-6;
    for (int i = 0; i < numbers && device->command.on; i++) {
        const double number = nima_take_number(wire + 48 + 8 * i);
        if (device->kind == NIMA_ARM) device->command.target_rad[i] = number;
        else if (i < 3) device->command.force_n[i] = number;
        else device->command.gripper_n = number;
    }
    device->taken++;
    return 1;
}

/* Reads the received commands, then sends this reading. `command` is the newest command; it is off and zero once it is
 * older than the watchdog's time. Returns whether NIMA Console sends commands. */
static inline int nima_device_exchange(nima_device *device, const nima_reading *reading, nima_command *command) {
    uint8_t wire[NIMA_BYTES_MAX];
    const uint64_t now_us = nima_now_us();
    for (int reads = 0; reads < 64; reads++) {
        const long count = (long)recv(device->socket, (char *)wire, sizeof wire, 0);
        if (count <= 0) break;
        nima_device_take(device, wire, (size_t)count, now_us);
    }
    if (device->command.heard && now_us - device->heard_us > device->watchdog_us) {
        device->silences++;
        device->peer_us = 0;
        memset(&device->command, 0, sizeof device->command);
        device->command.round_trip_s = -1.0;
    }
    *command = device->command;
    nima_device_send(device, reading);
    return command->heard;
}

#endif
