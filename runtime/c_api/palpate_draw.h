/* palpate: what to draw of a tool that touches a body, beside palpate.h. */
#ifndef PALPATE_DRAW_H
#define PALPATE_DRAW_H

#include "palpate.h"

#ifdef __cplusplus
extern "C" {
#endif

/* C's names, not C++'s. NOLINTBEGIN(readability-identifier-naming) */

/* A contact: the tool's own of a tool that touches at one place, or one of its spheres.
 * Points, normals and forces are the world's (palpate_place()). */
typedef struct palpate_contact {
  int32_t hand;     /* that holds it, from 0 */
  int32_t table;    /* of responses: for palpate_displaced() */
  int32_t touching; /* 1: the body acts on it */
  int32_t triangle; /* of the surface, nearest to it; -1: not found yet */
  double radius;    /* [host length] of the sphere; else height of the tool's reference
                       point when it touches a plane */
  double centre[3]; /* [host length] of the sphere, or the tool's reference point */
  double point[3];  /* [host length] nearest point of the surface at rest */
  double normal[3]; /* there, outward; zeros: not known */
  double force[3];  /* [host force] on the tool, with friction */
  double depth;     /* [host length] that the tool is below touch; negative above */
  double own_depth; /* of it, what its own force sinks the surface by: less where other
                       contacts sink it, too */
  double shares[3]; /* [0, 1] area coordinates of the point in its triangle */
} palpate_contact;

/* Haptic thread, outside a tick: the contacts of the latest tick, as many as there is
 * room for, each in contact_bytes (sizeof(palpate_contact)) of its own. How many there
 * are, 1 to 64, whatever the room; or PALPATE_ERROR_INPUT. Does not allocate. */
PALPATE_API int palpate_contacts_get(const palpate_tool* tool,
                                     palpate_contact* contacts, size_t room,
                                     size_t contact_bytes);

/* Any thread: by how much the surface gives way under contacts of that tool, for each
 * vertex of palpate_mesh_get() (3 each) [host length]: displacement fields of the
 * triangles' corners that the database holds (of a scene with [drawing] displacement =
 * true), in proportion to own_depth,
 * added up: for drawing. How many of the touching contacts
 * have fields at their corners: 0, and zeros, where none is stored. Allocates. An error
 * below zero, with one line in error (may be NULL), of a streamed database or a scene.
 */
PALPATE_API int palpate_displaced(const palpate_tool* tool,
                                  const palpate_contact* contacts, size_t count,
                                  size_t contact_bytes, double* displacements,
                                  char* error, size_t error_bytes);

/* NOLINTEND(readability-identifier-naming) */

#ifdef __cplusplus
}
#endif

#endif
