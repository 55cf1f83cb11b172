#include "precompute/contact/indentation_response.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "formats/base/reproducible.h"
#include "formats/database/place_check.h"
#include "formats/mesh/angle_between.h"
#include "formats/response/force_difference.h"
#include "precompute/contact/patch_state.h"

namespace palpate {
namespace {

// The error of a mesh is 1/(2^p - 1) of its difference to one twice as coarse, where
// the order is p: 1.5, between that of the contact's edge and that of its inside.
constexpr double kErrorPerDifference = 0.55;
// What no estimate sees of a mesh that was made for a budget, over that budget: mostly
// what the body's own mesh makes. With half of it, the nodes of an organ and a liver
// whose estimates are least decided the factor that checks ask for
// (error_calibration.h).
constexpr double kLeastErrorShare = 0.2;

double largest_force_n(const Indentation& indentation) {
  double largest = 0.0;
  for (const IndentationSample& sample : indentation.sample) {
    largest = std::max(largest, sample.force_n.norm());
  }
  return largest;
}

// The press's tilts as a line. What sticks is pushed along the surface by friction,
// too: its mean direction tells no slope of an energy, and a line would not be better.
TiltLine tilt_of(const Indentation& indentation, const IndentationPath& path,
                 const NodeResponse& response) {
  if (path.tool && path.tool->shape().sticking) {
    return tilt_line(response.direction, path.outward);
  }
  std::vector<double> past_touch_m;
  Points force_n(static_cast<Eigen::Index>(indentation.sample.size()), 3);
  for (const IndentationSample& sample : indentation.sample) {
    force_n.row(static_cast<Eigen::Index>(past_touch_m.size())) =
        sample.force_n.transpose();
    past_touch_m.push_back(sample.penetration_m - response.touch_offset_m);
  }
  return tilt_line(past_touch_m, force_n, path.outward);
}

// The largest error [N] of a sample, as force_difference() counts. Where the tool has
// left contact again an error relative to nothing says nothing.
template <typename ErrorOf>
double largest_error(const Indentation& indentation, const ErrorOf& error_n) {
  const double from_m = kErrorCountsFrom * indentation.sample.back().penetration_m;
  const double least_n = kErrorCountsFrom * largest_force_n(indentation);
  double largest = 0.0;
  for (const IndentationSample& sample : indentation.sample) {
    if (sample.penetration_m >= from_m) {
      largest =
          std::max(largest, error_n(sample) / std::max(sample.force_n.norm(), least_n));
    }
  }
  return largest;
}

// What the line of a press's tilts makes of its force's direction [-].
double turn_error(const Indentation& indentation, const IndentationPath& path,
                  const NodeResponse& response) {
  return largest_error(indentation, [&](const IndentationSample& sample) {
    const double past_touch_m = sample.penetration_m - response.touch_offset_m;
    const Eigen::Vector3d kept =
        sample.force_n.norm() * tilted(path.outward, response.tilt->at(past_touch_m));
    return (kept - sample.force_n).norm();
  });
}

}  // namespace

double pressure_mesh_error(const Indentation& indentation) {
  return kErrorPerDifference *
         largest_error(indentation, [](const IndentationSample& sample) {
           return std::abs(sample.coarse_force_n - sample.force_n.norm());
         });
}

double mesh_error(const NodeResponse& coarse, const NodeResponse& finer,
                  const Eigen::Vector3d& outward) {
  return kErrorPerDifference * response_difference(coarse, finer, outward);
}

NodeResponse to_response(const Indentation& indentation, const IndentationPath& path,
                         double force_relative_budget) {
  NodeResponse response;
  if (indentation.sample.size() < 2 || !indentation.converged) {
    response.flags = indentation.converged ? 0 : kFailed;
    return response;
  }
  if (largest_force_n(indentation) == 0.0) {
    return response;
  }
  response.origin = ResponseOrigin::kSimulated;
  // Direction: the force's integral over the path, by the trapezoidal rule.
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t k = 1; k < indentation.sample.size(); ++k) {
    const IndentationSample& before = indentation.sample[k - 1];
    const IndentationSample& after = indentation.sample[k];
    mean += 0.5 * (before.force_n + after.force_n) *
            (after.penetration_m - before.penetration_m);
  }
  response.direction = mean.normalized();
  response.touch_offset_m = indentation.sample.front().penetration_m;
  // Deflection d = (delta - touch offset) |n . u| (GLOSSARY.md).
  const double along = std::abs(path.outward.dot(response.direction));
  for (const IndentationSample& sample : indentation.sample) {
    response.depth_m.push_back((sample.penetration_m - response.touch_offset_m) *
                               along);
    response.force_n.push_back(sample.force_n.norm());
    if (sample.force_n.norm() > 0.0) {
      response.direction_spread_rad =
          std::max(response.direction_spread_rad,
                   angle_between(sample.force_n, response.direction));
    }
  }
  if (reproducible::sin(response.direction_spread_rad) > force_relative_budget) {
    // One direction alone would cost more than the budget of the force.
    for (const IndentationSample& sample : indentation.sample) {
      const double force_n = sample.force_n.norm();
      response.sample_direction.push_back(
          force_n > 0.0 ? (sample.force_n / force_n).eval() : response.direction);
    }
    response.sample_direction.front() = response.sample_direction[1];
  }
  response.tilt = tilt_of(indentation, path, response);
  response.contact = stored_contact(indentation, path);
  const double turn = turn_error(indentation, path, response);
  const IndentationSample& last = indentation.sample.back();
  // Two meshes may agree by chance.
  const double mesh =
      std::max(indentation.mesh_error, pressure_mesh_error(indentation));
  response.error_relative =
      std::hypot(std::hypot(mesh, indentation.path_error, indentation.edge_share), turn,
                 std::hypot(indentation.exterior_error_relative,
                            kLeastErrorShare * force_relative_budget));
  const auto flag_if = [&](bool set, ResponseFlag flag) {
    response.flags = static_cast<std::uint8_t>(response.flags | (set ? flag : 0));
  };
  flag_if(indentation.force_capped, kForceCapped);
  flag_if(last.contact_radius_m < 1.5 * indentation.node_spacing_m, kCoarseContact);
  flag_if(indentation.near_singular, kNearSingular);
  flag_if(indentation.reaches_elsewhere, kErrorOverBudget);
  return response;
}

}  // namespace palpate
