/* Presses a body with a tool of several contacts, turned about the y axis, and prints
 * force and torque.
 *   wrench DATABASE TOOL X Y Z TURN   (metres, radians; down the z axis to Z) */
#include <math.h>
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char** argv) {
  char error[512];
  double position[3], quaternion[4] = {0, 0, 0, 1}, force[3], torque[3];
  palpate_options options = {0};
  palpate_body* body;
  palpate_tool* tool;
  int i, status = 0;
  if (argc != 7) {
    fprintf(stderr, "usage: wrench DATABASE TOOL X Y Z TURN\n");
    return 2;
  }
  options.struct_size = sizeof options;
  options.flags = PALPATE_OWN_SLOW_STEPS;
  options.tool_name = argv[2];
  body = palpate_open(argv[1], &options, error, sizeof error);
  if (body == NULL) {
    fprintf(stderr, "wrench: %s\n", error);
    return 1;
  }
  tool = palpate_tool_add(body);
  quaternion[1] = sin(0.5 * atof(argv[6]));
  quaternion[3] = cos(0.5 * atof(argv[6]));
  for (i = 0; i <= 1000 && status >= 0; ++i) {
    position[0] = atof(argv[3]);
    position[1] = atof(argv[4]);
    position[2] = atof(argv[5]) + 0.01 * (1000 - i) / 1000.0; /* from above */
    status = palpate_wrench(tool, position, quaternion, 0.001, force, torque);
    if (i % 10 == 0 && palpate_slow_step(body) < 0) {
      return 1;
    }
  }
  printf("%s %.17g %.17g %.17g %.17g %.17g %.17g\n", palpate_fault_name(status),
         force[0], force[1], force[2], torque[0], torque[1], torque[2]);
  palpate_close(body);
  return status < 0;
}
