#include "precompute/press/relaxation_shares.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/QR>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/material/material_spectrum.h"
#include "precompute/press/work_unit_solver.h"
#include "precompute/process/parallel.h"

namespace palpate {
namespace {

// Force along the tool's way at the samples of a press's path.
using Forces = std::vector<double>;

Forces forces_of(const PressedNode& node) {
  Forces force_n;
  for (const IndentationSample& sample : node.indentation.sample) {
    force_n.push_back(sample.force_n.dot(node.path.outward));
  }
  return force_n;
}

// The transformed force over the sudden one at equal depths: the factor between the two
// in least squares, and the rms of what it misses, over the largest F(0).
struct ForceRatio {
  double factor = 0.0;
  double rms = 0.0;
};

ForceRatio ratio_of(const Forces& relaxed_n, const Forces& sudden_n) {
  // A softer body's path may go on where the other's force was capped.
  const auto samples =
      static_cast<Eigen::Index>(std::min(relaxed_n.size(), sudden_n.size()));
  const Eigen::Map<const Eigen::VectorXd> relaxed(relaxed_n.data(), samples);
  const Eigen::Map<const Eigen::VectorXd> sudden(sudden_n.data(), samples);
  const double squares = sudden.squaredNorm();
  if (samples < 2 || !(squares > 0.0) || !relaxed.allFinite() || !sudden.allFinite()) {
    return {};
  }
  // F_s = factor F_0 in least squares: factor = F_s . F_0 / F_0 . F_0.
  ForceRatio ratio{.factor = relaxed.dot(sudden) / squares};
  ratio.rms = (relaxed - ratio.factor * sudden).norm() /
              (std::sqrt(static_cast<double>(samples)) * sudden.maxCoeff());
  return ratio;
}

// Linear presses of all tools, of the scene as it is at one rate: [tool][node].
std::vector<std::vector<Forces>> presses(
    const Scene& scene, const BodySource& body, const PressStrategy& strategy,
    std::span<const std::vector<std::int32_t>> vertices) {
  std::vector<std::int32_t> any;
  for (const auto& some : vertices) {
    any.insert(any.end(), some.begin(), some.end());
  }
  std::sort(any.begin(), any.end());
  any.erase(std::unique(any.begin(), any.end()), any.end());
  Progress silent(nullptr);  // the caller tells
  const SceneSolver solver(scene, body, strategy, any, any, silent);
  const std::vector<WorkUnit> units = units_of(scene, body, any);
  std::vector<std::vector<Forces>> force_n(vertices.size());
  for (std::size_t t = 0; t < vertices.size(); ++t) {
    std::vector<Forces> of_vertex(static_cast<std::size_t>(body.normal.rows()));
    in_parallel(units.size(), [&](std::size_t i) {
      if (!units[i].is_check) {
        for (const PressedNode& node : solver.linear(body.tool[t], units[i].vertex)) {
          of_vertex[static_cast<std::size_t>(node.vertex)] = forces_of(node);
        }
      }
    });
    for (const std::int32_t v : vertices[t]) {
      force_n[t].push_back(std::move(of_vertex[static_cast<std::size_t>(v)]));
    }
  }
  return force_n;
}

// Nodes that no press describes take the row of the nearest that one does. @param known
// whether a press describes each vertex.
void fill_from_nearest(const BodySource& body, std::span<const std::int32_t> vertices,
                       const std::vector<bool>& known, Viscoelasticity& shares) {
  const float worst =
      *std::max_element(shares.error_relative.begin(), shares.error_relative.end());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (known[i]) {
      continue;
    }
    double nearest_m2 = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < vertices.size(); ++j) {
      const double distance_m2 = (body.surface.position_m.row(vertices[i]) -
                                  body.surface.position_m.row(vertices[j]))
                                     .squaredNorm();
      if (known[j] && distance_m2 < nearest_m2) {
        nearest_m2 = distance_m2;
        shares.g.row(vertices[i]) = shares.g.row(vertices[j]);
      }
    }
    shares.error_relative[static_cast<std::size_t>(vertices[i])] = worst;
  }
}

// Nodes without a response have the mean: elements at the rim blend it with others'.
void fill_others(std::span<const std::int32_t> vertices, Viscoelasticity& shares) {
  std::vector<bool> others(static_cast<std::size_t>(shares.g.rows()), true);
  Eigen::RowVectorXf sum = Eigen::RowVectorXf::Zero(shares.g.cols());
  for (const std::int32_t v : vertices) {
    others[static_cast<std::size_t>(v)] = false;
    sum += shares.g.row(v);
  }
  for (std::size_t v = 0; v < others.size() && !vertices.empty(); ++v) {
    if (others[v]) {
      shares.g.row(static_cast<Eigen::Index>(v)) =
          sum / static_cast<float>(vertices.size());
    }
  }
}

