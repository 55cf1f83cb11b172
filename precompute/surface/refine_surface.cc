#include "precompute/surface/refine_surface.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/surface/edge_key.h"

namespace palpate {
namespace {

using Corners = std::array<std::int32_t, 3>;

// Edge j of a triangle is opposite its corner j.
std::array<std::int32_t, 2> edge(const Corners& t, std::size_t j) {
  return {t[(j + 1) % 3], t[(j + 2) % 3]};
}

class Refinement {
 public:
  Refinement(const SurfaceMesh& surface, const EdgeLength& edge_m) : edge_m_(edge_m) {
    for (Eigen::Index v = 0; v < surface.position_m.rows(); ++v) {
      position_.emplace_back(surface.position_m.row(v).transpose());
    }
    for (Eigen::Index t = 0; t < surface.triangle.rows(); ++t) {
      triangle_.push_back(
          {surface.triangle(t, 0), surface.triangle(t, 1), surface.triangle(t, 2)});
    }
  }

  [[nodiscard]] std::size_t triangles() const { return triangle_.size(); }

  // One pass over all triangles; false if no edge was too long.
  bool pass() {
    // 1. Marks edges that are too long.
    // 2. Marks the longest edge of each triangle that has a marked one, until none is
    //    left.
    // 3. Cuts triangles, the longest edge first.
    middle_.clear();
    for (const Corners& t : triangle_) {
      for (std::size_t j = 0; j < 3; ++j) {
        mark_if_long(edge(t, j));
      }
    }
    if (middle_.empty()) {
      return false;
    }
    while (close()) {
    }
    std::vector<Corners> cut;
    for (const Corners& t : triangle_) {
      bisect(t, cut);
    }
    triangle_ = std::move(cut);
    return true;
  }

  [[nodiscard]] SurfaceMesh result() const {
    SurfaceMesh mesh;
    mesh.position_m.resize(static_cast<Eigen::Index>(position_.size()), 3);
    for (std::size_t v = 0; v < position_.size(); ++v) {
      mesh.position_m.row(static_cast<Eigen::Index>(v)) = position_[v].transpose();
    }
    mesh.triangle.resize(static_cast<Eigen::Index>(triangle_.size()), 3);
    for (std::size_t t = 0; t < triangle_.size(); ++t) {
      for (int j = 0; j < 3; ++j) {
        mesh.triangle(static_cast<Eigen::Index>(t), j) =
            triangle_[t][static_cast<std::size_t>(j)];
      }
    }
    return mesh;
  }

 private:
  const Eigen::Vector3d& at(std::int32_t v) const {
    return position_[static_cast<std::size_t>(v)];
  }

  [[nodiscard]] double squared_length(const std::array<std::int32_t, 2>& e) const {
    return (at(e[1]) - at(e[0])).squaredNorm();
  }

  // Ties go to the smaller key, so that both triangles of an edge agree.
  [[nodiscard]] std::array<std::int32_t, 2> longest(const Corners& t) const {
    std::array<std::int32_t, 2> best = edge(t, 0);
    for (std::size_t j = 1; j < 3; ++j) {
      const std::array<std::int32_t, 2> e = edge(t, j);
      if (std::tuple(-squared_length(e), edge_key(e)) <
          std::tuple(-squared_length(best), edge_key(best))) {
        best = e;
      }
    }
    return best;
  }

  void mark(const std::array<std::int32_t, 2>& e) {
    const auto next = static_cast<std::int32_t>(position_.size());
    if (middle_.try_emplace(edge_key(e), next).second) {
      const Eigen::Vector3d middle = 0.5 * (at(e[0]) + at(e[1]));
      position_.push_back(middle);
    }
  }

  void mark_if_long(const std::array<std::int32_t, 2>& e) {
    const double wanted = edge_m_(0.5 * (at(e[0]) + at(e[1])));
    if (!(wanted > 0.0)) {
      throw InputError(
          fmt::format("an edge length of {} m is wanted, must be positive", wanted));
    }
    if (squared_length(e) > wanted * wanted) {
      mark(e);
    }
  }

  // Marks the longest edge of every triangle that has a marked one.
  bool close() {
    const std::size_t before = middle_.size();
    for (const Corners& t : triangle_) {
      const bool any = std::any_of(kAll.begin(), kAll.end(), [&](std::size_t j) {
        return middle_.contains(edge_key(edge(t, j)));
      });
      if (any) {
        mark(longest(t));
      }
    }
    return middle_.size() > before;
  }

  // Cuts a triangle across its longest edge if that is marked, and so on in the halves.
  void bisect(const Corners& t, std::vector<Corners>& out) const {
    const auto found = middle_.find(edge_key(longest(t)));
    if (found == middle_.end()) {
      out.push_back(t);
      return;
    }
    const std::array<std::int32_t, 2> base = longest(t);
    std::size_t apex = 0;
    while (t[apex] == base[0] || t[apex] == base[1]) {
      ++apex;
    }
    const std::int32_t m = found->second;
    for (const Corners& half : {Corners{t[apex], t[(apex + 1) % 3], m},
                                Corners{t[apex], m, t[(apex + 2) % 3]}}) {
      cut_side(half, m, out);
    }
  }

  // A half has one edge of the old triangle, opposite `m`; if it is marked, it is cut
  // from there.
  void cut_side(const Corners& half, std::int32_t m, std::vector<Corners>& out) const {
    std::size_t j = 0;
    while (half[j] != m) {
      ++j;
    }
    const auto found = middle_.find(edge_key(edge(half, j)));
    if (found == middle_.end()) {
      out.push_back(half);
      return;
    }
    out.push_back({m, half[(j + 1) % 3], found->second});
    out.push_back({m, found->second, half[(j + 2) % 3]});
  }

  static constexpr std::array<std::size_t, 3> kAll{0, 1, 2};
  const EdgeLength& edge_m_;
  std::vector<Eigen::Vector3d> position_;
  std::vector<Corners> triangle_;
  std::unordered_map<std::uint64_t, std::int32_t> middle_;
};

}  // namespace

SurfaceMesh refine_longest_edge(const SurfaceMesh& surface, const EdgeLength& edge_m,
                                Eigen::Index triangles_max) {
  Refinement refinement(surface, edge_m);
  while (refinement.triangles() <= static_cast<std::size_t>(triangles_max) &&
         refinement.pass()) {
  }
  return refinement.result();
}

}  // namespace palpate
