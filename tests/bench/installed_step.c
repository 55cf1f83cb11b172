/* installed_step DATABASE POSITIONS: the C interface along a trajectory (n x 3 doubles
 * [m], 2 kHz), a slow step every 20 ticks. Prints ticks, ticks in contact, and the
 * median and 99th percentile of palpate_force() in contact [ns]. */
#define _POSIX_C_SOURCE 199309L
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return 1e9 * (double)now.tv_sec + (double)now.tv_nsec;
}

static int by_value(const void* a, const void* b) {
  const double left = *(const double*)a;
  const double right = *(const double*)b;
  return (left > right) - (left < right);
}

int main(int argc, char** argv) {
  char error[512];
  palpate_options options = {0};
  options.struct_size = sizeof options;
  options.flags = PALPATE_OWN_SLOW_STEPS;
  palpate_body* body =
      argc == 3 ? palpate_open(argv[1], &options, error, sizeof error) : NULL;
  FILE* file = argc == 3 ? fopen(argv[2], "rb") : NULL;
  if (body == NULL || file == NULL) {
    fprintf(stderr, "installed_step: %s\n",
            body == NULL && argc == 3 ? error
                                      : "usage: "
                                        "installed_step DATABASE POSITIONS");
    return 2;
  }
  palpate_tool* tool = palpate_tool_add(body);
  enum { kMost = 1000000 };
  double* cost = malloc(kMost * sizeof *cost);
  int ticks = 0;
  int contacts = 0;
  double position[3];
  while (ticks < kMost && fread(position, sizeof position, 1, file) == 1) {
    if (ticks++ % 20 == 0) {
      palpate_slow_step(body);
    }
    double force[3];
    const double begin = now_ns();
    const int status = palpate_force(tool, position, NULL, 0.0005, force);
    const double took = now_ns() - begin;
    if (status < 0) {
      fprintf(stderr, "installed_step: %s\n", palpate_fault_name(status));
      return 1;
    }
    if (status == PALPATE_CONTACT) {
      cost[contacts++] = took;
    }
  }
  qsort(cost, (size_t)contacts, sizeof *cost, by_value);
  if (contacts > 0) {
    printf("%d %d %.0f %.0f\n", ticks, contacts, cost[contacts / 2],
           cost[contacts - 1 - contacts / 100]);
  }
  free(cost);
  fclose(file);
  palpate_close(body);
  return contacts > 0 ? 0 : 1;
}