// One tool's table from sudden forces and those at each rate: [rate][node].
Viscoelasticity table_of(const BodySource& body, std::span<const std::int32_t> vertices,
                         const std::vector<double>& tau_s,
                         const std::vector<double>& rate_per_s,
                         const std::vector<Forces>& sudden_n,
                         const std::vector<std::vector<Forces>>& relaxed_n) {
  const auto nodes = body.normal.rows();
  Viscoelasticity shares;
  shares.tau_s = tau_s;
  shares.instantaneous = true;
  shares.g.setZero(nodes, static_cast<Eigen::Index>(tau_s.size()));
  shares.error_relative.assign(static_cast<std::size_t>(nodes), 0.0F);
  std::vector<bool> known(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    Eigen::VectorXd share(static_cast<Eigen::Index>(rate_per_s.size()));
    double squares = 0.0;
    for (std::size_t k = 0; k < rate_per_s.size(); ++k) {
      // Transform of F(t) / F(0) at rate s_k, one number for all depths.
      const ForceRatio ratio = ratio_of(relaxed_n[k][i], sudden_n[i]);
      share[static_cast<Eigen::Index>(k)] = ratio.factor;
      squares += ratio.rms * ratio.rms / static_cast<double>(rate_per_s.size());
    }
    known[i] = (share.array() > 0.0).all();
    if (known[i]) {
      const FittedShares fit = fit_shares(tau_s, rate_per_s, share);
      shares.g.row(vertices[i]) = fit.g.cast<float>();
      // Misses of the fit over the rates, and of one number for all depths.
      shares.error_relative[static_cast<std::size_t>(vertices[i])] =
          static_cast<float>(std::sqrt(fit.rms * fit.rms + squares));
    }
  }
  if (!vertices.empty() && std::find(known.begin(), known.end(), true) == known.end()) {
    throw NumericalError("no linear press of the body tells how it relaxes");
  }
  fill_from_nearest(body, vertices, known, shares);
  fill_others(vertices, shares);
  return shares;
}

}  // namespace

FittedShares fit_shares(const std::vector<double>& tau_s,
                        const std::vector<double>& rate_per_s,
                        const Eigen::VectorXd& share) {
  const auto terms = static_cast<Eigen::Index>(tau_s.size());
  // A g = 1 - share, A_ik = 1 / (1 + s_i tau_k).
  Eigen::MatrixXd A(share.size(), terms);
  for (Eigen::Index k = 0; k < terms; ++k) {
    for (Eigen::Index i = 0; i < share.size(); ++i) {
      A(i, k) = relaxed_part(tau_s[static_cast<std::size_t>(k)],
                             rate_per_s[static_cast<std::size_t>(i)]);
    }
  }
  const Eigen::VectorXd relaxed = 1.0 - share.array();
  FittedShares best{Eigen::RowVectorXd::Zero(terms), relaxed.norm()};
  // Of at most 2^4 sets of terms the best whose shares are all positive: the minimum
  // over g >= 0 is that of its own positive terms.
  for (unsigned set = 1; set < 1U << tau_s.size(); ++set) {
    std::vector<Eigen::Index> column;
    for (Eigen::Index k = 0; k < terms; ++k) {
      if ((set >> k & 1U) != 0U) {
        column.push_back(k);
      }
    }
    const Eigen::MatrixXd own = A(Eigen::all, column);
    const Eigen::VectorXd g = own.colPivHouseholderQr().solve(relaxed);
    const double missed = (own * g - relaxed).norm();
    if ((g.array() >= 0.0).all() && g.sum() <= 1.0 && missed < best.rms) {
      best.g.setZero();
      best.g(column) = g.transpose();
      best.rms = missed;
    }
  }
  best.rms /= std::sqrt(static_cast<double>(share.size()));
  return best;
}

std::vector<Viscoelasticity> relaxation_shares(
    const Scene& scene, const BodySource& body, const PressStrategy& strategy,
    std::span<const std::vector<std::int32_t>> vertices,
    const std::vector<double>& tau_s, Progress& progress) {
  PressStrategy linear = strategy;
  linear.nonlinear = false;
  const std::vector<double> rate_per_s = fitted_rates_per_s(tau_s);
  // The infinite rate stands for the sudden press: its moduli are not relaxed.
  std::vector<double> all_per_s{std::numeric_limits<double>::infinity()};
  all_per_s.insert(all_per_s.end(), rate_per_s.begin(), rate_per_s.end());
  std::vector<std::vector<std::vector<Forces>>> force_n(vertices.size());
  progress.stage("relaxation");
  for (std::size_t i = 0; i < all_per_s.size(); ++i) {
    const Scene relaxed = transformed_scene(scene, all_per_s[i]);
    BodySource relaxed_body = body;
    relaxed_body.material = materials_of(relaxed);
    auto of_tools = presses(relaxed, relaxed_body, linear, vertices);
    for (std::size_t t = 0; t < vertices.size(); ++t) {
      force_n[t].push_back(std::move(of_tools[t]));
    }
    progress.advance(i + 1, all_per_s.size(), "rates");
  }
  progress.finish();
  std::vector<Viscoelasticity> tables;
  for (std::size_t t = 0; t < vertices.size(); ++t) {
    const std::vector<Forces> sudden_n = std::move(force_n[t].front());
    force_n[t].erase(force_n[t].begin());
    tables.push_back(
        table_of(body, vertices[t], tau_s, rate_per_s, sudden_n, force_n[t]));
  }
  return tables;
}

}  // namespace palpate
