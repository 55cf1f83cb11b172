/* Pinches a body between two tools that feel each other through it, and prints the
 * force of each.
 *   pinch DATABASE THUMB FINGER X Y Z APART   (metres; down the z axis to Z, APART from
 *                                              each other along x) */
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char** argv) {
  char error[512];
  double at[6], forces[6] = {0}, torques[6];
  palpate_options options = {0};
  palpate_body* body;
  palpate_tool* both = NULL;
  int i, hand, status = 0;
  if (argc != 8) {
    fprintf(stderr, "usage: pinch DATABASE THUMB FINGER X Y Z APART\n");
    return 2;
  }
  options.struct_size = sizeof options;
  options.flags = PALPATE_OWN_SLOW_STEPS;
  options.tool_name = argv[2];
  body = palpate_open(argv[1], &options, error, sizeof error);
  if (body != NULL) {
    both = palpate_together_open(body, argv[3], error, sizeof error);
  }
  if (both == NULL) {
    fprintf(stderr, "pinch: %s\n", error);
    palpate_close(body);
    return 1;
  }
  for (i = 0; i <= 1000 && status >= 0; ++i) {
    for (hand = 0; hand < 2; ++hand) {
      at[3 * hand] = atof(argv[4]) + (hand - 0.5) * atof(argv[7]);
      at[3 * hand + 1] = atof(argv[5]);
      at[3 * hand + 2] = atof(argv[6]) + 0.01 * (1000 - i) / 1000.0; /* from above */
    }
    status = palpate_together(both, at, NULL, 0.001, forces, torques);
    if (i % 10 == 0 && palpate_slow_step(body) < 0) {
      palpate_close(body);
      return 1;
    }
  }
  printf("%s %.17g %.17g %.17g %.17g %.17g %.17g\n", palpate_fault_name(status),
         forces[0], forces[1], forces[2], forces[3], forces[4], forces[5]);
  palpate_close(body);
  return status < 0;
}
