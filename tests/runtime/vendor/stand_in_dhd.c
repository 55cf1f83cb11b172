/* A library of our own with the names of Force Dimension's functions: one device that
 * a force pushes, with a watchdog; its stand_in_ functions are for the tests. */
#define _GNU_SOURCE
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

int64_t stand_in_watchdog_ns = 0; /* 0: off */
int stand_in_has_device = 1;
int stand_in_has_watchdog = 1;
int stand_in_fails = 0; /* every exchange */
int stand_in_enabled = 0;
int stand_in_open = 0;
int stand_in_has_wrist = 0;
int stand_in_calibrated = 1;
double stand_in_frame[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

static double force_n[3], position_m[3];
static int64_t pushed_ns;
static const char* error = "no error";

static int64_t now_ns(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

/* [N] that the motors give now, in the library's axes. */
void stand_in_force(double* f) {
  const int gone = stand_in_watchdog_ns > 0 && now_ns() - pushed_ns > stand_in_watchdog_ns;
  for (int i = 0; i < 3; ++i) {
    f[i] = stand_in_enabled && stand_in_open && !gone ? force_n[i] : 0.0;
  }
}

static int failed(void) {
  error = "communication error";
  return stand_in_fails ? -1 : 0;
}

int dhdOpen(void) {
  error = "no device found";
  stand_in_open = stand_in_has_device;
  return stand_in_has_device ? 0 : -1;
}
int dhdOpenID(char index) {
  return index == 0 ? dhdOpen() : (error = "no such device", -1);
}
int dhdClose(char id) {
  (void)id;
  stand_in_open = 0;
  return 0;
}
int dhdGetPosition(double* x, double* y, double* z, char id) {
  (void)id;
  *x = position_m[0];
  *y = position_m[1];
  *z = position_m[2];
  return failed();
}
int dhdSetForce(double x, double y, double z, char id) {
  const double f[3] = {x, y, z};
  (void)id;
  pushed_ns = now_ns();
  for (int i = 0; i < 3; ++i) {
    force_n[i] = f[i];
    position_m[i] += 1e-5 * f[i];
  }
  return failed();
}
int dhdEnableForce(unsigned char on, char id) {
  (void)id;
  stand_in_enabled = on;
  return 0;
}
int dhdSetWatchdog(unsigned char steps, char id) {
  (void)id;
  error = "function not available";
  stand_in_watchdog_ns = stand_in_has_watchdog ? steps * (int64_t)125000 : 0;
  return stand_in_has_watchdog ? 0 : -1;
}
bool drdIsInitialized(char id) {
  (void)id;
  return stand_in_calibrated != 0;
}
bool dhdHasWrist(char id) {
  (void)id;
  return stand_in_has_wrist != 0;
}
int dhdGetOrientationFrame(double matrix[3][3], char id) {
  (void)id;
  memcpy(matrix, stand_in_frame, sizeof stand_in_frame);
  return failed();
}
const char* dhdErrorGetLastStr(void) { return error; }
