#include "fitting/curve/family_solve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fitting/numerics/bounded_linear.h"
#include "fitting/numerics/correlated_noise.h"
#include "fitting/numerics/least_squares.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr Eigen::Index kStartSamples = 200;
constexpr int kBins = 16, kHalvings = 8;
constexpr std::size_t kSamplesPerBin = 1;
constexpr double kOffMax = 8.0;  // times the median: 1 of 250 for chi squared of two
constexpr double kContactMax = 0.9;  // [-] of the depth

std::span<const double> shape_of(const Eigen::VectorXd& q) {
  return {q.data() + kFamilyShared, static_cast<std::size_t>(q.size() - kFamilyShared)};
}

FamilyData every(const FamilyData& data, Eigen::Index most) {
  const Eigen::Index step = std::max<Eigen::Index>(1, data.x.size() / most);
  if (step == 1) {
    return data;
  }
  FamilyData thin = data;
  const auto rows = Eigen::seq(0, data.x.size() - 1, step);
  thin.x = data.x(rows);
  thin.f = data.f(rows);
  thin.weight = data.weight(rows);
  return thin;
}

void fill_row(const CurveFamily& family, const Eigen::VectorXd& q, double x,
              std::span<double> row) {
  const double d = x - q[kFamilyContact];
  row[kFamilyForce] = 1.0;
  row[kFamilySlope] = x;
  row[kFamilyContact] = -family.at(shape_of(q), d).slope;
  family.gradient(shape_of(q), d, row.subspan(kFamilyShared));
}

LeastSquaresProblem joint_problem(const FamilyData& data, const CurveFamily& family,
                                  bool contact_free) {
  const auto p = static_cast<Eigen::Index>(family.parameters().size()) + kFamilyShared;
  LeastSquaresProblem problem;
  problem.residuals = problem.in_a_row = static_cast<int>(data.x.size());
  problem.lower = Eigen::VectorXd::Constant(p, -kInf);
  problem.upper = Eigen::VectorXd::Constant(p, kInf);
  problem.lower[kFamilyContact] = data.contact_min;
  problem.upper[kFamilyContact] = kContactMax;
  problem.held.assign(static_cast<std::size_t>(p), false);
  problem.held[kFamilySlope] = data.flat;
  problem.held[kFamilyContact] = !contact_free;
  for (Eigen::Index j = kFamilyShared; j < p; ++j) {
    const auto& bound =
        family.parameters()[static_cast<std::size_t>(j - kFamilyShared)];
    problem.lower[j] = bound.lower;
    problem.upper[j] = bound.upper;
  }
  problem.evaluate = [&data, &family](const Eigen::VectorXd& q,
                                      Eigen::Ref<Eigen::VectorXd> r,
                                      RowMajorMatrix* jacobian) {
    for (Eigen::Index i = 0; i < data.x.size(); ++i) {
      r[i] = data.weight[i] * (scaled_force(family, q, data.x[i]) - data.f[i]);
      if (jacobian != nullptr) {
        fill_row(family, q, data.x[i],
                 {jacobian->data() + i * q.size(), static_cast<std::size_t>(q.size())});
        jacobian->row(i) *= data.weight[i];
      }
    }
    return true;
  };
  return problem;
}

std::vector<Eigen::VectorXd> joint_starts(const FamilyData& data,
                                          const CurveFamily& family, double contact,
                                          bool contact_free) {
  std::vector<double> contacts{contact};
  if (contact_free) {
    contacts.push_back(std::max(data.contact_min, contact - 0.1));
  }
  std::vector<Eigen::VectorXd> starts;
  for (const double x0 : contacts) {
    for (const Eigen::VectorXd& shape : family.starts()) {
      Eigen::VectorXd q(kFamilyShared + shape.size());
      q << data.baseline_force, data.flat ? 0.0 : data.baseline_slope, x0, shape;
      starts.push_back(q);
    }
  }
  return starts;
}

// What held each parameter, the number of those that nothing held, and covariance.
void describe(const LeastSquaresProblem& problem, const FamilyData& data,
              FamilySolution& solution) {
  const std::vector<bool> bound = at_bound(problem, solution.q);
  solution.free_parameters = 0;
  for (std::size_t j = 0; j < bound.size(); ++j) {
    const auto k = static_cast<Eigen::Index>(j);
    std::string reason;
    if (problem.held[j]) {
      reason = j == kFamilyContact && !data.contact_held ? "power law" : "assumed";
    } else if (bound[j]) {
      reason = solution.q[k] - problem.lower[k] < problem.upper[k] - solution.q[k]
                   ? "lower bound"
                   : "upper bound";
    }
    solution.free_parameters += reason.empty() ? 1 : 0;
    solution.held.push_back(std::move(reason));
  }
  solution.covariance = least_squares_covariance(problem, solution.q);
}

