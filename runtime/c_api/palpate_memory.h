/* palpate: a database whose bytes are in memory, beside palpate.h.
 *
 * For hosts whose files are not on a disk: asset bundles, archives, downloads.
 */
#ifndef PALPATE_MEMORY_H
#define PALPATE_MEMORY_H

#include "palpate.h"

#ifdef __cplusplus
extern "C" {
#endif

/* C's names, not C++'s. NOLINTBEGIN(readability-identifier-naming) */

/* palpate_open() of the bytes of a database: a flat file (palpate-db export --flat) or
 * HDF5. They are read during the call alone, and may be freed when it returns. With
 * PALPATE_STREAMED they must stay as they are until palpate_close(): tools read them
 * there, and an HDF5 file is copied then. Not with PALPATE_SCENE. NULL on failure, with
 * one line in error (may be NULL). */
PALPATE_API palpate_body* palpate_open_memory(const void* bytes, size_t byte_count,
                                              const palpate_options* options,
                                              char* error, size_t error_bytes);

/* NOLINTEND(readability-identifier-naming) */

#ifdef __cplusplus
}
#endif

#endif
