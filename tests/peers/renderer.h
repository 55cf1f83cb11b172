/* What a renderer of contact forces must be to enter the benchmark: a shared library
 * (C, C++ or whatever makes one) with these six functions. README.md says what the
 * benchmark does with them, and what lies in a scene's folder.
 *
 * All calls come from one thread. Lengths in metres, forces in newtons, times in
 * seconds, in the frame of the scene's surface.obj. No call throws or prints.
 */
#ifndef PEERS_RENDERER_H
#define PEERS_RENDERER_H

#include <stddef.h>

#if defined(__GNUC__)
#define PEER_API __attribute__((visibility("default")))
#else
#define PEER_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* C's names. NOLINTBEGIN(readability-identifier-naming) */

typedef struct peer peer;

/* Name of the library's variant with that index, counted from 0, e.g. "finger-proxy
 * with friction"; NULL past the last. Each is a row of the table. */
PEER_API const char* peer_variant(int index);

/* A tool at rest in free space, far from the body. Whatever the library has to compute
 * for the scene it computes in the first call and keeps in the folder `own`, which
 * exists and is its own: the time of that call is the build time, the folder's bytes
 * are the size on disk. A later call on the same folders reads them.
 * tick_s: time between poses. NULL where the scene cannot be rendered or something
 * failed, with one line in error that says why. */
PEER_API peer* peer_open(const char* scene, const char* own, const char* variant,
                         double tick_s, char* error, size_t error_bytes);

/* The tool's reference point (a ball's centre) at the next tick, and its orientation.
 */
PEER_API void peer_pose(peer* p, const double position_m[3], const double quat_xyzw[4]);

/* Force on the tool at that tick. Timed together with peer_pose(). */
PEER_API void peer_force(peer* p, double force_n[3]);

/* What a program would do beside its haptic loop, 100 times a second: called after
 * every so many ticks, and timed by itself. May do nothing. */
PEER_API void peer_slow(peer* p);

PEER_API void peer_close(peer* p);

/* NOLINTEND(readability-identifier-naming) */

#ifdef __cplusplus
} /* extern "C" */
#endif

#endif /* PEERS_RENDERER_H */
