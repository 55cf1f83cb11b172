#include "precompute/tets/cut_regions.h"

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "formats/base/at.h"
#include "formats/base/error.h"
#include "precompute/surface/signed_distance.h"
#include "precompute/surface/winding_number.h"
#include "precompute/tets/cut_tets.h"

namespace palpate {
namespace {

constexpr double kSharedOfDiagonal = 0.002;
constexpr double kSharedOfThickness = 0.2;

// Whether points of a body are in a part of it. A point that is closer to the outer
// surface than `shared_m` is asked for below that, where faces that nearly coincide
// with it do not matter.
class InPart {
 public:
  InPart(const SignedDistance& outer, double diagonal_m, const InnerSurface& part)
      : outer_(outer), under_m_(part.under_m), own_(part.surface) {
    if (under_m_ == 0.0) {
      const double thickness_m =
          2.0 * enclosed_volume_m3(part.surface) / surface_area_m2(part.surface);
      shared_m_ =
          std::min(kSharedOfDiagonal * diagonal_m, kSharedOfThickness * thickness_m);
      box_ = bounding_box(part.surface);
      box_.min().array() -= shared_m_;
      box_.max().array() += shared_m_;
    }
  }

  [[nodiscard]] bool operator()(const Eigen::Vector3d& p_m) const {
    if (under_m_ > 0.0) {
      return -outer_.at_m(p_m).distance_m < under_m_;
    }
    if (!box_.contains(p_m)) {
      return false;
    }
    const SignedDistance::Place place = outer_.at_m(p_m);
    const double more_m = shared_m_ + place.distance_m;
    return own_.at_m(more_m > 0.0 ? p_m - more_m * place.outward : p_m).distance_m <
           0.0;
  }

 private:
  const SignedDistance& outer_;
  double under_m_;
  double shared_m_ = 0.0;
  SignedDistance own_;
  Eigen::AlignedBox3d box_;
};

// Smaller parts lie in larger ones, and these in layers.
std::pair<double, double> size_of(const InnerSurface& part) {
  return {part.under_m, part.under_m > 0.0 ? 0.0 : enclosed_volume_m3(part.surface)};
}

void require_tets(std::span<const InnerSurface> inner, const TetMesh& tets) {
  for (std::size_t i = 0; i < inner.size(); ++i) {
    const auto region = static_cast<std::int32_t>(i) + 1;
    if (inner[i].cut && std::find(tets.region.begin(), tets.region.end(), region) ==
                            tets.region.end()) {
      throw InputError(fmt::format(
          "{} holds none of the body: other parts cover it, or it is much thinner than "
          "the surface's triangles are long; make them shorter: palpate-precompute "
          "remesh MESH --edge-m LENGTH -o OUT",
          inner_surface_name(inner, i)));
    }
  }
}

}  // namespace

double share_left_out(const SurfaceMesh& outer, const InnerSurface& inner) {
  return inner.under_m > 0.0 ? 0.0 : share_outside(inner.surface, outer);
}

FilledBody cut_regions(const SurfaceMesh& outer, std::span<const InnerSurface> inner,
                       FilledBody filled) {
  // Places of the surface and of walls that were meshed are kept.
  Eigen::Index fixed = filled.surface.position_m.rows();
  for (const InnerSurface& one : inner) {
    fixed += one.cut ? 0 : one.surface.position_m.rows();
  }
  const SignedDistance depth(outer);
  const double diagonal_m = bounding_box(outer).diagonal().norm();
  CutTets cut(std::move(filled.tets), filled.surface.triangle, fixed);
  for (std::size_t i = 0; i < inner.size(); ++i) {
    if (!inner[i].cut) {
      continue;
    }
    const auto size = size_of(inner[i]);
    const InPart in_part(depth, diagonal_m, inner[i]);
    cut.along(std::cref(in_part), static_cast<std::int32_t>(i) + 1,
              [&](std::int32_t region) {
                return region == 0 || size < size_of(inner[at(region) - 1]);
              });
  }
  filled = cut.take();
  require_tets(inner, filled.tets);
  return filled;
}

}  // namespace palpate
