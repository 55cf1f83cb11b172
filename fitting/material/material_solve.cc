#include "fitting/material/material_solve.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <ceres/ceres.h>

namespace palpate {
namespace {

// Residuals of a curve: baseline + f(parameters, x - contact) - measured.
struct CurveResiduals {
  const ScaledMaterialCurve& curve;

  template <typename T>
  bool operator()(T const* const* blocks, T* residual) const {
    // (baseline + e^q f(parameters, d) / force_n - measured) / sigma. The sweep's law
    // gives ln f of ln parameters and ln d; q is the factor of the sweep's own error.
    const std::size_t p = curve.law.dimensions() - 1;
    std::vector<T> x(blocks[0], blocks[0] + p);
    x.emplace_back(0.0);
    const T& contact = blocks[1][0];
    const T& baseline = blocks[1][1];
    const T factor = exp(blocks[2][0]);
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      const T d = curve.x[i] - contact;
      T f = baseline - curve.f[i];
      if (d > 0.0) {
        x[p] = log(d * curve.length_m);
        f += factor * exp(curve.law.log_force(x.data())) / curve.force_n;
      }
      residual[i] = f / curve.sigma;
    }
    return true;
  }
};

// The sweep's forces are expected to be right.
struct FactorResidual {
  double sd;

  template <typename T>
  bool operator()(const T* log_factor, T* residual) const {
    residual[0] = log_factor[0] / sd;
    return true;
  }
};

using CostFunction = ceres::DynamicAutoDiffCostFunction<CurveResiduals, 4>;

// A problem over `state`, which must outlive it.
void add_curves(const std::vector<ScaledMaterialCurve>& curves, MaterialState& state,
                double factor_sd, ceres::Problem& problem) {
  for (std::size_t c = 0; c < curves.size(); ++c) {
    auto* cost = new CostFunction(new CurveResiduals{curves[c]});  // the problem's
    cost->AddParameterBlock(static_cast<int>(state.log_parameter.size()));
    cost->AddParameterBlock(2);
    cost->AddParameterBlock(1);
    cost->SetNumResiduals(static_cast<int>(curves[c].x.size()));
    problem.AddResidualBlock(cost, nullptr, state.log_parameter.data(),
                             state.contact_baseline[c].data(), &state.log_factor);
    problem.SetParameterLowerBound(state.contact_baseline[c].data(), 0, -0.5);
    problem.SetParameterUpperBound(state.contact_baseline[c].data(), 0, 0.95);
  }
  if (factor_sd > 0.0) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<FactorResidual, 1, 1>(  // the problem's
            new FactorResidual{factor_sd}),
        nullptr, &state.log_factor);
  } else {
    problem.SetParameterBlockConstant(&state.log_factor);
  }
}

void hold(MaterialState& state, int held, ceres::Problem& problem) {
  double* block = state.log_parameter.data();
  if (state.log_parameter.size() == 1) {
    problem.SetParameterBlockConstant(block);
  } else {
    problem.SetManifold(
        block, new ceres::SubsetManifold(static_cast<int>(state.log_parameter.size()),
                                         {held}));
  }
}

Eigen::MatrixXd dense(const ceres::CRSMatrix& sparse) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
  for (int i = 0; i < sparse.num_rows; ++i) {
    for (int k = sparse.rows[static_cast<std::size_t>(i)];
         k < sparse.rows[static_cast<std::size_t>(i) + 1]; ++k) {
      const auto at = static_cast<std::size_t>(k);
      matrix(i, sparse.cols[at]) = sparse.values[at];
    }
  }
  return matrix;
}

}  // namespace

MaterialSolve solve_material(const std::vector<ScaledMaterialCurve>& curves,
                             const MaterialState& start, const MaterialBox& box,
                             double factor_sd, std::optional<int> held) {
  MaterialSolve result{.state = start};
  ceres::Problem problem;
  add_curves(curves, result.state, factor_sd, problem);
  double* block = result.state.log_parameter.data();
  for (int j = 0; j < static_cast<int>(box.lower.size()); ++j) {
    if (held != j) {  // a held one may lie on its bound
      problem.SetParameterLowerBound(block, j, box.lower[j]);
      problem.SetParameterUpperBound(block, j, box.upper[j]);
    }
  }
  if (held) {
    hold(result.state, *held, problem);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-12;
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-11;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  result.squares = 2.0 * summary.final_cost;
  result.converged = summary.termination_type == ceres::CONVERGENCE;
  result.iterations = static_cast<int>(summary.iterations.size());
  return result;
}

std::vector<double> material_residuals(const ScaledMaterialCurve& curve,
                                       const MaterialState& state, std::size_t place) {
  std::vector<double> residual(curve.x.size());
  const double* blocks[] = {state.log_parameter.data(),
                            state.contact_baseline[place].data(), &state.log_factor};
  CurveResiduals{curve}(blocks, residual.data());
  for (double& r : residual) {
    r *= curve.sigma;
  }
  return residual;
}

Eigen::MatrixXd material_covariance(const std::vector<ScaledMaterialCurve>& curves,
                                    const MaterialState& state, double factor_sd) {
  MaterialState at = state;
  ceres::Problem problem;
  add_curves(curves, at, factor_sd, problem);
  std::vector<double*> blocks{at.log_parameter.data()};
  for (Eigen::Vector2d& block : at.contact_baseline) {
    blocks.push_back(block.data());
  }
  if (factor_sd > 0.0) {
    blocks.push_back(&at.log_factor);
  }
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = blocks;
  ceres::CRSMatrix sparse;
  problem.Evaluate(options, nullptr, nullptr, nullptr, &sparse);
  // (J^T J)^-1 of residuals over their sd, columns scaled to norm 1. The small diagonal
  // keeps directions that no curve determines from being singular.
  const Eigen::MatrixXd J = dense(sparse);
  const Eigen::VectorXd scale = J.colwise().norm().cwiseMax(1e-300);
  const Eigen::MatrixXd S = J * scale.cwiseInverse().asDiagonal();
  Eigen::MatrixXd N = S.transpose() * S;
  N.diagonal().array() += 1e-12;
  const Eigen::MatrixXd covariance =
      scale.cwiseInverse().asDiagonal() *
      N.ldlt().solve(Eigen::MatrixXd::Identity(N.rows(), N.rows())) *
      scale.cwiseInverse().asDiagonal();
  const Eigen::Index p = at.log_parameter.size();
  return covariance.topLeftCorner(p, p);
}

}  // namespace palpate
