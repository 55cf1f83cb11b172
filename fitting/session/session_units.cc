#include "fitting/session/session_units.h"

#include <array>
#include <cstddef>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/mesh/surface_search.h"

namespace palpate {
namespace {

constexpr double kSpreadShare = 0.01;  // [-] of the body's diagonal
constexpr double kDeepShare = 0.5;     // [-] of its smallest side
constexpr std::array kSlips = {1e-3, 1e3, 1e-2, 1e2, 1e-1, 1e1, 1e-6, 1e6};

std::vector<Eigen::Vector3d> positions_of(const Session& session) {
  std::vector<Eigen::Vector3d> positions;
  for (const SessionRun& run : session.run) {
    if (run.position_m && run.position_m->allFinite()) {
      positions.push_back(*run.position_m);
    }
  }
  return positions;
}

// How many of them, times `factor`, lie on the body.
std::size_t on_body(const SurfaceSearch& surface,
                    const std::vector<Eigen::Vector3d>& positions, double factor,
                    double within_m) {
  std::size_t count = 0;
  for (const Eigen::Vector3d& p : positions) {
    count += surface.nearest(factor * p).distance_m <= within_m ? 1 : 0;
  }
  return count;
}

// 0: none of the usual slips explains where they lie.
double slip_of(const SurfaceSearch& surface,
               const std::vector<Eigen::Vector3d>& positions, double within_m) {
  for (const double factor : kSlips) {
    if (10 * on_body(surface, positions, factor, within_m) >= 9 * positions.size()) {
      return factor;
    }
  }
  return 0.0;
}

// Which keys hold the two units, and what they say now.
std::string where_to_mend(const Session& session) {
  return fmt::format(
      "is length_unit of {} right, and length_unit of [body], now \"{}\"?",
      session.points_unit.empty()
          ? std::string("[points] (position_m of [[run]] is in metres)")
          : fmt::format("[points], now \"{}\",", session.points_unit),
      session.length_unit);
}

}  // namespace

std::vector<std::string> unit_notes(const Session& session, const SurfaceMesh& body) {
  const std::vector<Eigen::Vector3d> positions = positions_of(session);
  if (positions.empty() || body.triangle.rows() == 0) {
    return {};
  }
  const double size_m = bounding_box(body).diagonal().norm();
  const double within_m = kOnBodyShare * size_m;
  const SurfaceSearch surface(body);
  const std::size_t there = on_body(surface, positions, 1.0, within_m);
  if (2 * there < positions.size()) {
    const double slip = slip_of(surface, positions, within_m);
    throw InputError(fmt::format(
        "{}: {} of {} positions lie farther than {:.3g} m from the body, which is "
        "{:.3g} m large{}: {}{}",
        session.file.string(), positions.size() - there, positions.size(), within_m,
        size_m, slip > 0.0 ? fmt::format("; times {:g} they lie on it", slip) : "",
        where_to_mend(session),
        slip > 0.0 ? "" : " Both must be in one frame, or [registration] be told"));
  }
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : positions) {
    box.extend(p);
  }
  const double spread_m = box.diagonal().norm();
  const bool many = positions.size() > 1 && spread_m > 0.0;
  if (many && spread_m < kSpreadShare * size_m) {
    for (const double factor : {1e3, 1e2, 1e1}) {
      if (on_body(surface, positions, factor, within_m) == positions.size()) {
        return {fmt::format(
            "all positions lie within {:.3g} m of a body of {:.3g} m, and times {:g} "
            "they lie on it, too: {}",
            spread_m, size_m, factor, where_to_mend(session))};
      }
    }
  }
  return {};
}

std::vector<std::string> depth_notes(const Session& session, const SurfaceMesh& body,
                                     double depth_max_m) {
  const double side_m = bounding_box(body).sizes().minCoeff();
  if (!(side_m > 0.0) || depth_max_m <= kDeepShare * side_m) {
    return {};
  }
  return {fmt::format(
      "presses go {:.3g} m deep into a body whose smallest side is {:.3g} m: is "
      "length_unit of [body], now \"{}\", right, and depth_unit of [read]?",
      depth_max_m, side_m, session.length_unit)};
}

}  // namespace palpate
