/* Presses a body that stands turned in the host's world, straight down on its highest
 * vertex, and prints the force that is felt there.
 *   placed DATABASE TOOL RADIUS TURN   (metres, radians about the world's x axis) */
#include <math.h>
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char** argv) {
  char error[512];
  const double origin[3] = {0.3, 0.0, 1.0};
  double turn[4] = {0.0, 0.0, 0.0, 1.0}, *vertices, depth;
  size_t count, triangles, i, top = 0;
  palpate_options options;
  palpate_pose pose = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0}};
  palpate_hand_wrench wrench = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  palpate_body* body;
  palpate_tool* tool;
  int status = 0;
  if (argc != 5) return 2;
  palpate_options_init(&options);
  options.tool_name = argv[2];
  options.flags = PALPATE_OWN_SLOW_STEPS;
  if ((body = palpate_open(argv[1], &options, error, sizeof error)) == NULL) {
    fprintf(stderr, "placed: %s\n", error);
    return 1;
  }
  turn[0] = sin(0.5 * atof(argv[4]));
  turn[3] = cos(0.5 * atof(argv[4]));
  if (palpate_place(body, origin, turn) != 0 ||
      palpate_mesh_count(body, &count, &triangles) != 0) {
    return 1;
  }
  vertices = malloc(3 * count * sizeof *vertices); /* in the world, to be drawn */
  if (vertices == NULL || palpate_mesh_get(body, vertices, NULL) != 0) return 1;
  for (i = 1; i < count; ++i) {
    if (vertices[3 * i + 2] > vertices[3 * top + 2]) top = i;
  }
  tool = palpate_tool_add(body);
  for (i = 0; i <= 1000 && status >= 0; ++i) {
    depth = -0.005 + 0.008 * (double)i / 1000.0; /* from 5 mm above to 3 mm inside */
    pose.position[0] = vertices[3 * top];
    pose.position[1] = vertices[3 * top + 1];
    pose.position[2] = vertices[3 * top + 2] + atof(argv[3]) - depth;
    status = palpate_step(tool, &pose, 1, 0.001, &wrench);
    if (i % 10 == 0 && palpate_slow_step(body) < 0) return 1;
  }
  printf("%s %g %g %g\n", palpate_fault_name(status), wrench.force[0], wrench.force[1],
         wrench.force[2]);
  free(vertices);
  palpate_close(body);
  return status < 0;
}
