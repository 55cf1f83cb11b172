// Plates of contact spheres over a bench body, and how they wander: for benches and
// tests of coupled contacts.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "runtime/bench/bench_body.h"
#include "runtime/contacts/coupled_step.h"

namespace palpate {

/// A bench body with rows of compliance.
struct ContactBody {
  BenchBody body;
  ComplianceKnots knots;
  std::vector<ContactRow> row;  ///< by node
  int modes = 0;                ///< of the rows; the first adds, the second subtracts
};

/// Rows of a half-space, c(r) = 1 / (pi E* r), whose contact of radius_m is the body's
/// mean curve. At a node whose curve is s times that, c is times 1 / sqrt(s). c is less
/// by `thickness_m` as a layer of that thickness has it: c r (1 - r / thickness).
[[nodiscard]] ContactBody make_contact_body(const BenchBodyOptions& options,
                                            double radius_m, double thickness_m = 0.2);

/// Gives the rows two modes of this share of c at 1 cm [-]: a tilt along x, and a bulge
/// along y that subtracts.
void add_modes(ContactBody& body, double share);

/// A square plate of contacts at heights 0, as many of `side` x `side` as are asked
/// for; one hand. Finished.
[[nodiscard]] CoupledSet make_plate(const ContactBody& body, int contacts,
                                    double apart_m, double radius_m);

/// Two hands with one sphere each. Finished.
[[nodiscard]] CoupledSet make_pinch(const ContactBody& body, double radius_m);

/// What the slow process sends for contact i at its place.
void send(CoupledState& state, const ContactBody& body, const PortPoses& pose, int i);

struct PoseWalkOptions {
  double radius_m = 0.003;  ///< [m] of the contacts
  double depth_m = 0.0015;  ///< [m] deepest that is aimed at, below z = 0
  double lift_m = 0.001;    ///< [m] highest
  double reach_m = 0.01;    ///< [m] aims around the middle of the body, along x and y
  double tilt_rad = 0.06;   ///< [rad] largest about x and y
  double turn_rad = 2.0;    ///< [rad] about z
  double apart_m = 0.0;     ///< [m] along x between two hands
  std::uint32_t seed = 1;
};

/// Ports that a spring pulls after aims that change three times a second.
class PoseWalk {
 public:
  PoseWalk(const ContactBody& body, int ports, const PoseWalkOptions& options);

  static constexpr double kTickS = 0.0005;  ///< [s]

  /// Moves for a tick.
  const PortPoses& next();

 private:
  struct Port {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    Eigen::Vector3d aim = Eigen::Vector3d::Zero();
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();
    Eigen::Vector3d turning = Eigen::Vector3d::Zero();
    Eigen::Vector3d turn_aim = Eigen::Vector3d::Zero();
  };

  PoseWalkOptions o_;
  int ports_;
  Eigen::Vector3d middle_;
  std::mt19937_64 random_;
  std::int64_t tick_ = 0;
  std::array<Port, kPortsMax> port_;
  PortPoses pose_;
};

}  // namespace palpate
