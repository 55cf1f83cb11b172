#include "precompute/press/joint_presses.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <mutex>
#include <random>

#include <Eigen/LU>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/database/error_calibration.h"
#include "formats/response/memory_sites.h"
#include "formats/response/response_curve.h"
#include "precompute/contact/complementarity.h"
#include "precompute/contact/gaps_along.h"
#include "precompute/contact/indentation_response.h"
#include "precompute/press/contact_coupling.h"
#include "precompute/press/contact_spot.h"
#include "precompute/process/failure_of.h"
#include "precompute/process/parallel.h"

namespace palpate {
namespace {

constexpr double kFarthestInRadii = 7.0;

// Gaps of all contact nodes to the nearest tool, and whose it is.
struct MergedGaps {
  Eigen::VectorXd distance_m;   // (n)
  Eigen::MatrixX3d by_centre;   // (n x 3)
  std::vector<std::size_t> of;  // (n) tool
};

MergedGaps merged_gaps(const ContactSurface& surface, std::span<const std::int32_t> all,
                       std::span<const PressedNode> nodes,
                       const Eigen::VectorXd& penetration_m) {
  const auto n = static_cast<Eigen::Index>(all.size());
  MergedGaps merged{
      Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity()),
      Eigen::MatrixX3d::Zero(n, 3), std::vector<std::size_t>(all.size())};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::vector<std::int32_t>& patch = nodes[i].patch;
    const Gaps gaps = gaps_at(surface, patch, nodes[i].path,
                              penetration_m[static_cast<Eigen::Index>(i)]);
    for (std::size_t j = 0; j < patch.size(); ++j) {
      const auto from = static_cast<Eigen::Index>(j);
      const auto row = std::lower_bound(all.begin(), all.end(), patch[j]) - all.begin();
      // A node that several tools may touch meets the nearest.
      if (gaps.distance_m[from] < merged.distance_m[row]) {
        merged.distance_m[row] = gaps.distance_m[from];
        merged.by_centre.row(row) = gaps.by_centre.row(from);
        merged.of[static_cast<std::size_t>(row)] = i;
      }
    }
  }
  return merged;
}

// A contact alone: its curve, and the depth along it of a penetration.
struct SingleContact {
  NodeResponse response;
  ResponseCurve curve;
  double cosine = 1.0;

  [[nodiscard]] double depth_m(double penetration_m) const {
    return (penetration_m - response.touch_offset_m) * cosine;
  }
};

SingleContact alone(const Scene& scene, const BodyModel& model,
                    const SurfaceCompliance& compliance, PressedNode& node) {
  press_linear(model, compliance, node);
  const NodeResponse response =
      to_response(node.indentation, node.path, scene.force_relative);
  if (!node.failure.empty() || response.depth_m.size() < 2) {
    throw NumericalError(
        fmt::format("vertex {} cannot be pressed: {}", node.vertex,
                    node.failure.empty() ? "nothing is touched" : node.failure));
  }
  return {response,
          {response.depth_m, response.force_n},
          std::abs(node.path.outward.dot(response.direction))};
}

Eigen::VectorXd joint_forces_n(const BodyModel& model,
                               std::span<const std::int32_t> all,
                               const Eigen::MatrixXd& A,
                               std::span<const PressedNode> nodes,
                               const Eigen::VectorXd& penetration_m) {
  // One problem for all tools: w = g + A f >= 0, f >= 0, w . f = 0 over all their
  // nodes.
  const MergedGaps gaps = merged_gaps(model.contact, all, nodes, penetration_m);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(A.rows());
  if (!solve_complementarity(A, gaps.distance_m, f).converged) {
    throw NumericalError(
        "the joint contact's complementarity problem did not converge");
  }
  Eigen::MatrixX3d force_n = Eigen::MatrixX3d::Zero(std::ssize(nodes), 3);
  for (Eigen::Index j = 0; j < f.size(); ++j) {
    force_n.row(static_cast<Eigen::Index>(gaps.of[static_cast<std::size_t>(j)])) +=
        f[j] * gaps.by_centre.row(j);
  }
  return force_n.rowwise().norm();
}

