// Neighbouring vertices that are answered together: some are solved well, the others
// are their cheap presses times what the solved ones say.
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

inline constexpr std::size_t kFirstSamples = 6;  ///< solved well in every territory
inline constexpr std::size_t kOtherKinds = 6;    ///< at most, unlike all those
inline constexpr std::size_t kMoreSamples = 4;   ///< and per round until within budget
/// Rounds grow with what is known: a tenth of it.
inline constexpr std::size_t kKnownPerSample = 10;

/// Whether errors are within the budget at 95 % of vertices (kErrorCoverage), if they
/// are normal. Fewer than 19 ratios (kChecksToCalibrate) cannot tell what 95 % are
/// within: then all must be, kExpectedErrorFactor times.
/// @param expected (n >= 1) [-] RatioModel::error_at(), 0 where solved. @param known
/// ratios that they are told from.
[[nodiscard]] bool keeps_budget(std::span<const double> expected, std::size_t known,
                                double budget);

/// Every vertex has a cheap press, once press_cheap() was called, and a good one where
/// it is solved; the ratio of the two (path_ratio) is known where they are alike. There
/// are four ways to work, each ended by answer():
/// - press_cheap(), keep_cheap_within_budget();
/// - solve_all(), after press_cheap() where all presses share a mesh;
/// - press_cheap(), solve_within_budget();
/// - solve_few_first().
class Territory {
 public:
  /// @param vertices ascending, at least one; all arguments must outlive it.
  Territory(const Scene& scene, const BodySource& body, const SceneSolver& solver,
            const SharedTool& tool, std::span<const std::int32_t> vertices);

  void press_cheap() { cheap_ = solver_.cheap(tool_, vertex_); }

  /// Where cheap presses are of the same kind as good ones. @param graded those that
  /// their own estimate finds outside the budget are done again on finer meshes.
  void keep_cheap_within_budget(bool graded);

  void solve_all() { solve(unsolved()); }

  /// Solves vertices that only a solve can answer, a few others, and more until at 95 %
  /// of all (kErrorCoverage) the force vector is expected within the budget.
  void solve_within_budget();

  /// As solve_within_budget(), without cheap presses so far: a few good ones tell
  /// whether others could be interpolated from them, and only then are cheap ones worth
  /// their time.
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
    return RatioField::place_of(vertex_[i], cheap_[i].indentation);
  }
  [[nodiscard]] double expected_error(std::size_t i, const RatioModel& ratios) const;
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
  std::vector<PressedNode> cheap_;  // as default where not asked for
  std::vector<std::optional<PressedNode>> good_;
  RatioField field_;
};

}  // namespace palpate
