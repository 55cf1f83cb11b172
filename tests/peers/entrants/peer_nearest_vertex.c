/* An example of an entrant: a penalty along the normal of the nearest vertex. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../renderer.h"

struct peer {
  int vertices;
  double (*position)[3], (*normal)[3];
  double radius, stiffness, centre[3];
};

const char* peer_variant(int index) { return index == 0 ? "penalty" : NULL; }

static double value(const char* scene, const char* key) {
  char path[4096], line[4096];
  double found = 0.0;
  snprintf(path, sizeof path, "%s/scene.txt", scene);
  FILE* file = fopen(path, "r");
  while (file != NULL && fgets(line, sizeof line, file) != NULL) {
    const size_t length = strlen(key);
    if (strncmp(line, key, length) == 0 && line[length] == ' ') {
      found = atof(line + length);
    }
  }
  if (file != NULL) fclose(file);
  return found;
}
static int read_surface(peer* p, const char* scene) {
  char path[4096], line[4096];
  int corner[3];
  snprintf(path, sizeof path, "%s/surface.obj", scene);
  FILE* file = fopen(path, "r");
  if (file == NULL) return 0;
  while (fgets(line, sizeof line, file) != NULL) p->vertices += strncmp(line, "v ", 2) == 0;
  p->position = calloc((size_t)p->vertices, sizeof *p->position);
  p->normal = calloc((size_t)p->vertices, sizeof *p->normal);
  rewind(file);
  for (int at = 0; fgets(line, sizeof line, file) != NULL;) {
    double* x = p->position[at < p->vertices ? at : 0];
    if (strncmp(line, "v ", 2) == 0) {
      at += sscanf(line, "v %lf %lf %lf", x, x + 1, x + 2) == 3;
    } else if (sscanf(line, "f %d %d %d", corner, corner + 1, corner + 2) == 3) {
      const double *a = p->position[corner[0] - 1], *b = p->position[corner[1] - 1];
      const double* c = p->position[corner[2] - 1];
      for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double area = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
        for (int v = 0; v < 3; ++v) p->normal[corner[v] - 1][k] += area;
      }
    }
  }
  fclose(file);
  for (int v = 0; v < p->vertices; ++v) {
    double* n = p->normal[v];
    const double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3 && size > 0.0; ++k) n[k] /= size;
  }
  return p->vertices;
}
peer* peer_open(const char* scene, const char* own, const char* variant, double tick_s,
                char* error, size_t error_bytes) {
  (void)own, (void)variant, (void)tick_s;
  peer* p = calloc(1, sizeof *p);
  p->radius = value(scene, "tool_radius_m");
  p->stiffness = value(scene, "typed_stiffness_n_per_m");
  if (read_surface(p, scene) > 0 && p->radius > 0.0 && p->stiffness > 0.0) return p;
  snprintf(error, error_bytes, "no surface, tool radius or stiffness in %s", scene);
  peer_close(p);
  return NULL;
}
void peer_pose(peer* p, const double position_m[3], const double quat_xyzw[4]) {
  (void)quat_xyzw;
  memcpy(p->centre, position_m, sizeof p->centre);
}
void peer_force(peer* p, double force_n[3]) {
  double least = INFINITY, depth = 0.0;
  int nearest = 0;
  for (int v = 0; v < p->vertices; ++v) {
    const double *x = p->position[v], *c = p->centre;
    const double square = pow(x[0] - c[0], 2) + pow(x[1] - c[1], 2) + pow(x[2] - c[2], 2);
    if (square < least) least = square, nearest = v;
  }
  for (int k = 0; k < 3; ++k) {
    depth += (p->position[nearest][k] - p->centre[k]) * p->normal[nearest][k];
  }
  depth = fmax(0.0, depth + p->radius);
  if (depth > 2.0 * p->radius) depth = 0.0;
  for (int k = 0; k < 3; ++k) force_n[k] = p->stiffness * depth * p->normal[nearest][k];
}
void peer_slow(peer* p) { (void)p; }

void peer_close(peer* p) {
  free(p->position);
  free(p->normal);
  free(p);
}
