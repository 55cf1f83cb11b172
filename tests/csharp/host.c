/* What the C# files are compared with, through the same library.
 *   host path DATABASE TOOL    each tick's status and the bits of force and torque
 *   host speed DATABASE STEPS  nanoseconds of a palpate_step() in contact */
#define _POSIX_C_SOURCE 199309L
#include <inttypes.h>
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static palpate_pose pose_at(int tick) {
  palpate_pose pose = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 1.0}};
  pose.position[0] = 0.0031 + 1e-6 * tick;
  pose.position[1] = 0.0017;
  pose.position[2] = 0.0055 - 3e-6 * (tick < 1000 ? tick : 2000 - tick);
  pose.quat_xyzw[1] = 1e-5 * tick;
  return pose;
}

static void print_path(palpate_body* body, palpate_tool* tool) {
  int tick, i;
  for (tick = 0; tick < 2000; ++tick) {
    const palpate_pose pose = pose_at(tick);
    palpate_hand_wrench wrench;
    double made[6];
    if (tick % 10 == 0) palpate_slow_step(body);
    printf("%d", palpate_step(tool, &pose, 1, 0.001, &wrench));
    memcpy(made, wrench.force, sizeof wrench.force);
    memcpy(made + 3, wrench.torque, sizeof wrench.torque);
    for (i = 0; i < 6; ++i) {
      uint64_t bits;
      memcpy(&bits, made + i, sizeof bits);
      printf(" %016" PRIx64, bits);
    }
    printf("\n");
  }
}

static void print_speed(palpate_body* body, palpate_tool* tool, int steps) {
  struct timespec from, to;
  palpate_hand_wrench wrench;
  palpate_pose pose = pose_at(1000);
  int tick;
  for (tick = 0; tick < 2000; ++tick) {
    pose = pose_at(tick < 1000 ? tick : 1000);
    if (tick % 10 == 0) palpate_slow_step(body);
    palpate_step(tool, &pose, 1, 0.001, &wrench);
  }
  clock_gettime(CLOCK_MONOTONIC, &from);
  for (tick = 0; tick < steps; ++tick) {
    pose.position[0] += tick % 2 == 0 ? 1e-6 : -1e-6;
    palpate_step(tool, &pose, 1, 0.001, &wrench);
  }
  clock_gettime(CLOCK_MONOTONIC, &to);
  printf("%.1f\n", (1e9 * (double)(to.tv_sec - from.tv_sec) +
                    (double)(to.tv_nsec - from.tv_nsec)) / steps);
}

int main(int argc, char** argv) {
  char error[512];
  palpate_options options;
  palpate_body* body;
  if (argc != 4) return 2;
  palpate_options_init(&options);
  options.flags = PALPATE_OWN_SLOW_STEPS;
  if (strcmp(argv[1], "path") == 0) options.tool_name = argv[3];
  body = palpate_open(argv[2], &options, error, sizeof error);
  if (body == NULL) return fprintf(stderr, "host: %s\n", error), 1;
  if (strcmp(argv[1], "path") == 0) {
    print_path(body, palpate_tool_add(body));
  } else {
    print_speed(body, palpate_tool_add(body), atoi(argv[3]));
  }
  palpate_close(body);
  return 0;
}
