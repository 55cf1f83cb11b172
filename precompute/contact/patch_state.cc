#include "precompute/contact/patch_state.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "formats/base/reproducible.h"
#include "formats/response/tangent_frame.h"
#include "precompute/contact/contact_gap.h"

namespace palpate {
namespace {

using Frame = Eigen::Matrix<double, 3, 2>;

// Second moment about its node of a hat over a regular mesh of edges h, along one
// axis: h^2 / 8, where its integral is sqrt(3) h^2 / 2.
constexpr double kHatMoment = 0.25 / 1.7320508075688772;
// Kurtosis over 4 of pressures with the exponents -0.9 and 17.
constexpr double kLeastKurtosis = 1.05;
constexpr double kMostKurtosis = 1.9;
// Error of the stiffness where the contact's radius is one node spacing, and of what no
// mesh shows.
constexpr double kSpacingError = 0.25;
constexpr double kLeastLateralError = 0.02;
// Slopes d ln N / d ln d of a curve that count.
constexpr double kLeastPower = 0.1;
constexpr double kMostPower = 3.0;

PatchState pressure_state(const ContactSurface& surface,
                          std::span<const std::int32_t> patch,
                          const IndentationPath& path, const Frame& frame,
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

// The pressure of a rigid punch on the nodes in contact.
struct PunchPressure {
  std::vector<std::int32_t> node;  // of the surface
  Eigen::VectorXd q;               // sums to 1
  double rate = 0.0;               // [-] by which q closes gaps with the depth
};

PunchPressure punch_pressure(const ContactSurface& surface,
                             std::span<const std::int32_t> patch,
                             const IndentationPath& path, const Eigen::MatrixXd& A,
                             const IndentationSample& sample) {
  std::vector<Eigen::Index> place;
  PunchPressure punch;
  for (Eigen::Index i = 0; i < sample.pressure_n.size(); ++i) {
    if (sample.pressure_n[i] > 0.0) {
      place.push_back(i);
      punch.node.push_back(patch[static_cast<std::size_t>(i)]);
    }
  }
  const PlacedTool tool = tool_at(path, sample.penetration_m);
  Eigen::VectorXd rate(static_cast<Eigen::Index>(place.size()));
  for (Eigen::Index i = 0; i < rate.size(); ++i) {
    const ContactNode& node = node_of(surface, punch.node[static_cast<std::size_t>(i)]);
    rate[i] = average_gap(node, tool).by_tool.dot(path.outward);
  }
  punch.q = Eigen::MatrixXd(A(place, place)).ldlt().solve(rate);
  punch.q /= punch.q.sum();
  punch.rate = rate.dot(punch.q);
  return punch;
}

// The loads of tractions q along x and y of the frame, and of pressures q, over the
// free unknowns.
using PunchLoad = Eigen::Matrix<double, Eigen::Dynamic, 3>;
PunchLoad punch_load(const Supports& supports, const ContactSurface& surface,
                     const Frame& frame, const PunchPressure& punch) {
  PunchLoad load = PunchLoad::Zero(supports.free, 3);
  for (Eigen::Index i = 0; i < punch.q.size(); ++i) {
    const ContactNode& node = node_of(surface, punch.node[static_cast<std::size_t>(i)]);
    double whole = 0.0;
    for (const NodalForce& entry : node.load) {
      whole -= entry.force.dot(node.normal);
    }
    for (const NodalForce& entry : node.load) {
      const double share = punch.q[i] * -entry.force.dot(node.normal) / whole;
      for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t dof =
            supports.free_index[3 * static_cast<std::size_t>(entry.node) +
                                static_cast<std::size_t>(axis)];
        if (dof >= 0) {
          load.row(dof).head<2>() += share * frame.row(axis);
          load(dof, 2) += punch.q[i] * entry.force[axis];
        }
      }
    }
  }
  return load;
}

// Between the states around, linear in the root of the depth past the touch: in a
// ball's contact radius.
template <typename Value>
auto between_states(std::span<const PatchState> states, double touch_m,
                    double penetration_m, const Value& value) {
  const auto above = std::lower_bound(states.begin(), states.end(), penetration_m,
                                      [](const PatchState& state, double at) {
                                        return state.penetration_m < at;
                                      });
  if (above == states.begin()) {
    return value(states.front());
  }
  if (above == states.end()) {
    return value(states.back());
  }
  const PatchState& low = *(above - 1);
  const auto root = [&](double at_m) {
    return std::sqrt(std::max(0.0, at_m - touch_m));
  };
  const double t = (root(penetration_m) - root(low.penetration_m)) /
                   (root(above->penetration_m) - root(low.penetration_m));
  return decltype(value(low))(value(low) + t * (value(*above) - value(low)));
}

// d ln N / d ln d at a penetration, from the samples around: exact for powers.
double power_at(const Indentation& indentation, const IndentationPath& path,
                double penetration_m) {
  const auto& sample = indentation.sample;
  const double touch_m = sample.front().penetration_m;
  std::size_t k = 2;
  while (k + 1 < sample.size() && sample[k].penetration_m < penetration_m) {
    ++k;
  }
  const std::size_t high = std::min(k + 1, sample.size() - 1);
  const std::size_t low = high - 2;
  const auto log_ratio = [&](const auto& of) {
    return reproducible::log(of(sample[high]) /
                             of(sample[std::max<std::size_t>(low, 1)]));
  };
  const double forces = log_ratio([&](const IndentationSample& s) {
    return std::max(s.force_n.dot(path.outward), 1e-30);
  });
  const double depths = log_ratio([&](const IndentationSample& s) {
    return s.penetration_m - touch_m;
  });
  return std::clamp(forces / depths, kLeastPower, kMostPower);
}

void put_tensor(RowsOf<float>& rows, std::size_t depth, const Eigen::Matrix2d& tensor) {
  rows.block<1, 3>(0, static_cast<Eigen::Index>(3 * depth)) =
      Eigen::RowVector3d(tensor(0, 0), tensor(0, 1), tensor(1, 1)).cast<float>();
}

}  // namespace

void add_pressure_states(const ContactSurface& surface,
                         std::span<const std::int32_t> patch,
                         const IndentationPath& path, Indentation& indentation) {
  const Frame frame = tangent_frame(path.outward);
  for (const IndentationSample& sample : indentation.sample) {
    if (sample.pressure_n.size() > 0 && sample.pressure_n.sum() > 0.0) {
      indentation.contact.push_back(
          pressure_state(surface, patch, path, frame, sample));
      indentation.contact.back().spacing_ratio =
          indentation.node_spacing_m / sample.contact_radius_m;
    }
  }
}

void add_lateral_states(const CholeskyFactor& factor, const Supports& supports,
                        const ContactSurface& surface,
                        const SurfaceCompliance& compliance,
                        std::span<const std::int32_t> patch,
                        const IndentationPath& path, Indentation& indentation) {
  const std::size_t n = indentation.sample.size();
  if (indentation.contact.size() + 1 != n || n < kContactDepths + 1) {
    return;
  }
  const Frame frame = tangent_frame(path.outward);
  const Eigen::MatrixXd A = compliance.among(patch);
  constexpr auto kD = static_cast<Eigen::Index>(kContactDepths);
  std::vector<PatchState> solved;
  std::vector<double> rate;
  Eigen::MatrixXd load(supports.free, 3 * kD);
  for (Eigen::Index k = 0; k < kD; ++k) {
    const std::size_t at = (n - 1) * static_cast<std::size_t>(k + 1) / kContactDepths;
    solved.push_back(indentation.contact[at - 1]);
    const PunchPressure punch =
        punch_pressure(surface, patch, path, A, indentation.sample[at]);
    rate.push_back(punch.rate);
    load.middleCols<3>(3 * k) = punch_load(supports, surface, frame, punch);
  }
  const Eigen::MatrixXd moved = factor.solve(load);
  for (Eigen::Index k = 0; k < kD; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const Eigen::Matrix3d C =
        load.middleCols<3>(3 * k).transpose() * moved.middleCols<3>(3 * k);
    const double normal_n_per_m = rate[i] * rate[i] / C(2, 2);
    const Eigen::Matrix2d along = 0.5 * (C + C.transpose()).topLeftCorner<2, 2>();
    solved[i].lateral = along.inverse() / normal_n_per_m;
  }
  const double touch_m = indentation.sample.front().penetration_m;
  for (PatchState& state : indentation.contact) {
    state.lateral = between_states(solved, touch_m, state.penetration_m,
                                   [](const PatchState& s) -> Eigen::Matrix2d {
                                     return s.lateral;
                                   });
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
  row.lateral.resize(lateral ? 1 : 0, 3 * kD);
  row.lateral_error.resize(lateral ? 1 : 0, 1);
  double spacing = 0.0;
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
    spacing = at([](const PatchState& s) {
      return s.spacing_ratio;
    });
    if (lateral) {
      const Eigen::Matrix2d ratio = at([](const PatchState& s) -> Eigen::Matrix2d {
        return s.lateral;
      });
      put_tensor(row.lateral, k, power_at(indentation, path, at_m) * ratio);
    }
  }
  if (lateral) {
    row.lateral_error(0, 0) = static_cast<float>(
        std::hypot(kLeastLateralError, kSpacingError * spacing * spacing));
  }
  return broken_contact_row(row, 0).empty() ? row : ContactTable{};
}

}  // namespace palpate
