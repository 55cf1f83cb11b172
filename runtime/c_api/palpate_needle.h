/* palpate: a needle and what it has cut open, beside palpate.h.
 *
 * A tool is a needle where its database says what it punctures (shape "needle" of a
 * scene). It is driven as any other tool of one contact, by palpate_force(), with model
 * "potential" or "facets". Channels belong to the tool: another tool of the body finds
 * none of them. palpate_reset() keeps them, and lets the needle go.
 */
#ifndef PALPATE_NEEDLE_H
#define PALPATE_NEEDLE_H

#include "palpate.h"

#ifdef __cplusplus
extern "C" {
#endif

/* C's names, not C++'s. NOLINTBEGIN(readability-identifier-naming) */

/* The latest tick. Depths and forces are zero where the needle is in no channel. Forces
 * are those before limits of force, slew and ramp: where nothing is limited, they are
 * together what palpate_force() gave. The three works are part of palpate_state's
 * dissipated_j and yielded_j. */
typedef struct palpate_needle {
  size_t struct_size; /* sizeof(palpate_needle), set by the caller */
  int32_t channels;   /* that it has opened, 16 at most */
  int32_t channel;    /* that it is in; -1: none */
  uint64_t broken;    /* membranes since the tool was added */
  uint64_t refused;   /* ticks in which a puncture found no free channel */
  double tip_depth;   /* [host length] of the tip along the axis from the entry */
  double inserted;    /* [host length] of the shaft, at most the channel's depth */
  double tip_force;   /* [host force] of the tissue before the tip, outward */
  double shaft_force; /* [host force] along the shaft, outward; < 0 on the way out */
  double lateral_force[3]; /* [host force] across the axis, in the world */
  double cut_j;            /* [J] >= 0 spent on new surface */
  double released_j;       /* [J] >= 0 that ruptures set free beyond that, and lost */
  double shaft_j;          /* [J] >= 0 dissipated along and across the shaft */
} palpate_needle;

/* Points and axes are the world's (palpate_place()). */
typedef struct palpate_channel {
  double entry[3]; /* [host length] where the tool's reference point went in */
  double axis[3];  /* [-] outward unit vector */
  double depth;    /* [host length] to which it is cut open; never less */
  int32_t layer;   /* that the tip has broken into, from 0 */
  int32_t layers;  /* below its entry */
  double boundary; /* [host length] depth of the next membrane; 0: there is none */
} palpate_channel;

/* Haptic thread, outside a tick: fills the first struct_size bytes. 0, or
 * PALPATE_ERROR_INPUT with one line in error (may be NULL): a tool that is no needle.
 * Does not allocate. */
PALPATE_API int palpate_needle_get(const palpate_tool* tool, palpate_needle* needle,
                                   char* error, size_t error_bytes);

/* Haptic thread, outside a tick: the channels in the order of their entries, as many as
 * there is room for, each in channel_bytes (sizeof(palpate_channel)) of its own. How
 * many there are, 0 to 16, whatever the room; else as palpate_needle_get(). */
PALPATE_API int palpate_channels_get(const palpate_tool* tool,
                                     palpate_channel* channels, size_t room,
                                     size_t channel_bytes, char* error,
                                     size_t error_bytes);

/* NOLINTEND(readability-identifier-naming) */

#ifdef __cplusplus
}
#endif

#endif
