// What a build on a mesh that all presses share will take.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "precompute/build/plan.h"
#include "precompute/press/node_press.h"
#include "precompute/press/scene_solver.h"

namespace palpate {

/// Meshes the body, factorises it and presses a few vertices, `workers` of them side by
/// side; fills in the report's cost, tets, unknowns and columns. Where that would take
/// long a coarser mesh is timed, and larger ones are extrapolated from it
/// (expected_cpu_s). The mesh stays in memory, as in a build.
class PlanSharedMesh {
 public:
  /// All arguments must outlive it. @param vertices reachable ones, ascending.
  /// @throws as build().
  PlanSharedMesh(const Scene& scene, const BodySource& body,
                 const PressStrategy& strategy, std::span<const std::int32_t> vertices,
                 std::size_t workers, Progress& progress, PlanReport& report);

  /// Share of the linear presses whose error is outside the budget.
  [[nodiscard]] double share_outside_budget() const { return outside_; }

  /// Presses a few nonlinear. @param count of all that a build will press.
  void time_nonlinear(std::size_t count);

 private:
  [[nodiscard]] SurfaceMesh affordable_surface() const;
  [[nodiscard]] double near(const SurfaceMesh& surface) const;
  void make_mesh(const SurfaceMesh& surface);
  [[nodiscard]] std::vector<PressedNode> place_tools();
  void time_columns(std::span<const PressedNode> placed, std::size_t columns);
  void time_linear();

  const Scene& scene_;
  const BodySource& body_;
  const PressStrategy& strategy_;
  std::span<const std::int32_t> vertex_;
  std::size_t workers_;
  Progress& progress_;
  PlanReport& report_;
  // Triangles of the shared surface over those of the one that is timed in its place.
  double times_larger_ = 1.0;
  std::optional<BodyModel> model_;
  std::vector<std::int32_t> sample_;  // vertices whose columns are solved
  std::optional<SurfaceCompliance> compliance_;
  double outside_ = 0.0;
};

}  // namespace palpate
