// A tool's contacts: spheres that are fixed to a port, and how far apart they are.
//
// A port is what a hand or device holds: a pose in, a wrench out. The contacts of one
// port keep their distances, so that what the body's compliance is read at is fixed
// once; those of two ports (two hands on one body) move against each other.
//
// Compliance: row c_a of surface node a holds c_a(r) r at knots of distance r, the
// displacement at r for 1 N there, along the inward normals of both; linear in log r
// between knots, c as at the first knot below it, and as 1/r past the last one. With
// n_a the area coordinates of the contact's place, c_i = sum n_a c_a and
//
//   C_ij = (c_i(r_ij) + c_j(r_ij)) / 2.
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "runtime/fast/coupled_contacts.h"
#include "runtime/fast/real.h"

namespace palpate {

constexpr int kPortsMax = 2;
constexpr int kComplianceKnots = 32;  ///< at most
constexpr int kComplianceTables = 8;  ///< of distinct radii, at most

/// Where a port is: x = position + rotation p of a point p of its frame.
struct PortPose {
  Vector3 position_m = Vector3::Zero();    ///< [m] reference point
  Matrix3 rotation = Matrix3::Identity();  ///< [-] a rotation
};

struct ContactSphere {
  Vector3 centre_m = Vector3::Zero();  ///< [m] in the port's frame
  Real radius_m = 0.0;                 ///< [m] >= 0
  std::int8_t port = 0;                ///< [0, kPortsMax)
  std::int8_t table = 0;               ///< [0, kComplianceTables) of its radius
};

/// Distances at which a table's rows are known.
struct ComplianceKnots {
  int count = 0;  ///< [2, kComplianceKnots]; 0: no table
  std::array<Real, kComplianceKnots> distance_m{};  ///< [m] > 0, rising
  std::array<Real, kComplianceKnots> log_distance{};
};

/// @param distance_m (count) [m]. Null if valid, else what is wrong, one line.
[[nodiscard]] const char* set_knots(ComplianceKnots& knots, const double* distance_m,
                                    int count) noexcept;

/// One node's row [m^2/N]: c(r) r at the knots.
struct ComplianceRow {
  std::array<float, kComplianceKnots> value{};
};

/// Where a distance lies among the knots.
struct KnotPlace {
  std::int32_t knot = 0;     ///< the interval's first
  Real share = 0.0;          ///< [-] [0, 1] of the way in log r
  Real inverse_per_m = 0.0;  ///< 1 / r, of the first knot below it
  Real share_per_log = 0.0;  ///< d share / d log r
  bool below = false;        ///< nearer than the first knot: c does not change
};

[[nodiscard]] KnotPlace place_among(const ComplianceKnots& knots, Real r_m) noexcept;

/// c(r) [m/N].
[[nodiscard]] inline Real compliance_at(const ComplianceRow& row,
                                        const KnotPlace& at) noexcept {
  const auto k = static_cast<std::size_t>(at.knot);
  const Real from = row.value[k];
  return (from + at.share * (Real(row.value[k + 1]) - from)) * at.inverse_per_m;
}

/// dc/dr [1/N]; of the upper interval at a knot.
[[nodiscard]] inline Real compliance_slope_at(const ComplianceRow& row,
                                              const KnotPlace& at) noexcept {
  if (at.below) {
    return 0.0;
  }
  const auto k = static_cast<std::size_t>(at.knot);
  const Real rise = Real(row.value[k + 1]) - Real(row.value[k]);
  const Real value = Real(row.value[k]) + at.share * rise;
  return (at.share_per_log * rise - value) * at.inverse_per_m * at.inverse_per_m;
}

/// The tool, or the two hands, made once. About 200 kB.
struct ContactSet {
  int count = 0;  ///< [1, kContactsMax]
  int ports = 1;  ///< [1, kPortsMax]
  std::array<ContactSphere, kContactsMax> sphere;
  std::array<ComplianceKnots, kComplianceTables> knots;
  /// (i, j) of one port: their distance among the knots of i.
  std::array<std::array<KnotPlace, kContactsMax>, kContactsMax> apart;
};

/// Places the distances between contacts of one port among the knots of each. Null if
/// the set is valid, else what is wrong with it, one line.
[[nodiscard]] const char* finish(ContactSet& set) noexcept;

/// [m] Longest way from a port's reference point to the far side of a contact: turns a
/// torque into a force. 0 for a port without contacts.
[[nodiscard]] Real lever_m(const ContactSet& set, int port) noexcept;

/// Where contact i is [m].
[[nodiscard]] inline Vector3 centre_of(const ContactSet& set,
                                       const std::array<PortPose, kPortsMax>& pose,
                                       int i) noexcept {
  const ContactSphere& sphere = set.sphere[static_cast<std::size_t>(i)];
  const PortPose& at = pose[static_cast<std::size_t>(sphere.port)];
  return at.position_m + at.rotation * sphere.centre_m;
}

}  // namespace palpate
