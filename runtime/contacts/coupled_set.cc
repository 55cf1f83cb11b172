#include "runtime/contacts/coupled_set.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpate {

namespace {

Real lever_of(const CoupledSet& set, int port) {
  Real longest = 0.0;
  for (int i = 0; i < set.count; ++i) {
    const ContactSphere& at = set.sphere[static_cast<std::size_t>(i)];
    if (at.port == port) {
      longest = std::max(longest, at.centre_m.norm() + at.radius_m);
    }
  }
  return longest > 0.0 ? longest : Real(1.0);
}

}  // namespace

const char* finish(CoupledSet& set) noexcept {
  if (set.count < 1 || set.count > kContactsMax) {
    return "a tool has 1 to 64 contacts";
  }
  if (set.ports < 1 || set.ports > kPortsMax) {
    return "at most two hands press one body together";
  }
  for (int i = 0; i < set.count; ++i) {
    const ContactSphere& at = set.sphere[static_cast<std::size_t>(i)];
    if (!at.centre_m.allFinite() || !(at.radius_m >= 0.0) ||
        !std::isfinite(at.radius_m)) {
      return "contacts must lie at finite places, with radii that are not negative";
    }
    if (at.port < 0 || at.port >= set.ports) {
      return "a contact belongs to a hand that is not there";
    }
    if (at.table < 0 || at.table >= kResponseTables) {
      return "contacts have too many radii";
    }
  }
  if (set.count > 1 && set.knots.count < kFewestKnots) {
    return "several contacts need a table of compliance";
  }
  if (set.modes < 0 || set.modes > static_cast<int>(kMostModes) ||
      set.added_modes < 0 || set.added_modes > set.modes) {
    return "a table of compliance has 0 to 16 modes";
  }
  // The contacts of one port keep r_ij = |x_i - x_j|. Weights of c(r_ij) among the
  // knots of the table are therefore made once. Pairs of two ports do not use theirs.
  for (int i = 0; i < set.count && set.count > 1; ++i) {
    const ContactSphere& a = set.sphere[static_cast<std::size_t>(i)];
    for (int j = 0; j < set.count; ++j) {
      const ContactSphere& b = set.sphere[static_cast<std::size_t>(j)];
      set.apart[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
          compliance_weights(set.knots,
                             static_cast<double>((a.centre_m - b.centre_m).norm()));
    }
  }
  for (int port = 0; port < set.ports; ++port) {
    set.lever_m[static_cast<std::size_t>(port)] = lever_of(set, port);
  }
  return nullptr;
}

}  // namespace palpate
