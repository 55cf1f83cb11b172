#include "runtime/slow/static_field.h"

#include <algorithm>
#include <memory>
#include <numeric>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/tool_support.h"
#include "runtime/fast/potential_field.h"

namespace palpate {
namespace {

// The elements that the slow process sends with `active`, in a cache of their own.
// @returns the slot of the active one.
int fill(ElementCache& cache, const ElementStream& stream, std::int32_t active) {
  cache.received = 0;
  cache.stored_at.fill(0);
  const WantedTriangles wanted = wanted_triangles(stream.search(), active, -1);
  for (std::size_t i = 0; i < wanted.count; ++i) {
    if (!store(cache, stream.element(wanted.triangle[i]))) {
      throw FormatError(
          fmt::format("triangle {}: response is malformed", wanted.triangle[i]));
    }
  }
  return find(cache, active);
}

const ResponseTable& not_yielding(const ResponseTable& table) {
  if (!table.viscoelasticity.yielding.empty()) {
    throw InputError(
        fmt::format("tool '{}': the body yields, so that its force depends on what was "
                    "pressed before; render it instead",
                    table.tool.name));
  }
  return table;
}

}  // namespace

StaticField::StaticField(const ResponseDatabase& database, const ResponseTable& table,
                         FieldKind kind)
    : stream_(database, not_yielding(table)),
      radius_m_(nominal_height_m(table.tool)),
      kind_(kind) {}

std::vector<std::int32_t> StaticField::nearest_triangles(
    const Eigen::Ref<const Points>& position_m) const {
  std::vector<std::int32_t> triangle(static_cast<std::size_t>(position_m.rows()));
  for (Eigen::Index i = 0; i < position_m.rows(); ++i) {
    const Eigen::Vector3d x = position_m.row(i);
    if (!x.allFinite()) {
      throw InputError(fmt::format("position {} is ({}, {}, {}), must be finite", i,
                                   x.x(), x.y(), x.z()));
    }
    triangle[static_cast<std::size_t>(i)] = stream_.search().nearest(x).triangle;
  }
  return triangle;
}

Points StaticField::force_n(const Eigen::Ref<const Points>& position_m) const {
  const std::vector<std::int32_t> triangle = nearest_triangles(position_m);
  // Triangle by triangle: their neighbourhoods are collected once.
  std::vector<std::size_t> order(triangle.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return triangle[a] < triangle[b];
  });
  Points force = Points::Zero(position_m.rows(), 3);
  const auto cache = std::make_unique<ElementCache>();
  std::int32_t active = -1;
  int slot = -1;
  for (const std::size_t i : order) {
    if (triangle[i] < 0) {
      continue;
    }
    if (triangle[i] != active) {
      active = triangle[i];
      slot = fill(*cache, stream_, active);
    }
    const auto row = static_cast<Eigen::Index>(i);
    const Eigen::Vector3d x = position_m.row(row);
    FieldPlace place;
    adopt(place, *cache, slot, x, kind_);
    CurvePieces pieces;
    force.row(row) = respond(place, *cache, radius_m_, 0.0, pieces).force_n;
  }
  return force;
}

Points stored_forces(const ResponseDatabase& database, std::size_t tool,
                     const Points& position_m) {
  return StaticField(database, database.tools.at(tool)).force_n(position_m);
}

}  // namespace palpate
