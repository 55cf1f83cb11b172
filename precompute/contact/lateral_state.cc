#include "precompute/contact/lateral_state.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "formats/response/tangent_frame.h"
#include "precompute/contact/contact_gap.h"
#include "precompute/contact/patch_state.h"

namespace palpate {
namespace {

using StuckFrame = Eigen::Matrix<double, 3, 2>;
// Three tractions along x and y of the frame, and the pressure.
constexpr Eigen::Index kTractions = 3;
constexpr Eigen::Index kAlong = 2 * kTractions;
constexpr Eigen::Index kLoads = kAlong + 1;
using PunchLoad = Eigen::Matrix<double, Eigen::Dynamic, kLoads>;
using LoadCompliance = Eigen::Matrix<double, kLoads, kLoads>;

// Of a tangent's solution: residual over load, and conjugate gradients at most.
constexpr double kTangentResidual = 1e-4;
constexpr int kTangentGradients = 60;

// The pressure of a rigid punch on the nodes in contact.
struct PunchPressure {
  std::vector<std::int32_t> node;  // of the surface
  Eigen::VectorXd q;               // sums to 1
  double rate = 0.0;               // [-] by which q closes gaps with the depth
};

PunchPressure punch_pressure(const ContactSurface& surface,
                             std::span<const std::int32_t> patch,
                             const IndentationPath& path, const Eigen::MatrixXd& A,
                             const Eigen::VectorXd& pressure_n, double penetration_m) {
  std::vector<Eigen::Index> place;
  PunchPressure punch;
  for (Eigen::Index i = 0; i < pressure_n.size(); ++i) {
    if (pressure_n[i] > 0.0) {
      place.push_back(i);
      punch.node.push_back(patch[static_cast<std::size_t>(i)]);
    }
  }
  const PlacedTool tool = tool_at(path, penetration_m);
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

// Shares of the nodes in contact, each column sums to 1: q, even, even at the rim,
// which is all nodes that have a neighbour out of contact.
Eigen::Matrix<double, Eigen::Dynamic, kTractions> tractions(
    const ContactSurface& surface, const PunchPressure& punch) {
  Eigen::Matrix<double, Eigen::Dynamic, kTractions> shares(punch.q.size(), kTractions);
  for (Eigen::Index i = 0; i < punch.q.size(); ++i) {
    const ContactNode& node = node_of(surface, punch.node[static_cast<std::size_t>(i)]);
    const bool inside = std::ranges::all_of(node.neighbours, [&](std::int32_t other) {
      return std::ranges::binary_search(punch.node, other);
    });
    shares.row(i) << punch.q[i], node.area_m2, inside ? 0.0 : node.area_m2;
  }
  if (!(shares.col(2).sum() > 0.0)) {
    shares.col(2) = shares.col(1);
  }
  return shares.array().rowwise() / shares.colwise().sum().array();
}

// The loads of the tractions along x and y of the frame, and of the pressures q.
// @param unknown row of a mesh node's axis, -1: held. @param rows of all.
template <typename Unknown>
PunchLoad punch_load(const ContactSurface& surface, const StuckFrame& frame,
                     const PunchPressure& punch, Eigen::Index rows,
                     const Unknown& unknown) {
  PunchLoad load = PunchLoad::Zero(rows, kLoads);
  const auto shares = tractions(surface, punch);
  for (Eigen::Index i = 0; i < punch.q.size(); ++i) {
    const ContactNode& node = node_of(surface, punch.node[static_cast<std::size_t>(i)]);
    double whole = 0.0;
    for (const NodalForce& entry : node.load) {
      whole -= entry.force.dot(node.normal);
    }
    for (const NodalForce& entry : node.load) {
      const double share = -entry.force.dot(node.normal) / whole;
      for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t row = unknown(entry.node, axis);
        if (row >= 0) {
          for (Eigen::Index k = 0; k < kTractions; ++k) {
            load.row(row).segment<2>(2 * k) += share * shares(i, k) * frame.row(axis);
          }
          load(row, kAlong) += punch.q[i] * entry.force[axis];
        }
      }
    }
  }
  return load;
}

// K_t / k_n.
Eigen::Matrix2d stiffness_ratio(const LoadCompliance& C, double rate) {
  const double normal_n_per_m = rate * rate / C(kAlong, kAlong);
  const Eigen::Matrix<double, kAlong, kAlong> along =
      0.5 * (C + C.transpose()).topLeftCorner<kAlong, kAlong>();
  const Eigen::Matrix<double, kAlong, 2> sums =
      Eigen::Matrix2d::Identity().replicate<kTractions, 1>();
  // Of few nodes the tractions are alike: the decomposition leaves one of them out.
  const Eigen::Matrix<double, kAlong, 2> force =
      along.completeOrthogonalDecomposition().solve(sums);
  return sums.transpose() * force / normal_n_per_m;
}

// x of (K + dK) x = load, with K^-1 as the preconditioner. Of a direction K p is known:
// it is the source that p came from. Empty where the tangent is indefinite.
Eigen::VectorXd tangent_displacement(const PressedState& pressed,
                                     const RestSolve& solve,
                                     const Eigen::VectorXd& load) {
  const auto rest = [&](const Eigen::VectorXd& source) {
    return solve(pressed.near.dof(), source, SolveWith::kFactor);
  };
  Eigen::VectorXd x = Eigen::VectorXd::Zero(load.size());
  Eigen::VectorXd r = load;
  Eigen::VectorXd z = rest(r);
  Eigen::VectorXd along = z;
  Eigen::VectorXd source = r;
  double rz = r.dot(z);
  const double enough = kTangentResidual * kTangentResidual * rz;
  for (int i = 0; i < kTangentGradients && rz > enough; ++i) {
    Eigen::VectorXd image = source;
    pressed.near.add_change(along, image);
    const double curvature = along.dot(image);
    if (!(curvature > 0.0)) {
      return {};
    }
    const double step = rz / curvature;
    x += step * along;
    r -= step * image;
    z = rest(r);
    const double before = rz;
    rz = r.dot(z);
    along = z + rz / before * along;
    source = r + rz / before * source;
  }
  return x;
}

}  // namespace

void add_lateral_states(const CholeskyFactor& factor, const Supports& supports,
                        const ContactSurface& surface,
                        const SurfaceCompliance& compliance,
                        std::span<const std::int32_t> patch,
                        const IndentationPath& path, Indentation& indentation) {
  const std::size_t n = indentation.sample.size();
  if (indentation.contact.size() + 1 != n || n < kContactDepths + 1) {
    return;
  }
  const StuckFrame frame = tangent_frame(path.outward);
  const Eigen::MatrixXd A = compliance.among(patch);
  constexpr auto kD = static_cast<Eigen::Index>(kContactDepths);
  std::vector<PatchState> solved;
  std::vector<double> rate;
  Eigen::MatrixXd load(supports.free, kLoads * kD);
  for (Eigen::Index k = 0; k < kD; ++k) {
    const std::size_t at = (n - 1) * static_cast<std::size_t>(k + 1) / kContactDepths;
    const IndentationSample& sample = indentation.sample[at];
    solved.push_back(indentation.contact[at - 1]);
    const PunchPressure punch = punch_pressure(surface, patch, path, A,
                                               sample.pressure_n, sample.penetration_m);
    rate.push_back(punch.rate);
    load.middleCols<kLoads>(kLoads * k) = punch_load(
        surface, frame, punch, supports.free, [&](std::int32_t node, int axis) {
          return supports.free_index[3 * static_cast<std::size_t>(node) +
                                     static_cast<std::size_t>(axis)];
        });
  }
  const Eigen::MatrixXd moved = factor.solve(load);
  for (Eigen::Index k = 0; k < kD; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const LoadCompliance C = load.middleCols<kLoads>(kLoads * k).transpose() *
                             moved.middleCols<kLoads>(kLoads * k);
    solved[i].lateral = stiffness_ratio(C, rate[i]);
  }
  const double touch_m = indentation.sample.front().penetration_m;
  for (PatchState& state : indentation.contact) {
    state.lateral = between_states(solved, touch_m, state.penetration_m,
                                   [](const PatchState& s) -> Eigen::Matrix2d {
                                     return s.lateral;
                                   });
  }
}

void correct_lateral_states(const PressedState& pressed, const RestSolve& solve,
                            const ContactSurface& surface,
                            const Eigen::MatrixXd& compliance,
                            std::span<const std::int32_t> patch,
                            const IndentationPath& path, Indentation& indentation) {
  if (indentation.contact.empty() || indentation.sample.empty() ||
      !(indentation.contact.front().lateral.trace() > 0.0) ||
      !(pressed.pressure_n.size() > 0 && pressed.pressure_n.maxCoeff() > 0.0)) {
    return;
  }
  const PunchPressure punch = punch_pressure(surface, patch, path, compliance,
                                             pressed.pressure_n, pressed.penetration_m);
  const PunchLoad load = punch_load(
      surface, tangent_frame(path.outward), punch, pressed.near.size(),
      [&](std::int32_t node, int axis) -> std::int64_t {
        const std::int32_t near = pressed.near.near_node(node);
        const std::int64_t row = 3 * std::int64_t{near} + axis;
        return near < 0 || pressed.near.dof()[static_cast<std::size_t>(row)] < 0 ? -1
                                                                                 : row;
      });
  Eigen::VectorXd force_n = Eigen::VectorXd::Zero(pressed.near.size());
  pressed.near.linearise(pressed.state.displacement_m, force_n, false);
  LoadCompliance C;
  for (Eigen::Index k = 0; k < kLoads; ++k) {
    const Eigen::VectorXd x = tangent_displacement(pressed, solve, load.col(k));
    if (x.size() == 0) {
      return;
    }
    C.col(k) = load.transpose() * x;
  }
  const double touch_m = indentation.sample.front().penetration_m;
  const Eigen::Matrix2d there =
      between_states(indentation.contact, touch_m, pressed.penetration_m,
                     [](const PatchState& s) -> Eigen::Matrix2d {
                       return s.lateral;
                     });
  const double times = stiffness_ratio(C, punch.rate).trace() / there.trace() - 1.0;
  take_tangent(indentation, pressed.penetration_m, times);
}

void take_tangent(Indentation& indentation, double penetration_m, double times) {
  if (indentation.sample.empty()) {
    return;
  }
  const double touch_m = indentation.sample.front().penetration_m;
  for (PatchState& state : indentation.contact) {
    const double share = std::clamp(
        (state.penetration_m - touch_m) / (penetration_m - touch_m), 0.0, 1.0);
    state.lateral *= 1.0 + share * times;
    state.by_tangent = times;
  }
}

}  // namespace palpate