// Compliances between vertices by the table; diagonal 0.
Eigen::MatrixXd by_table(const ComplianceTable& coupling, const Points& position_m,
                         std::span<const std::int32_t> vertices) {
  const ComplianceKnots knots = knots_of(coupling);
  const auto n = std::ssize(vertices);
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const std::int32_t v = vertices[static_cast<std::size_t>(i)];
      const std::int32_t w = vertices[static_cast<std::size_t>(j)];
      if (i != j) {
        C(i, j) = node_coupling_m_per_n(coupling, knots, v, w,
                                        (position_m.row(v) - position_m.row(w)).norm());
      }
    }
  }
  return C;
}

void add_errors(const Eigen::VectorXd& joint_n, const Eigen::VectorXd& found_n,
                std::vector<double>& errors) {
  for (Eigen::Index i = 0; i < joint_n.size(); ++i) {
    errors.push_back(std::abs(found_n[i] - joint_n[i]) / joint_n.maxCoeff());
  }
}

}  // namespace

Eigen::VectorXd coupled_forces_n(std::span<const CurveView> curve,
                                 const Eigen::VectorXd& depth_m,
                                 const Eigen::MatrixXd& compliance_m_per_n) {
  // Solves g(delta) = delta + C f(delta) - d = 0 by Newton's method, J = 1 + C
  // diag(f'). C has no diagonal: a contact's own compliance is in its curve f.
  constexpr int kSteps = 200;
  const Eigen::Index n = depth_m.size();
  Eigen::MatrixXd C = compliance_m_per_n;
  C.diagonal().setZero();
  Eigen::VectorXd delta = depth_m;
  Eigen::VectorXd f(n);
  Eigen::VectorXd k(n);
  const auto residual = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
    for (Eigen::Index i = 0; i < n; ++i) {
      const ResponseSample sample = curve[static_cast<std::size_t>(i)].at(at[i]);
      f[i] = sample.force_n;
      k[i] = sample.stiffness_n_per_m;
    }
    return at + C * f - depth_m;
  };
  Eigen::VectorXd g = residual(delta);
  const double small = 1e-10 * depth_m.cwiseAbs().maxCoeff();
  for (int step = 0; step < kSteps && g.norm() > small; ++step) {
    const Eigen::MatrixXd J =
        Eigen::MatrixXd::Identity(n, n) + C * k.asDiagonal().toDenseMatrix();
    const Eigen::VectorXd by = J.partialPivLu().solve(-g);
    const double before = g.norm();
    // The step is halved while the residual grows, down to a thousandth.
    double share = 1.0;
    Eigen::VectorXd next = delta + by;
    g = residual(next);
    while (g.norm() > before && share > 1e-3) {
      share *= 0.5;
      next = delta + share * by;
      g = residual(next);
    }
    delta = next;
  }
  if (!(g.norm() <= small)) {
    throw NumericalError(
        fmt::format("forces of {} contacts that couple did not converge", n));
  }
  return f;
}

JointPress press_jointly(const Scene& scene, const BodySource& body,
                         const BodyModel& model, const SharedTool& tool,
                         std::span<const std::int32_t> vertices,
                         const Eigen::VectorXd& depth_share,
                         const ComplianceTable& coupling) {
  std::vector<PressedNode> nodes;
  for (const std::int32_t v : vertices) {
    nodes.push_back(placed_node(scene, body, model, tool, v));
    nodes.back().path.force_max_n = std::numeric_limits<double>::infinity();
  }
  const std::vector<std::int32_t> all = patches_of(nodes);
  const SurfaceCompliance compliance = compliance_among(model, nodes);
  const auto n = std::ssize(vertices);
  JointPress press{.vertex = {vertices.begin(), vertices.end()},
                   .joint_n = {},
                   .alone_n = Eigen::VectorXd(n),
                   .by_table_n = {},
                   .by_spot_n = {}};
  std::vector<PressureForces> spot;
  std::vector<SingleContact> single;
  std::vector<CurveView> curve;
  Eigen::VectorXd penetration_m(n);
  Eigen::VectorXd depth_m(n);
  single.reserve(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const SingleContact& contact =
        single.emplace_back(alone(scene, model, compliance, nodes[i]));
    curve.push_back(contact.curve.view());
    const double touch_m = nodes[i].indentation.sample.front().penetration_m;
    spot.push_back(contact_spot(model, compliance, nodes[i]));
    // Share 0 is the first touch, share 1 the largest depth.
    penetration_m[k] = touch_m + depth_share[k] * (nodes[i].path.depth_max_m - touch_m);
    depth_m[k] = contact.depth_m(penetration_m[k]);
    press.alone_n[k] = curve.back().at(depth_m[k]).force_n;
  }
  // The joint solve is the reference of two predictions by single curves. They couple
  // by the compliance table, and by compliances between the contacts' pressures.
  press.joint_n =
      joint_forces_n(model, all, compliance.among(all), nodes, penetration_m);
  press.by_table_n = coupled_forces_n(
      curve, depth_m, by_table(coupling, body.surface.position_m, vertices));
  press.by_spot_n = coupled_forces_n(curve, depth_m, between_spots(compliance, spot));
  return press;
}

