#include "fitting/curve/family_solve.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fitting/curve/family_bins.h"
#include "fitting/numerics/bounded_linear.h"
#include "fitting/numerics/correlated_noise.h"
#include "fitting/numerics/least_squares.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr Eigen::Index kStartSamples = 200;
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
  // r_i = w_i (baseline + slope x_i + family(x_i - contact) - f_i), all parameters at
  // once.
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
void finish_solution(const LeastSquaresProblem& problem, const FamilyData& data,
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
  // 1. From all starts on thinned samples, unless a solution near is known.
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
  // 2. From the best on all samples.
  LeastSquaresOptions options;
  options.tolerance = warm != nullptr ? 1e-8 : 1e-12;
  const LeastSquaresProblem problem = joint_problem(data, family, contact_free);
  const LeastSquaresReport last = solve_least_squares(problem, start, options);
  solution.q = last.q;
  solution.converged = last.converged;
  solution.iterations += last.iterations;
  if (warm == nullptr) {
    finish_solution(problem, data, solution);
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
  // Baseline columns are free, those of the family not negative; the contact point is
  // held.
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
  finish_solution(joint_problem(data, family, false), data, solution);
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
    return solve_bins(data, family, contact);
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
