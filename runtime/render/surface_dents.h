// What of a surface's memory is not gone: for drawing and for summaries, not for the
// fast step.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/recording/kept_surface.h"
#include "runtime/contacts/coupled_step.h"
#include "runtime/fast/fast_step.h"

namespace palpate {

/// A memory site that carries force, or that has yielded.
struct SurfaceDent {
  std::int32_t site = -1;  ///< as the database counts
  double carried_n = 0.0;  ///< [N] s >= 0: the force of its dent's depth
  double stays_m = 0.0;    ///< [m] >= 0 of it for good, beside that
};

/// Of a state between two steps: sites at hand and in the table, as they are now.
[[nodiscard]] std::vector<SurfaceDent> surface_dents(const FastState& state);

/// Dents of all contacts with the responses of that table. Of a site that several
/// contacts have pressed, the dent is the one that carries most (each contact has its
/// own dents).
/// @param table of the set's spheres, [0, kResponseTables).
[[nodiscard]] std::vector<SurfaceDent> surface_dents(const CoupledState& state,
                                                     int table);

/// What stays for good.
[[nodiscard]] KeptSurface kept_surface(const FastState& state);
[[nodiscard]] KeptSurface kept_surface(const CoupledState& state);

/// What had stayed takes the place of what stays in the state; nothing else changes.
/// Sites and channels must find room, and their table and materials be the state's.
/// @throws InputError where they are not; the state is as it was then.
void begin_kept(const KeptSurface& kept, FastState& state);
void begin_kept(const KeptSurface& kept, CoupledState& state);

}  // namespace palpate
