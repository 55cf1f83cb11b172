/* Presses a body while it is computed, until the place has its final answer.
 *   scene SCENE.toml OUTPUT.h5 PALPATE-PRECOMPUTE X Y Z RADIUS DEPTH
 * (metres; down the z axis) */
#define _POSIX_C_SOURCE 199309L
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

int main(int argc, char** argv) {
  static const char* const kAnswer[] = {"none", "estimated", "preliminary", "final"};
  const struct timespec tick = {0, 1000000};
  char error[256];
  double position[3], force[3];
  palpate_options options = {0};
  palpate_state state = {0};
  palpate_body* body;
  palpate_tool* tool;
  int i, answer = -1, status = 0;
  if (argc != 9) {
    fprintf(
        stderr,
        "usage: scene SCENE.toml OUTPUT.h5 PALPATE-PRECOMPUTE X Y Z RADIUS DEPTH\n");
    return 2;
  }
  options.struct_size = sizeof options;
  options.flags = PALPATE_SCENE | PALPATE_ESTIMATE;
  options.output = argv[2];
  options.server = argv[3];
  body = palpate_open(argv[1], &options, error, sizeof error);
  if (body == NULL) {
    fprintf(stderr, "scene: %s\n", error);
    return 1;
  }
  state.struct_size = sizeof state;
  tool = palpate_tool_add(body);
  position[0] = atof(argv[4]);
  position[1] = atof(argv[5]);
  for (i = 0; i < 60000 && status >= 0; ++i) { /* a press of 0.5 s each second */
    const double depth = i % 1000 < 500 ? atof(argv[8]) : -0.005;
    position[2] = atof(argv[6]) + atof(argv[7]) - depth;
    status = palpate_force(tool, position, NULL, 0.001, force);
    palpate_state_get(tool, &state);
    if (i % 1000 == 499 && state.answer != answer) {
      answer = state.answer;
      printf("%.0f s: %s, %.4f N\n", 0.001 * i, kAnswer[answer], force[2]);
    }
    if (answer == PALPATE_ANSWER_FINAL) {
      break;
    }
    nanosleep(&tick, NULL);
  }
  palpate_close(body);
  return answer != PALPATE_ANSWER_FINAL;
}
