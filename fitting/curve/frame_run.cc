#include "fitting/curve/frame_run.h"

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/chi_squared.hpp>
#include <fmt/format.h>

#include "fitting/curve/misfit.h"
#include "fitting/curve/power_law_fit.h"
#include "fitting/numerics/bounded_linear.h"
#include "fitting/numerics/correlated_noise.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kFromForce = 0.005;     // [-] of the largest: below it contact forms
constexpr std::size_t kMedianReach = 2;  // neighbours on each side of a median
constexpr double kPiecesApart = 0.02;    // [-] of the largest force
constexpr double kSignificance = 1e-3;

// Samples in contact.
struct Contact {
  Eigen::ArrayXd x, f;  // (n) [m], [N] above the baseline
};

// From the last sample on whose force does not stand out of the noise: no law of the
// contact is needed for that.
Contact in_contact(const Approach& approach, const ContactFit& fit) {
  std::vector<double> x = approach.displacement_m, f;
  for (std::size_t i = 0; i < x.size(); ++i) {
    f.push_back(approach.force_n[i] - fit.parameters[0].value -
                fit.parameters[1].value * x[i]);
  }
  const double least = std::max(kFromForce * *std::max_element(f.begin(), f.end()),
                                3.0 * approach.noise_sd_n);
  const std::vector<double> smooth = running_median(f, kMedianReach);
  const auto free = std::find_if(smooth.rbegin(), smooth.rend(), [&](double force) {
    return force < least;
  });
  const auto begin = smooth.rend() - free;
  x.erase(x.begin(), x.begin() + begin);
  f.erase(f.begin(), f.begin() + begin);
  if (x.size() < kFrameSamplesMin) {
    throw InputError(fmt::format("the frame's run has {} samples in contact, need {}",
                                 x.size(), kFrameSamplesMin));
  }
  const auto n = static_cast<Eigen::Index>(x.size());
  return {Eigen::Map<Eigen::ArrayXd>(x.data(), n),
          Eigen::Map<Eigen::ArrayXd>(f.data(), n)};
}

// A force curve linear in its parameters, fitted.
struct Pieces {
  Eigen::ArrayXd knot;       // (m + 1) [m]
  Eigen::VectorXd q;         // (m + 1) force at the first knot [N], slopes [N/m]
  Eigen::VectorXd residual;  // (n) [N]
  Eigen::MatrixXd jacobian;  // (n x m + 1)
};

Pieces fit_pieces(const Contact& c, int pieces) {
  Pieces fit;
  fit.knot = Eigen::ArrayXd::LinSpaced(pieces + 1, c.x.minCoeff(), c.x.maxCoeff());
  fit.jacobian = Eigen::MatrixXd::Ones(c.x.size(), pieces + 1);
  const double width = fit.knot[1] - fit.knot[0];
  // Column j + 1 rises from 0 to 1 over piece j and stays: q is what the force rises
  // by.
  for (int j = 0; j < pieces; ++j) {
    fit.jacobian.col(j + 1) = (c.x - fit.knot[j]).max(0.0).min(width).matrix() / width;
  }
  std::vector<bool> not_negative(static_cast<std::size_t>(pieces) + 1, true);
  not_negative[0] = false;
  fit.q = solve_not_negative(fit.jacobian, c.f.matrix(), not_negative);
  fit.residual = c.f.matrix() - fit.jacobian * fit.q;
  // From rises to slopes [N/m], in the Jacobian as well.
  fit.q.tail(pieces) /= width;
  fit.jacobian.rightCols(pieces) *= width;
  return fit;
}

double residual_rms(const Eigen::VectorXd& residual) {
  return residual.norm() / std::sqrt(static_cast<double>(residual.size()));
}

