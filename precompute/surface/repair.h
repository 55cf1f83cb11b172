// Mends a user's surface so that it bounds a body, and says what that changed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "formats/mesh/surface_mesh.h"
#include "precompute/surface/surface_check.h"

namespace palpate {

enum class RepairMode {
  kOff,   ///< the surface is taken as it is
  kSafe,  ///< connections only: vertices that stay keep their places
  kWrap,  ///< a new surface around the old one, with new vertices
};

/// @throws InputError unless the name is off, safe or wrap.
[[nodiscard]] RepairMode repair_mode(std::string_view name);

struct RepairStep {
  std::string what;       ///< "duplicate vertices welded"
  std::size_t count = 0;  ///< above 0
};

struct RepairReport {
  SurfaceReport before;
  SurfaceReport after;
  std::vector<RepairStep> changed;  ///< in order; empty: nothing had to be done
  /// (n_vertices) index of the input vertex at the same place, bit for bit; -1: new.
  /// Those that are not new come first, ascending.
  std::vector<std::int32_t> original_vertex;
  /// Largest distance of the old surface from the new one, and, if the old one was
  /// closed, of the new one from the old one.
  double displaced_m = 0.0;
  double volume_relative = 0.0;  ///< change; NaN where there was no volume before
  std::string refusal;           ///< empty: the result is to be trusted
};

struct RepairedSurface {
  SurfaceMesh mesh;
  RepairReport report;
};

/// kSafe repairs in these steps:
/// - weld vertices that are equal but for rounding;
/// - take out collapsed, duplicate (double-sided) and degenerate triangles;
/// - take out vertices of no triangle, and specks (kSpeckShare), also of a surface that
///   is accepted;
/// - make neighbours agree on the outside;
/// - take out walls inside, and part what touches (glued_parts.h);
/// - join coinciding borders, and part sheets that touch in a vertex;
/// - fill holes smaller than a tenth of the body;
/// - cut out triangles that cross others, with what that parts from the rest, and fill
///   the holes between the vertices at their rims;
/// - turn what lies inside another part and faces as that part does: a cavity.
///
/// kSafe is refused unless the result is a body of as many parts as before without
/// specks. The result must lie within 1 % of the diagonal from the old surface. It must
/// have the old volume to 5 % or, if there was none, the old area to 10 %.
///
/// kWrap closes every hole and lays a new surface around the old one (see
/// wrap_surface.h). Openings are a hundredth, the offset a two-thousandth of the
/// diagonal. kWrap is refused unless the result is a body that leaves out at most a
/// tenth of what the old surface encloses (share_outside). Where holes could not be
/// closed a wrap is a hollow shell.
///
/// The work is done in a child process with limits of time and memory.
/// @throws NumericalError if the child dies; InputError for a surface of no triangles.
[[nodiscard]] RepairedSurface repair_surface(const SurfaceMesh& mesh, RepairMode mode);

/// The weakest repair above `tried` whose result is to be trusted, found by trying;
/// kOff if there is none.
[[nodiscard]] RepairMode working_repair(const SurfaceMesh& mesh, RepairMode tried);

/// A sentence's end: what working_repair() found.
[[nodiscard]] std::string repair_advice(RepairMode mode);

/// require_body() for a surface that may be repaired.
/// @param notes gains one line for each change.
/// @throws InputError "<name>: ..." with the defects, and with the repair that works.
[[nodiscard]] CheckedSurface require_body(const SurfaceMesh& mesh, RepairMode mode,
                                          std::string_view name,
                                          std::vector<std::string>& notes);

}  // namespace palpate