void solve_joint(const FamilyData& data, double contact, bool contact_free,
                 const Eigen::VectorXd* warm, FamilySolution& solution) {
  const CurveFamily& family = *solution.family;
  Eigen::VectorXd start;
  if (warm != nullptr) {
    start = *warm;
  } else {
    const FamilyData thin = every(data, kStartSamples);
    LeastSquaresOptions rough;
    rough.tolerance = 1e-6;
    const LeastSquaresReport best =
        solve_from_starts(joint_problem(thin, family, contact_free),
                          joint_starts(thin, family, contact, contact_free), rough);
    start = best.q;
    solution.iterations += best.iterations;
  }
  LeastSquaresOptions options;
  options.tolerance = warm != nullptr ? 1e-8 : 1e-12;
  const LeastSquaresProblem problem = joint_problem(data, family, contact_free);
  const LeastSquaresReport last = solve_least_squares(problem, start, options);
  solution.q = last.q;
  solution.converged = last.converged;
  solution.iterations += last.iterations;
  if (warm == nullptr) {
    describe(problem, data, solution);
  }
}

// Linear in all parameters but the contact point, which is held: solved exactly.
void solve_linear(const FamilyData& data, double contact, FamilySolution& solution) {
  const CurveFamily& family = *solution.family;
  const auto p = static_cast<Eigen::Index>(family.parameters().size());
  Eigen::VectorXd q = Eigen::VectorXd::Zero(kFamilyShared + p);
  q[kFamilyContact] = contact;
  RowMajorMatrix A(data.x.size(), kFamilyShared + p);
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    fill_row(family, q, data.x[i],
             {A.data() + i * A.cols(), static_cast<std::size_t>(A.cols())});
  }
  std::vector<int> columns{kFamilyForce};
  if (!data.flat) {
    columns.push_back(kFamilySlope);
  }
  std::vector<bool> not_negative(columns.size(), false);
  for (int j = kFamilyShared; j < A.cols(); ++j) {
    columns.push_back(j);
    not_negative.push_back(true);
  }
  const Eigen::MatrixXd weighted = data.weight.asDiagonal() * A(Eigen::all, columns);
  q(columns) =
      solve_not_negative(weighted, data.weight.cwiseProduct(data.f), not_negative);
  solution.q = q;
  solution.converged = q.allFinite();
  solution.iterations = 1;
  describe(joint_problem(data, family, false), data, solution);
}

// Samples in contact in the order of their depth, cut into bins.
struct Bins {
  std::vector<Eigen::Index> order;   // of the samples
  std::vector<std::size_t> begin;    // of each bin in it, and the end
  std::vector<double> depth, force;  // means, [-]

  [[nodiscard]] std::size_t count() const { return depth.size(); }
  [[nodiscard]] double samples(std::size_t bin) const {
    return static_cast<double>(begin[bin + 1] - begin[bin]);
  }
};

// Cuts at these places, less those that leave a bin empty or no deeper than the last.
void cut(const FamilyData& data, double contact, const std::vector<std::size_t>& cuts,
         Bins& bins) {
  bins.begin = {0};
  bins.depth.clear();
  bins.force.clear();
  for (const std::size_t end : cuts) {
    double depth = 0.0, force = 0.0;
    for (std::size_t i = bins.begin.back(); i < end; ++i) {
      const Eigen::Index k = bins.order[i];
      depth += data.x[k] - contact;
      force += data.f[k] - data.baseline_force -
               (data.flat ? 0.0 : data.baseline_slope) * data.x[k];
    }
    const auto samples = static_cast<double>(end - bins.begin.back());
    if (samples > 0.0 &&
        depth / samples > (bins.depth.empty() ? 0.0 : bins.depth.back())) {
      bins.depth.push_back(depth / samples);
      bins.force.push_back(force / samples);
      bins.begin.push_back(end);
    }
  }
}

Bins even_bins(const FamilyData& data, double contact) {
  Bins bins;
  for (Eigen::Index i = 0; i < data.x.size(); ++i) {
    if (data.x[i] > contact) {
      bins.order.push_back(i);
    }
  }
  std::stable_sort(bins.order.begin(), bins.order.end(), [&](auto a, auto b) {
    return data.x[a] < data.x[b];
  });
  const double deepest = data.x.maxCoeff() - contact;
  std::vector<std::size_t> cuts;
  for (int bin = 1; bin <= kBins; ++bin) {
    const double end = contact + deepest * bin / kBins;
    const auto beyond =
        bin == kBins ? bins.order.end()
                     : std::find_if(bins.order.begin(), bins.order.end(), [&](auto i) {
                         return data.x[i] >= end;
                       });
    cuts.push_back(static_cast<std::size_t>(beyond - bins.order.begin()));
  }
  cut(data, contact, cuts, bins);
  return bins;
}

// A cubic through the bins, and its residuals.
struct BinFit {
  Bins bins;
  std::shared_ptr<const CurveFamily> family;
  Eigen::VectorXd q, residual;
};

