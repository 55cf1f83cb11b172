// Interpolation cluster: neighbouring vertices, some of them with full-accuracy
// presses. The others have their linear press times a ratio, which
// kriging predicts from the solved vertices (ratio_field.h).
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "formats/database/work_unit.h"
#include "formats/scene/scene.h"
#include "precompute/body/scene_body.h"
#include "precompute/press/ratio_field.h"
#include "precompute/press/scene_solver.h"

namespace palpate {

inline constexpr std::size_t kFirstSamples = 6;  ///< solved well in every cluster
inline constexpr std::size_t kOtherKinds = 6;    ///< at most, unlike all those
inline constexpr std::size_t kMoreSamples = 4;   ///< and per round until within budget
/// Rounds grow with what is known: a tenth of it.
inline constexpr std::size_t kKnownPerSample = 10;

/// Whether normally distributed errors are within the budget at 95 % of vertices
/// (kErrorCoverage). Fewer than 19 ratios (kChecksToCalibrate) do not determine that
/// quantile: kExpectedErrorFactor times every expected error must then be within it.
/// @param expected (n >= 1) [-] RatioModel::error_at(), 0 where solved. @param known
/// number of ratios that predict these errors.
[[nodiscard]] bool keeps_budget(std::span<const double> expected, std::size_t known,
                                double budget);

/// solve_linear() gives every vertex a linear press. A solved vertex has a
/// full-accuracy press. The ratio of both (path_ratio) is known where their paths are
/// comparable.
///
/// Sequences of calls; answer() ends each:
///
///   solve_linear()  keep_linear_within_budget()  linear presses suffice
///   solve_all()                                no interpolation, meshes of their own
///   solve_linear()  solve_all()                 no interpolation, a shared mesh
///   solve_linear()  solve_within_budget()       interpolation
///   solve_few_first()                          a small cluster, meshes of their own
class Cluster {
 public:
  /// @param vertices ascending, at least one; all arguments must outlive it.
  Cluster(const Scene& scene, const BodySource& body, const SceneSolver& solver,
          const SharedTool& tool, std::span<const std::int32_t> vertices);

  void solve_linear() { linear_ = solver_.linear(tool_, vertex_); }

  /// Where linear presses are of the same kind as full-accuracy ones. @param graded
  /// presses whose own error estimate is outside the budget are repeated on finer
  /// meshes.
  void keep_linear_within_budget(bool graded);

  void solve_all() { solve(unsolved()); }

  /// Solves the vertices that cannot be interpolated and a few others. Then solves more
  /// until at 95 % of all vertices (kErrorCoverage) the force vector is expected within
  /// the budget.
  void solve_within_budget();

  /// As solve_within_budget(), before any linear press. A few full-accuracy presses
  /// show whether the others could be interpolated. Only then are linear presses made.
  void solve_few_first();

  /// Appends the vertices' responses, ascending; each keeps the rules (broken_rule) or
  /// has failed.
  void answer(std::int32_t tool, std::vector<WorkUnitNode>& nodes) const;

 private:
  using Places = std::vector<std::size_t>;  // in vertex_

  [[nodiscard]] RatioField no_ratios() const;
  [[nodiscard]] bool touches(std::size_t i) const;
  [[nodiscard]] bool is_like_others(std::size_t i) const;
  [[nodiscard]] Places unsolved() const;
  [[nodiscard]] Places only_by_solving() const;
  [[nodiscard]] Places far_apart(std::size_t count) const;
  [[nodiscard]] Places farthest(std::size_t count, std::span<const double> error) const;
  [[nodiscard]] Places other_kinds() const;
  [[nodiscard]] Places spread(
      std::size_t count, const std::function<double(std::size_t, std::size_t)>& apart,
      const std::function<double(std::size_t, double)>& worth) const;
  [[nodiscard]] bool few_predict_each_other() const;
  [[nodiscard]] RatioField::Place place(std::size_t i) const {
    return RatioField::place_of(vertex_[i], linear_[i].indentation);
  }
  [[nodiscard]] double expected_error(std::size_t i, const RatioModel& ratios) const;
  [[nodiscard]] double nearest_tangent(std::size_t i) const;
  [[nodiscard]] NodeResponse interpolated(std::size_t i, const RatioModel& ratios,
                                          bool& ends_early) const;
  [[nodiscard]] std::size_t index_of(std::int32_t vertex) const;
  [[nodiscard]] bool is_outside_budget(const PressedNode& node) const;
  [[nodiscard]] NodeResponse response_of(const PressedNode& node) const;
  [[nodiscard]] double estimate(const PressedNode& node) const;
  [[nodiscard]] std::vector<std::int32_t> vertices_at(const Places& which) const;
  void solve(const Places& which);
  void solve_kinds_until_within_budget();
  void take_ratio(std::size_t i, const PressedNode& node);

  const Scene& scene_;
  const BodySource& body_;
  const SceneSolver& solver_;
  const SharedTool& tool_;
  std::span<const std::int32_t> vertex_;
  std::vector<PressedNode> linear_;  // as default where not asked for
  std::vector<std::optional<PressedNode>> full_;
  RatioField field_;
};

}  // namespace palpate
