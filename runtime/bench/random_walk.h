// A tool that wanders over the surface of a database's body, and in and out of it.
#pragma once

#include <cstdint>
#include <random>

#include <Eigen/Core>

#include "formats/database/response_database.h"
#include "formats/mesh/surface_search.h"

namespace palpate {

struct DatabaseWalkOptions {
  int ticks = 200000;
  int ticks_per_slow = 20;
  double speed_m_per_s = 0.05;  ///< [m/s] standard deviation of each component
  double memory_s = 0.1;        ///< [s] > 0, correlation time of the velocity
  double lift_m = 0.002;        ///< [m] highest above the surface
  double depth_share = 0.8;     ///< [-] deepest, of the node's curve
  std::uint32_t seed = 1;
};

/// First-order noise for the velocity; held over the surface by its height, and over
/// nodes that have a response. Both references must outlive it.
class Wanderer {
 public:
  Wanderer(const ResponseDatabase& database, const ResponseTable& table,
           const DatabaseWalkOptions& options);

  /// Moves for tick_s [s]. @return position of the tool's centre [m].
  Eigen::Vector3d step(double tick_s);

 private:
  const ResponseDatabase& database_;
  const ResponseTable& table_;
  DatabaseWalkOptions o_;
  std::mt19937_64 random_;
  SurfaceSearch search_;
  Eigen::Vector3d x_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_ = Eigen::Vector3d::Zero();
  std::int32_t triangle_ = -1;
};

}  // namespace palpate
