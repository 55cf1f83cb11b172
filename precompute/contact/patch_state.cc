#include "precompute/contact/patch_state.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/LU>

#include "formats/base/reproducible.h"
#include "formats/response/tangent_frame.h"

namespace palpate {
namespace {

using PatchFrame = Eigen::Matrix<double, 3, 2>;

// Second moment about its node of a hat over a regular mesh of edges h, along one
// axis: h^2 / 8, where its integral is sqrt(3) h^2 / 2.
constexpr double kHatMoment = 0.25 / 1.7320508075688772;
// Kurtosis over 4 of pressures with the exponents -0.9 and 17.
constexpr double kLeastKurtosis = 1.05;
constexpr double kMostKurtosis = 1.9;
// Error of the stiffness where the contact's radius is one node spacing, and of what no
// mesh shows.
constexpr double kSpacingError = 0.25;
constexpr double kLeastLateralError = 0.025;
// Of what the tangent changed at the last depth, the error between depths.
constexpr double kTangentError = 0.3;
// Error of the pressure's radius by the node spacing over it, and at least.
constexpr double kRadiusError = 0.35;
constexpr double kLeastRadiusError = 0.01;
// Share of the last depth from which the radius' error holds.
constexpr double kRadiusFrom = 0.25;
// Slopes d ln N / d ln d of a curve that count.
constexpr double kLeastPower = 0.1;
constexpr double kMostPower = 3.0;
constexpr double kPowerSpan = 2.5;

PatchState pressure_state(const ContactSurface& surface,
                          std::span<const std::int32_t> patch,
                          const IndentationPath& path, const PatchFrame& frame,
                          const IndentationSample& sample) {
  PatchState state{.penetration_m = sample.penetration_m};
  const Eigen::VectorXd share = sample.pressure_n / sample.pressure_n.sum();
  const auto node = [&](Eigen::Index i) -> const ContactNode& {
    return node_of(surface, patch[static_cast<std::size_t>(i)]);
  };
  const auto at = [&](Eigen::Index i) -> Eigen::Vector2d {
    return frame.transpose() * (node(i).position_m - path.vertex_m);
  };
  const auto hat = [&](Eigen::Index i) {
    return kHatMoment * node(i).area_m2;
  };
  for (Eigen::Index i = 0; i < share.size(); ++i) {
    state.centre_m += share[i] * at(i);
  }
  for (Eigen::Index i = 0; i < share.size(); ++i) {
    const Eigen::Vector2d from = at(i) - state.centre_m;
    state.moment_m2 +=
        share[i] * (from * from.transpose() + hat(i) * Eigen::Matrix2d::Identity());
  }
  // <rho^4> in the moments' measure, where <rho^2> = 2. A small isotropic hat of
  // variance v adds 4 v rho^2 + 2 v^2 tr.
  const Eigen::Matrix2d inverse = state.moment_m2.inverse();
  double fourth = 0.0;
  for (Eigen::Index i = 0; i < share.size(); ++i) {
    const Eigen::Vector2d from = at(i) - state.centre_m;
    const double r2 = from.dot(inverse * from);
    const double v = 0.5 * hat(i) * inverse.trace();
    fourth += share[i] * (r2 * r2 + 8.0 * v * r2 + 8.0 * v * v);
  }
  const double kurtosis = std::clamp(0.25 * fourth, kLeastKurtosis, kMostKurtosis);
  state.exponent = std::clamp((3.0 * kurtosis - 4.0) / (2.0 - kurtosis),
                              kPressureExponentLeast, kPressureExponentMost);
  return state;
}

// d ln N / d ln d at a penetration: the line nearest to the samples whose depths lie
// within kPowerSpan times of it, with weights d. Exact for powers, and smooth where a
// contact of few nodes makes the force step.
double power_at(const Indentation& indentation, const IndentationPath& path,
                double penetration_m) {
  const auto& sample = indentation.sample;
  const double touch_m = sample.front().penetration_m;
  const double at_m = penetration_m - touch_m;
  Eigen::Matrix2d left = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t k = 1; k < sample.size(); ++k) {
    const double d = (sample[k].penetration_m - touch_m) / at_m;
    const double normal_n = sample[k].force_n.dot(path.outward);
    if (normal_n > 0.0 && d < kPowerSpan && kPowerSpan * d > 1.0) {
      const Eigen::Vector2d row(1.0, reproducible::log(d));
      left += d * row * row.transpose();
      right += d * reproducible::log(normal_n) * row;
    }
  }
  const double determinant = left.determinant();
  const double power = (left(0, 0) * right(1) - left(1, 0) * right(0)) / determinant;
  return determinant > 0.0 ? std::clamp(power, kLeastPower, kMostPower) : 1.0;
}

void put_tensor(RowsOf<float>& rows, std::size_t depth, const Eigen::Matrix2d& tensor) {
  rows.block<1, 3>(0, static_cast<Eigen::Index>(3 * depth)) =
      Eigen::RowVector3d(tensor(0, 0), tensor(0, 1), tensor(1, 1)).cast<float>();
}

}  // namespace

