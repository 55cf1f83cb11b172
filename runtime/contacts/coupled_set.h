// A tool's contacts: spheres that are fixed to a port, and how far apart they are.
//
// A port is what a hand or device holds: a pose in, a wrench out. The contacts of one
// port keep their distances, so the distances at which the body's compliance is read
// are fixed once. Contacts of two ports (two hands on one body) move against each
// other.
//
// Compliance: with n_a the area coordinates of a contact's place and the nodes' rows of
// compliance_row.h, c_i = sum n_a c_a and
//
//   C_ij = (c_i(r_ij) + c_j(r_ij)) / 2 + sum_m s_m b_im b_jm,
//
// b_m the modes by which parts of the body move as a whole, blended likewise. All
// contacts read one table: what couples them is the body's.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "formats/response/compliance_row.h"
#include "runtime/account/local_model.h"
#include "runtime/account/real.h"
#include "runtime/contacts/coupled_contacts.h"

namespace palpate {

constexpr int kPortsMax = 2;
constexpr int kComplianceKnots = 32;  ///< at most
constexpr int kResponseTables = 8;    ///< of distinct radii, at most

/// Where a port is: x = position + rotation p of a point p of its frame.
struct PortPose {
  Vector3 position_m = Vector3::Zero();    ///< [m] reference point
  Matrix3 rotation = Matrix3::Identity();  ///< [-] a rotation
};

struct ContactSphere {
  Vector3 centre_m = Vector3::Zero();  ///< [m] in the port's frame
  Real radius_m = 0.0;                 ///< [m] >= 0
  std::int8_t port = 0;                ///< [0, kPortsMax)
  std::int8_t table = 0;               ///< [0, kResponseTables) of its responses
};

/// One node's row and modes, v and b of compliance_row.h; beyond their numbers 0.
struct ContactRow {
  std::array<float, kMostKnots> value{};
  std::array<float, kMostModes> mode{};
};

/// c(r) of a row [m/N]. @param at of r.
[[nodiscard]] inline Real reach_m_per_n(const ContactRow& row,
                                        const ComplianceWeights& at) noexcept {
  double sum = 0.0;
  for (std::size_t k = 0; k < at.value.size(); ++k) {
    sum += at.value[k] * static_cast<double>(row.value[at.first + k]);
  }
  return static_cast<Real>(sum);
}

/// The tool, or the two hands, made once. About 300 kB.
struct CoupledSet {
  int count = 0;  ///< [1, kContactsMax]
  int ports = 1;  ///< [1, kPortsMax]
  FieldKind field = FieldKind::kSmooth;
  std::array<ContactSphere, kContactsMax> sphere;
  ComplianceKnots knots;  ///< without: contacts do not couple
  int modes = 0;          ///< [0, kMostModes]
  int added_modes = 0;    ///< the first of them, [0, modes]
  /// (i, j) of one port: their distance among the knots.
  std::array<std::array<ComplianceWeights, kContactsMax>, kContactsMax> apart;
  /// [m] > 0 Longest way from each port's reference point to the far side of a contact.
  /// The lever turns a torque into a force. 1 m where there is no contact.
  std::array<Real, kPortsMax> lever_m{1.0, 1.0};
};

/// Fills `apart` and lever_m. Null if the set is valid, else what is wrong with it, one
/// line.
[[nodiscard]] const char* finish(CoupledSet& set) noexcept;

/// Where contact i is [m].
[[nodiscard]] inline Vector3 centre_of(const CoupledSet& set,
                                       const std::array<PortPose, kPortsMax>& pose,
                                       int i) noexcept {
  const ContactSphere& sphere = set.sphere[static_cast<std::size_t>(i)];
  const PortPose& at = pose[static_cast<std::size_t>(sphere.port)];
  return at.position_m + at.rotation * sphere.centre_m;
}

}  // namespace palpate