bool pieces_fit_better(const Contact& c, const Pieces& line, const Pieces& pieces,
                       double largest_n) {
  const double apart = ((line.residual - pieces.residual).cwiseAbs()).maxCoeff();
  if (!(apart > kPiecesApart * largest_n)) {
    return false;
  }
  const auto samples = static_cast<std::size_t>(c.x.size());
  const ResidualNoise noise({c.x.data(), samples}, {pieces.residual.data(), samples});
  const boost::math::chi_squared by_chance(kFramePieces - 1.0);
  const double deviance = noise.deviance({line.residual.data(), samples});
  return deviance > 0.0 &&
         boost::math::cdf(boost::math::complement(by_chance, deviance)) < kSignificance;
}

// The plate was met where the first piece, gone back, has no force.
FrameCompliance bent_frame(const Pieces& fit) {
  FrameCompliance frame;
  frame.linear = false;
  frame.force_n = {0.0};
  frame.deflection_m = {0.0};
  double force = fit.q[0];
  const double width = fit.knot[1] - fit.knot[0];
  const double met_m = fit.knot[0] - fit.q[0] / fit.q[1];
  for (Eigen::Index j = 0; j < fit.knot.size(); ++j) {
    force += j > 0 ? fit.q[j] * width : 0.0;
    const double u = fit.knot[j] - met_m;
    if (force > frame.force_n.back() && u > frame.deflection_m.back()) {
      frame.force_n.push_back(force);
      frame.deflection_m.push_back(u);
    }
  }
  const double most = frame.force_n.back(), u = frame.deflection_m.back();
  frame.stiffness_n_per_m = most / u;
  // By q: of the largest force, and of u = x - x_0 + q_0 / q_1.
  Eigen::VectorXd by_q = Eigen::VectorXd::Constant(fit.q.size(), width / most);
  by_q[0] = 1.0 / most - 1.0 / (fit.q[1] * u);
  by_q[1] += fit.q[0] / (fit.q[1] * fit.q[1] * u);
  const Eigen::MatrixXd covariance =
      covariance_under_noise(fit.jacobian, fit.residual, fit.residual.size());
  frame.stiffness_sd_n_per_m = most / u * std::sqrt(by_q.dot(covariance * by_q));
  return frame;
}

}  // namespace

FrameRun frame_of_run(const Measurement& measurement) {
  const Approach approach = select_approach(measurement);
  const ContactFit contact = fit_contact(approach);
  if (contact.has(FitFlag::kEmptyRun)) {
    throw InputError("the frame's run is empty: its force never leaves the noise");
  }
  const Contact samples = in_contact(approach, contact);
  const Pieces line = fit_pieces(samples, 1),
               pieces = fit_pieces(samples, kFramePieces);
  if (!(line.q[1] > 0.0)) {
    throw InputError(
        "the frame's run has a force that does not rise with displacement");
  }
  FrameRun run;
  run.force_max_n = samples.f.maxCoeff();
  run.samples = static_cast<std::size_t>(samples.x.size());
  run.straight_rms_n = residual_rms(line.residual);
  // What was taken off for the baseline's slope is as uncertain as that.
  const double contact_sd = contact.parameters[1].sd;
  const double slope_sd = std::isfinite(contact_sd) ? contact_sd : 0.0;
  if (pieces_fit_better(samples, line, pieces, run.force_max_n)) {
    if (contact.has(FitFlag::kAlreadyInContact) || !(pieces.q[1] > 0.0)) {
      throw InputError(
          "the frame's run begins in contact, and the stiffness is not constant: begin "
          "it before the plate is met");
    }
    run.rms_n = residual_rms(pieces.residual);
    run.frame = bent_frame(pieces);
    run.frame.stiffness_sd_n_per_m =
        std::hypot(run.frame.stiffness_sd_n_per_m, slope_sd);
    return run;
  }
  const Eigen::MatrixXd covariance =
      covariance_under_noise(line.jacobian, line.residual, line.residual.size());
  run.rms_n = run.straight_rms_n;
  run.frame =
      linear_frame(line.q[1], std::hypot(std::sqrt(covariance(1, 1)), slope_sd));
  return run;
}

}  // namespace palpate