BinFit fit_bins(const FamilyData& data, std::string_view name, double contact,
                Bins bins) {
  BinFit fit;
  std::vector<double> force = bins.force;
  if (name == "monotone-cubic") {
    std::vector<double> samples;
    for (std::size_t bin = 0; bin < bins.count(); ++bin) {
      samples.push_back(bins.samples(bin));
    }
    force = isotonic(force, samples);
  }
  const auto p = std::ssize(force);
  fit.family = cubic_family(name, bins.depth);
  fit.q = Eigen::VectorXd::Zero(kFamilyShared + p);
  fit.q[kFamilyForce] = data.baseline_force;
  fit.q[kFamilySlope] = data.flat ? 0.0 : data.baseline_slope;
  fit.q[kFamilyContact] = contact;
  for (Eigen::Index j = 0; j < p; ++j) {
    fit.q[kFamilyShared + j] = std::max(0.0, force[static_cast<std::size_t>(j)]);
  }
  fit.residual.resize(data.x.size());
  for (Eigen::Index i = 0; i < fit.residual.size(); ++i) {
    fit.residual[i] =
        data.weight[i] * (scaled_force(*fit.family, fit.q, data.x[i]) - data.f[i]);
  }
  fit.bins = std::move(bins);
  return fit;
}

// What the means of a bin's two halves say against the curve: for noise that is white
// over a bin, chi squared of two degrees of freedom times its long-run variance.
double off_in_halves(const BinFit& fit, std::size_t bin) {
  const std::size_t begin = fit.bins.begin[bin], end = fit.bins.begin[bin + 1];
  const std::size_t half = begin + (end - begin) / 2;
  double left = 0.0, right = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    (i < half ? left : right) += fit.residual[fit.bins.order[i]];
  }
  const auto of = [](double sum, std::size_t samples) {
    return samples > 0 ? sum * sum / static_cast<double>(samples) : 0.0;
  };
  return of(left, half - begin) + of(right, end - half);
}

// Halves bins until the curve is nowhere off by more than most bins are.
BinFit adapted_bins(const FamilyData& data, std::string_view name, double contact) {
  BinFit fit = fit_bins(data, name, contact, even_bins(data, contact));
  std::vector<double> first;
  for (std::size_t bin = 0; bin < fit.bins.count(); ++bin) {
    first.push_back(off_in_halves(fit, bin));
  }
  const double limit = kOffMax * median(first);
  for (int pass = 0; pass < kHalvings; ++pass) {
    std::vector<std::size_t> cuts;
    for (std::size_t bin = 0; bin < fit.bins.count(); ++bin) {
      const std::size_t begin = fit.bins.begin[bin], end = fit.bins.begin[bin + 1];
      if (end - begin >= 2 * kSamplesPerBin && off_in_halves(fit, bin) > limit) {
        cuts.push_back(begin + (end - begin) / 2);
      }
      cuts.push_back(end);
    }
    if (cuts.size() == fit.bins.count()) {
      break;
    }
    cut(data, contact, cuts, fit.bins);
    fit = fit_bins(data, name, contact, fit.bins);
  }
  return fit;
}

void solve_bins(const FamilyData& data, std::string_view name, double contact,
                FamilySolution& solution) {
  const BinFit fit = adapted_bins(data, name, contact);
  const auto p = std::ssize(fit.bins.depth);
  solution.family = fit.family;
  solution.q = fit.q;
  const double variance = long_run_variance(
      noises_of(Eigen::MatrixXd(fit.residual.size(), 0), fit.residual));
  solution.covariance = Eigen::MatrixXd::Zero(kFamilyShared + p, kFamilyShared + p);
  for (Eigen::Index j = 0; j < p; ++j) {
    solution.covariance(kFamilyShared + j, kFamilyShared + j) =
        variance / fit.bins.samples(static_cast<std::size_t>(j));
  }
  solution.held.assign(static_cast<std::size_t>(kFamilyShared + p), "");
  solution.held[kFamilyForce] = solution.held[kFamilySlope] = "power law";
  solution.held[kFamilyContact] = data.contact_held ? "assumed" : "power law";
  solution.free_parameters = static_cast<int>(p) + (data.flat ? 1 : 2);
  solution.converged = p > 0;
}

}  // namespace

bool has_contact_of_its_own(std::string_view family) {
  return family == "power-law" || family == "quadratic-linear" ||
         family == "linear-exponential";
}

FamilySolution solve_family(const FamilyData& data, std::string_view family,
                            double contact, bool contact_free,
                            const Eigen::VectorXd* warm) {
  FamilySolution solution;
  solution.family = family_by_name(family);
  if (!solution.family) {
    solve_bins(data, family, contact, solution);
  } else if (solution.family->linear()) {
    solve_linear(data, contact, solution);
  } else {
    solve_joint(data, contact, contact_free, warm, solution);
  }
  return solution;
}

double scaled_force(const CurveFamily& family, const Eigen::VectorXd& q, double x) {
  return q[kFamilyForce] + q[kFamilySlope] * x +
         family.at(shape_of(q), x - q[kFamilyContact]).force;
}

Eigen::VectorXd scaled_gradient(const CurveFamily& family, const Eigen::VectorXd& q,
                                double x) {
  Eigen::VectorXd row(q.size());
  fill_row(family, q, x, {row.data(), static_cast<std::size_t>(row.size())});
  return row;
}

}  // namespace palpate