std::size_t sets_of_build(const Scene& scene) {
  const std::size_t sets = 2 * static_cast<std::size_t>(scene.accuracy.verify);
  return sets < kChecksToCalibrate ? 0 : sets;
}

CouplingStudy coupling_errors(const Scene& scene, const BodySource& body,
                              const SharedTool& tool,
                              std::span<const std::int32_t> vertices,
                              const ComplianceTable& coupling,
                              const JointOptions& options, Progress& progress) {
  const double radius_m = contact_radius_m(tool->shape(), scene.reach.depth_max_m);
  const ContactFocus focus = contact_focus(scene, body);
  CouplingStudy study;
  for (const std::size_t contacts : options.contacts) {
    study.by_count.push_back(
        {.contacts = contacts, .alone = {}, .by_table = {}, .by_spot = {}});
  }
  std::mutex adding;
  std::size_t done = 0;
  in_parallel(options.sets, [&](std::size_t i) {
    std::mt19937_64 random(options.seed + i);
    const std::vector<std::int32_t> set =
        set_of_contacts(vertices, body.surface.position_m,
                        {kClosestInRadii * radius_m, kFarthestInRadii * radius_m},
                        options.contacts.back(), random);
    const Eigen::VectorXd share =
        Eigen::VectorXd::NullaryExpr(std::ssize(set), [&](Eigen::Index) {
          return 0.5 + 0.5 * static_cast<double>(random() % 1024) / 1023.0;
        });
    std::vector<std::int32_t> ascending = set;
    std::sort(ascending.begin(), ascending.end());
    // What a set throws leaves it out.
    const std::string failure = failure_of("its set", [&] {
      const BodyModel model = make_graded_model(scene, body, ascending, focus);
      std::vector<double> of_set;
      for (CouplingErrors& of : study.by_count) {
        if (of.contacts > set.size()) {
          continue;
        }
        const JointPress press =
            press_jointly(scene, body, model, tool, std::span(set).first(of.contacts),
                          share.head(static_cast<Eigen::Index>(of.contacts)), coupling);
        const std::lock_guard lock(adding);
        ++of.sets;
        add_errors(press.joint_n, press.alone_n, of.alone);
        add_errors(press.joint_n, press.by_table_n, of.by_table);
        add_errors(press.joint_n, press.by_spot_n, of.by_spot);
        add_errors(press.joint_n, press.by_table_n, of_set);
      }
      if (!of_set.empty()) {
        const std::lock_guard lock(adding);
        study.worst_by_table.push_back(*std::max_element(of_set.begin(), of_set.end()));
      }
    });
    const std::lock_guard lock(adding);
    study.left_out += failure.empty() ? 0 : 1;
    progress.advance(++done, options.sets, "sets");
  });
  std::sort(study.worst_by_table.begin(), study.worst_by_table.end());
  for (CouplingErrors& of : study.by_count) {
    for (auto* values : {&of.alone, &of.by_table, &of.by_spot}) {
      std::sort(values->begin(), values->end());
    }
  }
  return study;
}

}  // namespace palpate
