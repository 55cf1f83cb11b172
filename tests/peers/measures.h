// What is measured of the forces that a renderer gave along a hand's path.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "tests/peers/scene_folder.h"

namespace palpate::peers {

/// The upper one of two in the middle. @param values at least one
[[nodiscard]] double median(std::vector<double> values);

/// Forces against the truth where it is known. Relative ones: sum |dF| over sum |F|, of
/// the true forces. NaN without a point.
struct ForceError {
  int points = 0;
  int contact_points = 0;  ///< with a true force
  double mean_n = 0.0;     ///< [N] mean |dF| over all points
  double relative = 0.0;   ///< [-] over all points
  double contact_mean_n = 0.0;
  double contact_relative = 0.0;
  /// [-] in contact, of the force along the true one alone: what friction adds across
  /// it does not count.
  double along_relative = 0.0;
};

/// A hand, and the force on it at each of its ticks.
struct RenderedHand {
  const Hand* hand = nullptr;
  std::vector<Eigen::Vector3d> force_n;
};

/// Over all points of the hands, each weighing the same.
[[nodiscard]] ForceError force_error(std::span<const RenderedHand> rendered);

/// Jumps of the force, where the nearest triangle of the surface changes and anywhere.
struct EdgeJumps {
  int edges = 0;
  double largest_n = 0.0;          ///< [N] at an edge
  double mean_n = 0.0;             ///< [N] over the edges
  double relative = 0.0;           ///< [-] largest over the way's mean |F|
  double anywhere_relative = 0.0;  ///< [-] likewise of the largest jump anywhere
  double turn_rad = 0.0;           ///< [rad] largest turn of the force at an edge
  double turn_anywhere_rad = 0.0;
};

/// Steps count along the hand between its first and its last tick with a true force. So
/// steps count on the way over the surface, not where the hand comes and goes. A jump
/// is a step of the force from a tick to the next, less the median step of the kAround
/// ticks before and after. That median step is what the movement makes without a jump.
/// A turn is the angle between the forces of both ticks, less the median likewise. No
/// force has no direction, and does not turn. Of an edge it is the largest within
/// kAtEdge ticks of the crossing: a slow process comes up to ten ticks late.
constexpr int kAtEdge = 15;
constexpr int kAround = 40;
[[nodiscard]] EdgeJumps edge_jumps(const SurfaceMesh& surface,
                                   const RenderedHand& rendered);

/// Work that the hand has put in, by the trapezoid rule. The work belongs to forces and
/// places, not to forces that a device holds for a tick.
struct PathEnergy {
  double put_in_j = 0.0;   ///< [J] at the end; of a closed path: what was lost
  double created_j = 0.0;  ///< [J] >= 0, most that the hand had got beyond what it gave
  double largest_j = 0.0;  ///< [J] most that had been put in on the way
};
[[nodiscard]] PathEnergy path_energy(std::span<const Eigen::Vector3d> centre_m,
                                     std::span<const Eigen::Vector3d> force_n);

}  // namespace palpate::peers
