// Tets cut along parts of a body that reach its surface or touch each other.
#pragma once

#include <span>

#include "formats/mesh/surface_mesh.h"
#include "precompute/tets/inner_surface.h"
#include "precompute/tets/tet_mesh.h"

namespace palpate {

/// A surface and the tets that fill it, conforming.
struct FilledBody {
  SurfaceMesh surface;
  TetMesh tets;
};

/// Cuts tets and the triangles on their boundary along the inner surfaces that are
/// `cut`, so that every tet has one region. The region is that of the smallest of these
/// surfaces around the tet, by volume. A layer counts as larger than any of them, and
/// as smaller than a deeper layer.
///
/// No wall is meshed before, so that faces may be shared with the outer surface or
/// between inner surfaces. Shared faces coincide to a five-hundredth of the outer
/// surface's diagonal or a fifth of the part's thickness, whichever is less. What lies
/// outside is left out.
///
/// Old vertices of the surface stay first, and in place; new vertices on old edges
/// follow. A wall that would pass an inner vertex by less than a tenth of an edge goes
/// through the vertex. The vertex is moved onto the wall. A wall that passes another
/// vertex by less than a fiftieth goes through that vertex, too.
///
/// A wall is flat in each tet: where it is curved or has an edge, that is cut off. In
/// the depth tets are large, whatever the surface's edges. A layer's inner edges there
/// cost 9 % of its volume, and 2 % with edges of a quarter
/// (tests/precompute/tets/cut_regions_test.cc). A part that is thinner than the tets
/// may be missed where no vertex lies in it. Surfaces that keep a gap, however small,
/// do not touch.
/// @param outer the body's own surface, from which layers count.
/// @throws InputError if a part holds no tet.
[[nodiscard]] FilledBody cut_regions(const SurfaceMesh& outer,
                                     std::span<const InnerSurface> inner,
                                     FilledBody filled);

/// Share of the inner surface's volume that is outside of the outer one [0, 1].
[[nodiscard]] double share_left_out(const SurfaceMesh& outer,
                                    const InnerSurface& inner);

}  // namespace palpate
