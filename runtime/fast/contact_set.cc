#include "runtime/fast/contact_set.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpate {

const char* set_knots(ComplianceKnots& knots, const double* distance_m,
                      int count) noexcept {
  if (count < 2 || count > kComplianceKnots) {
    return "a table of compliance has 2 to 32 distances";
  }
  knots.count = count;
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const auto r = static_cast<Real>(distance_m[i]);
    if (!(r > 0.0) || !std::isfinite(r) || (i > 0 && !(r > knots.distance_m[at - 1]))) {
      return "distances of a table of compliance must be above zero and rise";
    }
    knots.distance_m[at] = r;
    knots.log_distance[at] = std::log(r);
  }
  return nullptr;
}

KnotPlace place_among(const ComplianceKnots& knots, Real r_m) noexcept {
  KnotPlace at;
  const auto last = static_cast<std::size_t>(knots.count - 1);
  if (!(r_m > knots.distance_m[0])) {
    at.inverse_per_m = Real(1.0) / knots.distance_m[0];
    at.below = true;
    return at;
  }
  at.inverse_per_m = Real(1.0) / r_m;
  if (!(r_m < knots.distance_m[last])) {
    at.knot = static_cast<std::int32_t>(last) - 1;
    at.share = 1.0;
    return at;
  }
  const Real x = std::log(r_m);
  const auto* begin = knots.log_distance.data();
  const auto* upper = std::upper_bound(begin + 1, begin + last, x);
  at.knot = static_cast<std::int32_t>(upper - begin) - 1;
  at.share_per_log = Real(1.0) / (upper[0] - upper[-1]);
  at.share = std::clamp((x - upper[-1]) * at.share_per_log, Real(0.0), Real(1.0));
  return at;
}

const char* finish(ContactSet& set) noexcept {
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
    if (at.table < 0 || at.table >= kComplianceTables ||
        (set.count > 1 && set.knots[static_cast<std::size_t>(at.table)].count == 0)) {
      return "several contacts need a table of compliance for each radius";
    }
  }
  for (int i = 0; i < set.count && set.count > 1; ++i) {
    const ContactSphere& a = set.sphere[static_cast<std::size_t>(i)];
    const ComplianceKnots& knots = set.knots[static_cast<std::size_t>(a.table)];
    for (int j = 0; j < set.count; ++j) {
      const ContactSphere& b = set.sphere[static_cast<std::size_t>(j)];
      set.apart[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
          place_among(knots, (a.centre_m - b.centre_m).norm());
    }
  }
  return nullptr;
}

Real lever_m(const ContactSet& set, int port) noexcept {
  Real longest = 0.0;
  for (int i = 0; i < set.count; ++i) {
    const ContactSphere& at = set.sphere[static_cast<std::size_t>(i)];
    if (at.port == port) {
      longest = std::max(longest, at.centre_m.norm() + at.radius_m);
    }
  }
  return longest;
}

}  // namespace palpate
