/* Presses a body at one place and prints what it answers.
 *   minimal DATABASE X Y Z RADIUS DEPTH   (metres; down the z axis) */
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char** argv) {
  char error[256];
  double position[3], force[3];
  palpate_options options = {0};
  palpate_body* body;
  palpate_tool* tool;
  int i, status = 0;
  if (argc != 7) {
    fprintf(stderr, "usage: minimal DATABASE X Y Z RADIUS DEPTH\n");
    return 2;
  }
  options.struct_size = sizeof options;
  options.flags = PALPATE_OWN_SLOW_STEPS;
  body = palpate_open(argv[1], &options, error, sizeof error);
  if (body == NULL) {
    fprintf(stderr, "minimal: %s\n", error);
    return 1;
  }
  tool = palpate_tool_add(body);
  for (i = 0; i <= 1000 && status >= 0; ++i) {
    const double depth = atof(argv[6]) * (i - 100) / 900.0; /* from above */
    position[0] = atof(argv[2]);
    position[1] = atof(argv[3]);
    position[2] = atof(argv[4]) + atof(argv[5]) - depth;
    status = palpate_force(tool, position, NULL, 0.001, force);
    if (i % 10 == 0 && palpate_slow_step(body) < 0) {
      return 1;
    }
  }
  printf("%s %.17g %.17g %.17g\n", palpate_fault_name(status), force[0], force[1],
         force[2]);
  palpate_close(body);
  return status < 0;
}
