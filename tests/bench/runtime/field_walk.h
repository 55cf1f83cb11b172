// A recorded walk of the tool over a body, and what its local model did there: for
// benches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "formats/database/response_database.h"
#include "runtime/account/local_model.h"
#include "runtime/bench/bench_body.h"
#include "runtime/bench/random_walk.h"
#include "runtime/element/element.h"

namespace palpate {

/// Positions of the tool at every tick, and what the slow process sends.
struct FieldWalk {
  double tool_radius_m = 0.0;  ///< [m]
  double tick_s = 0.0005;      ///< [s]
  std::size_t ticks_per_slow = 20;
  std::vector<Eigen::Vector3d> position_m;     ///< per tick [m]
  std::vector<std::vector<Element>> messages;  ///< per slow tick
};

/// Over a bench body; starts and ends off it.
[[nodiscard]] FieldWalk walk_over(const BenchBody& body,
                                  const BenchWalkOptions& options, int ticks_per_slow);

/// Over the nodes of a table that have a response, as the slow process would follow.
[[nodiscard]] FieldWalk walk_over(const ResponseDatabase& database,
                                  const ResponseTable& table,
                                  const DatabaseWalkOptions& options);

/// Gives every node of the messages this friction.
void set_friction(FieldWalk& walk, double coefficient, double presliding_m);

/// What a local model did on a walk.
struct FieldAccount {
  std::int64_t contact_ticks = 0;
  std::int64_t starved_ticks = 0;
  std::uint64_t interventions = 0;
  double lowest_work_j = 0.0;  ///< [J] <= 0, by the potentials before each step
  double lowest_felt_j = 0.0;  ///< [J] <= 0, by trapezoids of the forces
  double work_j = 0.0;         ///< [J] at the end
  double normal_max_n = 0.0;
  double error_max_n = 0.0;  ///< [N] of the normal force from the interpolated curve
  double normal_square_n2 = 0.0;
  double error_square_n2 = 0.0;
  double shift_max_m = 0.0;
  std::vector<double> angle_rad;  ///< per contact tick, of the force to the stored
                                  ///< direction
};

/// Renders a walk without clamps. The model follows a surface.
[[nodiscard]] FieldAccount render(const FieldWalk& walk, LocalModel model);

}  // namespace palpate