void add_pressure_states(const ContactSurface& surface,
                         std::span<const std::int32_t> patch,
                         const IndentationPath& path, Indentation& indentation) {
  const PatchFrame frame = tangent_frame(path.outward);
  for (const IndentationSample& sample : indentation.sample) {
    if (sample.pressure_n.size() > 0 && sample.pressure_n.sum() > 0.0) {
      indentation.contact.push_back(
          pressure_state(surface, patch, path, frame, sample));
      indentation.contact.back().spacing_ratio =
          indentation.node_spacing_m / sample.contact_radius_m;
    }
  }
}

ContactTable stored_contact(const Indentation& indentation,
                            const IndentationPath& path) {
  ContactTable row;
  if (indentation.contact.empty() || indentation.sample.size() < 4) {
    return row;
  }
  constexpr auto kD = static_cast<Eigen::Index>(kContactDepths);
  const double touch_m = indentation.sample.front().penetration_m;
  const double depth_m = indentation.sample.back().penetration_m - touch_m;
  const bool lateral = indentation.contact.front().lateral.trace() > 0.0;
  row.centre_m.resize(1, 2 * kD);
  row.moment_m2.resize(1, 3 * kD);
  row.exponent.resize(1, kD);
  row.pressure_error.resize(1, 1);
  row.lateral.resize(lateral ? 1 : 0, 3 * kD);
  row.lateral_error.resize(lateral ? 1 : 0, 1);
  const auto spacing_at = [&](double share) {
    return between_states(indentation.contact, touch_m, touch_m + share * depth_m,
                          [](const PatchState& s) {
                            return s.spacing_ratio;
                          });
  };
  for (std::size_t k = 0; k < kContactDepths; ++k) {
    const double at_m = touch_m + kContactDepthShares[k] * depth_m;
    const auto at = [&](const auto& value) {
      return between_states(indentation.contact, touch_m, at_m, value);
    };
    row.centre_m.block<1, 2>(0, static_cast<Eigen::Index>(2 * k)) =
        at([](const PatchState& s) -> Eigen::Vector2d {
          return s.centre_m;
        })
            .transpose()
            .cast<float>();
    put_tensor(row.moment_m2, k, at([](const PatchState& s) -> Eigen::Matrix2d {
                 return s.moment_m2;
               }));
    row.exponent(0, static_cast<Eigen::Index>(k)) =
        static_cast<float>(at([](const PatchState& s) {
          return s.exponent;
        }));
    if (lateral) {
      const Eigen::Matrix2d ratio = at([](const PatchState& s) -> Eigen::Matrix2d {
        return s.lateral;
      });
      put_tensor(row.lateral, k, power_at(indentation, path, at_m) * ratio);
    }
  }
  row.pressure_error(0, 0) = static_cast<float>(
      std::max(kLeastRadiusError, kRadiusError * spacing_at(kRadiusFrom)));
  if (lateral) {
    const double spacing = spacing_at(1.0);
    row.lateral_error(0, 0) = static_cast<float>(
        std::hypot(kLeastLateralError, kSpacingError * spacing * spacing,
                   kTangentError * indentation.contact.back().by_tangent));
  }
  return broken_contact_row(row, 0).empty() ? row : ContactTable{};
}

}  // namespace palpate
